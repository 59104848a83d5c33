//! The operators, and which of their results need no rounding.

use super::{Ball, Profile};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Whether an operation on exact operands has this result exactly.
///
/// The result in `f64` is within 2^-53 of the exact one, so that if the former is an `f32`, that is
/// what the exact one rounds to.
#[inline(always)]
pub(super) fn is_exact<P: Profile>(result: f64, radii: f64) -> bool {
    P::ROUNDS_TO_NEAREST && radii == 0.0 && f64::from(result as f32) == result
}

impl<P: Profile> Add for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (middle, spread) = (self.middle + other.middle, self.radius + other.radius);
        if is_exact::<P>(middle, spread) {
            return Self::exact(middle);
        }
        match (self.is_bounded(), other.is_bounded()) {
            (true, true) => P::sum(middle, [&self, &other]),
            // Infinite exactly, or unbounded.
            (true, false) => Self::new(middle, other.radius),
            (false, true) => Self::new(middle, self.radius),
            // Infinities of both signs.
            (false, false) => Self::unbounded(middle, true),
        }
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
        let (m, n, r, s) = (self.middle, other.middle, self.radius, other.radius);
        let middle = m * n;
        if is_exact::<P>(middle, r + s) {
            return Self::exact(middle);
        }
        if self.is_bounded() & other.is_bounded() {
            if self.is_zero() | other.is_zero() {
                return Self::exact(middle);
            }
            let spread = m.abs() * s + n.abs() * r + r * s;
            return Self::rounded(middle, spread, P::PRODUCT, P::TINY);
        }
        let zero = self.may_be_zero() | other.may_be_zero();
        Self::unbounded(middle, zero || r.is_nan() || s.is_nan())
    }
}

impl<P: Profile> Div for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (m, n, r, s) = (self.middle, other.middle, self.radius, other.radius);
        let middle = m / n;
        if is_exact::<P>(middle, r + s) {
            return Self::exact(middle);
        }
        let divides = !other.may_be_zero() & s.is_finite();
        if self.is_bounded() & divides & !(n.is_finite() & (n.abs() + s > P::LARGEST_DIVISOR)) {
            if self.is_zero() | n.is_infinite() {
                return Self::exact(middle);
            }
            let spread = (m.abs() * s + n.abs() * r) / (n.abs() * (n.abs() - s));
            return Self::rounded(middle, spread, P::QUOTIENT, P::TINY);
        }
        let zeros = self.may_be_zero() & other.may_be_zero();
        let infinities = !self.is_bounded() & !other.is_bounded();
        Self::unbounded(middle, zeros || infinities || r.is_nan() || s.is_nan())
    }
}

impl<P: Profile> Neg for Ball<P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // The terms are those of the opposite sum.
        Self { middle: -self.middle, ..self }
    }
}
