//! Laws of weighted accumulation and normalization \[ZP06, eq. 1\].
//!
//! The operators are `add(sum, weight, value)` and `average(sum, total)`, where `total` is the sum
//! of weights.

use super::search::search;
use super::{Kind, Law, Lawful, law, same, unit};
use crate::number::Exact;

/// Tries the laws of [`constant`], [`bits`], [`nothing`] and [`odd`] at up to 300 weights, some of
/// them tiny.
///
/// # Errors
/// The first counterexample.
pub fn sums<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
) -> Lawful {
    of_kinds(&Kind::ALL, add, average)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
) -> Lawful {
    search(2, kinds, &|inputs, asked| {
        let most = if inputs.below(16) == 15 { 300 } else { 8 };
        let weights: Vec<R> = (0..=inputs.below(most)).map(|_| inputs.weight()).collect();
        let small = R::ONE - inputs.between(0.0, 0.999);
        let value = [small, inputs.between(1.0, 1000.0), R::ONE];
        asked.check(Kind::Algebraic, || constant(add, average, &weights, value))?;
        asked.check(Kind::Exact, || bits(add, average, &weights, value))?;
        asked.check(Kind::Exact, || nothing(average, value))?;
        asked.check(Kind::Odd, || odd(average))
    })
}

const CONSTANT: Law = Law::algebraic(
    "the average of a constant is the constant, up to rounding",
    "a surface of one colour has that colour, however many surfels cover a pixel",
);
const ONE: Law =
    Law::exact("the average of 1 is 1, exactly", "white stays white, and an opaque surface opaque");
const SCALED: Law = Law::exact(
    "weights 1024 times as large change no bit of the average",
    "the rim of a splat, whose weights are small, is as bright as its centre",
);
const NOTHING: Law =
    Law::exact("without weight the average is 0", "empty pixels, which hold exact zeros");
const INFINITE: Law = Law::odd(
    "without weight an infinite sum averages to 0",
    "empty pixels of a target that held other numbers before",
);
const NEGATIVE: Law = Law::odd(
    "the average of -0 is +0",
    "two pictures that are compared byte by byte, after an underflow",
);

/// The averages of a constant, with all weights times `scale`.
fn mean<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
    weights: &[R],
    scale: f32,
    value: [R; 3],
) -> [R; 3] {
    let (mut sum, mut total) = ([R::ZERO; 3], R::ZERO);
    for weight in weights {
        let weight = *weight * R::from_f32(scale);
        (sum, total) = (add(sum, weight, value), total + weight);
    }
    average(sum, total)
}

/// The algebraic law of a value that every fragment has, for weights > 0 and values > 0 whose
/// products do not underflow: the average is the value up to the rounding of the sums, (2 n + 2)
/// half ulp for n fragments.
///
/// # Errors
/// The counterexample.
pub fn constant<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
    weights: &[R],
    value: [R; 3],
) -> Lawful {
    let inputs = format_args!("the value {value:?} with the weights {weights:?}");
    let found = mean(add, average, weights, 1.0, value);
    let bound = (2 * weights.len() + 2) as f64 * unit::<R>();
    let near = |i: usize| {
        let (found, value) = (found[i].to_f64(), value[i].to_f64());
        (found - value).abs() <= bound * value + 1e-37
    };
    let holds = near(0) && near(1) && near(2);
    law(&CONSTANT, holds, &inputs, &value, &found)
}

/// The exact laws of a value that every fragment has.
///
/// - The average of 1 is 1 exactly, because its sum is the sum of the weights.
/// - Weights that are all 1024 times as large give the same bits. (So the operator must not add a
///   small number to the weight to keep a quotient finite.)
///
/// # Errors
/// The first counterexample.
pub fn bits<R: Exact>(
    add: &impl Fn([R; 3], R, [R; 3]) -> [R; 3],
    average: &impl Fn([R; 3], R) -> [R; 3],
    weights: &[R],
    value: [R; 3],
) -> Lawful {
    let inputs = format_args!("the value {value:?} with the weights {weights:?}");
    let mean = |scale: f32, value: [R; 3]| mean(add, average, weights, scale, value);
    let (ones, one) = ([R::ONE; 3], mean(1.0, [R::ONE; 3]));
    law(&ONE, same(one, ones), &inputs, &ones, &one)?;
    let (found, scaled) = (mean(1.0, value), mean(1024.0, value));
    law(&SCALED, same(scaled, found), &inputs, &found, &scaled)
}

/// Returns a counterexample unless the average has the bits of +0.
fn is_nothing<R: Exact>(
    what: &Law,
    average: &impl Fn([R; 3], R) -> [R; 3],
    sum: [R; 3],
    weight: R,
) -> Lawful {
    let (found, zeros) = (average(sum, weight), [R::ZERO; 3]);
    let inputs = format_args!("the sum {sum:?} with the weight {weight:?}");
    law(what, same(found, zeros), &inputs, &zeros, &found)
}

/// Where no weight has arrived, the average is +0, whatever finite sum there is.
///
/// # Errors
/// The counterexample.
pub fn nothing<R: Exact>(average: &impl Fn([R; 3], R) -> [R; 3], sum: [R; 3]) -> Lawful {
    is_nothing(&NOTHING, average, sum, R::ZERO)
}

/// Where no weight has arrived, an infinite sum averages to +0. A sum of -0, after an underflow,
/// averages to +0.
///
/// # Errors
/// The first counterexample.
pub fn odd<R: Exact>(average: &impl Fn([R; 3], R) -> [R; 3]) -> Lawful {
    is_nothing(&INFINITE, average, [R::INFINITY, -R::INFINITY, R::ZERO], R::ZERO)?;
    is_nothing(&NEGATIVE, average, [-R::ZERO; 3], R::ONE)
}
