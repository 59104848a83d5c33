//! A number of the oracle, and how many roundings it may be off.
//!
//! Running error analysis: every operation adds what it may round, so that a formula carries its
//! own bound, of the first order, in units of the arithmetic's rounding (2^-24 for `f32`, 2^-53 for
//! `f64`). The order of operations hardly matters to it, and a cancellation shows. What no
//! arithmetic rounds, it does not either: adding 0, multiplying by 0 or 1.

use crate::kit::eye::V3;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The smallest normal `f32`: below it a rounding is no smaller.
const FLOOR: f64 = 1.175_494_350_822_287_5e-38;

/// A value, and the sum of the roundings on the way to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rounded {
    pub(crate) value: f64,
    pub(crate) units: f64,
}

impl Rounded {
    pub(crate) const ZERO: Self = Self::exact(0.0);
    pub(crate) const ONE: Self = Self::exact(1.0);

    pub(crate) const fn exact(value: f64) -> Self {
        Self { value, units: 0.0 }
    }

    /// A vector of exact numbers.
    pub(crate) fn vector(v: V3) -> [Self; 3] {
        v.map(Self::exact)
    }

    /// The result of an operation whose operands' errors move it by `units`.
    fn result(value: f64, units: f64) -> Self {
        let own = if value.abs() > FLOOR { value.abs() } else { FLOOR };
        Self { value, units: units + own }
    }

    /// Whether it is a number that no rounding has touched.
    fn is(self, value: f64) -> bool {
        self.units == 0.0 && self.value == value
    }

    /// Of zero it is exact.
    pub(crate) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        if root == 0.0 {
            return Self::ZERO;
        }
        Self::result(root, self.units / (2.0 * root))
    }

    /// A power of a number >= 0, rounded as a whole.
    pub(crate) fn power(self, exponent: f64) -> Self {
        let value = self.value.powf(exponent);
        let slope = if self.value > 0.0 { (exponent * value / self.value).abs() } else { 0.0 };
        Self::result(value, slope * self.units)
    }

    pub(crate) fn at_least(self, low: f64) -> Self {
        Self { value: if self.value < low { low } else { self.value }, ..self }
    }

    pub(crate) fn at_most(self, high: f64) -> Self {
        Self { value: if self.value > high { high } else { self.value }, ..self }
    }

    /// The order of two numbers if no rounding can turn it; `unit` is the rounding times a guard.
    pub(crate) fn compare(self, other: Self, unit: f64) -> Option<Ordering> {
        let difference = self.value - other.value;
        let reach = (self.units + other.units) * unit;
        match difference.partial_cmp(&0.0)? {
            Ordering::Equal if reach == 0.0 => Some(Ordering::Equal),
            order => (difference.abs() > reach).then_some(order),
        }
    }

    /// Whether it is greater, if that is certain.
    pub(crate) fn above(self, other: Self, unit: f64) -> Option<bool> {
        self.compare(other, unit).map(Ordering::is_gt)
    }
}

impl Add for Rounded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is(0.0) || other.is(0.0) {
            return if self.is(0.0) { other } else { self };
        }
        Self::result(self.value + other.value, self.units + other.units)
    }
}

impl Sub for Rounded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Rounded {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Mul for Rounded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is(0.0) || other.is(0.0) {
            return Self::ZERO;
        }
        if self.is(1.0) || other.is(1.0) {
            return if self.is(1.0) { other } else { self };
        }
        let units = self.value.abs() * other.units + self.units * other.value.abs();
        Self::result(self.value * other.value, units)
    }
}

impl Div for Rounded {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::result(value, (self.units + value.abs() * other.units) / other.value.abs())
    }
}

pub(crate) fn dot(a: [Rounded; 3], b: [Rounded; 3]) -> Rounded {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn scaled(a: [Rounded; 3], s: Rounded) -> [Rounded; 3] {
    a.map(|v| v * s)
}

pub(crate) fn unit(a: [Rounded; 3]) -> [Rounded; 3] {
    let length = dot(a, a).sqrt();
    a.map(|v| v / length)
}
