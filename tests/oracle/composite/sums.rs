//! Laws of the epsilon-z test and of weighted sums.

use crate::oracle::composite::lawful;
use proptest::prelude::*;
use splatref::composite::{decide, sum};
use splatref::laws;

/// A depth: ordinary, a few ulp from another, huge, tiny.
fn depth() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.01_f32..100.0,
        4 => (-3_i32..=3).prop_map(|ulps| f32::from_bits((3.0_f32.to_bits() as i32 + ulps) as u32)),
        1 => 1e-38_f32..1e-30,
        1 => 1e30_f32..3e38,
    ]
}

fn band() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), Just(f32::INFINITY), 0.0_f32..1e-6, 0.0_f32..10.0, 1e-44_f32..1e-38]
}

/// A weight that the pipeline can make: at least 2^-96 times the kernel at its rim.
fn weight() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 1e-4_f32..1.0, 1 => 1e-30_f32..1e-20]
}

proptest! {
    #[test]
    fn the_epsilon_test_is_an_interval_that_grows(t in depth(), nearest in depth(), a in band(), b in band()) {
        let visible = |t: f32, nearest, epsilon| decide::visible(t, decide::limit(nearest, epsilon));
        lawful(laws::epsilon::case(&visible, t, nearest, [a, b]))?;
        lawful(laws::epsilon::limit(&visible, t, nearest, a))?;
        lawful(laws::epsilon::infinite(&visible, t, nearest))?;
    }

    #[test]
    fn the_average_of_a_constant_is_the_constant(
        weights in prop::collection::vec(weight(), 1..300),
        value in (0.0_f32..1.0, 1e-3_f32..1e3).prop_map(|(a, b)| [a, b, 1.0]),
    ) {
        lawful(laws::sums::constant(&sum::add, &sum::average, &weights, value))?;
        lawful(laws::sums::bits(&sum::add, &sum::average, &weights, value))?;
        let total = weights.iter().fold(0.0, |total, w| total + w);
        let colors = weights.iter().fold([0.0; 3], |sum, w| sum::add(sum, *w, value));
        let direction = sum::direction(colors.map(|c| c + total), total);
        let length = direction.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
        prop_assert!((length - 1.0).abs() < 4e-7, "length {}", length);
    }

    #[test]
    fn without_weight_there_is_nothing(a: f32, b: f32, c: f32) {
        prop_assert_eq!(sum::average([a, b, c], 0.0).map(f32::to_bits), [0; 3]);
        prop_assert_eq!(sum::direction([a, b, c], 0.0).map(f32::to_bits), [0; 3]);
        // Opposite normals cancel to nothing, not to NaN.
        prop_assert_eq!(sum::direction([0.0, -0.0, 0.0], 1.0).map(f32::to_bits), [0; 3]);
    }
}
