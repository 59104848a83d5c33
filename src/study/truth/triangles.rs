//! Where rays meet triangles.
//!
//! With v0, v1, v2 the corners in view space ([`View::point`], in f64), the ray of a sample has the
//! direction d = (x, y, -1) from the eye, and
//!
//! ```text
//!   e0 = d . (v1 x v2)    e1 = d . (v2 x v0)    e2 = d . (v0 x v1)     each (a + b) + c
//!   s  = (e0 + e1) + e2      b1 = e1 / s      b2 = e2 / s      b0 = 1 - (b1 + b2)
//!   t  = -((b0 v0.z + b1 v1.z) + b2 v2.z)
//! ```
//!
//! The ray meets the triangle if no two of the three e have opposite signs, and not all are 0, and t
//! is > near. Two triangles with a common edge have e of exactly opposite sign there, and a zero
//! belongs to both, so that no ray passes between them. The front is seen where s < 0.
//!
//! Orthographic: the ray goes through p = (x, y), and with u = v - p
//!
//! ```text
//!   e0 = u2.x u1.y - u1.x u2.y    and so on      front and rest as above
//! ```
//!
//! The normal is that of the corners, (b0 n0 + b1 n1) + b2 n2 divided by its length; if that length
//! is 0 it is that of corner 0. Colours are interpolated likewise.

use crate::number::Vector3;
use crate::scene::Triangles;
use crate::splat::View;

type V = Vector3<f64>;

/// A triangle in view space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    corners: [V; 3],
    /// v1 x v2, v2 x v0, v0 x v1.
    edges: [V; 3],
    perspective: bool,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Met {
    pub(super) t: f64,
    pub(super) weights: [f64; 3],
    pub(super) front: bool,
}

impl Placed {
    pub(super) fn new(triangles: &Triangles, index: u32, view: &View<f64>) -> Self {
        let corners = triangles.corners()[index as usize];
        let position = &triangles.vertices().position;
        let corners = corners.map(|i| view.point(Vector3::from_glam(position[i as usize])));
        let [a, b, c] = corners;
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        Self { corners, edges, perspective: view.perspective }
    }

    /// Where the triangle may be seen, in px: left, top, right and bottom; none if it is nowhere
    /// beyond the near plane.
    pub(super) fn bounds(&self, view: &View<f64>) -> Option<[f64; 4]> {
        let mut bounds: Option<[f64; 4]> = None;
        let mut add = |v: V| {
            let t = if self.perspective { -v.z } else { 1.0 };
            let x = view.fx * (v.x / t) + view.cx;
            let y = view.cy - view.fy * (v.y / t);
            let [l, t, r, b] = bounds.unwrap_or([x, y, x, y]);
            bounds = Some([lesser(l, x), lesser(t, y), greater(r, x), greater(b, y)]);
        };
        let near = view.near;
        for i in 0..3 {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % 3]);
            let (ta, tb) = (-a.z, -b.z);
            if ta >= near {
                add(a);
            }
            if (ta < near) != (tb < near) {
                let s = (near - ta) / (tb - ta);
                add(Vector3::new(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), -near));
            }
        }
        // Rounding is far below this.
        bounds.map(|[l, t, r, b]| [l - SLACK, t - SLACK, r + SLACK, b + SLACK])
    }

    /// Where the ray of (x, y) meets it, beyond the near plane.
    #[inline]
    pub(super) fn meet(&self, x: f64, y: f64, near: f64) -> Option<Met> {
        let e = if self.perspective {
            self.edges.map(|n| (x * n.x + y * n.y) - n.z)
        } else {
            let [a, b, c] = self.corners.map(|v| [v.x - x, v.y - y]);
            [[b, c], [c, a], [a, b]].map(|[u, v]| v[0] * u[1] - u[0] * v[1])
        };
        let (any_above, any_below) =
            (e[0] > 0.0 || e[1] > 0.0 || e[2] > 0.0, e[0] < 0.0 || e[1] < 0.0 || e[2] < 0.0);
        if any_above == any_below {
            return None;
        }
        let sum = (e[0] + e[1]) + e[2];
        let (b1, b2) = (e[1] / sum, e[2] / sum);
        let weights = [1.0 - (b1 + b2), b1, b2];
        let z = self.corners.map(|v| v.z);
        let t = -((weights[0] * z[0] + weights[1] * z[1]) + weights[2] * z[2]);
        (t > near && t < f64::INFINITY).then_some(Met { t, weights, front: sum < 0.0 })
    }
}

/// How much farther bounds are taken, in px.
const SLACK: f64 = 1e-3;

/// The sum of three vectors by their weights.
pub(super) fn mixed([a, b, c]: [V; 3], [wa, wb, wc]: [f64; 3]) -> V {
    let mix = |a: f64, b: f64, c: f64| (a * wa + b * wb) + c * wc;
    Vector3::new(mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z))
}

fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}
