//! `f32` as an implementation may compute it: a coin decides what each operation does.
//!
//! The crate's formulas run in this number as in any other. No formula is written twice, so every
//! future formula is covered too. `tests/lawful.rs` draws whole pictures in it.

use crate::number::random::bits;
use crate::number::{Exact, Real};
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the coin may decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Law {
    /// Whether a product is fused with the sum it goes into.
    Ieee,
    /// The same, and more: division by the reciprocal, roots by inverse roots, e^x by powers of
    /// two, each as far off as published; whether small numbers are flushed.
    Precise,
    /// The same, and more: the order of sums; the neighbour that a result is rounded to.
    Gpu,
}

/// A value, the two factors if it is a product, and the two terms if it is a sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lawful {
    pub(crate) value: f32,
    product: Option<(f32, f32)>,
    sum: Option<(f32, f32)>,
}

thread_local! {
    static COIN: Cell<(Law, u64, u64)> = const { Cell::new((Law::Ieee, 0, 0)) };
}

/// Restarts the coin.
pub(crate) fn begin(law: Law, seed: u64) {
    COIN.with(|coin| coin.set((law, seed, 0)));
}

fn law() -> Law {
    COIN.with(Cell::get).0
}

/// A number below `sides`. Some seeds always give the largest number, so that every operation is as
/// far off as the law allows, to the same side.
fn roll(sides: u64) -> u64 {
    COIN.with(|coin| {
        let (law, seed, index) = coin.get();
        coin.set((law, seed, index + 1));
        if seed % 4 == 3 { sides - 1 } else { (bits(seed, index) >> 32) % sides }
    })
}

fn toss() -> bool {
    roll(2) == 1
}

/// The result of an operation from its value in `f64`. It is off by at most so many ulp, in
/// addition to the rounding to a neighbour.
fn rounded(exact: f64, ulps: u64) -> f32 {
    let nearest = exact as f32;
    // A relative error leaves 0 alone.
    if law() == Law::Ieee || !nearest.is_finite() || exact == 0.0 {
        return nearest;
    }
    let mut value = nearest;
    if toss() && f64::from(nearest) != exact {
        value = if f64::from(nearest) < exact { nearest.next_up() } else { nearest.next_down() };
    }
    for _ in 0..roll(ulps + 1) {
        value = if f64::from(value) < exact { value.next_down() } else { value.next_up() };
    }
    if value.is_subnormal() && toss() { 0.0 } else { value }
}

/// The sum or the product with this value in `f64`.
fn basic(exact: f64) -> f32 {
    match law() {
        Law::Ieee => exact as f32,
        Law::Precise if (exact as f32).is_subnormal() && toss() => 0.0,
        Law::Precise => exact as f32,
        Law::Gpu => rounded(exact, 0),
    }
}

impl From<f32> for Lawful {
    fn from(value: f32) -> Self {
        let flushed = law() != Law::Ieee && value.is_subnormal() && toss();
        Self { value: if flushed { 0.0 } else { value }, product: None, sum: None }
    }
}

/// The sum of two numbers; the first may be a product that is fused.
fn plus(a: Lawful, b: f32) -> Lawful {
    let value = match a.product {
        // A product of two `f32` is exact in `f64`; its sum is rounded there, far below an ulp.
        Some((x, y)) if toss() => basic(f64::from(x) * f64::from(y) + f64::from(b)),
        _ => basic(f64::from(a.value) + f64::from(b)),
    };
    Lawful { value, product: None, sum: Some((a.value, b)) }
}

impl Add for Lawful {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if law() == Law::Gpu && toss() {
            // Adds (a + b) + c as a + (b + c).
            if let Some((a, b)) = self.sum {
                return plus(a.into(), plus(b.into(), other.value).value);
            }
            if let Some((a, b)) = other.sum {
                return plus(plus(self, a), b);
            }
        }
        if other.product.is_some() && toss() {
            plus(other, self.value)
        } else {
            plus(self, other.value)
        }
    }
}

impl Sub for Lawful {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Lawful {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        let value = basic(f64::from(a) * f64::from(b));
        Self { value, product: Some((a, b)), sum: None }
    }
}

impl Div for Lawful {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        if law() != Law::Ieee && toss() && b.is_normal() && (1.0 / b).is_normal() {
            let reciprocal = rounded(1.0 / f64::from(b), 0);
            return rounded(f64::from(a) * f64::from(reciprocal), 0).into();
        }
        rounded(f64::from(a) / f64::from(b), 1).into()
    }
}

impl Neg for Lawful {
    type Output = Self;
    fn neg(self) -> Self {
        let product = self.product.map(|(a, b)| (-a, b));
        Self { value: -self.value, product, sum: self.sum.map(|(a, b)| (-a, -b)) }
    }
}

impl Real for Lawful {
    type Truth = bool;
    type Pixel = u32;

    const ZERO: Self = Self { value: 0.0, product: None, sum: None };
    const ONE: Self = Self { value: 1.0, product: None, sum: None };
    const INFINITY: Self = Self { value: f32::INFINITY, product: None, sum: None };

    fn from_f32(value: f32) -> Self {
        value.into()
    }
    fn from_i64(value: i64) -> Self {
        (value as f32).into()
    }
    fn to_f32(self) -> f32 {
        self.value
    }
    fn to_f64(self) -> f64 {
        self.value.into()
    }
    fn to_pixel(self) -> u32 {
        self.value.to_i64().clamp(0, 1 << 22) as u32
    }
    fn floor(self) -> Self {
        self.value.floor().into()
    }
    fn sqrt(self) -> Self {
        if law() == Law::Ieee || !(self.value > 0.0) {
            return self.value.sqrt().into();
        }
        let inverse = rounded(1.0 / f64::from(self.value).sqrt(), 1);
        rounded(1.0 / f64::from(inverse), 1).into()
    }
    fn abs(self) -> Self {
        self.value.abs().into()
    }
    fn exp(self) -> Self {
        if law() != Law::Ieee && toss() && self.value.abs() < 80.0 {
            let exponent = rounded(f64::from(self.value) * std::f64::consts::LOG2_E, 0);
            let power = Real::exp(f64::from(exponent) * std::f64::consts::LN_2);
            return rounded(power, 2).into();
        }
        Real::exp(self.value).into()
    }
    fn pow(self, exponent: Self) -> Self {
        if law() != Law::Ieee && toss() && self.value.is_normal() {
            let logarithm = rounded(libm::log2(self.value.into()), 2);
            let argument = rounded(f64::from(logarithm) * f64::from(exponent.value), 0);
            return rounded(Real::exp(f64::from(argument) * std::f64::consts::LN_2), 2).into();
        }
        Real::pow(self.value, exponent.value).into()
    }
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    fn gt(self, other: Self) -> bool {
        self.value > other.value
    }
    fn ge(self, other: Self) -> bool {
        self.value >= other.value
    }
    fn select(truth: bool, yes: Self, no: Self) -> Self {
        if truth { yes } else { no }
    }
    fn at_least(self, low: Self) -> Self {
        if self.lt(low) { low } else { self }
    }
    fn at_most(self, high: Self) -> Self {
        if self.gt(high) { high } else { self }
    }
    fn clamped(self, low: Self, high: Self) -> Self {
        self.at_least(low).at_most(high)
    }
}

impl PartialEq for Lawful {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialOrd for Lawful {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl Exact for Lawful {
    fn to_i64(self) -> i64 {
        self.value.to_i64()
    }
    fn atan2(self, x: Self) -> Self {
        let exact = libm::atan2(self.value.into(), x.value.into());
        rounded(exact, if roll(8) == 7 { 4095 } else { 2 }).into()
    }
    fn ulps_to(self, other: Self) -> f32 {
        self.value.ulps_to(other.value)
    }
}
