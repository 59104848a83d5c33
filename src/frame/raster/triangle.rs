//! Find the pixels whose centres are inside a triangle, with exact weights of the corners.
//!
//! **Weights.** The weights w0, w1, w2 of a point are twice the areas of its triangles with the
//! edges opposite to corners 0, 1, 2, positive inside. Their sum is the same everywhere: the
//! `area`. The unit is half a square of the fixed-point grid, so that pixel centres have integer
//! weights too. A value that is linear on the screen is (w0 v0 + w1 v1 + w2 v2) / area.
//!
//! ```text
//!   edge from q to r, sense s = +1 or -1 so that the area is positive, p in halves of a unit
//!   w(p) = s ((r.x - q.x) (p.y - 2 q.y) - (r.y - q.y) (p.x - 2 q.x))
//! ```
//!
//! **The top-left rule.** A pixel is covered if its centre is inside the triangle. A centre on an
//! edge counts as inside if the edge is
//!
//! - a **left** edge, which is not horizontal and has the triangle to its right: w grows with X,
//! - a **top** edge, which is horizontal and has the triangle below it: w grows with Y, down,
//!
//! and as outside on every other edge. On a corner both of its edges must accept.
//!
//! This is the rule of Direct3D. Vulkan and OpenGL require its consequence: if triangles share an
//! edge and lie on either side of it, exactly one of them covers a centre on the edge. The same
//! holds around a shared corner. The rule works as if every centre were moved to the right by an
//! infinitesimal and down by a much smaller one. The order of the corners does not matter.

use super::snap::{Snap, not_negative};
use crate::frame::Rect;
use crate::number::MapInline;

/// A triangle on the screen in fixed point; its area is not 0.
#[derive(Clone, Debug)]
pub struct Triangle {
    edges: [Edge; 3],
    area: i64,
    front: bool,
    /// The bounds in an infinite picture.
    bounds: Rect,
}

/// The weight of the corner opposite to an edge, as a function of the pixel.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// The weight at the centre of pixel (0, 0).
    origin: i64,
    /// The change of the weight from a pixel to the next on the right, and to the next below.
    step: [i64; 2],
    /// The least weight that counts as inside: 0 for top and left edges, else 1.
    least: i64,
}

impl Edge {
    /// The edge from q to r, with the triangle on the side given by `sense`.
    fn new(snap: &Snap, q: [i64; 2], r: [i64; 2], sense: i64) -> Self {
        // Coordinates are at most 2^29, gradients 2^30, p - 2 q at most 2^31 for every pixel that
        // is visited. So products stay below 2^61 and their sum below 2^62.
        let gradient = [-sense * (r[1] - q[1]), sense * (r[0] - q[0])];
        let first = snap.center(0);
        let origin = gradient[0] * (first - 2 * q[0]) + gradient[1] * (first - 2 * q[1]);
        let top_or_left = gradient[0] > 0 || (gradient[0] == 0 && gradient[1] > 0);
        let step = gradient.map_inline(|g| g << (snap.bits + 1));
        Self { origin, step, least: i64::from(!top_or_left) }
    }

    /// The weight at the centre of a pixel.
    fn at(&self, x: u32, y: u32) -> i64 {
        self.origin + self.step[0] * i64::from(x) + self.step[1] * i64::from(y)
    }
}

impl Triangle {
    /// The triangle of three corners in fixed point, X to the right and Y down; `None` if its area
    /// is 0.
    ///
    /// Coordinates outside the guard band are held at its border; [`Snap::fixed`] never gives such
    /// coordinates.
    #[must_use]
    pub fn new(snap: &Snap, corners: [[i64; 2]; 3]) -> Option<Self> {
        let [a, b, c] = corners.map_inline(|p| snap.held(p));
        let cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if cross == 0 {
            return None;
        }
        let sense = cross.signum();
        let edge = |q, r| Edge::new(snap, q, r, sense);
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let bounds = Self::around(snap, [a, b, c]);
        Some(Self { edges, area: 2 * cross.abs(), front: cross < 0, bounds })
    }

    /// The pixels whose centres are in the rectangle around three corners in fixed point, in an
    /// infinite picture.
    pub(crate) fn around(snap: &Snap, [a, b, c]: [[i64; 2]; 3]) -> Rect {
        // The ends are exclusive, because a centre on the right or the lower border is on no left
        // or top edge.
        let low = [0, 1].map_inline(|i| snap.first_center_from(2 * a[i].min(b[i]).min(c[i])));
        let high = [0, 1].map_inline(|i| snap.first_center_from(2 * a[i].max(b[i]).max(c[i])));
        not_negative(low, high)
    }

    /// Whether the corners run counter-clockwise as seen on the screen, with Y up.
    #[must_use]
    pub fn front(&self) -> bool {
        self.front
    }

    /// The sum of the three weights at any pixel, > 0: four times the area in fixed-point units.
    #[must_use]
    pub fn area(&self) -> i64 {
        self.area
    }

    /// The pixels of a picture that the triangle may cover; may be empty.
    #[must_use]
    pub fn bounds(&self, width: u32, height: u32) -> Rect {
        self.bounds.intersection(&Rect { x0: 0, y0: 0, x1: width, y1: height })
    }

    /// Visits the covered pixels of `rect`, row by row from left to right, with the weights of the
    /// corners. Each weight is at least 0, and their sum is [`Triangle::area`].
    #[inline]
    pub fn for_each(&self, rect: &Rect, mut visit: impl FnMut(u32, u32, [i64; 3])) {
        let rect = rect.intersection(&self.bounds);
        if rect.is_empty() {
            return;
        }
        let [e0, e1, e2] = self.edges.map_inline(|e| e.step[0]);
        for y in rect.y0..rect.y1 {
            let (x0, x1) = self.span(y, rect.x0, rect.x1);
            let [mut w0, mut w1, mut w2] = self.edges.map_inline(|e| e.at(x0, y));
            for x in x0..x1 {
                visit(x, y, [w0, w1, w2]);
                (w0, w1, w2) = (w0 + e0, w1 + e1, w2 + e2);
            }
        }
    }

    /// The covered columns of row `y` among `x0 .. x1`: one run, because a triangle is convex.
    #[inline]
    fn span(&self, y: u32, x0: u32, x1: u32) -> (u32, u32) {
        // Columns are counted from x0.
        let (mut first, mut end) = (0, i64::from(x1 - x0));
        for edge in &self.edges {
            let (excess, step) = (edge.at(x0, y) - edge.least, edge.step[0]);
            // The weight grows along the row, falls, or stays: it bounds the start of the run, the
            // end, or all of it.
            if step > 0 {
                first = first.max(-excess.div_euclid(step));
            } else if step < 0 {
                end = end.min(excess.div_euclid(-step) + 1);
            } else if excess < 0 {
                return (x0, x0);
            }
        }
        if first < end { (x0 + first as u32, x0 + end as u32) } else { (x0, x0) }
    }
}
