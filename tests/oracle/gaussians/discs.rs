//! Discs that meet the rays of pixels: each ray meets a plane in the camera's space, and each box comes
//! from the planes through the eye that touch the disc.
//!
//! How far rounding moves a number is found by moving what it is computed from.

use crate::oracle::gaussians::bounds::Bounds;
use crate::oracle::gaussians::model::{Model, tips};
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::eye::{V3, cross, dot, scaled, sub, unit, wide};
use splatref::method::gaussians::{Settings, Support};
use splatref::splat::ray_disc::DiscRule;

/// A disc in the camera frame: its centre and its axes of one deviation, and by how much rounding may
/// move each.
pub(crate) struct Disc {
    center: V3,
    axes: [V3; 2],
    moves: [V3; 3],
    /// The middle of the filter, and by how much it may move.
    filter: [[f64; 2]; 2],
}

/// A disc at a pixel.
pub(crate) struct Met {
    pub(crate) rho: Conditioned,
    pub(crate) depth: Conditioned,
    /// Whether there is a fragment.
    pub(crate) met: bool,
    pub(crate) sure: bool,
}

/// The box of a disc: its middle, the squares of its half sides, and whether the disc is in front.
#[derive(Clone, Copy)]
struct Side {
    middle: [f64; 2],
    square: [f64; 2],
    front: bool,
}

impl Disc {
    /// The disc itself, and the disc with each number moved to either side.
    fn moved(&self) -> Vec<(V3, [V3; 2])> {
        let mut all = vec![(self.center, self.axes)];
        for which in 0..3 {
            for part in 0..3 {
                for sign in [-1.0, 1.0] {
                    let (mut center, mut axes) = (self.center, self.axes);
                    let by = sign * self.moves[which][part];
                    match which {
                        0 => center[part] += by,
                        _ => axes[which - 1][part] += by,
                    }
                    all.push((center, axes));
                }
            }
        }
        all
    }
}

/// A number and the sum of what moves it.
fn conditioned(all: &[f64], own: f64) -> Conditioned {
    let value = all[0];
    let moved = all[1..].chunks(2).map(|pair| pair.iter().map(|v| (v - value).abs()));
    let condition: f64 = moved.map(|pair| pair.fold(0.0, f64::max)).sum();
    Conditioned { value, condition: condition + own * value.abs() }
}

impl Model<'_> {
    pub(crate) fn meets_rays(&self) -> bool {
        self.settings.kernel.disc != DiscRule::Projected
    }

    /// The axes of an item in the world.
    fn axes(&self, i: usize) -> [V3; 2] {
        let surfels = &self.scene.surfels;
        let shape = self.shape(i);
        if self.scene.gaussians.is_some() || surfels.tangents().is_some() {
            return [shape.spread[0], shape.spread[1]];
        }
        let n = unit(wide(surfels.normal()[i]));
        let s = f64::from(surfels.radius()[i]) / f64::from(self.settings.cutoff);
        let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).expect("three");
        let mut other = [0.0; 3];
        other[least] = 1.0;
        let u = unit(cross(n, other));
        [scaled(u, s), scaled(cross(n, u), s)]
    }

    pub(crate) fn disc(&self, i: usize, center: &[Conditioned; 3]) -> Disc {
        let axes = self.axes(i).map(|axis| self.turned(axis));
        let at = center.map(|c| c.value);
        let slope = if self.eye.perspective {
            let width = f64::from(self.camera.width) / self.eye.fx;
            1.0 + (at[0] / at[2]).abs() + (at[1] / at[2]).abs() + width
        } else {
            1.0
        };
        let size = |axis: V3| axis.iter().map(|v| v.abs()).sum::<f64>();
        let moved = axes.map(|axis| [8.0 * self.step * size(axis) * slope; 3]);
        let moves = [center.map(|c| c.condition), moved[0], moved[1]];
        let mut disc = Disc { center: at, axes, moves, filter: [[0.0; 2]; 2] };
        let screen = self.screen(center);
        disc.filter = [screen.map(|s| s.value), screen.map(|s| s.condition)];
        if self.settings.kernel.disc == DiscRule::RayBox {
            let sides = self.sides(&disc, self.settings.cutoff.into());
            let along = |axis: usize| {
                let all: Vec<f64> = sides.iter().map(|side| side.middle[axis]).collect();
                conditioned(&all, 8.0 * self.step)
            };
            let middle = [along(0), along(1)];
            disc.filter = [middle.map(|m| m.value), middle.map(|m| m.condition)];
        }
        disc
    }

    /// The box of r deviations, of the disc and of each that is moved. The plane through the eye and
    /// the line x = e has the normal N = (f, 0, -(e - c)), and touches the disc where (N . m)^2 = r^2
    /// ((N . a)^2 + (N . b)^2): a quadratic equation in e.
    fn sides(&self, disc: &Disc, r: f64) -> Vec<Side> {
        let eye = &self.eye;
        let one = |(m, [a, b]): (V3, [V3; 2])| {
            let form = |v: V3, x: usize, y: usize| v[x] * v[y];
            let sum = |x: usize, y: usize| form(m, x, y) - r * r * (form(a, x, y) + form(b, x, y));
            let side = |axis: usize| {
                let (f, c) = ([eye.fx, eye.fy][axis], [eye.cx, eye.cy][axis]);
                if !eye.perspective {
                    let square = r * r * f * f * (a[axis] * a[axis] + b[axis] * b[axis]);
                    return (c + f * m[axis], square);
                }
                let middle = f * sum(axis, 2) / sum(2, 2);
                (c + middle, middle * middle - f * f * sum(axis, axis) / sum(2, 2))
            };
            let (x, y) = (side(0), side(1));
            let front = !eye.perspective || sum(2, 2) > 0.0;
            Side { middle: [x.0, y.0], square: [x.1, y.1], front }
        };
        disc.moved().into_iter().map(one).collect()
    }

    /// The bounds that a disc may have, and those that it has for certain.
    pub(crate) fn bounds_of_disc(&self, disc: &Disc, o: f64) -> [Bounds; 2] {
        let Settings { support, cutoff, least_alpha, .. } = *self.settings;
        let (k, least) = (f64::from(cutoff), f64::from(least_alpha));
        let dense = (2.0 * (o / least).ln()).sqrt();
        let whole = Bounds([[0.0, 1e9], [0.0, 1e9]]);
        let dense = if least == 0.0 { [whole, whole] } else { self.around_disc(disc, dense) };
        let own = match support {
            Support::None => dense,
            Support::Ellipse => self.around_disc(disc, k),
            Support::Tiles => {
                let filter = k * f64::from(self.settings.kernel.low_pass).sqrt();
                self.tiles_of_disc(disc, k, |[x, y]| [x.max(y).max(filter); 2])
            }
            Support::Boxes => self.tiles_of_disc(disc, 1.0, |half| half.map(|h| k * h)),
        };
        let size = [self.camera.width, self.camera.height].map(f64::from);
        [0, 1].map(|i| {
            Bounds([0, 1].map(|a| {
                let ([first, last], [from, to]) = (own[i].0[a], dense[i].0[a]);
                [first.max(from).max(0.0), last.min(to).min(size[a] - 1.0)]
            }))
        })
    }

    fn around_disc(&self, disc: &Disc, r: f64) -> [Bounds; 2] {
        let (none, whole) = (Bounds([[0.0, -1.0]; 2]), Bounds([[0.0, 1e9]; 2]));
        if r.is_nan() {
            return [none, none];
        }
        let sides = self.sides(disc, r);
        match sides.iter().filter(|side| side.front).count() {
            0 => return [whole, whole],
            n if n < sides.len() => return [whole, none],
            _ => {}
        }
        let roomy = |side: f64| side * (1.0 + 1.0 / 1024.0) + 1.0;
        let blurred = roomy(r * f64::from(self.settings.kernel.low_pass).sqrt());
        let ends = |axis: usize| {
            let all = |of: fn(&Side, usize) -> f64| -> Vec<f64> {
                sides.iter().map(|side| of(side, axis)).collect()
            };
            let middle = conditioned(&all(|side, axis| side.middle[axis]), 8.0 * self.step);
            let half = conditioned(&all(|s, axis| s.square[axis].max(0.0).sqrt()), 1e-6);
            let (at, by) = (disc.filter[0][axis], disc.filter[1][axis]);
            let e = roomy(half.value);
            let slack = 1e-6 * (at.abs() + e) + 16.0 * (middle.condition + half.condition + by);
            let least = (middle.value - e).min(at - blurred);
            let most = (middle.value + e).max(at + blurred);
            [slack, -slack].map(|s| [(least - s - 0.5).ceil(), (most + s - 0.5).floor()])
        };
        let [x, y] = [ends(0), ends(1)];
        [Bounds([x[0], y[0]]), Bounds([x[1], y[1]])]
    }

    fn tiles_of_disc(
        &self,
        disc: &Disc,
        r: f64,
        extent: impl Fn([f64; 2]) -> [f64; 2],
    ) -> [Bounds; 2] {
        let square = self.settings.support == Support::Tiles;
        let sides = self.sides(disc, r);
        let mut ends = [[[f64::INFINITY, f64::NEG_INFINITY]; 2], [[0.0, 1e9]; 2]];
        // Several may move at once.
        for side in &sides {
            let half = side.square.map(|square| square.max(1e-4).sqrt());
            let extents = extent(half);
            for axis in 0..2 {
                let slack = 1e-6 * (side.middle[axis].abs() + extents[axis])
                    + 8.0 * (side.middle[axis] - sides[0].middle[axis]).abs();
                for (which, sign) in [(0, 1.0), (1, -1.0)] {
                    let e = (extents[axis] + sign * slack).ceil();
                    let [low, high] = [
                        side.middle[axis] - e - sign * slack,
                        side.middle[axis] + e + sign * slack,
                    ];
                    let [low, high] = if square { [low - 0.5, high - 1.5] } else { [low, high] };
                    let [first, last] =
                        [(low / 16.0).floor() * 16.0, (high / 16.0).floor() * 16.0 + 15.0];
                    let [from, to] = &mut ends[which][axis];
                    if which == 0 {
                        (*from, *to) = (from.min(first), to.max(last));
                    } else {
                        (*from, *to) = (from.max(first), to.min(last));
                    }
                }
            }
        }
        ends.map(Bounds)
    }

    /// Where the ray of a point of the picture meets the plane: rho3d, and the depth.
    fn hit(&self, [x, y]: [f64; 2], (m, [a, b]): (V3, [V3; 2])) -> [f64; 2] {
        let eye = &self.eye;
        let (u, v) = ((x - eye.cx) / eye.fx, (y - eye.cy) / eye.fy);
        let (origin, ray) =
            if eye.perspective { ([0.0; 3], [u, v, 1.0]) } else { ([u, v, 0.0], [0.0, 0.0, 1.0]) };
        let n = cross(a, b);
        let depth = dot(sub(m, origin), n) / dot(ray, n);
        let p = [0, 1, 2].map(|k| origin[k] + depth * ray[k] - m[k]);
        let square = dot(n, n);
        let (s, t) = (dot(cross(p, b), n) / square, dot(cross(a, p), n) / square);
        [s * s + t * t, depth]
    }

    /// A disc at a pixel by its column and row.
    pub(crate) fn meet(&self, disc: &Disc, t: Conditioned, [i, j]: [f64; 2]) -> Met {
        let at = [i + 0.5, j + 0.5];
        let near = f64::from(self.settings.kernel.near);
        let near = if near == 0.0 { self.eye.near } else { near };
        let mut hits: Vec<[f64; 2]> =
            disc.moved().into_iter().map(|moved| self.hit(at, moved)).collect();
        let screen = [0, 1].map(|axis| {
            let far = at[axis].abs()
                + disc.filter[0][axis].abs()
                + [self.eye.cx, self.eye.cy][axis].abs();
            2.0 * self.step * far
        });
        for axis in 0..2 {
            for sign in [-1.0, 1.0] {
                let mut moved = at;
                moved[axis] += sign * screen[axis];
                hits.push(self.hit(moved, (disc.center, disc.axes)));
            }
        }
        let all = |k: usize| hits.iter().map(|hit| hit[k]).collect::<Vec<f64>>();
        let (rho3d, z) =
            (conditioned(&all(0), 32.0 * self.step), conditioned(&all(1), 32.0 * self.step));
        let rho2d = self.blurred(disc, at);
        let least = hits.iter().map(|hit| hit[0]).fold(f64::INFINITY, f64::min);
        let far = rho3d.value.is_nan() || least > 1.001 * rho2d.value;
        let less = rho3d.value <= rho2d.value;
        let open = rho2d.value.is_finite()
            && !far
            && tips(rho3d.value - rho2d.value, rho2d.value, rho3d.condition + rho2d.condition);
        let before = z.value >= near;
        let near_open = !z.condition.is_finite() || tips(z.value - near, near, z.condition);
        if self.settings.kernel.disc == DiscRule::RayBox {
            let rho = if less { rho3d } else { rho2d };
            let steep = !rho.condition.is_finite();
            // No ray meets a line or a point.
            if disc.axes.contains(&[0.0; 3]) {
                return Met { rho, depth: z, met: false, sure: true };
            }
            return Met { rho, depth: z, met: before, sure: !near_open && !steep };
        }
        let shows = less && before;
        let met = shows || self.settings.kernel.low_pass > 0.0;
        let sure = !open && (far || !near_open) && (rho3d.condition.is_finite() || far);
        let (rho, depth) = if shows { (rho3d, z) } else { (rho2d, t) };
        Met { rho, depth, met, sure }
    }

    /// rho2d.
    fn blurred(&self, disc: &Disc, at: [f64; 2]) -> Conditioned {
        let h = f64::from(self.settings.kernel.low_pass);
        if h == 0.0 {
            return Conditioned::exact(f64::INFINITY);
        }
        let [x, y] = [0, 1].map(|axis| {
            let value = disc.filter[0][axis] - at[axis];
            Conditioned { value, condition: disc.filter[1][axis] + self.step * value.abs() }
        });
        let sum = x * x + y * y;
        let value = sum.value / h;
        Conditioned { value, condition: sum.condition / h + 8.0 * self.step * value }
    }
}
