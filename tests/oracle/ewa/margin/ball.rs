//! A midpoint and a radius of the profile Ieee, from the page of `splatref::number::ball` alone.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// 2^-24, half the distance of 1 from the next `f32`.
const UNIT: f64 = 1.0 / (1_u32 << 24) as f64;
/// More than the rounding of a midpoint in f64.
const MIDDLE: f64 = 1.0 + 1.0 / (1_u32 << 20) as f64;
/// More than the rounding of a radius in f64.
const RADIUS: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;
/// 2^-150, half the distance of neighbouring denormal `f32`, and a little more.
const TINY: f64 = 1.000002 * f64::from_bits((1023 - 150) << 52);

#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) middle: f64,
    pub(crate) radius: f64,
}

impl Ball {
    /// What is known: a number of a file, a constant.
    pub(crate) const fn exact(middle: f64) -> Self {
        Self { middle, radius: 0.0 }
    }

    /// The result of an operation that rounds to nearest; `tiny` is 0 for sums and square roots.
    fn rounded(operands: [Self; 2], middle: f64, spread: f64, tiny: f64) -> Self {
        let exact = operands.iter().all(|ball| ball.radius == 0.0);
        if exact && f64::from(middle as f32) == middle {
            return Self::exact(middle);
        }
        let radius = (spread + UNIT * MIDDLE * (middle.abs() + spread) + tiny) * RADIUS;
        // NaN stays NaN.
        let unbounded = middle.abs() + radius > f64::from(f32::MAX);
        Self { middle, radius: if unbounded { f64::INFINITY } else { radius } }
    }

    fn is_zero(self) -> bool {
        self.middle == 0.0 && self.radius == 0.0
    }

    pub(crate) fn low(self) -> f64 {
        self.middle - self.radius
    }

    pub(crate) fn high(self) -> f64 {
        self.middle + self.radius
    }

    /// Whether no value is infinite or NaN.
    pub(crate) fn bounded(self) -> bool {
        self.radius.is_finite()
    }

    pub(crate) fn abs(self) -> Self {
        Self { middle: self.middle.abs(), ..self }
    }

    pub(crate) fn sqrt(self) -> Self {
        let Self { middle: m, radius: r } = self;
        let spread = if m >= r { r / (m.sqrt() + (m - r).sqrt()) } else { f64::NAN };
        Self::rounded([self; 2], m.sqrt(), spread, 0.0)
    }

    /// A monotone bound, taken of the midpoints and of both ends; `bounds` are its other operands.
    ///
    /// "Rounds nothing": an end that the bound leaves alone stays as far away as it was.
    fn bound<const N: usize>(
        self,
        bounds: [Self; N],
        bound: impl Fn(f64, [f64; N]) -> f64,
    ) -> Self {
        let middle = bound(self.middle, bounds.map(|b| b.middle));
        let reach = |end: f64, bounds: [f64; N]| {
            let bounded = bound(end, bounds);
            let same = bounded == end && middle == self.middle;
            if same { self.radius } else { (middle - bounded).abs() }
        };
        let low = reach(self.low(), bounds.map(Self::low));
        let high = reach(self.high(), bounds.map(Self::high));
        Self { middle, radius: low.max(high) }
    }

    pub(crate) fn at_least(self, low: Self) -> Self {
        self.bound([low], |x, [low]| if x < low { low } else { x })
    }

    pub(crate) fn clamped(self, low: Self, high: Self) -> Self {
        self.bound([low, high], |x, [low, high]| {
            let x = if x < low { low } else { x };
            if x > high { high } else { x }
        })
    }

    /// How two numbers compare; none where that is undecided.
    pub(crate) fn compare(self, other: Self) -> Option<Ordering> {
        let radii = self.radius + other.radius;
        let apart = (self.middle - other.middle).abs() > radii * RADIUS;
        (apart || radii == 0.0).then(|| self.middle.partial_cmp(&other.middle))?
    }

    /// The distance of two midpoints in sums of their radii.
    pub(crate) fn distance(self, other: Self) -> f64 {
        let radii = self.radius + other.radius;
        match radii {
            0.0 => f64::INFINITY,
            _ if radii.is_finite() => (self.middle - other.middle).abs() / radii,
            _ => 0.0,
        }
    }
}

impl Add for Ball {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let middle = self.middle + other.middle;
        if other.radius == 0.0 && other.middle.is_infinite() && self.radius.is_finite() {
            return Self::exact(middle);
        }
        Self::rounded([self, other], middle, self.radius + other.radius, 0.0)
    }
}

impl Sub for Ball {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Ball {
    type Output = Self;
    fn neg(self) -> Self {
        Self { middle: -self.middle, ..self }
    }
}

impl Mul for Ball {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (Self { middle: m, radius: r }, Self { middle: n, radius: s }) = (self, other);
        if self.is_zero() && other.bounded() || other.is_zero() && self.bounded() {
            return Self::exact(m * n);
        }
        let spread = (m.abs() * s + n.abs() * r) + r * s;
        Self::rounded([self, other], m * n, spread, TINY)
    }
}

impl Div for Ball {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (Self { middle: m, radius: r }, Self { middle: n, radius: s }) = (self, other);
        // 1 / 0 of exact numbers has the result +inf, an `f32`, exactly.
        let exact = r == 0.0 && s == 0.0;
        if !(n.abs() > s || exact) {
            return Self { middle: m / n, radius: f64::INFINITY };
        }
        if self.is_zero() && n != 0.0 {
            return Self::exact(m / n);
        }
        let spread = (m.abs() * s + n.abs() * r) / (n.abs() * (n.abs() - s));
        Self::rounded([self, other], m / n, spread, TINY)
    }
}
