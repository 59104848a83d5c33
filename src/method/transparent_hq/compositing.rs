//! Pass 3 of Algorithm 3: the nearest layer before the others, and the light refracted through it.

use super::Settings;
use super::nearest::FrontLayer;
use crate::composite::over::Blend;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::tiled::{Tiled, pixels};
use crate::method::transparent::averaging::GroupAverage;
use crate::number::{Exact, MapInline, Real, Truth, Vector3};
use crate::scene::{Environment, Scene};
use crate::shade::optics::{self, Behind, NearestLayer};
use crate::splat::View;

/// The colour and opacity of each pixel before the environment.
pub(super) fn compositing<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    nearest: &Tiled<FrontLayer<R>>,
    others: &Tiled<GroupAverage<R>>,
) -> Tiled<Blend<R>> {
    spend(Work::Over);
    let through = Through::new(job, settings, Environment::radiance);
    Tiled::new(job, |tile, rect| {
        let layers = nearest.tile(tile).iter().zip(others.tile(tile));
        pixels(rect)
            .zip(layers)
            .map(|(at, (near, others))| through.pixel(at, near, others))
            .collect()
    })
}

/// Composites what is seen through the nearest layer.
pub(crate) struct Through<'a, R: Real> {
    scene: &'a Scene,
    settings: &'a Settings,
    view: View<R>,
    light: Light<R>,
}

/// The light that arrives from a direction.
type Light<R> = fn(&Environment, Vector3<R>) -> [R; 3];

impl<'a, R: Real> Through<'a, R> {
    pub(crate) fn new(job: &Job<'a>, settings: &'a Settings, light: Light<R>) -> Self {
        Self { scene: job.scene, settings, view: View::new(job.camera), light }
    }

    /// Whether light is bent at the nearest layer.
    pub(super) fn bends(&self) -> bool {
        self.settings.refraction.is_some() && self.scene.environment.is_some()
    }

    /// The colour and the opacity of a pixel at a column and row.
    pub(crate) fn pixel(
        &self,
        (x, y): (u32, u32),
        near: &FrontLayer<R>,
        others: &GroupAverage<R>,
    ) -> Blend<R> {
        let there = near.depth.is_finite();
        // In balls the layer may be there and may be missing; then both results are joined below.
        if !there.possibly() {
            return others.blend;
        }
        let shown = self.before((x, y), near, others);
        let part = |c: usize| R::select(there, shown.color[c], others.blend.color[c]);
        let alpha = R::select(there, shown.alpha, others.blend.alpha);
        Blend { color: [0, 1, 2].map_inline(part), alpha }
    }

    /// The nearest layer before the others.
    fn before(
        &self,
        (x, y): (u32, u32),
        near: &FrontLayer<R>,
        others: &GroupAverage<R>,
    ) -> Blend<R> {
        let (Some(refraction), Some(environment)) =
            (&self.settings.refraction, &self.scene.environment)
        else {
            return others.blend.over(near.opacity, near.color);
        };
        let [nx, ny, nz] = near.normal;
        let nearest = NearestLayer {
            color: near.color,
            opacity: near.opacity,
            normal: Vector3::new(nx, ny, nz),
        };
        let GroupAverage { blend, opacity, hidden, .. } = *others;
        let behind = Behind { color: blend.color, opacity, hidden };
        let view = -self.view.ray(x, y).normalized();
        let light = |direction| (self.light)(environment, direction);
        let color = optics::shade_before(light, refraction, view, &nearest, &behind);
        Blend { color, alpha: R::ONE }
    }
}

/// l of \[ZP06, section 5.2.3\]: 1 + the sum of the other layers' opacities over the opacity of the
/// nearest layer; 0 where the opacity of the nearest layer is 0.
pub(crate) fn count_by_opacity<R: Real>(near: &FrontLayer<R>, others: &GroupAverage<R>) -> R {
    let alpha = near.opacity;
    R::select(alpha.gt(R::ZERO), R::ONE + optics::layers(others.opacity, alpha), R::ZERO)
}

/// The count of layers: the count of the other layers, plus one where there is a nearest layer.
pub(crate) fn count<R: Real>(near: &FrontLayer<R>, others: &GroupAverage<R>) -> R {
    R::select(near.depth.is_finite(), others.layers + R::ONE, others.layers)
}
