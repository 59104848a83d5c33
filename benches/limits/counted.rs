//! A number that counts what is computed with it: an `f64` whose operators add to global counters.

use splatref::number::elementary;
use splatref::number::{Exact, Real};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// How often each kind of operation was done.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Operations {
    /// Additions, subtractions, multiplications, comparisons, choices, floors.
    pub(crate) short: f64,
    /// Divisions and square roots.
    pub(crate) long: f64,
    /// exp and pow.
    pub(crate) exp: f64,
}

impl Operations {
    /// This, less what another did.
    pub(crate) fn without(self, other: Self) -> Self {
        // Work that a stage does not repeat would leave less than nothing.
        let less = |a: f64, b: f64| if a > b { a - b } else { 0.0 };
        Self {
            short: less(self.short, other.short),
            long: less(self.long, other.long),
            exp: less(self.exp, other.exp),
        }
    }

    /// Both.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            short: self.short + other.short,
            long: self.long + other.long,
            exp: self.exp + other.exp,
        }
    }

    /// So many times this.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { short: self.short * factor, long: self.long * factor, exp: self.exp * factor }
    }
}

static COUNTS: [AtomicU64; 3] = [const { AtomicU64::new(0) }; 3];

/// What some work did, and its result.
pub(crate) fn counted<T>(work: impl FnOnce() -> T) -> (T, Operations) {
    COUNTS.iter().for_each(|count| count.store(0, Relaxed));
    let result = work();
    let [short, long, exp] = [0, 1, 2].map(|i| COUNTS[i].load(Relaxed) as f64);
    (result, Operations { short, long, exp })
}

/// Counts one operation of a kind, and passes its result on.
fn one<T>(kind: usize, result: T) -> T {
    COUNTS[kind].fetch_add(1, Relaxed);
    result
}

const SHORT: usize = 0;
const LONG: usize = 1;
const EXP: usize = 2;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted(f64);

/// Operators of two numbers.
macro_rules! operators {
    ($($operator:ident $function:ident $kind:ident,)*) => {$(
        impl $operator for Counted {
            type Output = Self;
            fn $function(self, other: Self) -> Self {
                one($kind, Self(self.0.$function(other.0)))
            }
        }
    )*};
}
operators! { Add add SHORT, Sub sub SHORT, Mul mul SHORT, Div div LONG, }

// A sign costs nothing: compilers fold it into the operation that follows.
impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        one(SHORT, self.0 == other.0)
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        one(SHORT, self.0.partial_cmp(&other.0))
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
        Real::to_f32(self.0)
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn to_pixel(self) -> u32 {
        one(SHORT, self.0.to_pixel())
    }
    fn floor(self) -> Self {
        one(SHORT, Self(Real::floor(self.0)))
    }
    fn sqrt(self) -> Self {
        one(LONG, Self(Real::sqrt(self.0)))
    }
    fn abs(self) -> Self {
        Self(Real::abs(self.0))
    }
    fn exp(self) -> Self {
        one(EXP, Self(elementary::exp(self.0)))
    }
    fn pow(self, exponent: Self) -> Self {
        one(EXP, Self(elementary::pow(self.0, exponent.0)))
    }
    fn is_finite(self) -> bool {
        one(SHORT, self.0.is_finite())
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
        one(SHORT, if truth { yes } else { no })
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
        one(SHORT, self.0.to_i64())
    }
    fn atan2(self, x: Self) -> Self {
        one(EXP, Self(elementary::atan2(self.0, x.0)))
    }
    fn ulps_to(self, other: Self) -> f32 {
        self.0.ulps_to(other.0)
    }
}
