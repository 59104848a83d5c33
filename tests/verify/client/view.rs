//! The camera, and what all splats of a picture share.

use super::How;
use super::bug::Bug;
use super::number::{Number, Vector, sum};
use glam::Vec3;
use splatref::scene::{Camera, Projection, Scene, Surfels};
use splatref::splat::{Epsilon, Outline, SplatSettings};

/// The uniforms of every shader.
pub(crate) struct Shared<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) how: How,
    pub(crate) rows: [[Number; 4]; 3],
    pub(crate) perspective: bool,
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    pub(crate) fx: Number,
    pub(crate) fy: Number,
    pub(crate) cx: Number,
    pub(crate) cy: Number,
    pub(crate) near: Number,
    pub(crate) outline: Outline,
    /// k.
    pub(crate) cutoff: Number,
    /// What q is compared with.
    pub(crate) limit: Number,
    /// h, in px^2.
    pub(crate) low_pass: Number,
    /// In world units.
    pub(crate) epsilon: Number,
    /// The number that the settings have for it, and whether it counts radii.
    pub(crate) written: f32,
    pub(crate) in_radii: bool,
    pub(crate) cull: bool,
}

impl<'a> Shared<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &Camera,
        settings: &SplatSettings,
        how: How,
    ) -> Self {
        let number = |value| how.habit.number(value);
        let columns = camera.view_from_world.to_cols_array();
        let row = |i: usize| [0, 4, 8, 12].map(|j| number(columns[i + j]));
        let cutoff = number(settings.kernel.cutoff);
        let h = settings.kernel.low_pass;
        Self {
            scene,
            how,
            rows: [row(0), row(1), row(2)],
            perspective: matches!(camera.projection, Projection::Perspective),
            size: camera.size(),
            fx: number(camera.fx),
            fy: number(camera.fy),
            cx: number(if how.has(Bug::PrincipalPointOff) { camera.cx + 0.5 } else { camera.cx }),
            cy: number(camera.cy),
            near: number(camera.near),
            outline: settings.kernel.outline,
            cutoff,
            limit: match how.bug {
                Some(Bug::CutoffNotSquared) => cutoff,
                Some(Bug::CutoffSmaller) => cutoff * cutoff * (1.0 - 1e-5),
                Some(Bug::CutoffLarger) => cutoff * cutoff * (1.0 + 1e-5),
                Some(Bug::CutoffBarelySmaller) => cutoff * cutoff * (1.0 - 2e-6),
                Some(Bug::CutoffBarelyLarger) => cutoff * cutoff * (1.0 + 2e-6),
                Some(Bug::CutoffVisiblySmaller) => cutoff * cutoff * (1.0 - 4e-5),
                Some(Bug::CutoffVisiblyLarger) => cutoff * cutoff * (1.0 + 4e-5),
                _ => cutoff * cutoff,
            },
            low_pass: match how.bug {
                Some(Bug::LowPassMissing) => number(0.0),
                Some(Bug::LowPassDoubled) => number(2.0 * h),
                _ => number(h),
            },
            epsilon: match how.bug {
                Some(Bug::EpsilonHalf) => epsilon(settings, &scene.surfels, how) * 0.5,
                Some(Bug::EpsilonDouble) => epsilon(settings, &scene.surfels, how) * 2.0,
                Some(Bug::EpsilonIgnored) => number(f32::INFINITY),
                _ => epsilon(settings, &scene.surfels, how),
            },
            written: match settings.epsilon {
                Epsilon::World(number) | Epsilon::MedianRadii(number) => number,
            },
            in_radii: matches!(settings.epsilon, Epsilon::MedianRadii(_)),
            cull: settings.cull,
        }
    }

    /// The length of the ray of a pixel up to depth 1.
    pub(crate) fn ray(&self, pixel: [u32; 2]) -> Number {
        let one = self.number(1.0);
        if !self.perspective {
            return one;
        }
        let [x, y] = pixel.map(|side| self.number(side as f32 + 0.5));
        let (x, y) = ((x - self.cx) / self.fx, (y - self.cy) / self.fy);
        sum(x * x, y * y, one).sqrt()
    }

    pub(crate) fn number(&self, value: f32) -> Number {
        self.how.habit.number(value)
    }

    pub(crate) fn vector(&self, [x, y, z]: [f32; 3]) -> Vector {
        [self.number(x), self.number(y), self.number(z)]
    }

    /// A point of the world in view space.
    pub(crate) fn point(&self, world: Vec3) -> Vector {
        let [x, y, z] = self.vector(world.to_array());
        self.rows.map(|m| sum(m[0] * x, m[1] * y, m[2] * z) + m[3])
    }

    /// A direction of the world in view space.
    pub(crate) fn direction(&self, world: Vec3) -> Vector {
        let [x, y, z] = self.vector(world.to_array());
        self.rows.map(|m| sum(m[0] * x, m[1] * y, m[2] * z))
    }

    /// The nearness of a depth.
    pub(crate) fn nearness(&self, t: Number) -> Number {
        if self.perspective { t.reciprocal() } else { -t }
    }

    /// The nearness of an empty pixel.
    pub(crate) fn empty(&self) -> f32 {
        if self.perspective { 0.0 } else { f32::NEG_INFINITY }
    }
}

/// Epsilon in world units; the median is the lower one.
fn epsilon(settings: &SplatSettings, surfels: &Surfels, how: How) -> Number {
    let meant = match settings.epsilon {
        Epsilon::World(number) if how.has(Bug::EpsilonOtherUnit) => Epsilon::MedianRadii(number),
        Epsilon::MedianRadii(number) if how.has(Bug::EpsilonOtherUnit) => Epsilon::World(number),
        own => own,
    };
    match meant {
        Epsilon::World(depth) => how.habit.number(depth),
        Epsilon::MedianRadii(count) => {
            let mut radii = surfels.radius().to_vec();
            radii.sort_by(f32::total_cmp);
            how.habit.number(radii[(radii.len() - 1) / 2]) * count
        }
    }
}
