//! Attribute splatting: weighted sums over the fragments within epsilon of the nearest
//! \[GBP04, section 3\].

use super::visibility::Foremost;
use crate::composite::{decide, sum};
use crate::frame::stencil::{Outcome, Stencil};
use crate::method::Job;
use crate::method::buffer_formats::Buffers;
use crate::method::clock::{Work, spend};
use crate::method::fragment::{TileSplats, facing};
use crate::method::prepare::Prepared;
use crate::method::tiled::Tiled;
use crate::number::{Exact, Real};
use crate::scene::Surfels;
use crate::splat::Splat;
use glam::Vec3;

/// The sums of a pixel so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sums<R> {
    pub(crate) weight: R,
    /// Weights times normals.
    pub(crate) normal: [R; 3],
    /// Weights times colours; 0 where the scene has none.
    pub(crate) color: [R; 3],
    /// Weights times opacities; an opacity that the scene does not have is 1.
    pub(crate) opacity: R,
    /// How many fragments, up to 255.
    pub(crate) count: u8,
}

/// Attribute splatting over the picture.
pub(crate) fn attributes<R: Exact>(
    job: &Job<'_>,
    splats: &Prepared<R, Splat<R>>,
    visible: &Tiled<Foremost<R>>,
) -> Tiled<Sums<R>> {
    let surfels = &job.scene.surfels;
    Tiled::new(job, |tile, rect| {
        let splats = TileSplats::new(splats, tile, rect);
        sums(&splats, surfels, job.buffers, visible.tile(tile), |_, _| true)
    })
}

/// The sums over the fragments that are inside, for which `candidate` holds (as in
/// [`super::visibility::foremost`]) and that pass the epsilon-z test against the nearest fragment.
/// The fragments are added in ascending surfel index, and each sum is stored as its buffer stores
/// it.
pub(crate) fn sums<R: Exact>(
    tile: &TileSplats<'_, R>,
    surfels: &Surfels,
    buffers: Buffers,
    nearest: &[Foremost<R>],
    candidate: impl Fn(usize, R) -> bool,
) -> Vec<Sums<R>> {
    spend(Work::Attributes);
    let (shared, epsilon) = (tile.shared(), tile.epsilon());
    let mut pixels = vec![Sums::NONE; tile.rect.pixels()];
    tile.each_inside(|splat, pixel, q, w| {
        let limit = decide::limit(nearest[pixel].depth, epsilon);
        if candidate(pixel, w) && decide::visible(shared.depth(w), limit) {
            let sums = &mut pixels[pixel];
            sums.add(surfels, splat.surfel, splat.back, splat.footprint.weight(q));
            *sums = sums.stored(buffers);
        }
    });
    pixels
}

impl<R: Real> Sums<R> {
    /// No fragment.
    pub(crate) const NONE: Self = Self {
        weight: R::ZERO,
        normal: [R::ZERO; 3],
        color: [R::ZERO; 3],
        opacity: R::ZERO,
        count: 0,
    };

    /// The sums as buffers hold them.
    fn stored(self, buffers: Buffers) -> Self
    where
        R: Exact,
    {
        Self {
            weight: buffers.sum(self.weight),
            normal: buffers.vector(self.normal),
            color: buffers.color(self.color),
            opacity: buffers.sum(self.opacity),
            ..self
        }
    }

    /// Adds the attributes of a fragment; `back` says whether the back of its surfel is seen.
    pub(crate) fn add(&mut self, surfels: &Surfels, surfel: u32, back: R::Truth, weight: R) {
        let opacity = R::from_f32(surfels.opacity_of(surfel as usize));
        self.opacity = self.opacity + weight * opacity;
        self.add_opaque(surfels, surfel, back, weight);
    }

    /// As [`Sums::add`], without the opacity, because no pass reads the opacity of opaque splats.
    #[inline(always)]
    pub(crate) fn add_opaque(&mut self, surfels: &Surfels, surfel: u32, back: R::Truth, weight: R) {
        let i = surfel as usize;
        // Not by `map`, which is not inlined.
        let numbers = |v: Vec3| [R::from_f32(v.x), R::from_f32(v.y), R::from_f32(v.z)];
        let normal = facing(numbers(surfels.normal()[i]), back);
        if let Some(colors) = surfels.color() {
            self.color = sum::add(self.color, weight, numbers(colors[i]));
        }
        self.normal = sum::add(self.normal, weight, normal);
        self.weight = self.weight + weight;
        self.count = Stencil::COUNT.update(self.count, Outcome::Pass);
    }
}
