//! The two values of a pixel, and the distance between them.

use super::Tolerance;
use crate::number::real::ordered_f32;
use std::fmt;

/// A pixel that differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Column, from 0.
    pub x: u32,
    /// Row, from 0 at the top.
    pub y: u32,
    /// The value in the first picture.
    pub first: ChannelValue,
    /// The value in the second picture.
    pub second: ChannelValue,
}

/// One value of a channel. Display shows its bits too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelValue {
    /// A value in a channel of floats.
    Float(f32),
    /// A value in a channel of indices.
    Index(u32),
}

impl ChannelValue {
    /// The 32 bits as stored.
    #[must_use]
    pub fn bits(self) -> u32 {
        match self {
            Self::Float(value) => value.to_bits(),
            Self::Index(value) => value,
        }
    }

    /// Whether the value is NaN.
    pub(super) fn is_nan(self) -> bool {
        self.number().is_nan()
    }

    /// The number, exactly.
    fn number(self) -> f64 {
        match self {
            Self::Float(value) => f64::from(value),
            Self::Index(value) => f64::from(value),
        }
    }

    /// The position in the ordered list of all values of the type. NaN has a position too, beyond
    /// the infinities.
    fn rank(self) -> i64 {
        match self {
            Self::Float(value) => ordered_f32(value),
            Self::Index(value) => i64::from(value),
        }
    }
}

impl fmt::Display for ChannelValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(value) => write!(f, "{value:?} (0x{:08x})", value.to_bits()),
            Self::Index(value) => write!(f, "{value} (0x{value:08x})"),
        }
    }
}

impl Difference {
    /// How many values of the type lie from one to the other: at least 1, except between the two
    /// zeros. None if either value is NaN.
    #[must_use]
    pub fn ulps(&self) -> Option<u32> {
        if self.first.is_nan() || self.second.is_nan() {
            return None;
        }
        // Less than 2^32: two infinities are 2 * 0x7F80_0000 apart.
        Some(self.first.rank().abs_diff(self.second.rank()) as u32)
    }

    /// The absolute difference of the numbers. Infinite if one number is infinite, NaN if one is
    /// NaN.
    #[must_use]
    pub fn abs(&self) -> f64 {
        (self.first.number() - self.second.number()).abs()
    }

    /// The size of the difference for ranking pixels: the absolute difference, infinite where
    /// either value is NaN.
    pub(super) fn weight(&self) -> f64 {
        if self.ulps().is_some() { self.abs() } else { f64::INFINITY }
    }

    /// Whether the difference lies within either bound of `tolerance`.
    #[must_use]
    pub fn passes(&self, tolerance: Tolerance) -> bool {
        let (ChannelValue::Float(first), ChannelValue::Float(second)) = (self.first, self.second)
        else {
            // Indices have no distance, and equal ones never get here.
            return false;
        };
        if !first.is_finite() || !second.is_finite() {
            // An infinity has no finite distance, and a NaN none at all.
            return false;
        }
        let within_ulp =
            tolerance.max_ulp.zip(self.ulps()).is_some_and(|(most, ulps)| ulps <= most);
        within_ulp || tolerance.max_abs.is_some_and(|most| self.abs() <= f64::from(most))
    }
}
