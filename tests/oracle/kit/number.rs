//! Running error analysis: a number in f64, and how far an arithmetic of fewer digits may be from
//! it.
//!
//! Every operation adds its own rounding, in the arithmetic under test and in f64, to what it
//! passes on, unless it is exact. The bound is rigorous, so that a tolerance is a share of it and
//! at most 1, and a comparison has three answers: yes, no, and `None` where rounding may decide.
//!
//! With [`BITS`] digits nothing is bounded: every operation rounds to `f32` (once, since f64 has
//! more than twice its digits), every comparison has an answer, and what comes out is what the
//! documentation says to the last bit.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The arithmetic that is `f32` itself.
pub(crate) const BITS: u32 = 32;

/// A number of a binary arithmetic of `P` digits: 24 or 53, or [`BITS`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Num<const P: u32> {
    pub(crate) v: f64,
    pub(crate) e: f64,
}

pub(crate) type N3<const P: u32> = [Num<P>; 3];

impl<const P: u32> Num<P> {
    pub(crate) const ZERO: Self = Self::exact(0.0);

    pub(crate) const fn exact(v: f64) -> Self {
        Self { v, e: 0.0 }
    }

    /// Half a unit of the last place of 1.
    pub(crate) fn unit() -> f64 {
        f64::from(P).exp2().recip()
    }

    /// The largest number, and half the least one that is not 0.
    fn range() -> (f64, f64) {
        if P <= BITS { (f32::MAX.into(), (-150.0_f64).exp2()) } else { (f64::MAX, 0.0) }
    }

    /// Whether the arithmetic has this number.
    fn has(v: f64) -> bool {
        P != 24 || f64::from(v as f32) == v
    }

    /// The result of an operation whose operands' errors pass on as `passed`; `exact`: f64 did not
    /// round.
    fn rounded(v: f64, passed: f64, exact: bool) -> Self {
        if P == BITS {
            return Self::exact(f64::from(v as f32));
        }
        let (most, least) = Self::range();
        if v.is_nan() || v.abs() - passed > most {
            return Self::exact(if v.is_nan() { v } else { v.signum() * f64::INFINITY });
        }
        if passed == 0.0 && exact && Self::has(v) {
            return Self::exact(v);
        }
        let own = (v.abs() + passed) * (Self::unit() + (-53.0_f64).exp2()) + least;
        let e = passed * (1.0 + (-40.0_f64).exp2()) + own;
        Self { v, e: if e.is_nan() || v.abs() + e > most { f64::INFINITY } else { e } }
    }

    /// An integer, rounded to the arithmetic.
    pub(crate) fn integer(i: i128) -> Self {
        let v = if P == BITS { f64::from(i as f32) } else { i as f64 };
        Self::rounded(v, 0.0, v as i128 == i)
    }

    /// A number that is known but for an error.
    pub(crate) fn near(v: f64, e: f64) -> Self {
        Self { v, e }
    }

    pub(crate) fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        let low = (self.v - self.e).max(0.0).sqrt();
        let passed = if self.e == 0.0 { 0.0 } else { self.e / (v + low).max(self.e.sqrt()) };
        Self::rounded(v, passed, v.mul_add(v, -self.v) == 0.0)
    }

    /// e to this power; std's own error is below a unit of f64.
    pub(crate) fn exp(self) -> Self {
        let v = self.v.exp();
        Self::rounded(v, v * (self.e.exp_m1() + (-52.0_f64).exp2()), false)
    }

    /// This number > 0 to a power that is not negative.
    pub(crate) fn pow(self, exponent: f64) -> Self {
        let (low, high) = ((self.v - self.e).max(0.0), self.v + self.e);
        let v = self.v.powf(exponent);
        let passed = (high.powf(exponent) - v).max(v - low.powf(exponent));
        Self::rounded(v, passed + v * (-50.0_f64).exp2(), false)
    }

    pub(crate) fn abs(self) -> Self {
        Self { v: self.v.abs(), ..self }
    }

    /// Not less than an exact number.
    pub(crate) fn at_least(self, low: f64) -> Self {
        Self { v: self.v.max(low), ..self }
    }

    /// Not more than an exact number.
    pub(crate) fn at_most(self, high: f64) -> Self {
        if self.v - self.e > high {
            Self::exact(high)
        } else {
            Self { v: self.v.min(high), ..self }
        }
    }

    /// self < other.
    pub(crate) fn less(self, other: Self) -> Option<bool> {
        let gap = other.v - self.v;
        self.decide(other, gap, gap > 0.0)
    }

    /// self <= other.
    pub(crate) fn at_most_as(self, other: Self) -> Option<bool> {
        let gap = other.v - self.v;
        self.decide(other, gap, gap >= 0.0 || self.v == other.v)
    }

    fn decide(self, other: Self, gap: f64, answer: bool) -> Option<bool> {
        if self.v.is_nan() || other.v.is_nan() {
            return Some(false);
        }
        let e = self.e + other.e;
        (e == 0.0 || gap.abs() > e * (1.0 + (-40.0_f64).exp2())).then_some(answer)
    }

    /// How far a number that was found is from this one, in units of the error.
    pub(crate) fn deviation(self, found: f64) -> f64 {
        let error = (found - self.v).abs();
        if found == self.v { 0.0 } else { error / self.e }
    }
}

/// Whether a + b = s in f64 exactly, by the two sums of Knuth.
fn sum_is_exact(a: f64, b: f64, s: f64) -> bool {
    let part = s - a;
    (a - (s - part)) + (b - part) == 0.0
}

impl<const P: u32> Add for Num<P> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let v = self.v + b.v;
        Self::rounded(v, self.e + b.e, sum_is_exact(self.v, b.v, v))
    }
}

impl<const P: u32> Neg for Num<P> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { v: -self.v, ..self }
    }
}

impl<const P: u32> Sub for Num<P> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl<const P: u32> Mul for Num<P> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let v = self.v * b.v;
        let part = |x: f64, e: f64| if e == 0.0 { 0.0 } else { x.abs() * e };
        let passed = part(self.v, b.e) + part(b.v, self.e) + part(self.e, b.e);
        // Below this the residual itself may round.
        let safe = v == 0.0 || v.abs() > 1e-280;
        Self::rounded(v, passed, safe && self.v.mul_add(b.v, -v) == 0.0)
    }
}

impl<const P: u32> Div for Num<P> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let v = self.v / b.v;
        let room = b.v.abs() - b.e;
        let passed = if self.e == 0.0 && b.e == 0.0 {
            0.0
        } else if room > 0.0 {
            (self.e + if b.e == 0.0 { 0.0 } else { v.abs() * b.e }) / room
        } else {
            return Self::near(v, f64::INFINITY);
        };
        Self::rounded(v, passed, v.mul_add(b.v, -self.v) == 0.0 && self.v.abs() > 1e-280)
    }
}

pub(crate) fn exact<const P: u32>(v: [f64; 3]) -> N3<P> {
    v.map(Num::exact)
}

/// `(x x' + y y') + z z'`.
pub(crate) fn dot<const P: u32>(a: N3<P>, b: N3<P>) -> Num<P> {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

pub(crate) fn negated<const P: u32>(a: N3<P>) -> N3<P> {
    a.map(|v| -v)
}

/// Divided by its length; the null vector if that is 0 or not finite.
pub(crate) fn normalized<const P: u32>(a: N3<P>) -> N3<P> {
    let length = dot(a, a).sqrt();
    if length.v == 0.0 || !length.v.is_finite() { exact([0.0; 3]) } else { a.map(|v| v / length) }
}

/// A decision of which both outcomes are tried where it is open: all ways to answer.
pub(crate) fn ways<const N: usize>(open: [Option<bool>; N]) -> Vec<[bool; N]> {
    let mut all = vec![[false; N]];
    for (i, answer) in open.into_iter().enumerate() {
        let copies: Vec<_> = if answer.is_none() { all.clone() } else { Vec::new() };
        all.iter_mut().for_each(|way| way[i] = answer.unwrap_or(false));
        all.extend(copies.into_iter().map(|mut way: [bool; N]| {
            way[i] = true;
            way
        }));
    }
    all
}

#[test]
fn numbers_bound_rounding() {
    // Sums of products in f32 against their bound, and what is exact has none.
    let mut dice = crate::oracle::kit::dice::Dice(5);
    let mut worst = 0.0_f64;
    for _ in 0..5000 {
        let mut draw = || dice.within(-3.0, 3.0) / 3.0 + dice.within(-1e-3, 1e-3);
        let (a, b, c, d) = (draw(), draw(), draw(), draw() + 4.0);
        let found = ((a * b + c).abs().sqrt() / d).exp();
        let [x, y, z, w] = [a, b, c, d].map(|v| Num::<24>::exact(v.into()));
        let bound = ((x * y + z).abs().sqrt() / w).exp();
        worst = worst.max(bound.deviation(found.into()));
        assert!(bound.deviation(found.into()) <= 1.0, "{found} for {bound:?}");
    }
    assert!(worst > 0.1, "the bound is far too wide: {worst}");
    let half = Num::<24>::exact(0.5) * Num::exact(3.0) + Num::exact(0.25);
    assert!(half.e == 0.0 && half.v == 1.75);
    assert!((Num::<24>::exact(1.0) / Num::exact(3.0)).e > 0.0);
    assert_eq!(Num::<24>::exact(1.0).less(Num::exact(1.0)), Some(false));
    assert_eq!((Num::<24>::exact(1.0) / Num::exact(3.0)).less(Num::near(1.0 / 3.0, 0.0)), None);
    assert_eq!(ways([Some(true), None, Some(false)]), [[true, false, false], [true, true, false]]);
}
