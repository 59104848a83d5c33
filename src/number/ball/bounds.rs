//! Bounds and hulls: computed from the ends of an interval, without rounding.

use super::{Ball, Profile, SLACK, larger};
use crate::number::MapInline;

/// The ball about `middle` that holds an interval; unbounded if an end is infinite.
#[inline(always)]
fn around<P: Profile>(middle: f64, [low, high]: [f64; 2]) -> Ball<P> {
    Ball::new(middle, larger(middle - low, high - middle) * SLACK)
}

/// `x`, or `low` where `x < low`.
#[inline(always)]
pub(super) fn at_least<P: Profile>(x: Ball<P>, low: Ball<P>) -> Ball<P> {
    if x.low() >= low.high() {
        return x;
    }
    if x.high() <= low.low() {
        return low;
    }
    let middle = if x.middle < low.middle { low.middle } else { x.middle };
    around(middle, [larger(x.low(), low.low()), larger(x.high(), low.high())])
}

/// `x`, `low` where `x < low`, or `high` where the result is greater than `high`.
#[inline(always)]
pub(super) fn clamped<P: Profile>(x: Ball<P>, low: Ball<P>, high: Ball<P>) -> Ball<P> {
    if (x.low() >= low.high()) & (x.high() <= high.low()) {
        return x;
    }
    let middle = if x.middle < low.middle { low.middle } else { x.middle };
    let middle = if middle > high.middle { high.middle } else { middle };
    let smaller = |a: f64, b: f64| -larger(-a, -b);
    let ends = [
        smaller(larger(x.low(), low.low()), high.low()),
        smaller(larger(x.high(), low.high()), high.high()),
    ];
    // The ends are the same infinity, so the result is exactly that infinity.
    if ends[0] == ends[1] { Ball::exact(middle) } else { around(middle, ends) }
}

/// The hull of two values, about the one that the midpoints choose.
pub(super) fn hull<P: Profile>(middle: bool, yes: Ball<P>, no: Ball<P>) -> Ball<P> {
    let (chosen, other) = if middle { (yes, no) } else { (no, yes) };
    // About equal midpoints the larger radius holds both, without any slack.
    if chosen.middle.to_bits() == other.middle.to_bits() {
        return Ball::new(chosen.middle, larger(chosen.radius, other.radius));
    }
    let away = (chosen.middle - other.middle).abs() + other.radius;
    Ball::new(chosen.middle, larger(chosen.radius, away * SLACK))
}

impl<P: Profile> Ball<P> {
    /// The hull of this value and another, about this one.
    #[must_use]
    pub(crate) fn either(self, other: Self) -> Self {
        hull(true, self, other)
    }

    /// The hulls of two triples.
    pub(crate) fn either_of(a: [Self; 3], b: [Self; 3]) -> [Self; 3] {
        [0, 1, 2].map_inline(|c| a[c].either(b[c]))
    }
}
