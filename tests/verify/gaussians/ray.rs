//! Discs that meet the rays of pixels, from the page of `ray_disc` alone.

use super::project::Matrix;
use super::{Bug, Shared};
use splatref::method::gaussians::Support;
use splatref::splat::ray_disc::DiscRule;

/// The images of a disc's axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    /// F.
    filter: [f32; 2],
    /// ai and bi.
    images: [[f32; 2]; 2],
    /// az and bz.
    bend: [f32; 2],
    /// a.z and b.z.
    slopes: [f32; 2],
    /// w.
    divisor: f32,
}

/// The middle of a box and the squares of its half sides, if there is a box.
struct Boxed {
    exists: bool,
    middle: [f32; 2],
    squares: [f32; 2],
}

impl Shared<'_> {
    /// Whether discs meet rays.
    pub(super) fn meets_rays(&self) -> bool {
        self.settings.kernel.disc != DiscRule::Projected
    }

    /// The disc of these axes, the columns of a matrix; none if it is degenerate.
    pub(super) fn disc(&self, m: Matrix, place: [f32; 3], center: [f32; 2]) -> Option<Disc> {
        let ([x, y, t], [fx, fy, ..]) = (place, self.lens);
        let turn = self.turn();
        let camera = |k: usize| turn.map(|row| self.dot(row, m.map(|own| own[k])));
        let axes = [camera(0), camera(1)];
        let slopes = axes.map(|axis| axis[2]);
        let mut disc = if self.perspective() {
            let (u, v) = (x / t, y / t);
            let image = |[x, y, z]: [f32; 3]| {
                [fx * self.add_product(x, -u, z), fy * self.add_product(y, -v, z)]
            };
            Disc { filter: center, images: axes.map(image), bend: slopes, slopes, divisor: t }
        } else {
            let image = |[x, y, _]: [f32; 3]| [fx * x, fy * y];
            Disc { filter: center, images: axes.map(image), bend: [0.0; 2], slopes, divisor: 1.0 }
        };
        if self.settings.kernel.disc == DiscRule::RayBox {
            disc.filter = self.boxed(&disc, center, self.settings.cutoff).middle;
        }
        let numbers = disc.images.as_flattened().iter().chain(&disc.filter).chain(&slopes);
        let finite = numbers.chain(&center).chain([&t]).all(|number| number.is_finite());
        finite.then_some(disc)
    }

    /// The box of r standard deviations.
    fn boxed(&self, disc: &Disc, center: [f32; 2], r: f32) -> Boxed {
        let Disc { images: [a, b], bend: [az, bz], divisor: w, .. } = *disc;
        let d = (r * r) * (az * az + bz * bz) - w * w;
        let c = (r * r) / d;
        let off = [0, 1].map(|k| c * (a[k] * az + b[k] * bz));
        Boxed {
            exists: d < 0.0,
            middle: [0, 1].map(|k| center[k] + off[k]),
            squares: [0, 1].map(|k| off[k] * off[k] - c * (a[k] * a[k] + b[k] * b[k])),
        }
    }

    /// The pixels that a disc may touch; none if there are none.
    pub(super) fn bounds_of_disc(
        &self,
        disc: &Disc,
        center: [f32; 2],
        opacity: f32,
    ) -> Option<[i64; 4]> {
        let (k, least) = (self.settings.cutoff, f64::from(self.settings.least_alpha));
        let filter = f64::from(self.settings.kernel.low_pass).sqrt();
        let half = |square: f32| f64::from(if square > 1e-4 { square } else { 1e-4 }).sqrt();
        let tiles = |r: f32, extent: &dyn Fn([f64; 2]) -> [f64; 2]| {
            let own = self.boxed(disc, center, r);
            if !own.middle.iter().chain(&own.squares).all(|number| number.is_finite()) {
                return Some(self.whole());
            }
            let tile = if self.how.has(Bug::TilesOf8) { 8 } else { 16 };
            self.pixels(own.middle.map(f64::from), extent(own.squares.map(half)), tile)
        };
        match self.settings.support {
            Support::Ellipse => self.around(disc, center, k),
            Support::None if f64::from(opacity) < least => None,
            Support::None => {
                let r = (2.0 * core_math::log(f64::from(opacity) / least)).sqrt();
                self.around(disc, center, r as f32)
            }
            Support::Tiles => tiles(k, &|[x, y]| {
                let widest = [x, y].into_iter().fold(f64::from(k) * filter, f64_greater);
                [widest.ceil(); 2]
            }),
            Support::Boxes => tiles(1.0, &|sides| sides.map(|side| (f64::from(k) * side).ceil())),
        }
    }

    /// The pixels within r standard deviations of a disc or of its filter.
    fn around(&self, disc: &Disc, center: [f32; 2], r: f32) -> Option<[i64; 4]> {
        let own = self.boxed(disc, center, r);
        if !own.exists {
            return Some(self.whole());
        }
        let roomy = |side: f64| side * (1.0 + 1.0 / 1024.0) + 1.0;
        let sides = own.squares.map(|square| roomy(f64::from(square).sqrt()));
        let blurred = roomy(f64::from(r) * f64::from(self.settings.kernel.low_pass).sqrt());
        let shown = self.pixels(own.middle.map(f64::from), sides, 1);
        let filter = self.pixels(disc.filter.map(f64::from), [blurred; 2], 1);
        match (shown, filter) {
            (Some(a), Some(b)) => {
                Some([a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])])
            }
            (one, other) => one.or(other),
        }
    }

    fn whole(&self) -> [i64; 4] {
        [0, 0, self.size[0].into(), self.size[1].into()]
    }

    /// rho and the depth of a disc at a place on the screen, if its ray meets the disc.
    pub(super) fn meet(
        &self,
        disc: &Disc,
        (center, t): ([f32; 2], f32),
        [x, y]: [f32; 2],
    ) -> Option<(f32, f32)> {
        let Disc { filter, images: [a, b], bend: [az, bz], slopes, divisor: w } = *disc;
        let (dx, dy) = (x - center[0], y - center[1]);
        let k = [self.add_product(a[0], -dx, az), self.add_product(b[0], -dx, bz)];
        let l = [self.add_product(a[1], -dy, az), self.add_product(b[1], -dy, bz)];
        let d = self.difference(k[0], l[1], k[1], l[0]);
        let u = (w * self.difference(dx, l[1], dy, k[1])) / d;
        let v = (w * self.difference(dy, k[0], dx, l[0])) / d;
        let rho3d = self.add_product(u * u, v, v);
        let z = t + self.add_product(u * slopes[0], v, slopes[1]);
        let h = self.settings.kernel.low_pass;
        let (ex, ey) = (filter[0] - x, filter[1] - y);
        let rho2d = if h > 0.0 { self.add_product(ex * ex, ey, ey) / h } else { f32::INFINITY };
        let kernel = &self.settings.kernel;
        let near = if kernel.near == 0.0 { self.camera.near } else { kernel.near };
        if kernel.disc == DiscRule::RayBox {
            let rho = if rho3d <= rho2d { rho3d } else { rho2d };
            return (z >= near && d != 0.0).then_some((rho, z));
        }
        if z >= near && rho3d <= rho2d {
            return Some((rho3d, z));
        }
        (h > 0.0).then_some((rho2d, t))
    }
}

fn f64_greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}
