//! Laws of weighted accumulation and normalization \[ZP06, eq. 1\].
//!
//! The operators are `add(sum, weight, value)` and `average(sum, total)`, where `total` is the sum
//! of weights.

use super::inputs::{CASES, Inputs};
use super::{Lawful, law, same, unit};
use crate::number::Exact;

/// Tries the laws of [`constant`] and [`nothing`] at up to 300 weights, some of them tiny.
///
/// # Errors
/// The first counterexample.
pub fn sums<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
) -> Lawful {
    let mut inputs = Inputs::new(2);
    for i in 0..CASES {
        let most = if i % 16 == 0 { 300 } else { 8 };
        let weights: Vec<R> = (0..=inputs.below(most)).map(|_| inputs.weight()).collect();
        let value = [inputs.between(1e-3, 1.0), inputs.between(1.0, 1e3), R::ONE];
        constant(add, average, &weights, value)?;
        nothing(average, value)?;
    }
    nothing(average, [R::INFINITY, -R::INFINITY, R::ZERO])
}

/// The laws of a value that every fragment has, for weights > 0 and values > 0 whose products do
/// not underflow.
///
/// - The average is the value up to the rounding of the sums: (2 n + 2) half ulp for n fragments.
/// - The average of 1 is 1 exactly, because its sum is the sum of the weights.
/// - Weights that are all 1024 times as large give the same bits. (So the operator must not add a
///   small number to the weight to keep a quotient finite.)
///
/// # Errors
/// The first counterexample.
pub fn constant<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
    weights: &[R],
    value: [R; 3],
) -> Lawful {
    let mean = |scale: f32, value: [R; 3]| {
        let (mut sum, mut total) = ([R::ZERO; 3], R::ZERO);
        for weight in weights {
            let weight = *weight * R::from_f32(scale);
            (sum, total) = (add(sum, weight, value), total + weight);
        }
        average(sum, total)
    };
    let inputs = format_args!("the value {value:?} with the weights {weights:?}");
    let found = mean(1.0, value);
    let bound = (2 * weights.len() + 2) as f64 * unit::<R>();
    let near = |i: usize| {
        let (found, value) = (found[i].to_f64(), value[i].to_f64());
        (found - value).abs() <= bound * value + 1e-37
    };
    let holds = near(0) && near(1) && near(2);
    law(
        "the average of a constant is the constant, up to rounding",
        holds,
        &inputs,
        &value,
        &found,
    )?;
    let (ones, one) = ([R::ONE; 3], mean(1.0, [R::ONE; 3]));
    law("the average of 1 is 1, exactly", same(one, ones), &inputs, &ones, &one)?;
    let scaled = mean(1024.0, value);
    let what = "weights 1024 times as large change no bit of the average";
    law(what, same(scaled, found), &inputs, &found, &scaled)
}

/// Where no weight has arrived, the average is +0, whatever the sum holds. A sum of -0, after an
/// underflow, averages to +0.
///
/// # Errors
/// The first counterexample.
pub fn nothing<R: Exact>(average: &impl Fn([R; 3], R) -> [R; 3], sum: [R; 3]) -> Lawful {
    let zeros = [R::ZERO; 3];
    let is = |what, sum: [R; 3], weight: R| {
        let found = average(sum, weight);
        let inputs = format_args!("the sum {sum:?} with the weight {weight:?}");
        law(what, same(found, zeros), &inputs, &zeros, &found)
    };
    is("without weight the average is 0", sum, R::ZERO)?;
    is("the average of -0 is +0", [-R::ZERO; 3], R::ONE)
}
