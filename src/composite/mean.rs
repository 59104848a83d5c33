//! The average of up to four neighbours \[MKC08, sections 3.2 and 3.3\], \[MOC08, section 3.1\].
//!
//! With weights `w_j` > 0 for the neighbours that take part, in this order of operations, an absent
//! neighbour's term and weight being 0:
//!
//! ```text
//!   average = ((w_0 a_0 + w_1 a_1) + (w_2 a_2 + w_3 a_3)) (1 / ((w_0 + w_1) + (w_2 + w_3)))
//!   not less than the least a_j and not more than the greatest of those that take part, plus 0
//! ```
//!
//! `Decided:` the bounds. They change nothing but rounding (three equal numbers, added and divided
//! by 3, can differ from them), and give the laws: a constant is reproduced exactly, an average
//! never leaves the hull of its terms, and since the sums pair neighbours 0 with 1 and 2 with 3,
//! exchanging left with right or top with bottom changes no bit. Of 1, 2 or 4 terms of weight 1 it
//! is the plain mean.

use crate::number::Exact;

/// The neighbours that take part, and their weights.
#[derive(Clone, Copy, Debug)]
pub struct Mean<R> {
    takes: [bool; 4],
    weights: [R; 4],
    /// 1 divided by the sum of the weights.
    scale: R,
}

impl<R: Exact> Mean<R> {
    /// The weights of neighbours; those of which `takes` is false are ignored.
    #[inline(always)]
    #[must_use]
    pub fn new(takes: [bool; 4], weights: [R; 4]) -> Self {
        let w = [0, 1, 2, 3].map(|j| if takes[j] { weights[j] } else { R::ZERO });
        Self { takes, weights: w, scale: R::ONE / ((w[0] + w[1]) + (w[2] + w[3])) }
    }

    /// Each with the weight 1.
    #[inline(always)]
    #[must_use]
    pub fn plain(takes: [bool; 4]) -> Self {
        Self::new(takes, [R::ONE; 4])
    }

    /// The average of a number, see the module page; of none at all it means nothing.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, a: [R; 4]) -> R {
        let term = |j: usize| if self.takes[j] { self.weights[j] * a[j] } else { R::ZERO };
        let mean = ((term(0) + term(1)) + (term(2) + term(3))) * self.scale;
        mean.at_least(self.least(a)).at_most(self.greatest(a)) + R::ZERO
    }

    /// The least of those that take part; +inf if there are none.
    #[inline(always)]
    #[must_use]
    pub fn least(&self, a: [R; 4]) -> R {
        let or = |j: usize| if self.takes[j] { a[j] } else { R::INFINITY };
        (or(0).at_most(or(1))).at_most(or(2).at_most(or(3)))
    }

    /// The greatest of those that take part; -inf if there are none.
    #[inline(always)]
    #[must_use]
    pub fn greatest(&self, a: [R; 4]) -> R {
        let or = |j: usize| if self.takes[j] { a[j] } else { -R::INFINITY };
        (or(0).at_least(or(1))).at_least(or(2).at_least(or(3)))
    }
}

/// Which of four neighbours belong to the surface in front: of the `candidates` the one with the
/// least `front`, ties to the earlier, and all whose `front` is not beyond its `back`.
///
/// Intervals [front, back] that overlap, since no other begins before that of the frontmost. The
/// second result is which one is in front, 0 if there is no candidate.
#[inline(always)]
#[must_use]
pub fn foremost<R: Exact>(
    candidates: [bool; 4],
    front: [R; 4],
    back: [R; 4],
) -> ([bool; 4], usize) {
    let (mut nearest, mut end, mut first) = (R::INFINITY, -R::INFINITY, 0);
    for j in 0..4 {
        if candidates[j] & (front[j] < nearest) {
            (nearest, end, first) = (front[j], back[j], j);
        }
    }
    ([0, 1, 2, 3].map(|j| candidates[j] & (front[j] <= end)), first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_constant_is_reproduced_exactly(
            a in -1e30_f32..1e30,
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            prop_assert_eq!(Mean::new(takes, w).of([a; 4]), a);
            let plain = Mean::plain(takes).of([f64::from(a); 4]);
            prop_assert_eq!(plain, f64::from(a));
        }

        #[test]
        fn it_stays_in_the_hull_and_near_the_exact_quotient(
            a in proptest::array::uniform4(-8.0_f32..8.0),
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            let mean = Mean::new(takes, w);
            let found = mean.of(a);
            let taken = || (0..4).filter(|&j| takes[j]);
            prop_assert!(taken().any(|j| a[j] <= found) && taken().any(|j| a[j] >= found));
            let total: f64 = taken().map(|j| f64::from(w[j])).sum();
            let sum: f64 = taken().map(|j| f64::from(w[j]) * f64::from(a[j])).sum();
            // Nine roundings of numbers up to 8: products, sums, total, its inverse, the product.
            prop_assert!((f64::from(found) - sum / total).abs() <= 9.0 * 8.0 * f64::from(f32::EPSILON) / 2.0);
        }

        #[test]
        fn exchanging_sides_changes_no_bit(
            a in proptest::array::uniform4(-8.0_f32..8.0),
            w in proptest::array::uniform4(0.1_f32..1.0),
            takes in proptest::array::uniform4(proptest::bool::ANY),
        ) {
            prop_assume!(takes.contains(&true));
            let found = Mean::new(takes, w).of(a);
            for order in [[1, 0, 3, 2], [2, 3, 0, 1]] {
                let mirrored = Mean::new(order.map(|j| takes[j]), order.map(|j| w[j]));
                prop_assert_eq!(mirrored.of(order.map(|j| a[j])), found);
            }
        }
    }

    #[test]
    fn three_equal_numbers_need_the_bounds() {
        let a = (0..1000).map(|i| 1.5 + i as f32 * f32::EPSILON);
        assert!(a.clone().any(|a| ((a + a) + a) / 3.0 != a), "or the bounds would be for nothing");
        for a in a {
            assert_eq!(Mean::plain([true, true, true, false]).of([a; 4]), a);
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
