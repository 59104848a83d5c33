//! A number that rounds by a habit: formulas are written once.

use super::habit::Habit;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An f32, and how it is computed with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number {
    pub(crate) value: f32,
    /// The factors, if it is a product: what a compiler that fuses looks back at.
    factors: Option<[f32; 2]>,
    habit: Habit,
}

impl Number {
    /// The number as memory gives it back: nobody knows any longer that it was a product.
    pub(crate) fn stored(self) -> Self {
        Self { factors: None, ..self }
    }
}

impl Habit {
    /// A given value.
    pub(crate) fn number(self, value: f32) -> Number {
        Number { value: self.flushed(value), factors: None, habit: self }
    }

    fn flushed(self, value: f32) -> f32 {
        if self == Self::FlushDenormals && value.is_subnormal() { 0.0 } else { value }
    }

    /// A result that is `nearest`, and off from the exact one by something of the sign of `error`.
    fn rounded(self, nearest: f32, error: f64) -> Number {
        let inexact = nearest.is_finite() && error != 0.0;
        let other = match self {
            Self::EitherNeighbor => scrambled(bits(nearest) ^ error.to_bits()) % 2 == 1,
            Self::TowardsZero => (error > 0.0) != (nearest > 0.0),
            _ => false,
        };
        let up = if error > 0.0 { nearest.next_up() } else { nearest.next_down() };
        self.number(if inexact && other { up } else { nearest })
    }

    /// A value some units in the last place off, up to `most`.
    fn coarse(self, value: f32, most: u64) -> Number {
        if self != Self::Coarse || !value.is_normal() {
            return self.number(value);
        }
        let steps = scrambled(bits(value)) % (2 * most + 1);
        let off = (0..steps / 2).fold(value, |value, _| {
            if steps.is_multiple_of(2) { value.next_up() } else { value.next_down() }
        });
        self.number(off)
    }
}

fn bits(value: f32) -> u64 {
    u64::from(value.to_bits())
}

/// A hash of 64 bits (the finalizer of `SplitMix64`).
pub(crate) fn scrambled(key: u64) -> u64 {
    let z = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[expect(clippy::disallowed_methods, reason = "a client may fuse; std's is correctly rounded")]
fn fused([a, b]: [f32; 2], c: f32) -> f32 {
    a.mul_add(b, c)
}

impl Add for Number {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        if self.habit == Habit::Fused {
            match (self.factors, other.factors) {
                (Some(factors), _) => return self.habit.number(fused(factors, b)),
                (None, Some(factors)) => return self.habit.number(fused(factors, a)),
                (None, None) => {}
            }
        }
        let sum = a + b;
        let part = sum - a; // Knuth's two-sum: its error is exact
        let error = (a - (sum - part)) + (b - part);
        self.habit.rounded(sum, error.into())
    }
}

impl Sub for Number {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Number {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, factors: self.factors.map(|[a, b]| [-a, b]), ..self }
    }
}

impl Mul for Number {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        let product = a * b;
        let rounded = self.habit.rounded(product, f64::from(a) * f64::from(b) - f64::from(product));
        Self { factors: Some([a, b]), ..rounded }
    }
}

impl Mul<f32> for Number {
    type Output = Self;
    fn mul(self, other: f32) -> Self {
        self * self.habit.number(other)
    }
}

impl Div for Number {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        if self.habit == Habit::Reciprocal {
            return self.habit.number(a * (1.0 / b));
        }
        let quotient = a / b;
        let rest = f64::from(a) - f64::from(quotient) * f64::from(b);
        let rounded = self.habit.rounded(quotient, rest / f64::from(b));
        self.habit.coarse(rounded.value, 2)
    }
}

impl Number {
    pub(crate) fn reciprocal(self) -> Self {
        self.habit.number(1.0) / self
    }

    pub(crate) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        if self.habit == Habit::InverseSqrt && root > 0.0 {
            return self.habit.number(self.value * (1.0 / root));
        }
        let error = f64::from(self.value) - f64::from(root) * f64::from(root);
        self.habit.rounded(root, error)
    }

    pub(crate) fn exp(self) -> Self {
        if self.habit == Habit::Exp2 {
            let power = self.value * std::f32::consts::LOG2_E;
            return self.habit.number(core_math::exp2f(power));
        }
        self.habit.coarse(core_math::expf(self.value), 3)
    }

    /// This number, not negative, to a power.
    pub(crate) fn pow(self, exponent: f32) -> Self {
        let power = match self.habit {
            Habit::Exp2 => core_math::exp2f(exponent * core_math::log2f(self.value)),
            _ => core_math::powf(self.value, exponent),
        };
        self.habit.number(power)
    }

    pub(crate) fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    pub(crate) fn smaller(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    pub(crate) fn larger(self, other: Self) -> Self {
        if other > self { other } else { self }
    }

    pub(crate) fn clamped(self, low: Self, high: Self) -> Self {
        match self.habit {
            Habit::ClampHighFirst => self.smaller(high).larger(low),
            _ => self.larger(low).smaller(high),
        }
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

/// a + b + c.
pub(crate) fn sum(a: Number, b: Number, c: Number) -> Number {
    if a.habit == Habit::Reassociated { a + (b + c) } else { (a + b) + c }
}

/// A vector of three numbers.
pub(crate) type Vector = [Number; 3];

pub(crate) fn dot(a: Vector, b: Vector) -> Number {
    sum(a[0] * b[0], a[1] * b[1], a[2] * b[2])
}

/// A vector divided by its length; the null vector if that is 0 or not finite.
pub(crate) fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    let some = length.value > 0.0 && length.value.is_finite();
    a.map(|a| if some { a / length } else { a.habit.number(0.0) })
}
