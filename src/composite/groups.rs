//! The compositing operator over the depth-images of groups \[ZP06, section 3.2, Fig. 5\].
//!
//! [`compose`] takes all images at once, because the epsilon-z test of one image needs the nearest
//! depth of all. `t_k` is the depth of image k, which also holds weighted attributes:
//!
//! ```text
//!   nearest = the least t_k                                         line 4
//!   sums    = over k in ascending order, if t_k <= nearest + epsilon:
//!               weight += weight_k, color += color_k ...             lines 5 to 10
//! ```
//!
//! Normalization, line 11, is [`super::sum::average`]. Laws:
//!
//! - An empty image (depth +inf) is neutral.
//! - epsilon = 0 keeps only the images of the nearest depth; epsilon = +inf sums all that are not
//!   empty.
//! - Relabelling the groups changes nothing but the order of the sums.
//! - Moving one fragment out of an image into an image of its own changes nothing but the order of
//!   the sums, because only the set of fragments counts. (Splitting a group is different. It can
//!   show a fragment that the depth test of the whole group hid. If that depth test is the Voronoi
//!   one, the split can also hide another fragment by a nearer depth. The depth test causes this,
//!   not this operator.)
//! - It is **not** associative: folding it over pairs is another function. Take epsilon = 1 and
//!   depths 0, 0.75, 1.5. All three together keep the first two. `(1 with 2) with 0` keeps all
//!   three if the pair is represented by its nearest depth, 0.75, because the pair was blended
//!   before the nearest depth was known. So a backend may not composite images as they come.

use super::{decide, sum};
use crate::number::{Exact, MapInline, Real};

/// The content of a depth-image at a pixel: the attributes of one fragment, times its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedFragment<R> {
    /// Depth t of the fragment; +inf where the image is empty.
    pub depth: R,
    /// Its weight.
    pub weight: R,
    /// Weight times normal.
    pub normal: [R; 3],
    /// Weight times colour.
    pub color: [R; 3],
    /// Weight times opacity.
    pub opacity: R,
}

impl<R> WeightedFragment<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> WeightedFragment<S> {
        WeightedFragment {
            depth: f(self.depth),
            weight: f(self.weight),
            normal: self.normal.map(&f),
            color: self.color.map(&f),
            opacity: f(self.opacity),
        }
    }
}

impl<R: Real> WeightedFragment<R> {
    /// An empty pixel.
    pub const EMPTY: Self = Self {
        depth: R::INFINITY,
        weight: R::ZERO,
        normal: [R::ZERO; 3],
        color: [R::ZERO; 3],
        opacity: R::ZERO,
    };

    /// Makes one fragment: each attribute is multiplied by the weight once.
    #[inline(always)]
    #[must_use]
    pub fn new(depth: R, weight: R, normal: [R; 3], color: [R; 3], opacity: R) -> Self {
        let weighted = |value: [R; 3]| value.map_inline(|component| weight * component);
        let (normal, color) = (weighted(normal), weighted(color));
        Self { depth, weight, normal, color, opacity: weight * opacity }
    }

    /// Adds the weighted attributes of a sample; the depth stays.
    #[inline(always)]
    pub fn add(&mut self, sample: &Self) {
        self.weight = self.weight + sample.weight;
        self.normal = sum::plus(self.normal, sample.normal);
        self.color = sum::plus(self.color, sample.color);
        self.opacity = self.opacity + sample.opacity;
    }
}

/// The operator of Fig. 5 over the samples of all images at one pixel, in the order of the groups.
///
/// Returns the sums, with the nearest depth, and how many samples passed the epsilon-z test.
/// `epsilon` is >= 0 and may be +inf.
pub fn compose<R: Exact>(
    samples: &[WeightedFragment<R>],
    epsilon: R,
) -> (WeightedFragment<R>, u32) {
    let mut sums = WeightedFragment::<R>::EMPTY;
    for sample in samples {
        sums.depth = sums.depth.at_most(sample.depth);
    }
    let limit = decide::limit(sums.depth, epsilon);
    let mut count = 0;
    for sample in samples {
        // An empty sample passes where epsilon or the nearest depth is infinite, but it must not
        // count.
        if sample.depth < R::INFINITY && decide::visible(sample.depth, limit) {
            sums.add(sample);
            count += 1;
        }
    }
    (sums, count)
}
