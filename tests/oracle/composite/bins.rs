//! Laws of low-precision and Voronoi-enhanced depth, against exact rational arithmetic.

use crate::oracle::composite::groups::unit;
use crate::oracle::composite::lawful;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use splatref::composite::bins::{DepthBins, MAX_BINS, Range};
use splatref::laws;
use splatref::number::Exact;

/// A number as a multiple of 2^-64, exactly: for multiples of that below 2^32.
fn integer(value: f64) -> i128 {
    let scaled = value * 2.0_f64.powi(64);
    assert!(scaled.abs() < 2.0_f64.powi(96) && scaled.fract() == 0.0, "{value} does not fit");
    scaled as i128
}

/// A range in exact arithmetic: (t - low) n / extent.
#[derive(Clone, Copy)]
struct Rational {
    low: i128,
    extent: i128,
    n: i128,
}

impl Rational {
    fn new(range: &Range) -> Self {
        let low = integer(range.nearest.into());
        Self { low, extent: integer(range.farthest.into()) - low, n: range.count.into() }
    }

    /// The bin, brought into the range, if the position is moved by a part of 2^-`bits` of itself.
    fn bin(&self, t: f64, bits: u32, sign: i128) -> f64 {
        let above = integer(t) - self.low;
        // Positions below one bin do not reach the next by rounding, and 2^-bits of a multiple of
        // 2^-64 is no such multiple: rounded outwards by one.
        let moved = above + sign * ((above.abs() >> bits) + 1);
        let position = (moved * self.n).div_euclid(self.extent);
        position.clamp(0, self.n) as f64
    }

    /// By how many 32nds of a bin two depths differ, rounded down.
    fn apart(&self, [near, far]: [f64; 2]) -> i128 {
        ((integer(far) - integer(near)) * self.n * 32).div_euclid(self.extent)
    }
}

/// A range of depth: ordinary, a few ulp wide far away, or from almost nothing.
fn range() -> impl Strategy<Value = Range> {
    let low = prop_oneof![
        2 => 0.01_f32..10.0,
        2 => 900.0_f32..1100.0,
        1 => 500_000.0_f32..1_000_000.0,
        1 => 1e-9_f32..1e-6,
    ];
    let extent = prop_oneof![
        3 => (1_u32..3000).prop_map(Err),
        4 => (1e-6_f32..10.0).prop_map(Ok),
        1 => (10.0_f32..100_000.0).prop_map(Ok),
    ];
    let count = prop_oneof![3 => Just(MAX_BINS), 1 => 1_u32..=MAX_BINS, 1 => 1_u32..20];
    (low, extent, count).prop_map(|(nearest, extent, count)| {
        let farthest = match extent {
            Ok(extent) => nearest + extent,
            Err(ulps) => f32::from_bits(nearest.to_bits() + ulps),
        };
        let next = f32::next_up(nearest);
        Range { nearest, farthest: if farthest > next { farthest } else { next }, count }
    })
}

/// A depth at a part of a range, in the digits of the number.
fn at<R: Exact>(range: &Range, part: f64) -> R {
    let (low, high) = (f64::from(range.nearest), f64::from(range.farthest));
    let t = low + (high - low) * part;
    // A multiple of 2^-64 in f64 as well.
    let t = (t * 2.0_f64.powi(64)).round() * 2.0_f64.powi(-64);
    let coarse = R::from_f32(t as f32);
    if unit::<R>() < 1e-10 { coarse + R::from_f32((t - coarse.to_f64()) as f32) } else { coarse }
}

/// The bin is that of exact arithmetic if the position is off by at most four roundings: of the
/// difference, the extent, the quotient and the product.
fn bin_is_floor<R: Exact>(range: &Range, part: f64) -> TestCaseResult {
    let (bins, exact) = (DepthBins::<R>::new(range), Rational::new(range));
    let t = at::<R>(range, part);
    let bin = bins.bin(t).to_f64();
    let bits = if unit::<R>() < 1e-10 { 51 } else { 22 };
    let (low, high) = (exact.bin(t.to_f64(), bits, -1), exact.bin(t.to_f64(), bits, 1));
    prop_assert!(low <= bin && bin <= high, "{} is not in {}..={} at {:?}", bin, low, high, t);
    prop_assert!(bin >= 0.0 && bin <= f64::from(range.count) && bin.fract() == 0.0);
    Ok(())
}

/// The operators of the crate, which the laws are asked of.
fn bin<R: Exact>(range: &Range, t: R) -> R {
    DepthBins::new(range).bin(t)
}

fn voronoi<R: Exact>(range: &Range, t: R, ratio: R) -> R {
    DepthBins::new(range).voronoi(t, ratio)
}

/// A depth is at least 0.
fn depth<R: Exact>(range: &Range, part: f64) -> R {
    let t = at::<R>(range, part);
    if t < R::ZERO { R::ZERO } else { t }
}

fn laws_of_a_pair<R: Exact>(range: &Range, parts: [f64; 2], ratios: [f32; 2]) -> TestCaseResult {
    let (depths, ratios) = (parts.map(|part| depth::<R>(range, part)), ratios.map(R::from_f32));
    lawful(laws::bins::pair(&bin, &voronoi, range, depths, ratios))
}

fn laws_of_one<R: Exact>(range: &Range, part: f64, ratios: [f32; 2]) -> TestCaseResult {
    let ratios = ratios.map(R::from_f32);
    let t = depth::<R>(range, part);
    lawful(laws::bins::one(&bin, &voronoi, range, t, ratios))?;
    lawful(laws::bins::clamped(&voronoi, range, t))?;
    lawful(laws::bins::infinite(&voronoi, range, t))
}

/// The law of separation, decided in exact arithmetic: depths in the range that differ by
/// (1 + 2^-5) extent / n are apart, whatever their ratios.
fn apart<R: Exact>(range: &Range, parts: [f64; 2]) -> TestCaseResult {
    let bins = DepthBins::<R>::new(range);
    let [a, b] = parts.map(|part| at::<R>(range, part));
    let (near, far) = if a < b { (a, b) } else { (b, a) };
    let inside = near >= R::from_f32(range.nearest) && far <= R::from_f32(range.farthest);
    if inside && Rational::new(range).apart([near.to_f64(), far.to_f64()]) >= 33 {
        prop_assert!(bins.bin(near) < bins.bin(far), "{:?} {:?} in {:?}", near, far, range);
        let (worst, best) = (bins.voronoi(near, R::ONE), bins.voronoi(far, R::ZERO));
        prop_assert!(worst < best, "{:?} {:?} in {:?}", near, far, range);
    }
    Ok(())
}

/// How finely ratios are told apart, which no other operator need do.
fn own_center_wins<R: Exact>(range: &Range, part: f64, ratios: [f32; 2]) -> TestCaseResult {
    let bins = DepthBins::<R>::new(range);
    let t = at::<R>(range, part);
    let bin = bins.bin(t);
    let (a, b) =
        if ratios[0] < ratios[1] { (ratios[0], ratios[1]) } else { (ratios[1], ratios[0]) };
    let [near, far] = [a, b].map(|ratio| bins.voronoi(t, R::from_f32(ratio)));
    prop_assert_eq!(bins.voronoi(t, R::ZERO), bin);
    prop_assert_eq!(bins.voronoi(t, R::ONE), bin + R::from_f32(255.0 / 256.0), "exact");
    // Below the end, ratios that differ by more than the spacing at the bin are told apart.
    let spacing = 2.0 * unit::<R>() * bin.to_f64().max(1.0);
    let told = f64::from(b) <= 255.0 / 256.0 && f64::from(b) - f64::from(a) > spacing;
    prop_assert!(!told || near < far, "{} {} at {:?}", a, b, bin);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn a_bin_is_that_of_exact_arithmetic(range in range(), part in -0.5_f64..1.5) {
        bin_is_floor::<f32>(&range, part)?;
        bin_is_floor::<f64>(&range, part)?;
    }

    #[test]
    fn no_rounding_turns_two_layers_around(
        range in range(),
        part in -0.1_f64..1.1,
        step in prop_oneof![0.0_f64..1e-5, 0.0_f64..1.0],
        ratios in [0.0_f32..1.25, 0.0_f32..1.25],
    ) {
        laws_of_a_pair::<f32>(&range, [part, part + step], ratios)?;
        laws_of_a_pair::<f64>(&range, [part, part + step], ratios)?;
    }

    #[test]
    fn a_voronoi_enhanced_depth_lies_in_the_bin_of_its_depth(
        range in range(), part in -0.1_f64..1.1, ratios in [0.0_f32..1.25, 0.0_f32..1.25],
    ) {
        laws_of_one::<f32>(&range, part, ratios)?;
        laws_of_one::<f64>(&range, part, ratios)?;
    }

    #[test]
    fn layers_farther_apart_than_a_bin_are_in_different_bins(
        range in range(), part in 0.0_f64..1.0, bins in prop_oneof![1.0_f64..1.1, 1.0_f64..3.0],
    ) {
        let parts = [part, part + bins / f64::from(range.count)];
        apart::<f32>(&range, parts)?;
        apart::<f64>(&range, parts)?;
    }

    #[test]
    fn in_a_bin_the_fragment_nearest_its_own_center_wins(
        range in range(),
        part in -0.1_f64..1.1,
        ratios in [0.0_f32..1.0, 0.0_f32..1.0],
        close in any::<bool>(),
    ) {
        let second = if close { ratios[0] + ratios[1] / 512.0 } else { ratios[1] };
        own_center_wins::<f32>(&range, part, [ratios[0], second])?;
        own_center_wins::<f64>(&range, part, [ratios[0], second])?;
    }

    #[test]
    fn bins_of_epsilon_are_no_deeper(range in range(), n in 0.1_f32..70_000.0) {
        let Range { nearest, farthest, .. } = range;
        let epsilon = ((f64::from(farthest) - f64::from(nearest)) / f64::from(n)) as f32;
        prop_assume!(epsilon > 1e-9);
        let extent = integer(farthest.into()) - integer(nearest.into());
        let step = integer(epsilon.into());
        let least = (extent + step - 1).div_euclid(step);
        match Range::of_epsilon(nearest, farthest, epsilon) {
            Ok(found) => {
                prop_assert_eq!((found.nearest, found.farthest), (nearest, farthest));
                let count = i128::from(found.count);
                // Difference and quotient round: by a part of 2^-51 the bins may be too deep.
                let rounds = count + 1 == least && (extent - count * step) << 51 <= extent;
                prop_assert!(count == least || rounds, "{} bins, not {}", count, least);
            }
            Err(_) => prop_assert!(least > i128::from(MAX_BINS), "{} bins are refused", least),
        }
    }
}

#[test]
fn the_rim_never_reaches_the_next_bin() {
    let range = Range { nearest: 0.0, farthest: 65_535.0, count: MAX_BINS };
    let (single, double) = (DepthBins::<f32>::new(&range), DepthBins::<f64>::new(&range));
    for bin in 0..=MAX_BINS {
        let t = bin as f32;
        for ratio in [1.0, 2.0, f32::INFINITY, 255.0 / 256.0] {
            assert_eq!(single.voronoi(t, ratio), t + 0.996_093_75, "bin {bin}");
            assert_eq!(double.voronoi(t.into(), ratio.into()), f64::from(bin) + 0.996_093_75);
        }
        let next = single.voronoi(t + 1.0, 0.0);
        assert!(single.voronoi(t, f32::INFINITY) < next || bin == MAX_BINS, "bin {bin}");
    }
    // 256 ratios are told apart even in the last bin.
    let z = |i: u16| single.voronoi(65_535.0, f32::from(i) / 256.0);
    assert!((1..256).all(|i| z(i - 1) < z(i)));
}

#[test]
fn depths_outside_the_range_are_in_its_ends() {
    let range = Range { nearest: 1.0, farthest: 2.0, count: 8 };
    let bins = DepthBins::<f32>::new(&range);
    for (t, bin) in [(0.0, 0.0), (0.999, 0.0), (1.0, 0.0), (2.0, 8.0), (3.0, 8.0), (1e30, 8.0)] {
        assert_eq!(bins.bin(t), bin, "{t}");
    }
    assert_eq!(bins.bin(f32::next_down(2.0)), 7.0, "the farthest depth has the last bin alone");
}

#[test]
fn bins_of_epsilon_have_bounds() {
    let count = |low, high, epsilon| Range::of_epsilon(low, high, epsilon).map(|range| range.count);
    assert_eq!(count(1.0, 2.0, 0.125).expect("few"), 8);
    assert_eq!(count(1.0, 2.0, f32::next_down(0.125)).expect("few"), 9);
    assert_eq!(count(1.0, 2.0, 1.0).expect("one"), 1);
    assert_eq!(count(1.0, 2.0, f32::INFINITY).expect("at least one"), 1);
    assert_eq!(count(0.0, 65_535.0, 1.0).expect("the most"), MAX_BINS);
    for (low, high, epsilon) in [
        (0.0, 65_536.0, 1.0),
        (0.0, f32::next_up(65_535.0), 1.0),
        (1.0, 2.0, 0.0),
        (1.0, 2.0, 1e-6),
    ] {
        let error = count(low, high, epsilon).expect_err("too many").to_string();
        assert!(error.contains("65535") && error.contains(&epsilon.to_string()), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

/// Why the law of separation needs its 2^-5: the widest bin that a search over ranges has found.
#[test]
fn in_f32_a_bin_can_be_wider_than_its_part_of_the_range() {
    let [nearest, farthest, near, far] =
        [0x3e87_b789, 0x3f4f_8766, 0x3f44_e3c8, 0x3f44_e455].map(f32::from_bits);
    let range = Range { nearest, farthest, count: MAX_BINS };
    let bins = DepthBins::<f32>::new(&range);
    assert_eq!((bins.bin(near), bins.bin(far)), (60_543.0, 60_543.0));
    let apart = (f64::from(far) - f64::from(near)) / (f64::from(farthest) - f64::from(nearest));
    let apart = apart * f64::from(MAX_BINS);
    assert!(apart > 1.009 && apart < 1.0 + 1.0 / 32.0, "{apart} bins");
}

/// Ratios that differ by the spacing itself can tie, where both lie half-way between numbers.
#[test]
fn ratios_half_way_between_numbers_tie() {
    let range = Range { nearest: 0.0, farthest: 65_535.0, count: MAX_BINS };
    let z = |ratio: f32| DepthBins::<f32>::new(&range).voronoi(32_768.0, ratio);
    assert_eq!(z(1.5 / 256.0), z(2.5 / 256.0));
    assert!(z(1.5 / 256.0) < z(f32::next_up(2.5 / 256.0)));
}
