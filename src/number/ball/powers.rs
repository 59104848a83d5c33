//! Powers of an exponent that is not exact.

use super::{Ball, Profile, SLACK, larger};
use crate::number::Real;

/// x^y, between the powers of both ends of y: a power is monotonic in its exponent.
pub(super) fn between<P: Profile>(base: Ball<P>, exponent: Ball<P>) -> Ball<P> {
    let middle = base.middle.pow(exponent.middle);
    let ends = [exponent.low(), exponent.high()];
    // Comparisons that NaN fails.
    if !(ends[0] >= 0.0 && ends[1].is_finite()) {
        return Ball::unbounded(middle, true);
    }
    let [a, b] = ends.map(|end| {
        let power = base.pow(Ball::exact(end));
        (power.middle - middle).abs() + power.radius
    });
    Ball::new(middle, larger(a, b) * SLACK)
}
