//! The operators, and which of their results need no rounding.
//!
//! An operator first assumes that its operands are bounded. If an operand is unbounded, or a
//! divisor may be 0, the bound of the result is infinite, NaN, or beyond the largest `f32`. One
//! test finds all these cases, and the operator calls a function out of line for them, because they
//! are rare.

use super::{Ball, Profile, common};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Whether an operation on exact operands has exactly this result.
///
/// The result in `f64` is within 2^-53 of the exact result. So if the `f64` result is an `f32`, the
/// exact result rounds to it, unless it may be flushed to 0.
#[inline(always)]
pub(super) fn is_exact<P: Profile>(rounds_to_nearest: bool, result: f64, radii: f64) -> bool {
    let kept = !P::FLUSHES | (result == 0.0) | (result.abs() >= f64::from(f32::MIN_POSITIVE));
    rounds_to_nearest & kept & (radii == 0.0) & (f64::from(result as f32) == result)
}

impl<P: Profile> Add for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        if P::COMMON_ONLY {
            return common::sum(self, other);
        }
        let (middle, spread) = (self.middle + other.middle, self.radius + other.radius);
        if is_exact::<P>(P::ROUNDS_TO_NEAREST, middle, spread) {
            return Self::exact(middle);
        }
        let sum = P::sum(middle, [&self, &other]);
        // A sum may forget that a term, itself a sum, is unbounded; the spread does not.
        if sum.is_in_range() & spread.is_finite() { sum } else { rare_sum(self, other) }
    }
}

/// A sum that is not bounded, or has unbounded terms.
#[cold]
#[inline(never)]
fn rare_sum<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let middle = a.middle + b.middle;
    match (a.is_bounded(), b.is_bounded()) {
        (true, true) => {
            let sum = P::sum(middle, [&a, &b]);
            Ball { radius: Ball::<P>::unbounded(middle, sum.radius.is_nan()).radius, ..sum }
        }
        // One term is exactly infinite, or unbounded.
        (true, false) => Ball::new(middle, b.radius),
        (false, true) => Ball::new(middle, a.radius),
        // Both may be infinite, with opposite signs.
        (false, false) => Ball::unbounded(middle, true),
    }
}

impl<P: Profile> Sub for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<P: Profile> Mul for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        if P::COMMON_ONLY {
            return common::product(self, other);
        }
        let (m, n, r, s) = (self.middle, other.middle, self.radius, other.radius);
        let middle = m * n;
        if is_exact::<P>(P::ROUNDS_TO_NEAREST, middle, r + s) {
            return Self::exact(middle);
        }
        let spread = m.abs() * s + n.abs() * r + r * s;
        let product = Self::new(middle, Self::reach(middle, spread, P::PRODUCT, P::TINY));
        // A factor may be 0.
        if product.is_in_range() & (middle != 0.0) { product } else { rare_product(self, other) }
    }
}

/// A product that is 0, or not bounded.
#[cold]
#[inline(never)]
fn rare_product<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (m, n, r, s) = (a.middle, b.middle, a.radius, b.radius);
    let middle = m * n;
    if a.is_bounded() & b.is_bounded() {
        if a.is_zero() | b.is_zero() {
            return Ball::exact(middle);
        }
        let spread = m.abs() * s + n.abs() * r + r * s;
        return Ball::rounded(middle, spread, P::PRODUCT, P::TINY);
    }
    let zero = a.may_be_zero() | b.may_be_zero();
    Ball::unbounded(middle, zero || r.is_nan() || s.is_nan())
}

impl<P: Profile> Div for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        if P::COMMON_ONLY {
            return common::quotient(self, other);
        }
        quotient(self, other)
    }
}

#[inline(always)]
fn quotient<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (m, n, r, s) = (a.middle, b.middle, a.radius, b.radius);
    let middle = m / n;
    if is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, r + s) {
        return Ball::exact(middle);
    }
    let spread = (m.abs() * s + n.abs() * r) / (n.abs() * (n.abs() - s));
    let quotient = Ball::new(middle, Ball::<P>::reach(middle, spread, P::QUOTIENT, P::TINY));
    let divides = !b.may_be_zero() & (n.abs() + s <= P::LARGEST_DIVISOR);
    // The dividend may be 0, or the divisor infinite.
    let common = quotient.is_in_range() & divides & (middle != 0.0);
    if common { quotient } else { rare_quotient(a, b) }
}

/// A quotient that is 0, or not bounded.
#[cold]
#[inline(never)]
fn rare_quotient<P: Profile>(a: Ball<P>, b: Ball<P>) -> Ball<P> {
    let (m, n, r, s) = (a.middle, b.middle, a.radius, b.radius);
    let middle = m / n;
    let divides = !b.may_be_zero() & s.is_finite();
    if a.is_bounded() & divides & !(n.is_finite() & (n.abs() + s > P::LARGEST_DIVISOR)) {
        if a.is_zero() | n.is_infinite() {
            return Ball::exact(middle);
        }
        let spread = (m.abs() * s + n.abs() * r) / (n.abs() * (n.abs() - s));
        return Ball::rounded(middle, spread, P::QUOTIENT, P::TINY);
    }
    let zeros = a.may_be_zero() & b.may_be_zero();
    let infinities = !a.is_bounded() & !b.is_bounded();
    Ball::unbounded(middle, zeros || infinities || r.is_nan() || s.is_nan())
}

impl<P: Profile> Neg for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // The terms now stand for the opposite sum.
        Self { middle: -self.middle, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Gpu, Ieee, Precise};
    use super::*;

    /// Balls of common and of odd numbers.
    fn balls<P: Profile>() -> Vec<Ball<P>> {
        let largest = f64::from(f32::MAX);
        let middles = [0.0, -0.0, 1.0, -3.0, 0.1, 1e-45, -1e-38, 1e30, largest, f64::INFINITY];
        let radii = [0.0, 1e-46, 1e-9, 0.1, 0.5, 3.0, 1e31, largest, f64::INFINITY, f64::NAN];
        let mut all = vec![Ball::new(f64::NAN, f64::NAN), Ball::new(f64::NEG_INFINITY, 0.0)];
        for middle in middles {
            all.extend(radii.map(|radius| Ball::new(middle, radius)));
        }
        all
    }

    fn bits<P: Profile>(ball: Ball<P>) -> [u64; 2] {
        [ball.middle, ball.radius].map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() })
    }

    fn compare<P: Profile>() {
        for a in balls::<P>() {
            for b in balls::<P>() {
                let spread = a.radius + b.radius;
                let [one, all] = [P::ROUNDS_TO_NEAREST, P::ROUNDS_ALL_TO_NEAREST];
                let or_exact = |rounds: bool, rare: Ball<P>| {
                    let exact = is_exact::<P>(rounds, rare.middle, spread);
                    bits(if exact { Ball::exact(rare.middle) } else { rare })
                };
                assert_eq!(bits(a * b), or_exact(one, rare_product(a, b)), "{a:?} times {b:?}");
                assert_eq!(bits(a / b), or_exact(all, rare_quotient(a, b)), "{a:?} by {b:?}");
                let bounded = a.is_bounded() & b.is_bounded();
                if !bounded {
                    assert_eq!(bits(a + b), or_exact(one, rare_sum(a, b)), "{a:?} plus {b:?}");
                }
            }
        }
    }

    #[test]
    fn the_common_case_and_the_rare_ones_agree() {
        compare::<Ieee>();
        compare::<Precise>();
        compare::<Gpu>();
    }

    #[test]
    fn a_sum_of_an_unbounded_sum_is_unbounded() {
        let large = Ball::<Gpu>::exact(f32::MAX.into());
        let unbounded = large + large;
        assert_eq!(unbounded.radius, f64::INFINITY);
        assert_eq!((unbounded + -large).radius, f64::INFINITY);
    }
}
