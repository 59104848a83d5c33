//! The average of up to four neighbours \[MKC08, sections 3.2 and 3.3\], \[MOC08, section 3.1\].
//!
//! The weights `w_j` > 0 belong to the neighbours that take part; the term and the weight of an
//! absent neighbour are 0. In this order of operations:
//!
//! ```text
//!   average = ((w_0 a_0 + w_1 a_1) + (w_2 a_2 + w_3 a_3)) (1 / ((w_0 + w_1) + (w_2 + w_3)))
//!   not less than the least a_j and not more than the greatest of those that take part, plus 0
//! ```
//!
//! `Decided:` the bounds. They change nothing but rounding (three equal numbers, added and divided
//! by 3, can differ from them). They are a part of the definition all the same: an average without
//! them can lie a rounding outside, and is wrong there. The bounds and the order of the sums give
//! the laws:
//!
//! - A constant is reproduced exactly.
//! - An average never leaves the hull of its terms.
//! - The sums pair neighbours 0 with 1 and 2 with 3, so exchanging left with right or top with
//!   bottom changes no bit.
//!
//! For 1, 2 or 4 terms of weight 1 the average is the plain mean.

use super::decide;
use crate::number::{Exact, MapInline, Real};

/// The neighbours that take part, and their weights.
#[derive(Clone, Copy, Debug)]
pub struct Mean<R> {
    takes: [bool; 4],
    weights: [R; 4],
    /// 1 divided by the sum of the weights.
    scale: R,
}

impl<R: Real> Mean<R> {
    /// Sets the weights of the neighbours; a neighbour whose `takes` is false is ignored.
    #[inline(always)]
    #[must_use]
    pub fn new(takes: [bool; 4], weights: [R; 4]) -> Self {
        let w = [0, 1, 2, 3].map_inline(|j| if takes[j] { weights[j] } else { R::ZERO });
        Self { takes, weights: w, scale: R::ONE / ((w[0] + w[1]) + (w[2] + w[3])) }
    }

    /// Gives each neighbour the weight 1.
    #[inline(always)]
    #[must_use]
    pub fn plain(takes: [bool; 4]) -> Self {
        Self::new(takes, [R::ONE; 4])
    }

    /// The average of a number, see the module page; meaningless if no neighbour takes part.
    #[inline(always)]
    #[must_use]
    pub fn average(&self, a: [R; 4]) -> R {
        let term = |j: usize| if self.takes[j] { self.weights[j] * a[j] } else { R::ZERO };
        let mean = ((term(0) + term(1)) + (term(2) + term(3))) * self.scale;
        mean.clamped(self.least(a), self.greatest(a)) + R::ZERO
    }

    /// [`Mean::average`], called and not compiled into each place that averages, because in balls it
    /// takes 5 kB.
    #[inline(never)]
    pub(crate) fn average_called(&self, a: [R; 4]) -> R {
        self.average(a)
    }

    /// The least value that takes part; +inf if there are none.
    #[inline(always)]
    #[must_use]
    pub fn least(&self, a: [R; 4]) -> R {
        let or = |j: usize| if self.takes[j] { a[j] } else { R::INFINITY };
        (or(0).at_most(or(1))).at_most(or(2).at_most(or(3)))
    }

    /// The greatest value that takes part; -inf if there are none.
    #[inline(always)]
    #[must_use]
    pub fn greatest(&self, a: [R; 4]) -> R {
        let or = |j: usize| if self.takes[j] { a[j] } else { -R::INFINITY };
        (or(0).at_least(or(1))).at_least(or(2).at_least(or(3)))
    }
}

/// Which of four neighbours belong to the surface in front: the candidate with the least `front`,
/// ties to the earlier, and all `candidates` whose `front` is not beyond the `back` of that one.
///
/// These are the intervals [front, back] that overlap the frontmost, because no other begins before
/// it. The second result is the index of the frontmost, 0 if there is no candidate.
#[inline(always)]
#[must_use]
pub fn foremost<R: Exact>(
    candidates: [bool; 4],
    front: [R; 4],
    back: [R; 4],
) -> ([bool; 4], usize) {
    let (mut nearest, mut end, mut first) = (R::INFINITY, -R::INFINITY, 0);
    for j in 0..4 {
        if candidates[j] & decide::before(front[j], nearest) {
            (nearest, end, first) = (front[j], back[j], j);
        }
    }
    ([0, 1, 2, 3].map_inline(|j| candidates[j] & decide::overlaps(front[j], end)), first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{Lawful, means};
    use proptest::prelude::*;

    fn mean<R: Exact>(takes: [bool; 4], weights: [R; 4], a: [R; 4]) -> R {
        Mean::new(takes, weights).average(a)
    }

    fn lawful(found: Lawful) -> Result<(), TestCaseError> {
        found.map_err(|counterexample| TestCaseError::fail(counterexample.to_string()))
    }

    proptest! {
        #[test]
        fn a_constant_is_reproduced_exactly(
            a in -1e30_f32..1e30,
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            lawful(means::constant(&mean, takes, w, a))?;
            let plain = |takes, _, a| Mean::<f64>::plain(takes).average(a);
            lawful(means::constant(&plain, takes, [1.0; 4], f64::from(a)))?;
        }

        #[test]
        fn it_stays_in_the_hull_and_near_the_exact_quotient(
            a in proptest::array::uniform4(-8.0_f32..8.0),
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            lawful(means::hull(&mean, takes, w, a))?;
            lawful(means::quotient(&mean, takes, w, a))?;
        }

        #[test]
        fn exchanging_sides_changes_no_bit(
            a in proptest::array::uniform4(-8.0_f32..8.0),
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            lawful(means::mirror(&mean, takes, w, a))?;
        }
    }

    #[test]
    fn three_equal_numbers_need_the_bounds() {
        let a = (0..1000).map(|i| 1.5 + i as f32 * f32::EPSILON);
        assert!(a.clone().any(|a| ((a + a) + a) / 3.0 != a), "or the bounds would be for nothing");
        for a in a {
            assert_eq!(Mean::plain([true, true, true, false]).average([a; 4]), a);
        }
    }

    #[test]
    fn the_foremost_takes_what_overlaps_with_it() {
        let all = [true; 4];
        let (takes, first) = foremost(all, [3.0, 1.0, 2.0, 2.5], [9.0, 2.0, 9.0, 9.0]);
        assert_eq!((takes, first), ([false, true, true, false], 1), "at the end of it still");
        let (takes, first) = foremost([true, false, true, true], [1.0; 4], [1.0, 9.0, 5.0, 5.0]);
        assert_eq!((takes, first), ([true, false, true, true], 0), "ties to the earlier");
        assert_eq!(foremost([false; 4], [1.0; 4], [1.0; 4]), ([false; 4], 0));
    }
}
