//! Pass 1 of Algorithm 3: the nearest layer in high quality, by the single pass.

use super::Settings;
use crate::composite::decide;
use crate::frame::stencil::{Function, Operation, Outcome, Stencil};
use crate::method::Job;
use crate::method::clock::{Work, spend};
pub(crate) use crate::method::single_pass;
use crate::method::single_pass::compositing::Composite;
use crate::method::surface::SurfacePixel;
use crate::method::tiled::{Tiled, pixels};
use crate::number::{Exact, MapInline, Vector3};
use crate::shade::phong::Shader;
use crate::splat::View;

/// The stencil of pixels that the nearest layer covers: 1.
pub(super) const MASK: Stencil =
    Stencil { reference: 1, pass: Operation::Replace, ..Stencil::DISABLED };

/// Fragments of the other layers pass where the nearest layer is.
pub(crate) const BEHIND: Stencil =
    Stencil { function: Function::Equal, pass: Operation::Keep, ..MASK };

/// The nearest layer at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrontLayer<R> {
    /// Depth Z of its nearest fragment; +inf where there is none.
    pub(crate) depth: R,
    /// The surfel of that fragment.
    pub(crate) id: u32,
    /// Sum of the weights.
    pub(crate) weight: R,
    /// Direction of the average normal, in world space.
    pub(crate) normal: [R; 3],
    /// `C_F`: Phong-shaded.
    pub(crate) color: [R; 3],
    /// alpha: the average opacity, in [0, 1].
    pub(crate) opacity: R,
    /// The stencil, see [`MASK`].
    pub(crate) mask: u8,
}

/// The settings of the single pass that draws the nearest layer.
pub(crate) fn single_pass(settings: &Settings) -> single_pass::Settings {
    single_pass::Settings { splats: settings.layers.splats, depth: settings.nearest }
}

/// Normalization, deferred shading and the mask over the picture.
pub(super) fn nearest<R: Exact>(
    job: &Job<'_>,
    composites: &Tiled<Composite<R>>,
) -> Tiled<FrontLayer<R>> {
    spend(Work::Shade);
    let shading = Shading::new(job);
    Tiled::new(job, |tile, rect| {
        let composites = pixels(rect).zip(composites.tile(tile));
        composites.map(|(at, composite)| shading.layer(at, composite)).collect()
    })
}

/// Shades the nearest layer.
pub(super) struct Shading<R> {
    shader: Shader<R>,
    /// The colour of surfels that have none.
    own: Option<[R; 3]>,
}

impl<R: Exact> Shading<R> {
    pub(super) fn new(job: &Job<'_>) -> Self {
        let scene = job.scene;
        let colored = scene.surfels.color().is_some();
        let own = (!colored).then(|| scene.material.color.to_array().map_inline(R::from_f32));
        Self { shader: Shader::new(View::new(job.camera), &scene.lights, scene.material), own }
    }

    /// The nearest layer at a column and row.
    pub(super) fn layer(&self, (x, y): (u32, u32), composite: &Composite<R>) -> FrontLayer<R> {
        let SurfacePixel { depth, id, weight, normal, color } = composite.surface();
        let [nx, ny, nz] = normal;
        let (at, n) = ((x as usize, y as usize), Vector3::new(nx, ny, nz));
        let surface = self.own.unwrap_or(color);
        let color = self.shader.pixel(at, depth, n, Vector3::ZERO, surface);
        let outcome = if composite.count > 0 { Outcome::Pass } else { Outcome::DepthFail };
        let (opacity, mask) = (composite.opacity(), MASK.update(0, outcome));
        FrontLayer { depth, id, weight, normal, color, opacity, mask }
    }
}

impl<R: Exact> FrontLayer<R> {
    /// Whether the layer is strictly before a fragment at depth `t`. The fragment then belongs to
    /// the other layers: the stencil test passes, and the fragment is beyond the visible band.
    pub(super) fn is_before(&self, t: R, epsilon: R) -> bool {
        BEHIND.test(self.mask) && !decide::visible(t, decide::limit(self.depth, epsilon))
    }
}
