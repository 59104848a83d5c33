//! Convert between stored colours and linear light by the transfer function of sRGB (IEC
//! 61966-2-1).

use super::lanes::{LANES, vectorized};
use super::{Exact, MapInline, Real, elementary};

/// The linear value of a stored value, both in [0, 1].
///
/// `c / 12.92` if `c <= 0.04045`, else `((c + 0.055) / 1.055)^2.4`, in f64.
#[must_use]
pub fn to_linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { elementary::pow((c + 0.055) / 1.055, 2.4) }
}

/// The stored value of a linear value, the inverse of [`to_linear`].
///
/// `12.92 x` if `x <= 0.0031308`, else `1.055 x^(1/2.4) - 0.055`, in f64.
#[must_use]
pub fn from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * elementary::pow(x, 1.0 / 2.4) - 0.055 }
}

/// [`to_linear`] in any number and for any colour, with constants rounded to `f32`: `c / 12.92` if
/// `c <= 0.04045`, else `((c + 0.055) / 1.055)^2.4`.
#[inline]
pub fn decoded<R: Real>(c: R) -> R {
    decoded_by(c, base(c).pow(R::from_f32(2.4)))
}

/// What the power of [`decoded`] is of.
#[inline(always)]
fn base<R: Real>(c: R) -> R {
    (c.at_least(R::ZERO) + R::from_f32(0.055)) / R::from_f32(1.055)
}

/// [`decoded`], if the power is known.
#[inline(always)]
fn decoded_by<R: Real>(c: R, power: R) -> R {
    R::select(c.le(R::from_f32(0.040_45)), c / R::from_f32(12.92), power)
}

vectorized!(
    /// [`decoded`] of every value.
    pub fn decode<R: Exact>(values: &mut [R]) {
        for chunk in values.chunks_mut(LANES) {
            let mut own = [R::ZERO; LANES];
            own[..chunk.len()].copy_from_slice(chunk);
            let powers = R::powers(&own.map_inline(base), R::from_f32(2.4));
            for (value, power) in chunk.iter_mut().zip(powers) {
                *value = decoded_by(*value, power);
            }
        }
    }
);

/// [`from_linear`] in any number and for any colour, with constants rounded to `f32`: `12.92 x` if `x
/// <= 0.0031308`, else `1.055 x^(1/2.4) - 0.055`.
#[inline]
pub fn encoded<R: Real>(x: R) -> R {
    let n = R::from_f32;
    let power = n(1.055) * x.at_least(R::ZERO).pow(n(1.0 / 2.4)) - n(0.055);
    R::select(x.le(n(0.003_130_8)), n(12.92) * x, power)
}

/// The linear value of each code 0 to `max`, rounded to f32 once; code `max` is white, 1.
#[must_use]
pub fn table(max: u16) -> Vec<f32> {
    (0..=max).map(|code| to_linear(f64::from(code) / f64::from(max)) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_agree_in_every_number() {
        for i in -10..=400 {
            let code = f64::from(i) / 255.0;
            // The constants have 24 bits; beyond them the formulas are those of f64.
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            assert!(near(decoded(code), to_linear(code)), "{code}");
            assert!(near(encoded(decoded(code)), code), "{code}");
            let single = code as f32;
            assert!(near(decoded(single).into(), to_linear(code)), "{code}");
            assert!(near(encoded(decoded(single)).into(), code), "{code}");
        }
    }

    #[test]
    fn a_row_has_the_bits_of_its_values() {
        let mut row: Vec<f32> = (-10..=3_000).map(|i| i as f32 / 1_000.0).collect();
        row.extend([0.0, -0.0, f32::INFINITY, 1e-40, 0.040_45]);
        let expected: Vec<u32> = row.iter().map(|&c| decoded(c).to_bits()).collect();
        decode(&mut row);
        assert_eq!(row.iter().map(|c| c.to_bits()).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn the_table_holds_known_values() {
        let table = table(255);
        assert_eq!(table.len(), 256);
        assert_eq!((table[0], table[255]), (0.0, 1.0));
        assert_eq!(table[10], (10.0 / 255.0 / 12.92) as f32, "the last code on the straight part");
        // 188 is the code of half the light: 0.502886 in the tables of the standard.
        assert!((table[188] - 0.502_886_5).abs() < 1e-6, "{}", table[188]);
        assert!(table.is_sorted());
    }
}
