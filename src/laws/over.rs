//! Laws of alpha-blending from back to front \[ZP06, section 3.3\].
//!
//! The operator is `over(below, opacity, colour)`: it blends the next nearer layer over the layers
//! below, and returns the result.

use super::search::{Asked, search};
use super::{Kind, Law, Lawful, law, same, unit};
use crate::composite::over::Blend;
use crate::number::Exact;

/// Tries the laws of [`closed_form`], [`ends`] and [`wall`] at up to 24 layers.
///
/// # Errors
/// The first counterexample.
pub fn over<R: Exact>(over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>) -> Lawful {
    of_kinds(&Kind::ALL, over)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>,
) -> Lawful {
    Asked::ordinary(kinds).check(Kind::Algebraic, || closed_form(over, &[]))?;
    search(3, kinds, &|inputs, asked| {
        let (layers, nearer) = (inputs.layers(24), inputs.layers(8));
        let color = inputs.color();
        asked.check(Kind::Algebraic, || closed_form(over, &layers))?;
        asked.check(Kind::Exact, || ends(over, &layers, color))?;
        asked.check(Kind::Exact, || wall(over, &layers, color, &nearer))
    })
}

const CLOSED_FORM: Law = Law::algebraic(
    "blending is its closed form, up to rounding",
    "the colour and the opacity of every pixel where layers lie over each other",
);
const HIDES: Law = Law::exact(
    "an opaque layer hides what is below",
    "hidden layers may be left out: no bit of the picture depends on them",
);
const CLEAR: Law = Law::exact(
    "a clear layer changes nothing",
    "layers of opacity 0 may be left out: no bit of the picture depends on them",
);
const WALL: Law = Law::exact(
    "nothing shines through an opaque layer",
    "a loop may begin at the nearest opaque layer, and draw the same bits",
);

/// Blends layers from back to front over nothing.
fn blend<R: Exact>(
    over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>,
    layers: &[(R, [R; 3])],
) -> Blend<R> {
    layers.iter().fold(Blend::CLEAR, |below, (alpha, color)| over(below, *alpha, *color))
}

fn equal<R: Exact>(a: &Blend<R>, b: &Blend<R>) -> bool {
    same(a.color, b.color) && same([a.alpha], [b.alpha])
}

/// Blending m layers from back to front equals its closed form. The opacities are in \[0, 1\] and
/// the colours finite and >= 0.
///
/// - The opacity is 1 - the product of all 1 - alpha, and in \[0, 1\].
/// - The colour is the sum of alpha c times the product of the 1 - alpha of the nearer layers.
///
/// Both hold up to 4 (m + 1) half ulp of the greatest colour, at least 1.
///
/// ```
/// use splatref::composite::over::Blend;
/// use splatref::laws::over::closed_form;
///
/// let layers = [(0.5_f32, [1.0, 0.0, 0.0]), (0.25, [0.0, 1.0, 0.0])]; // from back to front
/// closed_form(&|below: Blend<f32>, alpha, color| below.over(alpha, color), &layers)?;
/// let wrong = |below: Blend<f32>, alpha, color| Blend { color, ..below.over(alpha, color) };
/// assert!(closed_form(&wrong, &layers).is_err(), "the layers below are lost");
/// # Ok::<(), splatref::laws::Counterexample>(())
/// ```
///
/// # Errors
/// The first counterexample.
pub fn closed_form<R: Exact>(
    over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>,
    layers: &[(R, [R; 3])],
) -> Lawful {
    let found = blend(over, layers);
    let (mut through, mut color, mut largest) = (1.0_f64, [0.0_f64; 3], 1.0_f64);
    for (alpha, value) in layers.iter().rev() {
        for (sum, c) in color.iter_mut().zip(value.map(R::to_f64)) {
            *sum += through * alpha.to_f64() * c;
            largest = if c > largest { c } else { largest };
        }
        through *= 1.0 - alpha.to_f64();
    }
    let bound = 4.0 * (layers.len() as f64 + 1.0) * unit::<R>() * largest;
    let near = |found: R, expected: f64| (found.to_f64() - expected).abs() <= bound;
    let holds = near(found.alpha, 1.0 - through)
        && (R::ZERO <= found.alpha && found.alpha <= R::ONE)
        && (0..3).all(|i| near(found.color[i], color[i]));
    let expected = Blend { color, alpha: 1.0 - through };
    law(&CLOSED_FORM, holds, &layers, &expected, &found)
}

/// Exact laws: an opaque layer hides everything below, and a clear layer changes nothing, to the bit.
///
/// # Errors
/// The first counterexample.
pub fn ends<R: Exact>(
    over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>,
    layers: &[(R, [R; 3])],
    color: [R; 3],
) -> Lawful {
    let below = blend(over, layers);
    let inputs = format_args!("the colour {color:?} over {below:?}");
    let (alone, found) = (Blend { color, alpha: R::ONE }, over(below, R::ONE, color));
    law(&HIDES, equal(&found, &alone), &inputs, &alone, &found)?;
    let found = over(below, R::ZERO, color);
    law(&CLEAR, equal(&found, &below), &inputs, &below, &found)
}

/// Exact law: layers behind an opaque layer change no bit, whatever is in front of the opaque layer.
///
/// # Errors
/// The first counterexample.
pub fn wall<R: Exact>(
    over: &impl Fn(Blend<R>, R, [R; 3]) -> Blend<R>,
    behind: &[(R, [R; 3])],
    color: [R; 3],
    before: &[(R, [R; 3])],
) -> Lawful {
    let from_wall = [&[(R::ONE, color)], before].concat();
    let whole = [behind, &from_wall].concat();
    let (alone, found) = (blend(over, &from_wall), blend(over, &whole));
    law(&WALL, equal(&found, &alone), &whole, &alone, &found)
}
