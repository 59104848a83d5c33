//! Several running sums of products, side by side.

use super::{Ball, Common, Profile, common};
use crate::number::lanes::LANES;
use std::marker::PhantomData;

/// N sums with equally many terms. Each is the ball that `+` makes of the same terms from 0 on, bit
/// for bit, or unknown.
///
/// No term may itself be a sum. A term that [`Common`] balls do not know makes the sum unknown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Totals<P: Profile, const N: usize> {
    middle: [f64; N],
    /// The radii that the terms brought along if the profile adds terms in any order, else the
    /// sum's radius.
    radius: [f64; N],
    /// The magnitude of the terms, used only if the profile adds terms in any order.
    magnitude: [f64; N],
    terms: f64,
    profile: PhantomData<P>,
}

impl<P: Profile, const N: usize> Totals<P, N> {
    /// No term.
    pub(crate) const NONE: Self = Self {
        middle: [0.0; N],
        radius: [0.0; N],
        magnitude: [0.0; N],
        terms: 0.0,
        profile: PhantomData,
    };

    /// Adds a term to each sum.
    #[inline(always)]
    pub(crate) fn add(&mut self, terms: [Ball<Common<P>>; N]) {
        let Self { middle, radius, magnitude, .. } = *self;
        for (i, term) in terms.into_iter().enumerate() {
            if P::ADDS_IN_ANY_ORDER {
                self.middle[i] = middle[i] + term.middle;
                self.radius[i] = radius[i] + term.radius;
                self.magnitude[i] = magnitude[i] + (term.middle.abs() + term.radius);
            } else {
                let sum = common::sum(Ball::new(middle[i], radius[i]), term);
                (self.middle[i], self.radius[i]) = (sum.middle, sum.radius);
            }
        }
        self.terms += 1.0;
    }

    /// The sums; none if one of them is unknown.
    pub(crate) fn balls(&self) -> Option<[Ball<P>; N]> {
        let (balls, known) = self.balls_if_known();
        known.then_some(balls)
    }

    /// The sums, and whether all of them are known; without a branch.
    #[inline(always)]
    fn balls_if_known(&self) -> ([Ball<P>; N], bool) {
        let (mut balls, mut known) = ([Ball::exact(0.0); N], true);
        for (i, ball) in balls.iter_mut().enumerate() {
            let (middle, radius, magnitude) = (self.middle[i], self.radius[i], self.magnitude[i]);
            *ball = if P::ADDS_IN_ANY_ORDER {
                P::total(middle, [magnitude, self.terms, radius])
            } else {
                Ball::new(middle, radius)
            };
            // No partial sum was larger than this bound. NaN fails this comparison.
            let most = if P::ADDS_IN_ANY_ORDER { 2.0 * magnitude } else { 0.0 };
            known &= most + ball.radius <= f64::from(f32::MAX);
        }
        (balls, known)
    }
}

/// Totals side by side.
#[derive(Clone, Copy)]
pub(crate) struct TotalsLanes<P: Profile, const N: usize> {
    middle: [[f64; LANES]; N],
    radius: [[f64; LANES]; N],
    magnitude: [[f64; LANES]; N],
    terms: [f64; LANES],
    profile: PhantomData<P>,
}

impl<P: Profile, const N: usize> TotalsLanes<P, N> {
    /// No terms.
    pub(crate) const NONE: Self = Self {
        middle: [[0.0; LANES]; N],
        radius: [[0.0; LANES]; N],
        magnitude: [[0.0; LANES]; N],
        terms: [0.0; LANES],
        profile: PhantomData,
    };

    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, totals: &Totals<P, N>) {
        for i in 0..N {
            self.middle[i][lane] = totals.middle[i];
            self.radius[i][lane] = totals.radius[i];
            self.magnitude[i][lane] = totals.magnitude[i];
        }
        self.terms[lane] = totals.terms;
    }

    /// The sums of a lane, and whether all of them are known.
    #[inline(always)]
    pub(crate) fn balls(&self, lane: usize) -> ([Ball<P>; N], bool) {
        let of = |numbers: &[[f64; LANES]; N]| {
            let mut of_lane = [0.0; N];
            for (number, lanes) in of_lane.iter_mut().zip(numbers) {
                *number = lanes[lane];
            }
            of_lane
        };
        let totals = Totals::<P, N> {
            middle: of(&self.middle),
            radius: of(&self.radius),
            magnitude: of(&self.magnitude),
            terms: self.terms[lane],
            profile: PhantomData,
        };
        totals.balls_if_known()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Gpu, Ieee, Precise};
    use super::*;

    /// Compares sums of these terms with the sums of `+`; returns how many are known.
    fn compare<P: Profile>(terms: &[[Ball<P>; 2]]) -> usize {
        let (mut totals, mut plain) = (Totals::<P, 2>::NONE, [Ball::exact(0.0); 2]);
        let mut known = 0;
        for term in terms {
            totals.add(term.map(Ball::rounding_as));
            plain = [plain[0] + term[0], plain[1] + term[1]];
            let Some(balls) = totals.balls() else { continue };
            known += 1;
            for (own, plain) in balls.into_iter().zip(plain) {
                // The next sum shows that the terms are equal too.
                for (a, b) in [(own, plain), (own + Ball::exact(0.3), plain + Ball::exact(0.3))] {
                    assert_eq!(a.middle.to_bits(), b.middle.to_bits());
                    assert_eq!(a.radius.to_bits(), b.radius.to_bits(), "{a:?} is not {b:?}");
                }
            }
        }
        known
    }

    fn compare_all<P: Profile>() {
        let products: Vec<[Ball<P>; 2]> = (1..40)
            .map(|i| {
                let weight =
                    Ball::<P>::exact(f64::from(i) * 0.013) * Ball::exact(f64::from(0.7_f32));
                let part = f64::from(i % 5) - 2.0;
                [weight, weight * Ball::exact(part / 3.0)]
            })
            .collect();
        assert_eq!(compare(&products), products.len());
        assert_eq!(compare::<P>(&[]), 0);
        // An exact sum stays exact where operations round to nearest.
        assert_eq!(compare(&[[Ball::<P>::exact(0.5); 2], [Ball::exact(0.25); 2]]), 2);
        let large = Ball::exact(f64::from(f32::MAX));
        assert!(compare(&[[Ball::<P>::exact(1.0), large], [Ball::exact(1.0), large]]) < 2);
        let unbounded = Ball::new(1.0, f64::INFINITY);
        let odd = [[Ball::<P>::exact(1.0), unbounded], [Ball::exact(1.0), Ball::exact(1.0)]];
        assert_eq!(compare(&odd), 0);
    }

    #[test]
    fn totals_are_sums() {
        compare_all::<Ieee>();
        compare_all::<Precise>();
        compare_all::<Gpu>();
    }
}
