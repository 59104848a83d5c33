//! Laws of the epsilon-z test.
//!
//! The operator is `visible(t, nearest, epsilon)`: whether the fragment of depth `t` belongs to the
//! surface whose nearest fragment lies at `nearest`.

use super::inputs::{CASES, Inputs};
use super::{Lawful, law, unit};
use crate::number::Exact;

/// Tries the laws of [`case`] at depths and bands of every size, and at the limit itself.
///
/// # Errors
/// The first counterexample.
pub fn epsilon<R: Exact>(visible: &impl Fn(R, R, R) -> bool) -> Lawful {
    let mut inputs = Inputs::new(1);
    for _ in 0..CASES {
        let (t, nearest, bands) = (inputs.depth(), inputs.depth(), [inputs.band(), inputs.band()]);
        case(visible, t, nearest, bands)?;
        let limit: R = nearest + bands[0];
        if limit < R::INFINITY {
            let beyond = limit + limit * R::from_f32(2.0) * R::from_f32(unit::<R>() as f32);
            case(visible, limit, nearest, bands)?;
            case(visible, beyond, nearest, bands)?;
        }
    }
    Ok(())
}

/// The laws at one place, for finite depths > 0 and bands >= 0, which may be +inf.
///
/// - The nearest fragment passes, whatever epsilon.
/// - epsilon = +inf keeps everything; epsilon = 0 keeps only the depth of the nearest.
/// - A larger epsilon keeps every fragment that a smaller one keeps. A fragment nearer than one
///   that passes, passes too.
/// - The limit is `nearest + epsilon`, rounded once, and a fragment at the limit passes.
///
/// # Errors
/// The first counterexample.
pub fn case<R: Exact>(
    visible: &impl Fn(R, R, R) -> bool,
    t: R,
    nearest: R,
    [a, b]: [R; 2],
) -> Lawful {
    let is = |what, (t, nearest, epsilon): (R, R, R), expected: bool| {
        let found = visible(t, nearest, epsilon);
        let inputs = format_args!("t = {t:?}, nearest = {nearest:?}, epsilon = {epsilon:?}");
        law(what, found == expected, &inputs, &expected, &found)
    };
    is("the nearest fragment is visible", (nearest, nearest, a), true)?;
    is("an infinite epsilon keeps everything", (t, nearest, R::INFINITY), true)?;
    let (near, far) = if t < nearest { (t, nearest) } else { (nearest, t) };
    is("epsilon = 0 keeps the nearest depth alone", (far, near, R::ZERO), far == near)?;
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if visible(t, nearest, small) {
        is("a greater epsilon keeps what a smaller one keeps", (t, nearest, large), true)?;
    }
    if visible(far, nearest, a) {
        is("what is nearer than a visible fragment is visible", (near, nearest, a), true)?;
    }
    is("the limit is nearest + epsilon, and visible", (t, nearest, a), t <= nearest + a)
}
