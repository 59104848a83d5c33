//! exp, ln, pow, sin, cos, tan, atan2 and J0 with the same bits on every machine.
//!
//! This is the only home of such functions in the crate, because std leaves their bits to the
//! platform. Clippy's `disallowed-methods` rejects the functions of std everywhere. A function that
//! no formula needs is not here.
//!
//! - **f64**: the functions of the crate `libm` 0.2.16 (pinned; <https://docs.rs/libm/0.2.16>),
//!   which give the same bits on every target. They are neither the functions of the platform's
//!   libm nor correctly rounded. A second implementation has to call or port this version: `exp`, `log`, `pow`, `sin`, `cos`, `tan`, `atan2` and `j0`, ports of FreeBSD's msun.
//!   Other libraries, newer versions of musl among them, differ in the last digit here and there.
//! - **f32**: the definition is *the correctly rounded value*. It is computed in f64 and rounded
//!   once. [`exp_f32`] uses the polynomial below, which an ignored test checks over every `f32` in
//!   its range against a correctly rounded oracle. The others go through `libm`, or get the bits of
//!   `libm` in another way ([`powers_f32`]).

use super::lanes::{LANES, any, each, mask};

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

/// The bits of [`pow`], rounded to `f32` once, for bases that are not negative (nor -0).
///
/// An approximation in f64 is wrong by a relative error of at most e, see `squares` and
/// `by_logarithm`. [`pow`] is off by less than an ulp. So its value is in the interval of e + 2^-52
/// about the approximation, and if both ends round to one `f32`, so does that value. Where they do
/// not, this function calls [`pow`]: for about one number in 100,000 if y is 2.4, in 2,000 if it is
/// 65,536. A NaN differs from itself, and is left to [`pow`].
#[inline(always)]
#[must_use]
pub fn powers_f32(x: &[f32; LANES], y: f32) -> [f32; LANES] {
    let whole = y.floor() == y && (0.0..=65_536.0).contains(&y);
    let (power, error) = if whole {
        (squares(x, y as u32), (f64::from(y) + 1.0) * f64::EPSILON)
    } else {
        (by_logarithm(x, y.into()), BY_LOGARITHM + f64::EPSILON)
    };
    let mut low = each(|i| (power[i] * (1.0 - error)) as f32);
    let high = each(|i| (power[i] * (1.0 + error)) as f32);
    if any(&mask(|i| low[i] != high[i])) {
        for i in 0..LANES {
            if low[i] != high[i] {
                low[i] = pow_f32(x[i], y);
            }
        }
    }
    low
}

/// Approximates x^y by squares of x and their products. They are rounded fewer than y times, counted
/// with the errors that a square doubles: the error is at most y 2^-53 to first order.
///
/// An underflow of a factor means that x < 1 and that x^y, the product and the value of [`pow`] are
/// all beyond 2^-1000: they round to 0. An overflow likewise means that they round to infinity.
#[inline(always)]
fn squares(x: &[f32; LANES], mut y: u32) -> [f64; LANES] {
    let mut product = [1.0; LANES];
    let mut square: [f64; LANES] = each(|i| x[i].into());
    while y != 0 {
        for i in 0..LANES {
            product[i] = if y & 1 == 1 { product[i] * square[i] } else { product[i] };
            square[i] = square[i] * square[i];
        }
        y >>= 1;
    }
    product
}

/// The greatest relative error of [`by_logarithm`].
const BY_LOGARITHM: f64 = 1.0 / 4_398_046_511_104.0;

/// Approximates x^y = e^(y ln x), with x = 2^k m and m in [sqrt(1/2), sqrt(2)):
///
/// ```text
///   s = (m - 1)/(m + 1)    ln m = 2 s (1 + s^2/3 + s^4/5 + ... + s^20/21)    ln x = k ln 2 + ln m
/// ```
///
/// Numerator and denominator of s are exact, since m has 24 bits, and s^2 < 0.03, so that what is cut
/// off of the series is less than 2^-60 of it. ln x is off by less than 8 roundings, of 2^-53 each,
/// and y ln x by 9. A power that is neither 0 nor infinite in `f32` has |y ln x| <= 104: that makes
/// 936 roundings of the power, to which e^t adds fewer than 8. 2^-42 is more than twice that.
#[inline(always)]
fn by_logarithm(x: &[f32; LANES], y: f64) -> [f64; LANES] {
    /// The bits of sqrt(1/2).
    const HALF_ROOT: u64 = 0x3FE6_A09E_667F_3BCD;
    let mut power = [0.0; LANES];
    for i in 0..LANES {
        let bits = f64::from(x[i]).to_bits();
        let k = (bits.wrapping_sub(HALF_ROOT) as i64 >> 52) as u64;
        let m = f64::from_bits(bits.wrapping_sub(k << 52));
        let k = f64::from_bits(ROUND.to_bits().wrapping_add(k)) - ROUND;
        let s = (m - 1.0) / (m + 1.0);
        let z = s * s;
        let (z2, z4) = (z * z, (z * z) * (z * z));
        let low = (1.0 + z * (1.0 / 3.0)) + z2 * (1.0 / 5.0 + z * (1.0 / 7.0));
        let middle = (1.0 / 9.0 + z * (1.0 / 11.0)) + z2 * (1.0 / 13.0 + z * (1.0 / 15.0));
        let high = (1.0 / 17.0 + z * (1.0 / 19.0)) + z2 * (1.0 / 21.0);
        let series = low + z4 * (middle + z4 * high);
        let ln = k * LN2_HIGH + (k * LN2_LOW + (2.0 * s) * series);
        let t = y * ln;
        let t = if t < -104.0 { -104.0 } else { t };
        let t = if t > 89.0 { 89.0 } else { t };
        // The bits of 0 and of infinity are no product of that form.
        let zero = if y > 0.0 { 0.0 } else { f64::NAN };
        let edge = if x[i] == 0.0 { zero } else { f64::NAN };
        let inside = x[i] > 0.0 && x[i] < f32::INFINITY;
        power[i] = if inside { exp_in_range::<false>(t) } else { edge };
    }
    power
}

/// [`pow`] of `f32`, rounded once.
#[must_use]
pub fn pow_f32(x: f32, y: f32) -> f32 {
    pow(f64::from(x), f64::from(y)) as f32
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

/// The angle of the point (x, y) from the x axis, in [-pi, pi] radians in f64. Where y is 0 the
/// angle is 0 or +-pi, with the sign of y.
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// The Bessel function of the first kind and order 0, J0, in f64.
#[must_use]
pub fn bessel_j0(x: f64) -> f64 {
    libm::j0(x)
}

/// The polynomial of degree 10 whose greatest relative error from e^r is the least, 2.1e-16, for
/// |r| <= ln(2)/2. Coefficients of 1, r, r^2 ..., by the Remez exchange in 40 digits, rounded.
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

/// The upper part of ln 2. It has 32 significant bits, so that n times it is exact.
pub const LN2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
/// The rest of ln 2.
pub const LN2_LOW: f64 = f64::from_bits(0x3DEA_39EF_3579_3C76);
/// 1.5 * 2^52: adding it rounds to an integer, and the low bits of the sum then hold that integer.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// e^x for `f32`, correctly rounded; branch-free, so that a loop over it vectorizes.
///
/// In f64, in this order:
///
/// 1. n = x log2(e) rounded to an integer, ties to even (by adding and subtracting 1.5 2^52);
/// 2. r = (x - n [`LN2_HIGH`]) - n [`LN2_LOW`];
/// 3. the polynomial [`EXP`] in r, by Estrin's scheme as written (a third of the latency of
///    Horner's rule);
/// 4. times 2^n;
/// 5. rounded to `f32` once.
///
/// Below -104 the result is 0, above 89 +inf; NaN stays NaN.
#[inline(always)]
#[must_use]
pub fn exp_f32(x: f32) -> f32 {
    let x = if x < -104.0 { -104.0 } else { x };
    let x = if x > 89.0 { 89.0 } else { x };
    exp_f32_in_range::<false>(x)
}

/// [`exp_f32`] for x in [-104, 89]; any number for another x.
///
/// With `FUSED`, a product that is added to something is not rounded first. That is faster on a
/// machine that does both in one instruction, and far slower on any other. The bits are the same,
/// because both results are correctly rounded: a test checks every `f32`.
#[inline(always)]
#[must_use]
pub fn exp_f32_in_range<const FUSED: bool>(x: f32) -> f32 {
    exp_in_range::<FUSED>(x.into()) as f32
}

/// [`exp_f32_in_range`] before it is rounded to `f32`.
#[expect(clippy::disallowed_methods, reason = "the callers fuse only where the hardware does")]
#[inline(always)]
fn exp_in_range<const FUSED: bool>(x: f64) -> f64 {
    let add = |sum: f64, a: f64, b: f64| if FUSED { a.mul_add(b, sum) } else { sum + a * b };
    let shifted = add(ROUND, x, std::f64::consts::LOG2_E);
    let n = shifted - ROUND;
    let r = add(add(x, -n, LN2_HIGH), -n, LN2_LOW);
    let c = &EXP;
    let (r2, r4) = (r * r, (r * r) * (r * r));
    let low = add(add(c[0], c[1], r), add(c[2], c[3], r), r2);
    let middle = add(add(c[4], c[5], r), add(c[6], c[7], r), r2);
    let high = add(add(c[8], c[9], r), c[10], r2);
    let sum = add(add(low, middle, r4), high, r4 * r4);
    // The low 12 bits of `shifted` hold n in two's complement: n + 1023 is the exponent of 2^n.
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    sum * power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::lanes::vectorized;
    use crate::number::random::unit;
    use crate::number::{Exact, Real};

    vectorized!(
        /// [`exp_f32`] with products that are not rounded.
        fn fused(numbers: &mut [f32]) {
            for x in numbers {
                *x = exp_f32_in_range::<true>(x.at_least(-104.0).at_most(89.0));
            }
        }
    );

    /// How many of every `step`-th float of [-110, 100] are not correctly rounded, with products
    /// rounded or not.
    fn misrounded(step: usize) -> usize {
        let negative = (0_u32..=110.0_f32.to_bits()).step_by(step).map(|b| -f32::from_bits(b));
        let positive = (0_u32..=100.0_f32.to_bits()).step_by(step).map(f32::from_bits);
        let mut numbers = negative.chain(positive);
        let mut misrounded = 0;
        loop {
            let some: Vec<_> = numbers.by_ref().take(4096).collect();
            if some.is_empty() {
                return misrounded;
            }
            let mut fused_some = some.clone();
            fused(&mut fused_some);
            let wrong = some.iter().zip(fused_some).filter(|&(&x, fused)| {
                let right = core_math::expf(x);
                exp_f32(x) != right || fused != right
            });
            misrounded += wrong.count();
        }
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

    /// Bases that a power may meet: all of (0, 1), near 1 on both sides, tiny, and any float at
    /// all.
    fn bases(seed: u64) -> [f32; LANES] {
        std::array::from_fn(|lane| {
            let (i, lane) = (seed * LANES as u64, lane as u64);
            let some = unit(1, i + lane);
            match lane {
                0..8 => some,
                8 => 1.0 - some / 256.0,
                9 => 1.0 - some / 1_048_576.0,
                10 => 1.0 + some / 65_536.0,
                11 => f32::from_bits((some * 255.0) as u32),
                12 => some * some * some * some,
                13 => 1.0 + 1.0 / (1 + seed % 4096) as f32,
                _ => f32::from_bits((unit(2, i + lane) * 2_139_095_040.0) as u32),
            }
        })
    }

    /// Whole numbers, halves, many digits, tiny and large ones, those of sRGB, none, a negative one.
    const EXPONENTS: [f32; 21] = [
        1.0,
        2.0,
        3.0,
        5.0,
        10.0,
        32.0,
        100.0,
        1_000.5,
        64.5,
        0.0,
        65_536.0,
        0.5,
        10.1,
        0.25,
        0.1,
        1.0e-3,
        1.0e-40,
        70_000.0,
        2.4,
        1.0 / 2.4,
        -1.5,
    ];

    #[test]
    fn powers_have_the_bits_of_pow() {
        for y in EXPONENTS {
            for seed in 0..12_000 {
                let x = bases(seed);
                let expected = x.map(|x| pow_f32(x, y).to_bits());
                let found = powers_f32(&x, y).map(f32::to_bits);
                assert_eq!(found, expected, "{x:?} to the power of {y}");
            }
            let edges = [0.0, f32::INFINITY, f32::NAN, 1.0, f32::MAX, f32::MIN_POSITIVE];
            let mut x = [f32::from_bits(1); LANES];
            x[..6].copy_from_slice(&edges);
            let found = powers_f32(&x, y);
            for (x, found) in x.into_iter().zip(found) {
                let expected = pow_f32(x, y);
                let same = found.to_bits() == expected.to_bits();
                assert!(same || found.is_nan() && expected.is_nan(), "{x} to the power of {y}");
            }
        }
    }

    #[test]
    fn a_power_between_two_floats_is_left_to_pow() {
        // (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24 lies halfway between two floats.
        let x = [1.0 + 1.0 / 4096.0; LANES];
        assert_eq!(squares(&x, 2), [1.0 + 1.0 / 2048.0 + 1.0 / 16_777_216.0; LANES]);
        assert_eq!(powers_f32(&x, 2.0), [1.0 + 1.0 / 2048.0; LANES], "ties to even");
    }

    /// The approximation of [`powers_f32`], and its greatest relative error.
    fn approximation(x: &[f32; LANES], y: f32) -> ([f64; LANES], f64) {
        if y.floor() == y && (0.0..=65_536.0).contains(&y) {
            return (squares(x, y as u32), f64::from(y) * 0.5 * f64::EPSILON);
        }
        (by_logarithm(x, y.into()), BY_LOGARITHM)
    }

    #[test]
    fn a_power_that_the_approximation_cannot_tell_is_left_to_pow() {
        // Large exponents multiply the error. All these floats are near 1, so their powers are not
        // 0 or infinite.
        let mut misled = 0;
        for y in (0_u16..40).map(|i| 65_536.0 - 0.25 * f32::from(i * i)) {
            for first in (0.999_f32.to_bits()..1.0005_f32.to_bits()).step_by(LANES) {
                let x = std::array::from_fn(|i| f32::from_bits(first + i as u32));
                let expected = x.map(|x| pow_f32(x, y));
                assert_eq!(powers_f32(&x, y), expected, "{x:?} to the power of {y}");
                let near = approximation(&x, y).0.map(|p| p as f32);
                misled += near.iter().zip(&expected).filter(|(a, b)| a != b).count();
            }
        }
        assert!(misled > 0, "the interval is never needed");
    }

    /// Checks the error bounds of [`powers_f32`] against the correctly rounded power.
    #[test]
    fn powers_and_pow_are_as_close_as_they_claim() {
        for y in EXPONENTS {
            for seed in 0..500 {
                let x = bases(seed);
                let (powers, claimed) = approximation(&x, y);
                for (x, found) in x.into_iter().zip(powers) {
                    let exact = core_math::pow(x.into(), y.into());
                    if (1e-45..=3.4e38).contains(&exact) {
                        // `exact` has lost half an ulp; the difference of close numbers has lost
                        // less.
                        let error = (found / exact - 1.0).abs();
                        assert!(error <= claimed + 2.0 * f64::EPSILON, "{x} ^ {y}: {error}");
                        let ulps = pow(x.into(), y.into()).ulps_to(exact);
                        assert!(ulps <= 1.0, "{x} ^ {y}: {ulps} ulps");
                    } else {
                        let lost = exact < 1e-45 && found < 1e-45;
                        let huge = exact > 3.4e38 && (found > 3.4e38 || found.is_nan());
                        assert!(lost || huge, "{x} ^ {y}: {found}");
                    }
                }
            }
        }
    }
}
