//! A number with a radius: every value that a correct `f32` implementation may compute.
//!
//! Evaluate a formula in [`Ball`]s and you get, beside the value, how far a client's `f32` may lie
//! from it. A [`Ball`] is a midpoint and a radius, both `f64`:
//!
//! - The midpoint is the value of the same formula in `f64`, bit for bit.
//! - The radius bounds how far an `f32` result may lie from the midpoint. It assumes that the
//!   client does the same operations on the same inputs, and that each operation rounds as the
//!   [`Profile`] allows.
//!
//! The bound holds for whole formulas because it holds for each operation: the operands may be any
//! values of their balls, in any combination.
//!
//! # How the radius of a result is computed
//!
//! Let the operands x and y have midpoints m and n and radii r and s. The *spread* of an operation
//! is how much the operands' errors can change its exact result, second-order terms included:
//!
//! ```text
//!   x + y, x - y   r + s
//!   x y            |m| s + |n| r + r s
//!   x / y          (|m| s + |n| r) / (|n| (|n| - s))        unbounded unless |n| > s
//!   sqrt x         r / (sqrt m + sqrt(m - r))               NaN is possible unless m >= r
//!                  of a sum of squares otherwise max(sqrt m, sqrt(m + r) - sqrt m)
//!   e^x            e^m (r + r r) + 2^-50 e^m (1 + r + r r)             r <= 1, where e^r - 1 <= r + r r
//!                  else (e^(m + r) - e^m) + 2^-50 e^(m + r)
//!   x^y            m^y (z + z z + 2 z r/m) + 2^-50 m^y (1 + z + z z)   y >= 0 exact, x >= 0; z = y r/m <= 1
//!                                                                      and r/m <= 1/2
//!                  else max(m^y - (m - r)^y, (m + r)^y - m^y) + 2^-50 (m + r)^y
//!                  of another y >= 0 what holds the powers of both of its ends
//!   floor x        max(floor m - floor(m - r), floor(m + r) - floor m)
//!   -x, |x|        r
//! ```
//!
//! An operation that rounds adds its own rounding. The constant c comes from the [`Profile`], in
//! units of u = 2^-24:
//!
//! ```text
//!   radius = (spread + c u (1 + 2^-20) (|midpoint| + spread) + tiny) (1 + 2^-40)
//! ```
//!
//! For sums, c = 1 where each operation rounds to nearest; [`Gpu`] says what sums cost where terms
//! are added in any order. `tiny` is what an operation loses below the normal numbers: 1.000002
//! 2^-150 for [`Ieee`]. It is 0 for sums and square roots that round to nearest.
//!
//! The factors 1 + 2^-20 and 1 + 2^-40 exceed the rounding errors of the `f64` operations that
//! compute the midpoint and the radius. So no rounding mode has to be changed. Where a formula
//! needs the ends m - r and m + r of an interval, the ends are also moved outwards by about 2^-40
//! r. A radius is therefore defined to about 2^-39 of itself, not to the bit; a midpoint is defined
//! to the bit.
//!
//! - **Exact operations.** The radius is 0 where the operation rounds to nearest, both radii are 0
//!   and the midpoint of the result is an `f32` that is not flushed to 0. An infinity is an `f32`, so 1 / 0 of exact numbers is
//!   exactly +inf, and so is a bounded ball plus +inf. 0 times a bounded ball is exactly 0, and so
//!   is 0 divided by a ball that cannot be 0.
//! - **Unbounded.** A radius of +inf stands for any number or infinity, and a radius of NaN
//!   includes NaN too. A quotient whose divisor may be 0 is unbounded, and so is a result that may
//!   exceed the largest `f32`. Whether an unbounded ball is finite is undecided.
//! - **Bounds** ([`Real::at_least`], [`Real::at_most`], [`Real::clamped`]) apply to both ends of
//!   the interval, and round nothing.
//!
//! # When a comparison is certain
//!
//! A comparison gives a [`Three`]. It is certain where the distance of the midpoints exceeds (r +
//! s) (1 + 2^-40) or both radii are 0, and undecided otherwise. Where the truth is undecided,
//! [`Real::select`] gives the hull of both values.
//!
//! First-order bounds are not enough: with the product r s left out, 110 of 2,965 depths of edge-on
//! splats far from the origin escaped. The tests of this module run the crate's formulas in numbers
//! that round by the toss of a coin. They also run variants of this ball that round too little,
//! which the tests must catch.

mod angle;
mod arithmetic;
mod bounds;
mod common;
mod lanes;
mod powers;
mod profile;
#[cfg(test)]
pub(crate) mod tests;
mod three;
mod totals;

pub(crate) use lanes::BallLanes;
pub(crate) use profile::Common;
pub use profile::{Gpu, Ieee, Precise, Profile, SumTerms};
pub use three::{PixelRange, Three};
pub(crate) use totals::{Totals, TotalsLanes};

use super::Real;
use crate::number::MapInline;
use arithmetic::is_exact;
use std::fmt::Debug;

/// All values that lie within `radius` of `middle`; see the [module](self).
pub struct Ball<P: Profile = Ieee> {
    /// The value of the formula in `f64`.
    pub middle: f64,
    /// At least 0; +inf: any number or infinity; NaN: NaN as well.
    pub radius: f64,
    terms: P::Terms,
}

/// u, half the distance of 1 from the next `f32`, and a little more because the `f64` midpoint
/// rounds too.
const U: f64 = (1.0 + 1.0 / 1_048_576.0) / 16_777_216.0;

/// More than the rounding errors of a radius.
const SLACK: f64 = 1.0 + 1.0 / 1_099_511_627_776.0;

impl<P: Profile> Ball<P> {
    /// Makes a ball from a midpoint and a radius.
    #[inline(always)]
    #[must_use]
    pub const fn new(middle: f64, radius: f64) -> Self {
        Self { middle, radius, terms: P::NO_SUM }
    }

    /// A known value: what a file holds, whatever its format.
    #[inline(always)]
    #[must_use]
    pub const fn exact(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    /// Whether the ball contains this value.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        let unbounded = !self.radius.is_finite();
        let anything = self.radius.is_nan() || (unbounded && !value.is_nan());
        anything || value == self.middle || (value - self.middle).abs() <= self.radius * SLACK
    }

    /// The distance between the midpoints of two numbers, in units of the sum of their radii.
    ///
    /// Beyond 1 the comparison of the two is certain. +inf where both are exact; 0 where a radius
    /// is not finite.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        let reach = self.radius + other.radius;
        if reach == 0.0 {
            f64::INFINITY
        } else if reach.is_finite() {
            (self.middle - other.middle).abs() / reach
        } else {
            0.0
        }
    }

    /// The distance of the midpoint from a known number's midpoint, in units of the sum of their
    /// radii.
    ///
    /// As [`Ball::distance`], with three exceptions: 0 for equal midpoints, +inf for two exact
    /// numbers that differ, and +inf for NaN unless the ball contains NaN.
    #[must_use]
    pub fn misfit(self, found: Self) -> f64 {
        let reach = self.radius + found.radius;
        if self.middle == found.middle || self.radius.is_nan() {
            0.0
        } else if found.middle.is_nan() || reach == 0.0 {
            f64::INFINITY
        } else if reach.is_finite() {
            (self.middle - found.middle).abs() / (reach * SLACK)
        } else {
            0.0
        }
    }

    /// [`Ball::misfit`] without a branch, so that a loop over it vectorizes; NaN where a radius is
    /// not finite and the midpoints differ.
    #[inline(always)]
    pub(crate) fn misfit_of_bounded(self, found: Self) -> f64 {
        let reach = self.radius + found.radius;
        let error = (self.middle - found.middle).abs() / (reach * SLACK);
        let error = if reach.is_finite() { error } else { f64::NAN };
        if self.middle == found.middle { 0.0 } else { error }
    }

    /// The ball of the absolute value, as a sum of the same terms.
    #[inline(always)]
    pub(crate) fn magnitude(self) -> Self {
        Self { middle: self.middle.abs(), ..self }
    }

    /// The least value; -inf if there is none.
    #[inline(always)]
    fn low(&self) -> f64 {
        if self.radius == 0.0 { self.middle } else { self.middle - self.radius * SLACK }
    }

    /// The greatest value; +inf if there is none.
    #[inline(always)]
    fn high(&self) -> f64 {
        if self.radius == 0.0 { self.middle } else { self.middle + self.radius * SLACK }
    }

    /// The least and the greatest value.
    pub(crate) fn ends(self) -> [f64; 2] {
        [self.low(), self.high()]
    }

    #[inline(always)]
    fn is_bounded(&self) -> bool {
        self.radius.is_finite() && self.middle.is_finite()
    }

    #[inline(always)]
    fn may_be_zero(&self) -> bool {
        // A NaN radius also means that the ball may be 0.
        !(self.middle.abs() > self.radius * SLACK)
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.middle == 0.0 && self.radius == 0.0
    }

    /// Builds the result of an operation from its midpoint, its spread, and its rounding in units
    /// of u.
    #[inline(always)]
    fn rounded(middle: f64, spread: f64, units: f64, tiny: f64) -> Self {
        let ball = Self::new(middle, Self::reach(middle, spread, units, tiny));
        if ball.is_in_range() {
            ball
        } else {
            Self::unbounded(middle, ball.radius.is_nan() || middle.is_nan())
        }
    }

    /// The radius of the result of an operation, if the result is bounded.
    #[inline(always)]
    fn reach(middle: f64, spread: f64, units: f64, tiny: f64) -> f64 {
        let rounding = units * U * (middle.abs() + spread) + tiny;
        (spread + rounding) * SLACK
    }

    /// Whether all values are finite `f32`.
    #[inline(always)]
    fn is_in_range(&self) -> bool {
        // NaN fails this comparison.
        self.middle.abs() + self.radius <= f64::from(f32::MAX)
    }

    /// A ball without bounds.
    #[cold]
    #[inline(never)]
    fn unbounded(middle: f64, may_be_nan: bool) -> Self {
        Self::new(middle, if may_be_nan { f64::NAN } else { f64::INFINITY })
    }

    /// Reinterprets this ball under another rounding profile.
    #[inline(always)]
    pub(crate) fn rounding_as<Q: Profile<Terms = P::Terms>>(self) -> Ball<Q> {
        Ball { middle: self.middle, radius: self.radius, terms: self.terms }
    }
}

impl<P: Profile> Real for Ball<P> {
    type Truth = Three;
    type Pixel = PixelRange;

    const ZERO: Self = Self::exact(0.0);
    const ONE: Self = Self::exact(1.0);
    const INFINITY: Self = Self::exact(f64::INFINITY);

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        let value = f64::from(value);
        let flushed = P::FLUSHES && value.abs() < f64::from(f32::MIN_POSITIVE);
        let radius = if flushed { value.abs() } else { 0.0 };
        Self::new(value, if value.is_nan() { f64::NAN } else { radius })
    }

    #[inline(always)]
    fn from_i64(value: i64) -> Self {
        let middle = value as f64;
        let error = (f64::from(value as f32) - middle).abs();
        // Beyond 2^53 the midpoint itself is rounded too.
        let radius = if error == 0.0 { 0.0 } else { error * SLACK + middle.abs() * f64::EPSILON };
        Self::new(middle, radius)
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self.middle as f32
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.middle
    }

    #[inline(always)]
    fn to_pixel(self) -> PixelRange {
        // An unbounded ball gets the whole range that a pixel can have. A cast saturates.
        let high = if self.radius.is_nan() { f64::INFINITY } else { self.high() };
        PixelRange::new(self.low() as u32, (high as u32).min(1 << 22))
    }

    #[inline(always)]
    fn floor(self) -> Self {
        let middle = self.middle.floor();
        let (below, above) = (middle - self.low().floor(), self.high().floor() - middle);
        Self::new(middle, if self.radius == 0.0 { 0.0 } else { larger(below, above) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        if P::COMMON_ONLY { common::root(self) } else { root(self) }
    }

    #[inline(always)]
    fn root_of_squares(self) -> Self {
        if P::COMMON_ONLY {
            return common::root_of_squares(self);
        }
        root_of_squares(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(self.middle.abs(), self.radius)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let middle = Real::exp(self.middle);
        if is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, self.radius) {
            return Self::exact(middle);
        }
        let spread = powers::exponential(middle, self.radius * SLACK, self.high());
        // The largest argument of the ball costs most.
        let units = P::exponential(self.middle.abs() + self.radius);
        Self::rounded(middle, spread, units, P::TINY)
    }

    #[inline]
    fn pow(self, exponent: Self) -> Self {
        let middle = self.middle.pow(exponent.middle);
        if is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, self.radius + exponent.radius) {
            return Self::exact(middle);
        }
        if exponent.radius > 0.0 {
            return powers::between(self, exponent);
        }
        let ends = [self.low(), self.high()];
        // NaN fails these comparisons.
        if !(exponent.radius == 0.0 && exponent.middle >= 0.0 && ends[1].is_finite()) {
            return Self::unbounded(middle, true);
        }
        // The base is not negative, so an end below 0 is only an effect of the radius.
        let bases = ends.map_inline(|end| larger(end, 0.0));
        let spread =
            powers::power(middle, self.middle, self.radius * SLACK, bases, exponent.middle);
        Self::rounded(middle, spread, P::power(bases, exponent.middle), P::TINY)
    }

    #[inline(always)]
    fn is_finite(self) -> Three {
        let unbounded = !self.radius.is_finite();
        let finite = self.middle.is_finite();
        Three::new([finite & !unbounded, finite, finite | unbounded])
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Three {
        less(self, other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Three {
        less(self, other, |a, b| a <= b)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Three {
        other.lt(self)
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Three {
        other.le(self)
    }

    #[inline(always)]
    fn select(truth: Three, yes: Self, no: Self) -> Self {
        if P::COMMON_ONLY {
            return common::select(truth, yes, no);
        }
        match truth.decided() {
            Some(true) => yes,
            Some(false) => no,
            None => bounds::hull(truth.middle(), yes, no),
        }
    }
    #[inline(always)]
    fn at_least(self, low: Self) -> Self {
        if P::COMMON_ONLY {
            return common::at_least(self, low);
        }
        bounds::at_least(self, low)
    }
    #[inline(always)]
    fn at_most(self, high: Self) -> Self {
        -(-self).at_least(-high)
    }
    #[inline(always)]
    fn clamped(self, low: Self, high: Self) -> Self {
        bounds::clamped(self, low, high)
    }
}

/// The square root.
#[inline(always)]
fn root<P: Profile>(x: Ball<P>) -> Ball<P> {
    let middle = x.middle.sqrt();
    if is_exact::<P>(P::ROUNDS_ALL_TO_NEAREST, middle, x.radius) | x.is_zero() {
        return Ball::exact(middle);
    }
    let low = x.low();
    // NaN fails this comparison.
    if low >= 0.0 {
        let spread = x.radius / (middle + low.sqrt());
        // The root of a normal number is normal; the root of a flushed number is 0.
        return Ball::rounded(middle, spread, P::ROOT, 0.0);
    }
    Ball::unbounded(middle, true)
}

/// The square root of a sum of squares, which may be 0.
#[inline(always)]
fn root_of_squares<P: Profile>(x: Ball<P>) -> Ball<P> {
    // NaN fails these comparisons.
    if x.low() < 0.0 && x.high().is_finite() {
        let middle = x.middle.sqrt();
        let spread = larger(middle, x.high().sqrt() - middle);
        return Ball::rounded(middle, spread, P::ROOT, 0.0);
    }
    root(x)
}

/// Whether one ball is below another, given the comparison of exact numbers.
#[inline(always)]
fn less<P: Profile>(a: Ball<P>, b: Ball<P>, compare: fn(f64, f64) -> bool) -> Three {
    let (middle, reach) = (compare(a.middle, b.middle), a.radius + b.radius);
    if reach == 0.0 {
        return middle.into();
    }
    // Subtraction keeps the sign, and its relative error is less than the slack. NaN leaves the
    // comparison undecided.
    let (gap, reach) = (b.middle - a.middle, reach * SLACK);
    Three::new([gap > reach, middle, !(-gap > reach)])
}

/// The larger of two numbers; NaN if either is NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

impl<P: Profile> Clone for Ball<P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Profile> Copy for Ball<P> {}

impl<P: Profile> Debug for Ball<P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} +- {}", self.middle, self.radius)
    }
}
