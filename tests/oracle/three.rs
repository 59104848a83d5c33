//! A number whose comparisons have three outcomes: an interval of f64.
//!
//! Every result is rounded outwards, so that an interval holds what f64 gives for any of the
//! numbers in the intervals it was computed from. The number is as simple as can be: what it
//! shows is that the formulas and the decisions of the crate can be asked by such a number.

use splatref::number::{Pixel, Real, Truth};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Kleene's three truths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Three {
    Yes,
    No,
    Undecided,
}

impl Three {
    /// Yes and no, if they are certain.
    fn of(yes: bool, no: bool) -> Self {
        match (yes, no) {
            (true, _) => Self::Yes,
            (_, true) => Self::No,
            _ => Self::Undecided,
        }
    }

    /// Whether one of the numbers may have answered so.
    pub(crate) fn allows(self, answer: bool) -> bool {
        if answer { self.possibly() } else { !self.certainly() }
    }
}

impl From<bool> for Three {
    fn from(value: bool) -> Self {
        Self::of(value, !value)
    }
}

impl BitAnd for Three {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self::of(self.certainly() && other.certainly(), self == Self::No || other == Self::No)
    }
}

impl BitOr for Three {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        !(!self & !other)
    }
}

impl Not for Three {
    type Output = Self;
    fn not(self) -> Self {
        Self::of(self == Self::No, self == Self::Yes)
    }
}

impl Truth for Three {
    fn certainly(self) -> bool {
        self == Self::Yes
    }
    fn possibly(self) -> bool {
        self != Self::No
    }
}

/// All columns or rows from the least to the greatest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixels(u32, u32);

impl Pixel for Pixels {
    fn least(self) -> u32 {
        self.0
    }
    fn greatest(self) -> u32 {
        self.1
    }
}

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Interval {
    const WHOLE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    pub(crate) fn point(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// All numbers within a part of `value`.
    pub(crate) fn around(value: f64, part: f64) -> Self {
        let reach = value.abs() * part;
        Self { low: value - reach, high: value + reach }
    }

    /// The number at a part in [0, 1] of the interval.
    pub(crate) fn at(self, part: f64) -> f64 {
        (self.low + (self.high - self.low) * part).max(self.low).min(self.high)
    }

    /// Whether the interval holds a number; NaN is in none, and no law speaks of it.
    pub(crate) fn holds(self, value: f64) -> bool {
        value.is_nan() || self.low <= value && value <= self.high
    }

    /// From the least to the greatest, rounded outwards; all numbers if one is NaN.
    fn hull<const N: usize>(values: [f64; N]) -> Self {
        if values.iter().any(|value| value.is_nan()) {
            return Self::WHOLE;
        }
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { low: low.next_down(), high: high.next_up() }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::hull([self.low + other.low, self.high + other.high])
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b] = [self.low, self.high];
        Self::hull([a * other.low, a * other.high, b * other.low, b * other.high])
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.holds(0.0) {
            return Self::WHOLE;
        }
        let [a, b] = [self.low, self.high];
        Self::hull([a / other.low, a / other.high, b / other.low, b / other.high])
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Real for Interval {
    type Truth = Three;
    type Pixel = Pixels;

    const ZERO: Self = Self { low: 0.0, high: 0.0 };
    const ONE: Self = Self { low: 1.0, high: 1.0 };
    const INFINITY: Self = Self { low: f64::INFINITY, high: f64::INFINITY };

    fn from_f32(value: f32) -> Self {
        Self::point(value.into())
    }
    fn from_i64(value: i64) -> Self {
        Self::point(Real::from_i64(value))
    }
    fn to_f32(self) -> f32 {
        self.to_f64() as f32
    }
    fn to_f64(self) -> f64 {
        self.at(0.5)
    }
    fn to_pixel(self) -> Pixels {
        Pixels(self.low as u32, self.high as u32)
    }
    fn floor(self) -> Self {
        Self { low: self.low.floor(), high: self.high.floor() }
    }
    fn sqrt(self) -> Self {
        // Roots of numbers below 0 are NaN, which no interval holds.
        Self::hull([self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt()])
    }
    fn abs(self) -> Self {
        let [a, b] = [self.low.abs(), self.high.abs()];
        let low = if self.holds(0.0) { 0.0 } else { a.min(b) };
        Self { low, high: a.max(b) }
    }
    fn exp(self) -> Self {
        // The function of f64 is off by less than an ulp, and need not be monotone within it.
        let [low, high] = [Real::exp(self.low), Real::exp(self.high)];
        Self::hull([low.next_down(), high.next_up()])
    }
    fn pow(self, exponent: Self) -> Self {
        // Of numbers >= 0 the power of an exponent >= 0 grows with both ends that a splat has.
        let [low, high] = [self.low, self.high].map(|base| Real::pow(base.max(0.0), exponent.low));
        Self::hull([low.next_down(), high.next_up()])
    }
    fn is_finite(self) -> Three {
        Three::of(self.low.is_finite() && self.high.is_finite(), false)
    }

    fn lt(self, other: Self) -> Three {
        Three::of(self.high < other.low, self.low >= other.high)
    }
    fn le(self, other: Self) -> Three {
        Three::of(self.high <= other.low, self.low > other.high)
    }
    fn gt(self, other: Self) -> Three {
        other.lt(self)
    }
    fn ge(self, other: Self) -> Three {
        other.le(self)
    }
    fn select(truth: Three, yes: Self, no: Self) -> Self {
        match truth {
            Three::Yes => yes,
            Three::No => no,
            Three::Undecided => Self { low: yes.low.min(no.low), high: yes.high.max(no.high) },
        }
    }
    fn at_least(self, low: Self) -> Self {
        Self { low: self.low.max(low.low), high: self.high.max(low.high) }
    }
    fn at_most(self, high: Self) -> Self {
        Self { low: self.low.min(high.low), high: self.high.min(high.high) }
    }
    fn clamped(self, low: Self, high: Self) -> Self {
        self.at_least(low).at_most(high)
    }
}
