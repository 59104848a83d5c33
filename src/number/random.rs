//! Random values as functions of a seed and an index.
//!
//! There is no state: value `i` of a stream is computed from `(seed, i)` alone. So it does not
//! depend on which caller asks first, and you can enter a stream anywhere. The definition is
//! stable.
//!
//! [`bits`] is output number `i` of `SplitMix64` (Steele, Lea, Flood: *Fast Splittable Pseudorandom
//! Number Generators*, OOPSLA 2014) started with `seed`; all arithmetic is modulo 2^64:
//!
//! ```text
//!   z = seed + (i + 1) * 0x9E3779B97F4A7C15
//!   z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9
//!   z = (z ^ (z >> 27)) * 0x94D049BB133111EB
//!   z ^ (z >> 31)
//! ```

/// 2^64 divided by the golden ratio, rounded to an odd number.
pub const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// 64 random bits: value `index` of the stream `seed`.
#[inline]
#[must_use]
pub fn bits(seed: u64, index: u64) -> u64 {
    let z = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(GOLDEN));
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A random number in [0, 1): the upper 24 of the [`bits`] times 2^-24, exactly.
#[inline]
#[must_use]
pub fn unit(seed: u64, index: u64) -> f32 {
    (bits(seed, index) >> 40) as f32 * (1.0 / 16_777_216.0)
}

/// A random number below `count`: floor([`bits`] count / 2^64), 0 if `count` is 0.
#[inline]
#[must_use]
pub fn below(seed: u64, index: u64, count: u64) -> u64 {
    let product = u128::from(bits(seed, index)) * u128::from(count);
    // The shifted product is less than 2^64.
    (product >> 64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_streams_are_those_of_splitmix64() {
        // The outputs of Vigna's splitmix64.c (https://prng.di.unimi.it/splitmix64.c): published
        // there for seed 0 and, at https://rosettacode.org/wiki/Pseudo-random_numbers/Splitmix64,
        // for seed 1234567.
        let zero = [0xE220_A839_7B1D_CDAF, 0x6E78_9E6A_A1B9_65F4, 0x06C4_5D18_8009_454F];
        assert_eq!([0, 1, 2].map(|i| bits(0, i)), zero);
        let rosetta = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([0, 1, 2, 3, 4].map(|i| bits(1_234_567, i)), rosetta);
    }

    #[test]
    fn a_unit_is_the_upper_24_bits() {
        assert_eq!(f64::from(unit(0, 0)), f64::from(0xE2_20A8) / 16_777_216.0);
        assert!((0..10_000).all(|i| (0.0..1.0).contains(&unit(7, i))));
    }
}
