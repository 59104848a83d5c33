//! A third number: f64 that counts its operations. Every formula of the crate runs on it.

use splatref::number::{Exact, Real};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What is counted.
#[derive(Clone, Copy)]
pub(crate) enum Op {
    Add,
    Mul,
    Div,
    Sqrt,
    Exp,
    Pow,
    Compare,
    /// A choice, a floor, a conversion to an integer, a test for finite numbers.
    Other,
}

/// How many kinds there are.
pub(crate) const KINDS: usize = Op::Other as usize + 1;

static COUNTS: [AtomicU64; KINDS] = [const { AtomicU64::new(0) }; KINDS];

#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted(pub(crate) f64);

fn tick<T>(op: Op, result: T) -> T {
    COUNTS[op as usize].fetch_add(1, Relaxed);
    result
}

/// The result of a job, and how many operations of each kind it did, wherever they ran.
pub(crate) fn count<T>(job: impl FnOnce() -> T) -> (T, [u64; KINDS]) {
    COUNTS.iter().for_each(|count| count.store(0, Relaxed));
    let result = job();
    (result, std::array::from_fn(|i| COUNTS[i].load(Relaxed)))
}

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        tick(Op::Compare, self.0 == other.0)
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        tick(Op::Compare, self.0.partial_cmp(&other.0))
    }
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        tick(Op::Add, Self(self.0 + other.0))
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        tick(Op::Add, Self(self.0 - other.0))
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        tick(Op::Mul, Self(self.0 * other.0))
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        tick(Op::Div, Self(self.0 / other.0))
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Counted {
    type Truth = bool;
    type Pixel = u32;

    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const INFINITY: Self = Self(f64::INFINITY);

    fn from_f32(value: f32) -> Self {
        Self(value.into())
    }
    fn from_i64(value: i64) -> Self {
        Self(Real::from_i64(value))
    }
    fn to_f32(self) -> f32 {
        self.0 as f32
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn to_pixel(self) -> u32 {
        tick(Op::Other, Real::to_pixel(self.0))
    }
    fn floor(self) -> Self {
        tick(Op::Other, Self(self.0.floor()))
    }
    fn sqrt(self) -> Self {
        tick(Op::Sqrt, Self(self.0.sqrt()))
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn exp(self) -> Self {
        tick(Op::Exp, Self(Real::exp(self.0)))
    }
    fn pow(self, exponent: Self) -> Self {
        tick(Op::Pow, Self(Real::pow(self.0, exponent.0)))
    }
    fn is_finite(self) -> bool {
        tick(Op::Other, self.0.is_finite())
    }
    fn lt(self, other: Self) -> bool {
        self < other
    }
    fn le(self, other: Self) -> bool {
        self <= other
    }
    fn gt(self, other: Self) -> bool {
        self > other
    }
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    fn select(truth: bool, yes: Self, no: Self) -> Self {
        tick(Op::Other, if truth { yes } else { no })
    }
    fn at_least(self, low: Self) -> Self {
        if self < low { low } else { self }
    }
    fn at_most(self, high: Self) -> Self {
        if self > high { high } else { self }
    }
    fn clamped(self, low: Self, high: Self) -> Self {
        self.at_least(low).at_most(high)
    }
}

impl Exact for Counted {
    fn to_i64(self) -> i64 {
        tick(Op::Other, Exact::to_i64(self.0))
    }
    fn atan2(self, x: Self) -> Self {
        tick(Op::Other, Self(Exact::atan2(self.0, x.0)))
    }
    fn ulps_to(self, other: Self) -> f32 {
        self.0.ulps_to(other.0)
    }
}
