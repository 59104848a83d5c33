//! A pixel: the fragments of all splats, and the sums over those that are drawn, written as
//! products.

use crate::oracle::gaussians::model::{Model, Splat, tips};
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::eye::dot;
use splatref::frame::NO_ID;
use splatref::method::gaussians::{Order, Support};

/// A splat at a pixel.
struct Fragment<'a> {
    splat: &'a Splat,
    alpha: Conditioned,
    depth: Conditioned,
    /// Whether another number in its last digits would neither drop nor admit it.
    sure: bool,
}

/// A pixel after blending.
pub(crate) struct Pixel {
    /// Whether rounding may change what is drawn here.
    pub(crate) open: bool,
    /// Whether rounding may change which fragment is the heaviest, or the median.
    pub(crate) open_heaviest: bool,
    pub(crate) open_median: bool,
    pub(crate) color: [Conditioned; 3],
    pub(crate) through: Conditioned,
    pub(crate) depth: Conditioned,
    pub(crate) expected: Conditioned,
    pub(crate) median: Conditioned,
    pub(crate) id: u32,
    pub(crate) heaviest: u32,
    pub(crate) count: usize,
}

const ONE: Conditioned = Conditioned::exact(1.0);
const FAR: Conditioned = Conditioned::exact(f64::INFINITY);

impl Model<'_> {
    /// A pixel by its column and row, over splats in the order of the picture.
    pub(crate) fn pixel(&self, splats: &[Splat], at: [f64; 2]) -> Pixel {
        let mut fragments: Vec<_> = splats.iter().filter_map(|s| self.fragment(s, at)).collect();
        if self.settings.order == Order::Pixel {
            let key = |f: &Fragment<'_>| (f.depth.value, f.splat.item);
            fragments.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("depths"));
        }
        let mut open = fragments.iter().any(|f| !f.sure) || self.unordered(&fragments);
        let (drawn, stops_near) = self.until_the_stop(&fragments);
        open |= stops_near;
        self.sums(&fragments[..drawn], open)
    }

    /// How many fragments are drawn, and whether the stop is near.
    fn until_the_stop(&self, fragments: &[Fragment<'_>]) -> (usize, bool) {
        let (stop, mut near) = (f64::from(self.settings.stop), false);
        let mut through = ONE;
        for (i, fragment) in fragments.iter().enumerate() {
            through = through * (ONE - fragment.alpha);
            let left = through.value;
            near |= stop > 0.0 && tips(left - stop, stop, through.condition);
            // Without a stop, nothing ends where T is 0.
            if left < stop || (self.settings.stop_at && stop > 0.0 && left == stop) {
                return (i, near);
            }
        }
        (fragments.len(), near)
    }

    fn sums(&self, fragments: &[Fragment<'_>], open: bool) -> Pixel {
        let weight = |i: usize| {
            let before = fragments[..i].iter().fold(ONE, |t, f| t * (ONE - f.alpha));
            (before, before * fragments[i].alpha)
        };
        let all: Vec<_> = (0..fragments.len()).map(weight).collect();
        let zero = Conditioned::ZERO;
        let total = |of: &dyn Fn(usize) -> Conditioned| {
            let sum = (0..all.len()).fold(zero, |sum, i| sum + all[i].1 * of(i));
            let size: f64 = (0..all.len()).map(|i| (all[i].1 * of(i)).value.abs()).sum();
            let own = self.step * (2.0 + all.len() as f64) * size;
            Conditioned { value: sum.value, condition: sum.condition + own }
        };
        let mut heaviest = 0;
        for i in 1..all.len() {
            if all[i].1.value > all[heaviest].1.value {
                heaviest = i;
            }
        }
        let rival = |i: usize| {
            let gap = all[i].1.value - all[heaviest].1.value;
            // Of weights that are all 0 the first is the heaviest.
            let nothing = all[heaviest].1.value == 0.0;
            i != heaviest
                && !nothing
                && tips(gap, all[heaviest].1.value, all[i].1.condition + all[heaviest].1.condition)
        };
        let median = (0..all.len()).rev().find(|&i| all[i].0.value > 0.5);
        let beside = |i: usize| tips(all[i].0.value - 0.5, 0.5, all[i].0.condition);
        let through = fragments.iter().fold(ONE, |t, f| t * (ONE - f.alpha));
        let rounding = self.step * fragments.len() as f64;
        let weights = total(&|_| ONE);
        Pixel {
            open,
            open_heaviest: (0..all.len()).any(rival),
            open_median: (0..all.len()).any(beside),
            color: [0, 1, 2].map(|c| total(&|i| fragments[i].splat.color[c])),
            through: Conditioned { condition: through.condition + rounding, ..through },
            depth: fragments.first().map_or(FAR, |f| f.depth),
            expected: if weights.value > 0.0 {
                total(&|i| fragments[i].depth) / weights
            } else {
                FAR
            },
            median: median.map_or(FAR, |i| fragments[i].depth),
            id: fragments.first().map_or(NO_ID, |f| f.splat.item),
            heaviest: fragments.get(heaviest).map_or(NO_ID, |f| f.splat.item),
            count: fragments.len(),
        }
    }

    /// Whether the order of two fragments that are drawn one after the other is open.
    fn unordered(&self, fragments: &[Fragment<'_>]) -> bool {
        let key = |f: &Fragment<'_>| {
            if self.settings.order == Order::Pixel { f.depth } else { f.splat.key }
        };
        fragments.windows(2).any(|pair| {
            let [a, b] = [key(&pair[0]), key(&pair[1])];
            let error = a.condition + b.condition;
            let same = pair[0].splat.center.iter().zip(&pair[1].splat.center);
            let exact = self.settings.order != Order::Pixel
                && (same.clone().all(|(a, b)| a.value == b.value)
                    || (self.settings.order == Order::Steps && error == 0.0));
            let scale = if self.settings.order == Order::Steps { 0.0 } else { a.value };
            !exact && tips(a.value - b.value, scale, error)
        })
    }

    /// The fragment of a splat, if it is drawn or rounding may draw it.
    fn fragment<'s>(&self, splat: &'s Splat, at: [f64; 2]) -> Option<Fragment<'s>> {
        if !splat.wide.hold(at) {
            return None;
        }
        let mut sure = splat.sure && splat.narrow.hold(at);
        let met = splat.disc.as_ref().map(|disc| self.meet(disc, splat.depth, at));
        let q = met.as_ref().map_or_else(|| self.form(splat, at), |met| met.rho);
        if let Some(met) = &met {
            sure &= met.sure;
            if !met.met && met.sure {
                return None;
            }
        }
        if self.settings.support == Support::Ellipse {
            let limit = f64::from(self.settings.cutoff).powi(2);
            let near = tips(q.value - limit, limit, q.condition);
            sure &= !near;
            if q.value > limit && !near {
                return None;
            }
        }
        // Rounding may leave less than 0, which is skipped.
        sure &= met.is_some() || q.value == 0.0 || q.value > 16.0 * q.condition;
        let fall = (-q.value / 2.0).exp();
        let change = (q.condition / 2.0).exp_m1() + 2.0 * self.step;
        let alpha = splat.opacity * Conditioned { value: fall, condition: fall * change };
        let (least, most) =
            (f64::from(self.settings.least_alpha), f64::from(self.settings.most_alpha));
        let alpha = Conditioned { value: alpha.value.min(most), ..alpha };
        let near = least > 0.0 && tips(alpha.value - least, least, alpha.condition);
        if alpha.value < least && !near {
            return None;
        }
        let depth = met.map_or_else(|| self.depth(splat, at), |met| met.depth);
        sure &= !near;
        if let Some((opaque, _)) = self.opaque(at) {
            let behind = depth.value - f64::from(opaque);
            let near = tips(behind, opaque.into(), depth.condition);
            sure &= !near;
            if behind > 0.0 && !near {
                return None;
            }
        }
        Some(Fragment { splat, alpha, depth, sure })
    }

    /// Depth and colour of the surface at a pixel.
    pub(crate) fn opaque(&self, [x, y]: [f64; 2]) -> Option<(f32, [f32; 3])> {
        let surface = self.scene.surface.as_ref()?;
        let i = y as usize * self.camera.width as usize + x as usize;
        let depth = surface.depths().values()[i];
        (depth != f32::INFINITY).then(|| (depth, surface.colors().values()[i]))
    }

    /// q by the adjugate of V over its determinant.
    fn form(&self, splat: &Splat, [x, y]: [f64; 2]) -> Conditioned {
        let half = |v: Conditioned, at: f64| {
            let value = v.value - at - 0.5;
            Conditioned { value, condition: v.condition + self.step * value.abs() }
        };
        let (dx, dy) = (half(splat.screen[0], x), half(splat.screen[1], y));
        let [xx, xy, yy] = splat.ellipse;
        let two = Conditioned::exact(2.0);
        let sum = yy * dx * dx - two * xy * dx * dy + xx * dy * dy;
        let size = (yy * dx * dx).value + (two * xy * dx * dy).value.abs() + (xx * dy * dy).value;
        let own = 4.0 * self.step * size;
        Conditioned { value: sum.value, condition: sum.condition + own } / splat.det
    }

    /// The depth of a fragment: the depth of the centre; or where the ray comes nearest to the
    /// centre in the coordinates of the Gaussian, by least squares over its axes.
    fn depth(&self, splat: &Splat, [x, y]: [f64; 2]) -> Conditioned {
        if self.settings.order != Order::Pixel {
            return splat.depth;
        }
        let eye = &self.eye;
        let (u, v) = ((x + 0.5 - eye.cx) / eye.fx, (y + 0.5 - eye.cy) / eye.fy);
        let center = splat.center.map(|c| c.value);
        let (ray, to) = if eye.perspective {
            ([u, v, 1.0], center)
        } else {
            ([0.0, 0.0, 1.0], [center[0] - u, center[1] - v, center[2]])
        };
        let size = |v: [f64; 3]| v.iter().map(|v| v.abs()).sum::<f64>();
        let wrong: f64 = splat.center.iter().map(|c| c.condition).sum();
        let (mut above, mut below) = (Conditioned::ZERO, Conditioned::ZERO);
        for axis in splat.thin {
            let along = |to: [f64; 3], error: f64| Conditioned {
                value: dot(axis, to),
                condition: size(axis) * (error + 4.0 * self.step * size(to)),
            };
            let (a, b) = (along(ray, self.step), along(to, wrong + self.step));
            // The matrix B' is rounded, not the products with its axes.
            let own = |to: [f64; 3]| 4.0 * self.step * size(axis).powi(2) * size(ray) * size(to);
            above = above + a * b + Conditioned { value: 0.0, condition: own(to) };
            below = below + a * a + Conditioned { value: 0.0, condition: own(ray) };
        }
        let depth = above / below;
        if below.value > 0.0 && depth.value.is_finite() { depth } else { splat.depth }
    }
}
