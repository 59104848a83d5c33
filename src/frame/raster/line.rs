//! Draw lines one pixel wide and without gaps, with the exact position along them.
//!
//! \[MKC08, section 4.1\] rasterizes a ribbon's centreline with the least width that leaves a
//! connected set of pixels. `Decided:` the rule below, because graphics interfaces do not agree on
//! a rule, and because their diamond rule leaves out the last pixel of a polyline:
//!
//! ```text
//!   major axis    that of the larger of |b.x - a.x| and |b.y - a.y|, X if they are equal
//!   in this order
//!     the pixel that contains a                                            parameter 0
//!     for every pixel centre c of the major axis strictly between a and b, from a to b:
//!       the pixel that contains the line's point there                     |c - a| / |b - a|
//!     the pixel that contains b                                            parameter 1
//! ```
//!
//! - A pixel contains its left and its upper border, not the right and the lower one. So a point on
//!   a border belongs to the pixel to its right or below. A point is a quotient of integers and its
//!   floor is exact.
//! - Consecutive pixels touch at an edge or a corner, so the set is 8-connected. The pixels of a
//!   polyline are 8-connected too, because its segments share the pixel of the vertex.
//! - A line from b to a has the same pixels in the opposite order, with parameters counted from the
//!   other end, without exception: no tie depends on the direction. Mirroring a line may change
//!   pixels where the line runs along a border of pixels.
//! - The first and the last sample may lie in the pixel of an end. That pixel is then visited
//!   twice, with different parameters. The depth test chooses between the visits, as it does
//!   between segments.
//! - A segment of length 0 is its one pixel, once, with parameter 0.

use super::snap::{Snap, not_negative};
use crate::frame::Rect;
use crate::number::MapInline;

/// A segment on the screen in fixed point.
#[derive(Clone, Debug)]
pub struct Line {
    snap: Snap,
    a: [i64; 2],
    b: [i64; 2],
    /// 0 for X, 1 for Y.
    major: usize,
}

impl Line {
    /// The segment from a to b in fixed point, X to the right and Y down.
    ///
    /// Coordinates outside the guard band are held at its border; [`Snap::fixed`] never gives such
    /// coordinates.
    #[must_use]
    pub fn new(snap: &Snap, a: [i64; 2], b: [i64; 2]) -> Self {
        let (a, b) = (snap.held(a), snap.held(b));
        let major = usize::from(a[0].abs_diff(b[0]) < a[1].abs_diff(b[1]));
        Self { snap: *snap, a, b, major }
    }

    /// The pixels of a picture that the line may visit; may be empty.
    #[must_use]
    pub fn bounds(&self, width: u32, height: u32) -> Rect {
        let (a, b) = (self.snap.pixel(self.a), self.snap.pixel(self.b));
        let low = [0, 1].map_inline(|i| a[i].min(b[i]));
        let high = [0, 1].map_inline(|i| a[i].max(b[i]) + 1);
        let picture = Rect { x0: 0, y0: 0, x1: width, y1: height };
        not_negative(low, high).intersection(&picture)
    }

    /// Visits the pixels of the line in `rect`, from a to b. The parameter comes as numerator and
    /// denominator: it is in [0, 1] and never decreases, and the denominator is > 0.
    #[inline]
    pub fn for_each(&self, rect: &Rect, mut visit: impl FnMut(u32, u32, i64, i64)) {
        let (snap, a, b, major) = (&self.snap, self.a, self.b, self.major);
        let mut visit_inside = |pixel: [i64; 2], numerator: i64, denominator: i64| {
            if let [Ok(x), Ok(y)] = pixel.map_inline(u32::try_from)
                && rect.contains(x, y)
            {
                visit(x, y, numerator, denominator);
            }
        };
        // A segment of length 0 has no denominator for a parameter.
        if a == b {
            return visit_inside(snap.pixel(a), 0, 1);
        }
        // In halves of a fixed-point unit, so that pixel centres are integers.
        let length = 2 * (b[major] - a[major]).abs();
        visit_inside(snap.pixel(a), 0, length);
        let (first, end) = self.samples(rect);
        for k in 0..end - first {
            // The samples ascend along the axis; a line that runs the other way visits them in
            // reverse.
            let i = if a[major] < b[major] { first + k } else { end - 1 - k };
            let along = (snap.center(i) - 2 * a[major]).abs();
            visit_inside(self.sample(i, along, length), along, length);
        }
        visit_inside(snap.pixel(b), length, length);
    }

    /// The pixels of the major axis whose centres are strictly between the ends, inside `rect`
    /// only.
    fn samples(&self, rect: &Rect) -> (i64, i64) {
        let (a, b) = (self.a[self.major], self.b[self.major]);
        let first = self.snap.first_center_from(2 * a.min(b) + 1);
        let end = self.snap.first_center_from(2 * a.max(b));
        let (low, high) = [(rect.x0, rect.x1), (rect.y0, rect.y1)][self.major];
        (first.max(low.into()), end.min(high.into()))
    }

    /// The pixel at the centre of pixel `i` of the major axis, `along` of `length` from a to b.
    fn sample(&self, i: i64, along: i64, length: i64) -> [i64; 2] {
        let minor = 1 - self.major;
        let (from, to) = (self.a[minor], self.b[minor]);
        // The coordinate times `length`. Coordinates are at most 2^29 and lengths 2^31, so the
        // products are at most 2^61 and 2^62.
        let times_length = 2 * from * length + 2 * (to - from) * along;
        let pixel = times_length.div_euclid(length << (self.snap.bits + 1));
        if self.major == 0 { [i, pixel] } else { [pixel, i] }
    }
}
