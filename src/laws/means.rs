//! Laws of the average of up to four neighbours \[MKC08, sections 3.2 and 3.3\].
//!
//! The operator is `mean(takes, weights, values)`: which neighbours take part, their weights > 0
//! and their values. At least one neighbour takes part.

use super::inputs::{CASES, Inputs};
use super::{Lawful, law, same, unit};
use crate::number::Exact;

/// Tries the laws of [`constant`], [`hull`] and [`mirror`].
///
/// # Errors
/// The first counterexample.
pub fn means<R: Exact>(mean: &impl Fn([bool; 4], [R; 4], [R; 4]) -> R) -> Lawful {
    let mut inputs = Inputs::new(7);
    for i in 0..CASES {
        let set = 1 + i % 15;
        let takes = [0, 1, 2, 3].map(|j| set >> j & 1 == 1);
        let unit = inputs.flag();
        let w = [(); 4].map(|()| if unit { R::ONE } else { inputs.between(0.1, 1.0) });
        let a = [(); 4].map(|()| inputs.between(-8.0, 8.0));
        let size = R::from_f32(inputs.of(&[1.0, 1e30, 1e-30]));
        constant(mean, takes, w, a[0] * size)?;
        hull(mean, takes, w, a)?;
        mirror(mean, takes, w, a)?;
    }
    Ok(())
}

/// A constant is reproduced exactly.
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
    law("the average of a constant is the constant", found == value, &inputs, &value, &found)
}

/// An average lies between the least and the greatest value that takes part, and is the exact
/// quotient up to nine roundings.
///
/// # Errors
/// The first counterexample.
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
    law("an average lies in the hull", holds, &inputs, &expected, &found)?;
    let total: f64 = taken().map(|j| weights[j].to_f64()).sum();
    let sum: f64 = taken().map(|j| weights[j].to_f64() * a[j].to_f64()).sum();
    let largest = taken().map(|j| a[j].to_f64().abs()).fold(0.0, |m, v| if v > m { v } else { m });
    // Products, sums, total, its inverse, the product; the quotient in this test has as many in
    // f64.
    let bound = 9.0 * (unit::<R>() + f64::EPSILON / 2.0) * largest;
    let (exact, near) = (sum / total, (found.to_f64() - sum / total).abs() <= bound);
    law("an average is the quotient, up to rounding", near, &inputs, &exact, &found)
}

/// Exchanging left with right (0 with 1, 2 with 3) or top with bottom changes no bit.
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
        law("exchanging sides changes no bit", holds, &inputs, &expected, &found)?;
    }
    Ok(())
}
