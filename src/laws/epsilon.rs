//! Laws of the epsilon-z test.
//!
//! The operator is `visible(t, nearest, epsilon)`: whether the fragment of depth `t` belongs to the
//! surface whose nearest fragment lies at `nearest`.

use super::search::search;
use super::{Kind, Law, Lawful, law, unit};
use crate::number::Exact;

/// Tries the laws of [`case`], [`limit`] and [`infinite`] at depths and bands of every size, and at
/// the limit itself.
///
/// # Errors
/// The first counterexample.
pub fn epsilon<R: Exact>(visible: &impl Fn(R, R, R) -> bool) -> Lawful {
    of_kinds(&Kind::ALL, visible)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(kinds: &[Kind], visible: &impl Fn(R, R, R) -> bool) -> Lawful {
    search(1, kinds, &|inputs, asked| {
        let (t, nearest): (R, R) = (inputs.depth(), inputs.depth());
        let bands = [inputs.band(), inputs.band()];
        let off =
            bands[0] * R::from_f32(inputs.of(&[0.5, 1.0 / 16.0, 1.0 / 512.0, 1.0 / 16_384.0]));
        let at = |t: R| {
            asked.check(Kind::Algebraic, || case(visible, t, nearest, bands))?;
            asked.check(Kind::Exact, || limit(visible, t, nearest, bands[0]))
        };
        at(t)?;
        let end: R = nearest + bands[0];
        if end < R::INFINITY {
            let beyond = end + end * R::from_f32(2.0) * R::from_f32(unit::<R>() as f32);
            for t in [end, beyond, end + off, end - off] {
                at(t)?;
            }
        }
        asked.check(Kind::Odd, || infinite(visible, t, nearest))
    })
}

const NEAREST: Law = Law::algebraic(
    "the nearest fragment is visible",
    "a pixel where something was drawn is not left empty",
);
const GREATER: Law = Law::algebraic(
    "a greater epsilon keeps what a smaller one keeps",
    "epsilon works as a dial: turning it up adds fragments only",
);
const NEARER: Law = Law::algebraic(
    "what is nearer than a visible fragment is visible",
    "the sums of a pixel have no gap in depth",
);
const ABOUT: Law = Law::algebraic(
    "the limit is nearest + epsilon, up to rounding",
    "the thickness of the visible surface",
);
const LIMIT: Law = Law::exact(
    "the limit is nearest + epsilon, and visible",
    "the fragments within a rounding of the limit, which scenes with round numbers have",
);
const ZERO: Law = Law::exact(
    "epsilon = 0 keeps the nearest depth alone",
    "epsilon = 0 as the setting that blends nothing",
);
const INFINITE: Law = Law::odd(
    "an infinite epsilon keeps everything",
    "an infinite epsilon as the setting that turns the test off",
);

/// Returns a counterexample unless the operator decides as expected.
fn decides<R: Exact>(
    what: &Law,
    visible: &impl Fn(R, R, R) -> bool,
    t: R,
    nearest: R,
    epsilon: R,
    expected: bool,
) -> Lawful {
    let found = visible(t, nearest, epsilon);
    let inputs = format_args!("t = {t:?}, nearest = {nearest:?}, epsilon = {epsilon:?}");
    law(what, found == expected, &inputs, &expected, &found)
}

/// The algebraic laws at one place, for finite depths > 0 and bands >= 0, which may be +inf.
///
/// - The nearest fragment passes, whatever epsilon.
/// - A larger epsilon keeps every fragment that a smaller one keeps. A fragment nearer than one
///   that passes, passes too.
/// - The limit is `nearest + epsilon`, up to 4 half ulp of it.
///
/// # Errors
/// The first counterexample.
pub fn case<R: Exact>(
    visible: &impl Fn(R, R, R) -> bool,
    t: R,
    nearest: R,
    [a, b]: [R; 2],
) -> Lawful {
    decides(&NEAREST, visible, nearest, nearest, a, true)?;
    let (near, far) = if t < nearest { (t, nearest) } else { (nearest, t) };
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if visible(t, nearest, small) {
        decides(&GREATER, visible, t, nearest, large, true)?;
    }
    if visible(far, nearest, a) {
        decides(&NEARER, visible, near, nearest, a, true)?;
    }
    let (depth, limit) = (t.to_f64(), nearest.to_f64() + a.to_f64());
    let rounding = 4.0 * unit::<R>() * limit;
    if (depth - limit).abs() > rounding || limit == f64::INFINITY {
        decides(&ABOUT, visible, t, nearest, a, depth <= limit)?;
    }
    Ok(())
}

/// The exact laws at one place, for the same numbers.
///
/// - The limit is `nearest + epsilon`, rounded once, and a fragment at the limit passes.
/// - epsilon = 0 keeps only the depth of the nearest.
///
/// # Errors
/// The first counterexample.
pub fn limit<R: Exact>(visible: &impl Fn(R, R, R) -> bool, t: R, nearest: R, epsilon: R) -> Lawful {
    let (near, far) = if t < nearest { (t, nearest) } else { (nearest, t) };
    decides(&ZERO, visible, far, near, R::ZERO, far == near)?;
    decides(&LIMIT, visible, t, nearest, epsilon, t <= nearest + epsilon)
}

/// epsilon = +inf keeps everything.
///
/// # Errors
/// The counterexample.
pub fn infinite<R: Exact>(visible: &impl Fn(R, R, R) -> bool, t: R, nearest: R) -> Lawful {
    decides(&INFINITE, visible, t, nearest, R::INFINITY, true)
}
