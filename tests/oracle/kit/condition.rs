//! A number of the oracle, and how much rounding may change it.

use std::ops::{Add, Div, Mul, Sub};

/// A value and its condition: the sum of its changes when each input is rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Num {
    pub(crate) value: f64,
    pub(crate) condition: f64,
}

impl Num {
    pub(crate) const ZERO: Self = Self::exact(0.0);

    pub(crate) const fn exact(value: f64) -> Self {
        Self { value, condition: 0.0 }
    }
}

impl Add for Num {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let condition = self.condition + other.condition;
        Self { value: self.value + other.value, condition }
    }
}

impl Sub for Num {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let condition = self.condition + other.condition;
        Self { value: self.value - other.value, condition }
    }
}

impl Mul for Num {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let condition = self.value.abs() * other.condition + self.condition * other.value.abs();
        Self { value: self.value * other.value, condition }
    }
}

impl Div for Num {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let condition = (self.condition + value.abs() * other.condition) / other.value.abs();
        Self { value, condition }
    }
}
