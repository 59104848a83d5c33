//! Where rays meet triangles.
//!
//! A corner v in view space ([`View::point`], in f64) has the depth t = -v.z. It has w = t under a
//! perspective camera, and w = 1 under an orthographic one. The ray of a sample has the point
//! (x w, y w, -t) at the depth t. Seen along this ray, the corner is at
//!
//! ```text
//!   p = (v.x - x w, v.y - y w)
//! ```
//!
//! Let the three corners be at p0, p1 and p2. Each e is twice an area:
//!
//! ```text
//!   e0 = p1.x p2.y - p1.y p2.x    e1 = p2.x p0.y - p2.y p0.x    e2 = p0.x p1.y - p0.y p1.x
//!   s  = (e0 + e1) + e2           b_k = e_k / s
//!   t  = (b0 t0 + b1 t1) + b2 t2
//! ```
//!
//! The ray meets the triangle if no two of the three e have opposite signs, not all are 0, and
//! t > near. The front, with its corners counter-clockwise, is seen where s > 0.
//!
//! **No ray falls between two triangles.** An e is the difference of two rounded products. If the
//! products are equal, e is the difference of their rounding errors, which are computed exactly
//! \[Dekker: A Floating-Point Technique for Extending the Available Precision, 1971\]. So an e has
//! the sign of the exact difference, and a zero is exact. A corner has the same p in every triangle.
//! For corners that are off by one rounding, a ray therefore meets exactly what is there: a ray
//! through the inside of a surface meets a triangle, and a ray through an edge meets both of its
//! triangles.
//!
//! The normal interpolates the corners' normals, (b0 n0 + b1 n1) + b2 n2 divided by its length; if
//! the length is 0, it is the normal of corner 0. Colours are interpolated likewise. The corners
//! alone say which side is the front, as where polygons are drawn; see
//! [`mod@crate::method::projection`].

use crate::number::Vector3;
use crate::scene::Triangles;
use crate::splat::View;

type V = Vector3<f64>;

/// A triangle in view space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    x: [f64; 3],
    y: [f64; 3],
    w: [f64; 3],
    t: [f64; 3],
}

/// The place where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Met {
    pub(super) t: f64,
    pub(super) weights: [f64; 3],
    pub(super) front: bool,
}

/// The rays that may meet a triangle: those with `a x + b y + c >= 0` for each of three lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    lines: [[f64; 3]; 3],
    /// Whether they see its front.
    pub(super) front: bool,
}

/// What the rays of a picture share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The largest magnitudes of x and y.
    pub(super) x: f64,
    pub(super) y: f64,
}

impl Placed {
    pub(super) fn new(triangles: &Triangles, index: u32, view: &View<f64>) -> Self {
        let corners = triangles.corners()[index as usize];
        let position = &triangles.vertices().position;
        let v = corners.map(|i| view.point(Vector3::from_glam(position[i as usize])));
        let t = v.map(|v| -v.z);
        let w = if view.perspective { t } else { [1.0; 3] };
        Self { x: v.map(|v| v.x), y: v.map(|v| v.y), w, t }
    }

    /// Where the triangle may be seen, in px: left, top, right and bottom; `None` if no part is
    /// beyond the near plane.
    pub(super) fn bounds(&self, view: &View<f64>) -> Option<[f64; 4]> {
        // Because weights are rounded, a triangle that ends at the near plane may be met beyond it.
        let far = self.t.map(f64::abs).into_iter().fold(view.near.abs(), greater);
        let near = view.near - far * RELATIVE;
        if view.perspective && !(near > 0.0) {
            return Some(EVERYWHERE);
        }
        let mut bounds: Option<[f64; 4]> = None;
        // A corner of the part beyond the near plane, and how large the numbers in its computation
        // were.
        let mut add = |[x, y, w]: [f64; 3], [wide, high]: [f64; 2]| {
            let (px, py) = (view.fx * (x / w) + view.cx, view.cy - view.fy * (y / w));
            let off = |f: f64, wide: f64, p: f64, c: f64| {
                SLACK + RELATIVE * ((f * (wide / w)).abs() + (p.abs() + c.abs()))
            };
            let (dx, dy) = (off(view.fx, wide, px, view.cx), off(view.fy, high, py, view.cy));
            let mut here = [px - dx, py - dy, px + dx, py + dy];
            if !here.iter().all(|v| v.is_finite()) {
                here = EVERYWHERE;
            }
            let [l, t, r, b] = bounds.unwrap_or(here);
            bounds = Some([
                lesser(l, here[0]),
                lesser(t, here[1]),
                greater(r, here[2]),
                greater(b, here[3]),
            ]);
        };
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (ta, tb) = (self.t[i], self.t[j]);
            if ta >= near {
                add([self.x[i], self.y[i], self.w[i]], [self.x[i].abs(), self.y[i].abs()]);
            }
            if (ta < near) != (tb < near) {
                let s = (near - ta) / (tb - ta);
                let at = |of: &[f64; 3]| of[i] + s * (of[j] - of[i]);
                let wide = |of: &[f64; 3]| of[i].abs() + of[j].abs();
                let w = if view.perspective { near } else { 1.0 };
                add([at(&self.x), at(&self.y), w], [wide(&self.x), wide(&self.y)]);
            }
        }
        bounds
    }

    /// The lines that bound it, for rays that reach so far; none if they look along it, so that rounding
    /// decides what they meet.
    ///
    /// With h0, h1, h2 the triples (v.x, v.y, w) of the corners and D their determinant, a ray (x, y) meets
    /// the plane where (b0 h0 + b1 h1) + b2 h2 is W (x, y, 1). There e0 = b0 D / W, and so on. W is
    /// a depth, or 1: so before the eye every e has the sign of D.
    pub(super) fn lines(&self, reach: Reach) -> Option<Lines> {
        let [x, y, w] = [&self.x, &self.y, &self.w];
        let wide = [0, 1, 2].map(|k| x[k].abs() + reach.x * w[k].abs());
        let high = [0, 1, 2].map(|k| y[k].abs() + reach.y * w[k].abs());
        let (mut lines, mut volume, mut doubt) = ([[0.0; 3]; 3], 0.0, 0.0);
        let mut slack = [0.0; 3];
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let a = y[i] * w[j] - w[i] * y[j];
            let b = w[i] * x[j] - x[i] * w[j];
            let c = x[i] * y[j] - y[i] * x[j];
            lines[k] = [a, b, c];
            // About 30 roundings of the terms of e.
            slack[k] = RELATIVE * (wide[i] * high[j] + high[i] * wide[j]);
            volume += w[k] * c;
            doubt += 4.0 * (w[k].abs() * slack[k]);
        }
        let front = volume > 0.0;
        if !(volume > doubt || -volume > doubt) {
            return None;
        }
        for (line, slack) in lines.iter_mut().zip(slack) {
            *line = line.map(|v| if front { v } else { -v });
            line[2] += slack;
        }
        Some(Lines { lines, front })
    }

    /// Where the ray of (x, y) meets the triangle, beyond the near plane.
    #[inline(always)]
    pub(super) fn meet(&self, x: f64, y: f64, near: f64) -> Option<Met> {
        // No closures: those of arrays stay functions.
        let mut p = [[0.0; 2]; 3];
        for (k, p) in p.iter_mut().enumerate() {
            *p = [self.x[k] - x * self.w[k], self.y[k] - y * self.w[k]];
        }
        let e = [area(p[1], p[2]), area(p[2], p[0]), area(p[0], p[1])];
        let above = e[0] > 0.0 || e[1] > 0.0 || e[2] > 0.0;
        let below = e[0] < 0.0 || e[1] < 0.0 || e[2] < 0.0;
        if above == below {
            return None;
        }
        let sum = (e[0] + e[1]) + e[2];
        let weights = [e[0] / sum, e[1] / sum, e[2] / sum];
        let t = mix(self.t, weights);
        (t > near && t < f64::INFINITY).then_some(Met { t, weights, front: above })
    }
}

impl Lines {
    /// The least and the largest x of the rays of y that may meet the triangle; `None` if no ray
    /// may.
    #[inline(always)]
    pub(super) fn span(&self, y: f64) -> Option<[f64; 2]> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for [a, b, c] in self.lines {
            let rest = b * y + c;
            let edge = -(rest / a);
            if a > 0.0 {
                low = greater(low, edge);
            } else if a < 0.0 {
                high = lesser(high, edge);
            } else if rest < 0.0 {
                return None;
            }
        }
        Some([low, high])
    }
}

/// a.x b.y - a.y b.x with the sign of the exact number, see the [module](self).
#[inline(always)]
fn area(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (p, q) = (a[0] * b[1], a[1] * b[0]);
    if p == q { lost(a[0], b[1], p) - lost(a[1], b[0], q) } else { p - q }
}

/// The exact a b minus the rounded product.
#[cold]
fn lost(a: f64, b: f64, product: f64) -> f64 {
    let ([a, a_low], [b, b_low]) = (halves(a), halves(b));
    ((a * b - product) + a * b_low + a_low * b) + a_low * b_low
}

/// Splits a number into the sum of two numbers of 26 bits.
fn halves(v: f64) -> [f64; 2] {
    let scaled = 134_217_729.0 * v; // 2^27 + 1
    let high = scaled - (scaled - v);
    [high, v - high]
}

/// The bounds of everything that may be seen.
const EVERYWHERE: [f64; 4] = [f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY];
/// The margin of bounds in px, on top of the effect of rounding.
const SLACK: f64 = 1.0 / 1024.0;
/// 2^-46: far above the relative effect of rounding.
const RELATIVE: f64 = 1.0 / 70_368_744_177_664.0;

#[inline(always)]
fn mix([a, b, c]: [f64; 3], [wa, wb, wc]: [f64; 3]) -> f64 {
    (a * wa + b * wb) + c * wc
}

/// The weighted sum of three vectors.
#[inline(always)]
pub(super) fn mixed([a, b, c]: [V; 3], weights: [f64; 3]) -> V {
    Vector3::new(
        mix([a.x, b.x, c.x], weights),
        mix([a.y, b.y, c.y], weights),
        mix([a.z, b.z, c.z], weights),
    )
}

/// The lesser of two numbers.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Checks against integers, for products that are equal or nearly so.
        #[test]
        fn an_area_has_the_sign_of_the_exact_number(
            x in -(1_i64 << 52)..(1_i64 << 52),
            y in -(1_i64 << 52)..(1_i64 << 52),
            part in -64_i64..64,
            off in prop::array::uniform2(-2_i64..3),
            power in -200_i32..200,
        ) {
            // Along one line, except for the last digits.
            let (a, b) = ([x, y], [x * part / 64 + off[0], y * part / 64 + off[1]]);
            let product = |p: i64, q: i64| i128::from(p) * i128::from(q);
            let exact = product(a[0], b[1]) - product(a[1], b[0]);
            // A power of two loses no digit.
            let scale = f64::from_bits(((1023 + power) as u64) << 52);
            let [a, b] = [a, b].map(|p| p.map(|v| v as f64 * scale));
            let found = area(a, b);
            let sign = i128::from(found > 0.0) - i128::from(found < 0.0);
            prop_assert_eq!(sign, exact.signum());
            prop_assert_eq!(area(b, a), -found);
        }
    }
}
