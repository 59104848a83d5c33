//! How the operands' errors spread through exponentials and powers.

use super::{Ball, Profile, SLACK, larger};
use crate::number::MapInline;
use crate::number::Real;

/// More than the relative error of the functions of [`elementary`](crate::number::elementary).
const LOST: f64 = 1.0 / 1_125_899_906_842_624.0;

/// The spread of e^x for numbers up to `reach` from m; `middle` is e^m, and `high` is the greatest
/// x.
#[inline(always)]
pub(super) fn exponential(middle: f64, reach: f64, high: f64) -> f64 {
    // NaN fails this comparison.
    if reach <= 1.0 {
        let more = reach + reach * reach;
        middle * more + middle * (1.0 + more) * LOST
    } else {
        let most = Real::exp(high);
        (most - middle) + most * LOST
    }
}

/// The spread of x^y for numbers up to `reach` from m; `middle` is m^y. `ends` are the least and
/// the greatest x, neither below 0.
///
/// With x = m (1 + e), the bound from above is (1 + e)^y <= `e^(y e)`. The bound from below is
/// Bernoulli's inequality if y >= 1, else the slope of the power at 1 - |e|.
#[inline(always)]
pub(super) fn power(middle: f64, m: f64, reach: f64, ends: [f64; 2], y: f64) -> f64 {
    let part = reach / m;
    let z = y * part;
    // NaN fails these comparisons.
    if (0.0..=0.5).contains(&part) && z <= 1.0 {
        let more = z + z * z;
        middle * (more + 2.0 * z * part) + middle * (1.0 + more) * LOST
    } else {
        let [least, most] = ends.map_inline(|end| end.pow(y));
        larger(middle - least, most - middle) + most * LOST
    }
}

/// x^y, between the powers of both ends of y, because a power is monotonic in its exponent.
pub(super) fn between<P: Profile>(base: Ball<P>, exponent: Ball<P>) -> Ball<P> {
    let middle = base.middle.pow(exponent.middle);
    let ends = [exponent.low(), exponent.high()];
    // NaN fails these comparisons.
    if !(ends[0] >= 0.0 && ends[1].is_finite()) {
        return Ball::unbounded(middle, true);
    }
    let [a, b] = ends.map_inline(|end| {
        let power = base.pow(Ball::exact(end));
        (power.middle - middle).abs() + power.radius
    });
    Ball::new(middle, larger(a, b) * SLACK)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a spread against the ends of the interval. Both differences are off by at most 2^-51
    /// of the largest number; with `close` set, the spread must be tight.
    fn hold(spread: f64, [least, middle, most]: [f64; 3], close: bool) {
        let exact = larger(middle - least, most - middle);
        let error = most / 2_251_799_813_685_248.0;
        assert!(spread >= exact - error, "{spread} of {exact}");
        assert!(!close || spread <= 1.2 * exact + 4.0 * error, "{spread} of {exact}");
    }

    /// The ends about m, and how far the farther end is from m, all without an error.
    fn about(m: f64, reach: f64) -> ([f64; 2], f64) {
        let ends = [m - reach, m + reach];
        (ends, larger(m - ends[0], ends[1] - m))
    }

    #[test]
    fn spreads_hold_both_ends() {
        for i in 0..60 {
            let part = 0.7_f64.pow(f64::from(i));
            for m in [-80.0, -1.5, 0.0, 2.0, 60.0] {
                let (ends, reach) = about(m, part);
                let powers = [ends[0], m, ends[1]].map(Real::exp);
                hold(exponential(powers[1], reach, ends[1]), powers, part < 0.1);
            }
            for y in [0.0, 0.3, 1.0, 2.5, 32.0, 500.0] {
                for m in [1e-4, 0.9, 1.0, 7.0] {
                    let (ends, reach) = about(m, m * part);
                    let powers = [ends[0], m, ends[1]].map(|x: f64| x.pow(y));
                    if powers[2] < 1e30 {
                        let spread = power(powers[1], m, reach, ends, y);
                        hold(spread, powers, part < 0.05 && y * part < 0.05);
                    }
                }
            }
        }
    }
}
