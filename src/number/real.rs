//! The number type that every formula is generic over.

use super::elementary;
use super::lanes::LANES;
use super::{Pixel, Truth};
use crate::number::MapInline;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number type that can evaluate the formulas of the crate.
///
/// An operation rounds once, to nearest, ties to even, and is never fused with another. Comparisons
/// give a [`Truth`], not a `bool`. So a formula over any `Real` has no control flow that depends on
/// a value; code with such control flow is generic over [`Exact`] numbers. A comparison with NaN is
/// false. There are no `min` and `max`, because their treatment of zeros and NaN is not portable;
/// use [`Real::at_least`] and [`Real::at_most`].
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// The outcome of a comparison of two numbers.
    type Truth: Truth;
    /// The integer part of a number.
    type Pixel: Pixel;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Positive infinity: the depth of an empty pixel.
    const INFINITY: Self;

    /// Converts exactly: every input and every constant of the crate is an `f32`.
    fn from_f32(value: f32) -> Self;
    /// The number nearest to an integer, ties to even: exact up to 2^24 in `f32`, 2^53 in `f64`.
    fn from_i64(value: i64) -> Self;
    /// The `f32` nearest to this number, rounded once.
    fn to_f32(self) -> f32;
    /// The `f64` nearest to this number; exact for `f32` and `f64`.
    fn to_f64(self) -> f64;
    /// The integer part of a number in [0, 2^22].
    fn to_pixel(self) -> Self::Pixel;
    /// The largest integer that is not greater, exactly.
    fn floor(self) -> Self;
    /// The square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// The square root of a sum of squares. A ball needs this method because it does not remember
    /// that such a sum is not negative.
    #[inline(always)]
    #[must_use]
    fn root_of_squares(self) -> Self {
        self.sqrt()
    }
    /// The absolute value.
    fn abs(self) -> Self;
    /// e to this power, see [`elementary`].
    fn exp(self) -> Self;
    /// This number to the power of `exponent`, see [`elementary`]; `self` is not negative.
    #[must_use]
    fn pow(self, exponent: Self) -> Self;
    /// Whether this number is neither infinite nor NaN.
    fn is_finite(self) -> Self::Truth;

    /// `self < other`.
    fn lt(self, other: Self) -> Self::Truth;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Truth;
    /// `self > other`.
    fn gt(self, other: Self) -> Self::Truth;
    /// `self >= other`.
    fn ge(self, other: Self) -> Self::Truth;
    /// `yes` if the truth is yes, else `no`. Where the truth is undecided, a number that stands for
    /// an interval gives the hull of both.
    #[must_use]
    fn select(truth: Self::Truth, yes: Self, no: Self) -> Self;
    /// `self`, or `low` if `self < low`. For intervals the result is never undecided, because the
    /// bound is continuous.
    #[must_use]
    fn at_least(self, low: Self) -> Self;
    /// `self`, or `high` if `self > high`; continuous as well.
    #[must_use]
    fn at_most(self, high: Self) -> Self;
    /// `self.at_least(low).at_most(high)` in one step.
    ///
    /// The number is the same. It is one step because a midpoint and a radius cannot hold the
    /// lopsided interval that the first of two bounds leaves.
    #[must_use]
    fn clamped(self, low: Self, high: Self) -> Self;
}

/// A number whose comparisons have two outcomes; code with control flow is generic over it.
///
/// `f32` and `f64` implement it; their operators of [`PartialOrd`] are the comparisons of [`Real`].
/// No number with three outcomes needs the methods of this trait.
pub trait Exact: Real<Truth = bool, Pixel = u32> + PartialOrd {
    /// The integer part, towards 0; the nearest `i64` if out of range, 0 for NaN.
    fn to_i64(self) -> i64;
    /// [`Real::pow`] of several numbers.
    #[inline(always)]
    #[must_use]
    fn powers(bases: &[Self; LANES], exponent: Self) -> [Self; LANES] {
        bases.map_inline(|base| base.pow(exponent))
    }
    /// The angle of the point (x, `self`) from the x axis, in radians, see [`elementary::atan2`].
    fn atan2(self, x: Self) -> Self;
    /// How far apart two numbers are in the ascending list of all numbers: the difference of their
    /// ranks, 1 for neighbours.
    ///
    /// The rank of a number >= 0 is its bits as an integer, and the rank of -x is the negative of
    /// x's rank. So both zeros have rank 0, and +inf is one after the largest number. The
    /// difference is exact as an integer and then rounded to `f32`; +inf if either number is NaN.
    fn ulps_to(self, other: Self) -> f32;
}

/// The comparisons of a number type that has comparison operators.
macro_rules! compared_by_operators {
    () => {
        type Truth = bool;
        type Pixel = u32;

        #[inline(always)]
        fn lt(self, other: Self) -> bool {
            self < other
        }
        #[inline(always)]
        fn le(self, other: Self) -> bool {
            self <= other
        }
        #[inline(always)]
        fn gt(self, other: Self) -> bool {
            self > other
        }
        #[inline(always)]
        fn ge(self, other: Self) -> bool {
            self >= other
        }
        #[inline(always)]
        fn select(truth: bool, yes: Self, no: Self) -> Self {
            if truth { yes } else { no }
        }
        #[inline(always)]
        fn at_least(self, low: Self) -> Self {
            if self < low { low } else { self }
        }
        #[inline(always)]
        fn at_most(self, high: Self) -> Self {
            if self > high { high } else { self }
        }
        #[inline(always)]
        fn clamped(self, low: Self, high: Self) -> Self {
            self.at_least(low).at_most(high)
        }
    };
}

impl Real for f32 {
    compared_by_operators!();

    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const INFINITY: Self = Self::INFINITY;

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn from_i64(value: i64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_f32(self) -> f32 {
        self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn to_pixel(self) -> u32 {
        // A float-to-integer conversion that saturates does not vectorize. Adding 2^23 rounds to an
        // integer, and the mantissa of the sum then holds that integer.
        let shifted = self + 8_388_608.0;
        let above = shifted - 8_388_608.0 > self;
        let shifted = if above { shifted - 1.0 } else { shifted };
        shifted.to_bits() & 0x007F_FFFF
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.floor()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp_f32(self)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        elementary::pow_f32(self, exponent)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Exact for f32 {
    #[inline(always)]
    fn to_i64(self) -> i64 {
        self as i64
    }
    #[inline(always)]
    fn powers(bases: &[Self; LANES], exponent: Self) -> [Self; LANES] {
        elementary::powers_f32(bases, exponent)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        elementary::atan2(f64::from(self), f64::from(x)) as Self
    }
    #[inline]
    fn ulps_to(self, other: Self) -> f32 {
        if self.is_nan() || other.is_nan() {
            return Self::INFINITY;
        }
        ordered_f32(self).abs_diff(ordered_f32(other)) as Self
    }
}

impl Real for f64 {
    compared_by_operators!();

    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const INFINITY: Self = Self::INFINITY;

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        Self::from(value)
    }
    #[inline(always)]
    fn from_i64(value: i64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_f32(self) -> f32 {
        self as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn to_pixel(self) -> u32 {
        self as u32
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.floor()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        elementary::pow(self, exponent)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Exact for f64 {
    #[inline(always)]
    fn to_i64(self) -> i64 {
        self as i64
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        elementary::atan2(self, x)
    }
    #[inline]
    fn ulps_to(self, other: Self) -> f32 {
        if self.is_nan() || other.is_nan() {
            return f32::INFINITY;
        }
        ordered_f64(self).abs_diff(ordered_f64(other)) as f32
    }
}

/// The position of a float in the ordered list of all floats; both zeros are at 0.
pub(crate) fn ordered_f32(value: f32) -> i64 {
    let magnitude = i64::from(value.to_bits() & 0x7FFF_FFFF);
    if value.is_sign_negative() { -magnitude } else { magnitude }
}

/// As [`ordered_f32`].
pub(crate) fn ordered_f64(value: f64) -> i64 {
    let magnitude = (value.to_bits() & 0x7FFF_FFFF_FFFF_FFFF) as i64;
    if value.is_sign_negative() { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulps_count_representable_numbers() {
        assert_eq!(1.0_f32.ulps_to(1.0), 0.0);
        assert_eq!(1.0_f32.ulps_to(1.0 + f32::EPSILON), 1.0);
        assert_eq!((-0.0_f32).ulps_to(0.0), 0.0);
        let tiny = f32::from_bits(1);
        assert_eq!((-tiny).ulps_to(tiny), 2.0, "one step to zero from either side");
        assert_eq!(1.0_f32.ulps_to(f32::NAN), f32::INFINITY);
        assert_eq!(1.0_f64.ulps_to(1.0 - f64::EPSILON), 2.0, "the spacing halves below one");
    }

    #[test]
    fn a_pixel_is_the_integer_part() {
        let values = [0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.5, 65_535.5, 65_536.0, 4_194_303.5];
        for value in values {
            for near in [value, f32::next_down(value), f32::next_up(value)] {
                if near >= 0.0 {
                    assert_eq!(near.to_pixel(), near.trunc() as u32, "{near}");
                    assert_eq!(f64::from(near).to_pixel(), near.trunc() as u32, "{near}");
                }
            }
        }
    }

    #[test]
    fn an_integer_becomes_the_nearest_number_and_ties_go_to_even() {
        // The spacing of the two types becomes 2 at 2^24 and 2^53.
        for (sign, odd) in [(1, 16_777_217_i64), (-1, 16_777_217), (1, 33_554_434 + 1)] {
            let single = <f32 as Real>::from_i64(sign * odd);
            let neighbours = [f32::next_down(single), f32::next_up(single)];
            let error = |v: f32| (v as i64 - sign * odd).abs();
            assert!(neighbours.into_iter().all(|n| error(n) >= error(single)), "{single}");
            assert_eq!(f64::from_i64(sign * odd) as i64, sign * odd, "exact");
        }
        assert_eq!(<f32 as Real>::from_i64(16_777_217), 16_777_216.0, "down to even");
        assert_eq!(<f32 as Real>::from_i64(16_777_219), 16_777_220.0, "up to even");
        assert_eq!(<f32 as Real>::from_i64(-16_777_217), -16_777_216.0);
        let wide = 1_i64 << 53;
        assert_eq!(f64::from_i64(wide + 1), wide as f64, "down to even");
        assert_eq!(f64::from_i64(wide + 3), (wide + 4) as f64, "up to even");
        // Rounded once, not by way of f64: 2^60 + 2^36 + 1 is above the tie that f64 would make of
        // it.
        assert_eq!(
            <f32 as Real>::from_i64((1 << 60) + (1 << 36) + 1),
            f32::next_up((1_i64 << 60) as f32)
        );
        assert_eq!([-2.75_f32, 2.75, f32::NAN].map(Exact::to_i64), [-2, 2, 0]);
        assert_eq!([-2.75, 2.75, f64::INFINITY].map(Exact::to_i64), [-2, 2, i64::MAX]);
    }

    #[test]
    fn floor_and_angle_are_those_of_their_type() {
        assert_eq!([-0.25_f32, -1.0, 2.75, 1e30].map(Real::floor), [-1.0, -1.0, 2.0, 1e30]);
        assert_eq!((-0.25_f64).floor(), -1.0);
        // Around the circle, against known angles.
        let eighth = std::f64::consts::FRAC_PI_4;
        for (i, (y, x)) in
            [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, -1.0), (0.0, -1.0)].into_iter().enumerate()
        {
            assert_eq!(Exact::atan2(y, x), i as f64 * eighth);
            assert_eq!(Exact::atan2(y as f32, x as f32), (i as f64 * eighth) as f32);
            assert_eq!(Exact::atan2(-y, x), -(i as f64 * eighth));
        }
        let mut worst = 0.0;
        for i in 0..10_000 {
            let angle = (crate::number::random::unit(1, i) - 0.5) * 6.25;
            let (y, x) = (core_math::sinf(angle), core_math::cosf(angle));
            let ulps = Exact::atan2(y, x).ulps_to(core_math::atan2f(y, x));
            if ulps > worst {
                worst = ulps;
            }
        }
        assert_eq!(worst, 0.0, "correctly rounded");
    }

    #[test]
    fn bounds_keep_what_lies_inside() {
        assert_eq!(2.0_f32.at_least(3.0), 3.0);
        assert_eq!(2.0_f32.at_most(3.0), 2.0);
        assert!(f32::NAN.at_least(0.0).is_nan(), "a comparison with NaN is false");
        let odd = [-0.0, 0.0, 1.0, -1.0, 3.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        for [x, low, high] in odd
            .iter()
            .flat_map(|&x| odd.iter().flat_map(move |&low| odd.map(move |high| [x, low, high])))
        {
            let two_steps = x.at_least(low).at_most(high);
            assert_eq!(x.clamped(low, high).to_bits(), two_steps.to_bits(), "{x} {low} {high}");
        }
    }
}
