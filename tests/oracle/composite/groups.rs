//! Laws of the compositing operator over depth-images, in `f32` and in `f64`.

use crate::oracle::composite::lawful;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use splatref::composite::groups::{WeightedFragment, compose};
use splatref::composite::{decide, sum};
use splatref::laws;
use splatref::number::Exact;

/// Half the spacing of the numbers in [1, 2).
pub(crate) fn unit<R: Exact>() -> f64 {
    let single = R::ONE + R::from_f32(2.0_f32.powi(-30)) == R::ONE;
    if single { 2.0_f64.powi(-24) } else { 2.0_f64.powi(-53) }
}

/// A number of about `coarse` that fills the digits of `f64` as well.
pub(crate) fn filled<R: Exact>((coarse, fine): (f32, f32)) -> R {
    let step = R::from_f32(fine) * R::from_f32(2.0_f32.powi(-26));
    R::from_f32(coarse) * (R::ONE + step)
}

/// The numbers of a sample: depth, weight, normal, colour, opacity.
type Numbers = [(f32, f32); 9];

fn sample<R: Exact>(numbers: &Numbers) -> WeightedFragment<R> {
    if numbers[0].0 == f32::INFINITY {
        return WeightedFragment::EMPTY;
    }
    let [t, w, nx, ny, nz, r, g, b, o] = numbers.map(filled::<R>);
    WeightedFragment::new(t, w, [nx, ny, nz], [r, g, b], o)
}

fn samples<R: Exact>(all: &[Numbers]) -> Vec<WeightedFragment<R>> {
    all.iter().map(sample).collect()
}

fn depth() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => 0.5_f32..4.0,
        3 => (-2_i32..=2).prop_map(|ulps| f32::from_bits((2.0_f32.to_bits() as i32 + ulps) as u32)),
        1 => 1e-30_f32..1e-20,
        1 => 1e20_f32..1e30,
        2 => Just(f32::INFINITY),
    ]
}

fn numbers() -> impl Strategy<Value = Numbers> {
    let fine = || prop::array::uniform9(0.0_f32..1.0);
    let normal = || prop_oneof![3 => -1.0_f32..1.0, 1 => Just(0.0_f32)];
    let color = || prop_oneof![4 => 0.0_f32..1.0, 1 => 1.0_f32..100.0, 1 => Just(0.0_f32)];
    let weight = prop_oneof![4 => 1e-4_f32..1.0, 1 => 1e-20_f32..1e-10];
    let coarse = (depth(), weight, [normal(), normal(), normal()], [color(), color(), color()]);
    // Depths of few digits, so that ties are as frequent in f64 as in f32.
    (coarse, 0.0_f32..1.0, fine(), any::<bool>()).prop_map(|((t, w, n, c), o, fine, tie)| {
        let coarse = [t, w, n[0], n[1], n[2], c[0], c[1], c[2], o];
        let mut all = std::array::from_fn(|i| (coarse[i], fine[i]));
        all[0].1 = if tie { 0.0 } else { all[0].1 };
        all
    })
}

/// Images at a pixel, and an order of them.
fn images() -> impl Strategy<Value = (Vec<Numbers>, Vec<usize>)> {
    prop::collection::vec(numbers(), 1..24).prop_flat_map(|all| {
        let order: Vec<usize> = (0..all.len()).collect();
        (Just(all), Just(order).prop_shuffle())
    })
}

fn band() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), Just(f32::INFINITY), 0.0_f32..1e-6, 0.0_f32..4.0]
}

/// The nine attributes but for the depth.
fn attributes<R: Exact>(s: &WeightedFragment<R>) -> [f64; 8] {
    let ([nx, ny, nz], [r, g, b]) = (s.normal, s.color);
    [s.weight, nx, ny, nz, r, g, b, s.opacity].map(R::to_f64)
}

fn bits<R: Exact>((sums, count): &(WeightedFragment<R>, u32)) -> ([u64; 8], u64, u32) {
    (attributes(sums).map(f64::to_bits), sums.depth.to_f64().to_bits(), *count)
}

/// Those that pass the epsilon-z test, by the definition in words.
fn visible<R: Exact>(all: &[WeightedFragment<R>], epsilon: R) -> Vec<WeightedFragment<R>> {
    let full = || all.iter().filter(|s| s.depth.is_finite());
    let nearest = full().map(|s| s.depth).fold(R::INFINITY, |a, b| if b < a { b } else { a });
    full().filter(|s| s.depth <= nearest + epsilon).copied().collect()
}

fn order_is_rounding<R: Exact>(all: &[Numbers], order: &[usize], band: f32) -> TestCaseResult {
    lawful(laws::groups::order(&compose, &samples::<R>(all), order, R::from_f32(band)))
}

fn empty_is_neutral<R: Exact>(all: &[Numbers], places: &[usize], band: f32) -> TestCaseResult {
    let (mut all, band) = (samples::<R>(all), R::from_f32(band));
    for place in places {
        lawful(laws::groups::empty(&compose, &all, *place, band))?;
        all.insert(place % (all.len() + 1), WeightedFragment::EMPTY);
    }
    Ok(())
}

fn it_is_its_definition<R: Exact>(all: &[Numbers], band: f32) -> TestCaseResult {
    let (all, band) = (samples::<R>(all), R::from_f32(band));
    lawful(laws::groups::definition(&compose, &all, band))?;
    let (sums, count) = compose(&all, band);
    let terms = visible(&all, band);
    prop_assert_eq!(count as usize, terms.len());
    let plain =
        |of: fn(&WeightedFragment<R>) -> R| terms.iter().fold(R::ZERO, |a, s| a + of(s)).to_f64();
    let expected = [
        plain(|s| s.weight),
        plain(|s| s.normal[0]),
        plain(|s| s.normal[1]),
        plain(|s| s.normal[2]),
        plain(|s| s.color[0]),
        plain(|s| s.color[1]),
        plain(|s| s.color[2]),
        plain(|s| s.opacity),
    ];
    prop_assert_eq!(attributes(&sums), expected, "in ascending order from 0, to the bit");
    let full = all.iter().filter(|s| s.depth.is_finite());
    let least = full.clone().all(|s| sums.depth <= s.depth);
    let empty = full.clone().count() == 0;
    prop_assert!(least && (empty || full.clone().any(|s| sums.depth == s.depth)));
    if band == R::INFINITY {
        prop_assert_eq!(count as usize, full.count(), "everything but the empty ones");
    } else if band == R::ZERO {
        prop_assert_eq!(count as usize, full.filter(|s| s.depth == sums.depth).count());
    }
    if empty {
        prop_assert_eq!(bits(&(sums, count)), bits(&(WeightedFragment::<R>::EMPTY, 0)));
    }
    Ok(())
}

fn greater_keeps_more<R: Exact>(all: &[Numbers], [a, b]: [f32; 2]) -> TestCaseResult {
    let all = samples::<R>(all);
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    let (less, more) = (compose(&all, R::from_f32(small)), compose(&all, R::from_f32(large)));
    prop_assert!(less.1 <= more.1 && less.0.weight <= more.0.weight);
    prop_assert_eq!(less.0.depth, more.0.depth, "the nearest does not depend on epsilon");
    let kept = visible(&all, R::from_f32(large));
    prop_assert!(visible(&all, R::from_f32(small)).iter().all(|s| kept.contains(s)));
    Ok(())
}

fn an_image_of_its_own<R: Exact>(all: &[Numbers], place: usize, band: f32) -> TestCaseResult {
    let all = samples::<R>(all);
    lawful(laws::groups::apart(&compose, &all, place % all.len(), R::from_f32(band)))
}

/// Values that are one constant average to it, whatever is seen.
fn a_constant_stays<R: Exact>(all: &[Numbers], band: f32, color: f32) -> TestCaseResult {
    let mut all = all.to_vec();
    all.iter_mut().for_each(|s| s[5..8].fill((color, 0.5)));
    let (sums, count) = compose(&samples::<R>(&all), R::from_f32(band));
    let value = filled::<R>((color, 0.5)).to_f64();
    // The products round once, the sum of weights and that of products m - 1 times, the quotient
    // once.
    let bound = 2.0 * f64::from(count) * unit::<R>() * value * 1.001;
    for average in sum::average(sums.color, sums.weight).map(R::to_f64) {
        let expected = if count == 0 { 0.0 } else { value };
        prop_assert!((average - expected).abs() <= bound, "{} for {}", average, expected);
    }
    Ok(())
}

proptest! {
    #[test]
    fn composing_is_the_sum_over_the_band((all, _) in images(), e in band()) {
        it_is_its_definition::<f32>(&all, e)?;
        it_is_its_definition::<f64>(&all, e)?;
    }

    #[test]
    fn permuting_images_changes_the_order_of_the_sums_alone((all, order) in images(), e in band()) {
        order_is_rounding::<f32>(&all, &order, e)?;
        order_is_rounding::<f64>(&all, &order, e)?;
    }

    #[test]
    fn an_empty_image_is_neutral(
        (all, _) in images(),
        places in prop::collection::vec(any::<usize>(), 1..5),
        e in band(),
    ) {
        empty_is_neutral::<f32>(&all, &places, e)?;
        empty_is_neutral::<f64>(&all, &places, e)?;
    }

    #[test]
    fn a_greater_epsilon_keeps_what_a_smaller_kept((all, _) in images(), e in [band(), band()]) {
        greater_keeps_more::<f32>(&all, e)?;
        greater_keeps_more::<f64>(&all, e)?;
    }

    #[test]
    fn a_sample_may_move_to_an_image_of_its_own(
        (all, _) in images(), place in any::<usize>(), e in band(),
    ) {
        an_image_of_its_own::<f32>(&all, place, e)?;
        an_image_of_its_own::<f64>(&all, place, e)?;
    }

    #[test]
    fn a_constant_color_stays((all, _) in images(), e in band(), c in 1e-3_f32..100.0) {
        a_constant_stays::<f32>(&all, e, c)?;
        a_constant_stays::<f64>(&all, e, c)?;
    }
}

/// The documented counterexample: folding over pairs is another function.
#[test]
fn it_is_not_associative() {
    let epsilon = 1.0_f64;
    let at = |t: f64| WeightedFragment::new(t, 1.0, [0.0, 0.0, 1.0], [t; 3], 1.0);
    let depths = [0.0, 0.75, 1.5];
    let (all, count) = compose(&depths.map(at), epsilon);
    assert_eq!((count, all.weight, all.color[0]), (2, 2.0, 0.75), "the first two");
    // The pair of the farther two keeps both, and its nearest depth is in the band of the third.
    let (pair, both) = compose(&[at(0.75), at(1.5)], epsilon);
    assert_eq!((both, pair.depth, pair.weight), (2, 0.75, 2.0));
    let (folded, _) = compose(&[at(0.0), pair], epsilon);
    assert_eq!((folded.weight, folded.color[0]), (3.0, 2.25), "all three");
    // From the other end it happens to be right.
    let (first, _) = compose(&[at(0.0), at(0.75)], epsilon);
    let (folded, _) = compose(&[first, at(1.5)], epsilon);
    assert_eq!((folded.weight, folded.color[0]), (2.0, 0.75));
    assert!(!decide::visible(1.5, decide::limit(0.0, epsilon)));
}
