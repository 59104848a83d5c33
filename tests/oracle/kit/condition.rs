//! A number of the oracle, and how much the rounding of the inputs changes it.
//!
//! A condition is no bound of an error, as [`crate::oracle::kit::number`] has one: it is a unit, of the
//! first order, in which the errors of the crate are measured. The oracle that bears conditions
//! computes in another order than the crate, and finds most of them by moving every input by a
//! step; a bound of its roundings would say nothing of those of the crate.

use std::ops::{Add, Div, Mul, Sub};

/// A value and its condition: the sum of its changes when each input is rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditioned {
    pub(crate) value: f64,
    pub(crate) condition: f64,
}

impl Conditioned {
    pub(crate) const ZERO: Self = Self::exact(0.0);

    pub(crate) const fn exact(value: f64) -> Self {
        Self { value, condition: 0.0 }
    }
}

impl Add for Conditioned {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let condition = self.condition + other.condition;
        Self { value: self.value + other.value, condition }
    }
}

impl Sub for Conditioned {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let condition = self.condition + other.condition;
        Self { value: self.value - other.value, condition }
    }
}

impl Mul for Conditioned {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let condition = self.value.abs() * other.condition + self.condition * other.value.abs();
        Self { value: self.value * other.value, condition }
    }
}

impl Div for Conditioned {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let condition = (self.condition + value.abs() * other.condition) / other.value.abs();
        Self { value, condition }
    }
}
