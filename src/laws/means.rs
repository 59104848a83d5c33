//! Laws of the average of up to four neighbours \[MKC08, sections 3.2 and 3.3\].
//!
//! The operator is `mean(takes, weights, values)`: which neighbours take part, their weights > 0
//! and their values. At least one neighbour takes part.

use super::search::search;
use super::{Kind, Law, Lawful, law, same, unit};
use crate::number::Exact;

/// Tries the laws of [`quotient`], [`constant`], [`hull`] and [`mirror`].
///
/// # Errors
/// The first counterexample.
pub fn means<R: Exact>(mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R) -> Lawful {
    of_kinds(&Kind::ALL, mean)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R,
) -> Lawful {
    search(7, kinds, &|inputs, asked| {
        let set = 1 + inputs.below(15);
        let takes = [0, 1, 2, 3].map(|j| set >> j & 1 == 1);
        let unit = inputs.below(2) == 0;
        let w =
            [(); 4].map(|()| if unit { R::ONE } else { R::ONE - inputs.between::<R>(0.0, 0.9) });
        let a = [(); 4].map(|()| inputs.signed(8.0));
        let size = R::from_f32(inputs.of(&[1.0, 1e30, 1e-30]));
        asked.check(Kind::Algebraic, || quotient(mean, takes, w, a))?;
        asked.check(Kind::Exact, || constant(mean, takes, w, a[0] * size))?;
        asked.check(Kind::Exact, || hull(mean, takes, w, a))?;
        asked.check(Kind::Exact, || mirror(mean, takes, w, a))
    })
}

const QUOTIENT: Law = Law::algebraic(
    "an average is the quotient, up to rounding",
    "the depths, normals and colours of every coarser level",
);
const CONSTANT: Law = Law::exact(
    "the average of a constant is the constant",
    "a plane that faces the camera has one depth on every level",
);
const HULL: Law = Law::exact(
    "an average lies in the hull",
    "the intervals of depth of a level hold the depths of the finer ones",
);
const MIRROR: Law =
    Law::exact("exchanging sides changes no bit", "a mirrored scene draws the mirrored picture");

/// Exact law: a constant is reproduced.
///
/// # Errors
/// The first counterexample.
pub fn constant<R: Exact>(
    mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R,
    takes: [bool; 4],
    weights: [R; 4],
    value: R,
) -> Lawful {
    let found = mean(takes, weights, [value; 4]);
    let inputs = format_args!("{value:?} of {takes:?} with the weights {weights:?}");
    law(&CONSTANT, found == value, &inputs, &value, &found)
}

/// Exact law: an average lies between the least and the greatest value that takes part.
///
/// # Errors
/// The counterexample.
pub fn hull<R: Exact>(
    mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R,
    takes: [bool; 4],
    weights: [R; 4],
    a: [R; 4],
) -> Lawful {
    let found = mean(takes, weights, a);
    let inputs = format_args!("{a:?} of {takes:?} with the weights {weights:?}");
    let taken = || (0..4).filter(|&j| takes[j]);
    let holds = taken().any(|j| a[j] <= found) && taken().any(|j| a[j] >= found);
    let expected = format_args!("a number between those that take part");
    law(&HULL, holds, &inputs, &expected, &found)
}

/// Algebraic law: an average is the exact quotient up to nine roundings.
///
/// # Errors
/// The counterexample.
pub fn quotient<R: Exact>(
    mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R,
    takes: [bool; 4],
    weights: [R; 4],
    a: [R; 4],
) -> Lawful {
    let found = mean(takes, weights, a);
    let inputs = format_args!("{a:?} of {takes:?} with the weights {weights:?}");
    let taken = || (0..4).filter(|&j| takes[j]);
    let total: f64 = taken().map(|j| weights[j].to_f64()).sum();
    let sum: f64 = taken().map(|j| weights[j].to_f64() * a[j].to_f64()).sum();
    let largest = taken().map(|j| a[j].to_f64().abs()).fold(0.0, |m, v| if v > m { v } else { m });
    // Products, sums, total, its inverse, the product; the quotient in this test has as many in
    // f64.
    let bound = 9.0 * (unit::<R>() + f64::EPSILON / 2.0) * largest;
    let (exact, near) = (sum / total, (found.to_f64() - sum / total).abs() <= bound);
    law(&QUOTIENT, near, &inputs, &exact, &found)
}

/// Exact law: exchanging left with right (0 with 1, 2 with 3) or top with bottom changes no bit.
///
/// # Errors
/// The first counterexample.
pub fn mirror<R: Exact>(
    mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R,
    takes: [bool; 4],
    weights: [R; 4],
    a: [R; 4],
) -> Lawful {
    let expected = mean(takes, weights, a);
    for order in [[1, 0, 3, 2], [2, 3, 0, 1]] {
        let [w, a] = [weights, a].map(|all| order.map(|j: usize| all[j]));
        let takes = order.map(|j| takes[j]);
        let found = mean(takes, w, a);
        let inputs = format_args!("{a:?} of {takes:?} with the weights {w:?}");
        let holds = same([found], [expected]);
        law(&MIRROR, holds, &inputs, &expected, &found)?;
    }
    Ok(())
}
