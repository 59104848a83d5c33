//! The operations of [`Common`](super::Common) balls. They have no branch, and they choose each
//! part of a result separately, because a choice between whole balls does not vectorize.

use super::arithmetic::is_exact;
use super::{Ball, Profile, Three};

/// Builds a result: exact, or with this radius if the result is common, else unknown.
#[inline(always)]
fn result<P: Profile>(middle: f64, radius: f64, exact: bool, common: bool) -> Ball<P> {
    // NaN fails this comparison.
    let common = common & (middle.abs() + radius <= f64::from(f32::MAX));
    let radius = if common { radius } else { f64::NAN };
    Ball::new(middle, if exact { 0.0 } else { radius })
}

#[inline(always)]
pub(super) fn sum<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (middle, spread) = (a.middle + b.middle, a.radius + b.radius);
    let sum = P::sum(middle, [&a, &b]);
    let exact = is_exact::<P>(P::ROUNDS_TO_NEAREST, middle, spread);
    let common = spread.is_finite();
    Ball { terms: sum.terms, ..result(middle, sum.radius, exact, common) }
}

#[inline(always)]
pub(super) fn product<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (m, n, r, s) = (a.middle, b.middle, a.radius, b.radius);
    let middle = m * n;
    let spread = m.abs() * s + n.abs() * r + r * s;
    // 0 times a bounded ball; a NaN radius is not bounded.
    let zero = (a.is_zero() | b.is_zero()) & (spread == 0.0);
    let exact = is_exact::<P>(P::ROUNDS_TO_NEAREST, middle, r + s) | zero;
    result(middle, Ball::<P>::reach(middle, spread, P::PRODUCT, P::TINY), exact, true)
}

#[inline(always)]
pub(super) fn quotient<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (m, n, r, s) = (a.middle, b.middle, a.radius, b.radius);
    let middle = m / n;
    let spread = (m.abs() * s + n.abs() * r) / (n.abs() * (n.abs() - s));
    let divides = !b.may_be_zero() & (n.abs() + s <= P::LARGEST_DIVISOR);
    // 0 divided by a bounded ball.
    let zero = divides & a.is_zero() & n.is_finite();
    let exact = is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, r + s) | zero;
    let radius = Ball::<P>::reach(middle, spread, P::QUOTIENT, P::TINY);
    result(middle, radius, exact, divides)
}

/// The square root of a number that is not below 0.
#[inline(always)]
pub(super) fn root<P: Profile>(x: Ball<P>) -> Ball<P> {
    let (middle, low) = (x.middle.sqrt(), x.low());
    let spread = x.radius / (middle + low.sqrt());
    let exact = is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, x.radius) | x.is_zero();
    result(middle, Ball::<P>::reach(middle, spread, P::ROOT, 0.0), exact, low >= 0.0)
}

/// The square root of a sum of squares that may be 0.
#[inline(always)]
pub(super) fn root_of_squares<P: Profile>(x: Ball<P>) -> Ball<P> {
    let middle = x.middle.sqrt();
    let end = x.high().sqrt() - middle;
    let spread = if middle > end { middle } else { end };
    let radius = Ball::<P>::reach(middle, spread, P::ROOT, 0.0);
    let near_zero = result::<P>(middle, radius, false, x.high().is_finite());
    let root = root(x);
    Ball::new(middle, if x.low() < 0.0 { near_zero.radius } else { root.radius })
}

/// Chooses one of two balls; unknown if the choice is undecided.
#[inline(always)]
pub(super) fn select<P: Profile>(truth: Three, yes: Ball<P>, no: Ball<P>) -> Ball<P> {
    let choose = |yes: f64, no: f64| if truth.middle() { yes } else { no };
    let decided = truth.decided().is_some();
    let radius = choose(yes.radius, no.radius);
    Ball {
        middle: choose(yes.middle, no.middle),
        radius: if decided { radius } else { f64::NAN },
        terms: P::choose(truth.middle(), yes.terms, no.terms),
    }
}

/// `x`, or `low` where `x < low`; unknown if the comparison is undecided.
#[inline(always)]
pub(super) fn at_least<P: Profile>(x: Ball<P>, low: Ball<P>) -> Ball<P> {
    let (above, below) = (x.low() >= low.high(), x.high() <= low.low());
    select(Three::new([above, above, above | !below]), x, low)
}

#[cfg(test)]
mod tests {
    use super::super::{Common, Gpu, Ieee, Precise};
    use super::*;
    use crate::number::Real;

    /// Balls of common and of odd numbers.
    fn balls<P: Profile>() -> Vec<Ball<P>> {
        let largest = f64::from(f32::MAX);
        let middles = [0.0, -0.0, 1.0, -3.0, 0.1, 1e-45, -1e-38, 1e30, largest, f64::INFINITY];
        let radii = [0.0, 1e-46, 1e-9, 0.1, 0.5, 3.0, 1e31, largest, f64::INFINITY, f64::NAN];
        let each = |middle| radii.map(|radius| Ball::new(middle, radius));
        let mut all: Vec<Ball<P>> = middles.into_iter().flat_map(each).collect();
        // Sums of sums, in range and not.
        let sums = [0.25, 1e20, 3e38]
            .map(|part| (Ball::new(part, 1e-9) + Ball::new(0.1, 0.0)) + Ball::ONE);
        all.extend(sums);
        all
    }

    /// Counts the results that equal the plain ball's; all others must be unknown.
    fn hold<P: Profile>(common: Ball<Common<P>>, plain: Ball<P>, found: &mut [usize; 2]) {
        let bits = |x: f64| x.to_bits();
        let same = bits(common.middle) == bits(plain.middle)
            && bits(common.radius) == bits(plain.radius)
            // The next sum shows that the terms are equal too.
            && bits((common.rounding_as::<P>() + Ball::ONE).radius) == bits((plain + Ball::ONE).radius);
        assert!(same || common.radius.is_nan(), "{common:?} is not {plain:?}");
        found[usize::from(same && plain.radius.is_finite())] += 1;
    }

    fn compare<P: Profile>() {
        let (mut found, balls) = ([0; 2], balls::<P>());
        for &a in &balls {
            let c: Ball<Common<P>> = a.rounding_as();
            hold(c.sqrt(), a.sqrt(), &mut found);
            hold(c.root_of_squares(), a.root_of_squares(), &mut found);
            for &b in &balls {
                let d = b.rounding_as();
                hold(c + d, a + b, &mut found);
                hold(c - d, a - b, &mut found);
                hold(c * d, a * b, &mut found);
                hold(c / d, a / b, &mut found);
                hold(c.at_least(d), a.at_least(b), &mut found);
                hold(c.at_most(d), a.at_most(b), &mut found);
                hold(Real::select(c.lt(d), c, d), Real::select(a.lt(b), a, b), &mut found);
                assert_eq!(c.lt(d), a.lt(b));
                assert_eq!(c.le(d), a.le(b));
            }
        }
        assert!(found[1] > found[0] / 4, "{found:?} are known");
    }

    #[test]
    fn what_is_known_is_the_plain_ball() {
        compare::<Ieee>();
        compare::<Precise>();
        compare::<Gpu>();
    }
}
