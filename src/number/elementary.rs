//! The only home of exp, pow, sin ... in the crate; what it lacks nobody needs yet.
//!
//! std leaves the bits of these functions to the platform, so clippy's `disallowed-methods` rejects
//! them everywhere.
//!
//! - **f64**: the functions of `libm` (pinned), which give the same bits on every target.
//! - **f32**: the definition is *the correctly rounded value*. It is computed in f64 and rounded
//!   once: [`exp_f32`] by the polynomial below, which is checked over every `f32` in its range by an
//!   ignored test against a correctly rounded oracle; the others through `libm`.

/// e^x in f64.
#[must_use]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// The natural logarithm in f64.
#[must_use]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// x^y in f64.
#[must_use]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// The sine of `x` radians in f64.
#[must_use]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// The cosine of `x` radians in f64.
#[must_use]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// The tangent of `x` radians in f64.
#[must_use]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// The angle of the point (x, y) from the x axis, in [-pi, pi] radians in f64; 0 or +-pi, with the
/// sign of y, where y is 0.
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// The polynomial of degree 10 with the least greatest relative error from e^r, 2.1e-16, for
/// |r| <= ln(2)/2: coefficients of 1, r, r^2 ... by the Remez exchange in 40 digits, rounded.
pub const EXP: [f64; 11] = [
    1.0,
    f64::from_bits(0x3FF0_0000_0000_001D),
    f64::from_bits(0x3FDF_FFFF_FFFF_FE17),
    f64::from_bits(0x3FC5_5555_5554_BC09),
    f64::from_bits(0x3FA5_5555_5559_33C3),
    f64::from_bits(0x3F81_1111_12D4_9790),
    f64::from_bits(0x3F56_C16C_0C0A_CB68),
    f64::from_bits(0x3F2A_0197_A4E9_8520),
    f64::from_bits(0x3EFA_01B6_CE39_CA8E),
    f64::from_bits(0x3EC7_2F98_5479_1E7B),
    f64::from_bits(0x3E92_727A_87DC_A817),
];

/// The upper part of ln 2, of 32 significant bits, so that n times it is exact.
pub const LN2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
/// The rest of ln 2.
pub const LN2_LOW: f64 = f64::from_bits(0x3DEA_39EF_3579_3C76);
/// 1.5 * 2^52: adding it rounds to an integer, which the low bits of the sum then hold.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// e^x for `f32`, correctly rounded; branch-free, so that a loop over it vectorizes.
///
/// In f64: n = x log2(e) rounded to an integer, ties to even (by adding and subtracting 1.5 2^52);
/// r = (x - n [`LN2_HIGH`]) - n [`LN2_LOW`];
/// the polynomial [`EXP`] in r, by Estrin's scheme as written (a third of the latency of
/// Horner's rule); times 2^n; rounded to `f32` once. Below -104 the result is 0, above 89 +inf; NaN
/// stays NaN.
#[inline(always)]
#[must_use]
pub fn exp_f32(x: f32) -> f32 {
    let x = if x < -104.0 { -104.0 } else { x };
    let x = if x > 89.0 { 89.0 } else { x };
    exp_f32_in_range(x)
}

/// [`exp_f32`] for x in [-104, 89]; any number for another x.
#[inline(always)]
#[must_use]
pub fn exp_f32_in_range(x: f32) -> f32 {
    let x = f64::from(x);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    let c = &EXP;
    let (r2, r4) = (r * r, (r * r) * (r * r));
    let low = ((c[0] + c[1] * r) + (c[2] + c[3] * r) * r2)
        + ((c[4] + c[5] * r) + (c[6] + c[7] * r) * r2) * r4;
    let high = (c[8] + c[9] * r) + c[10] * r2;
    let sum = low + high * (r4 * r4);
    // The low 12 bits of `shifted` hold n in two's complement: n + 1023 is the exponent of 2^n.
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    (sum * power) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every `step`-th float of [-110, 100], and how many of them are not correctly rounded.
    fn misrounded(step: usize) -> usize {
        let negative = (0_u32..=110.0_f32.to_bits()).step_by(step).map(|b| -f32::from_bits(b));
        let positive = (0_u32..=100.0_f32.to_bits()).step_by(step).map(f32::from_bits);
        negative.chain(positive).filter(|&x| exp_f32(x) != core_math::expf(x)).count()
    }

    #[test]
    fn exp_is_correctly_rounded_on_a_sample() {
        assert_eq!(misrounded(997), 0);
    }

    #[test]
    #[ignore = "two billion floats, about a minute: run by .ci/run"]
    fn exp_is_correctly_rounded_everywhere() {
        assert_eq!(misrounded(1), 0);
    }

    #[test]
    fn exp_ends_where_f32_ends() {
        assert_eq!(exp_f32(-104.5), 0.0);
        assert_eq!(exp_f32(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp_f32(89.5), f32::INFINITY);
        assert_eq!(exp_f32(f32::INFINITY), f32::INFINITY);
        assert!(exp_f32(f32::NAN).is_nan());
        assert_eq!(exp_f32(0.0), 1.0);
    }
}
