//! Laws of alpha-blending from front to back.
//!
//! The operator is `under(above, opacity, colour)`: it blends the next farther layer under the
//! layers above, and returns the result.

use super::search::{Asked, search};
use super::{Kind, Law, Lawful, law, same, unit};
use crate::composite::under::Under;
use crate::number::Exact;

/// Tries the laws of [`closed_form`], [`ends`] and [`infinite`] at up to 24 layers.
///
/// # Errors
/// The first counterexample.
pub fn under<R: Exact>(under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>) -> Lawful {
    of_kinds(&Kind::ALL, under)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
) -> Lawful {
    Asked::ordinary(kinds).check(Kind::Algebraic, || closed_form(under, &[]))?;
    search(4, kinds, &|inputs, asked| {
        let layers = inputs.layers(24);
        asked.check(Kind::Algebraic, || closed_form(under, &layers))?;
        asked.check(Kind::Exact, || ends(under, &layers, [inputs.color(), inputs.color()]))?;
        asked.check(Kind::Odd, || infinite(under, &layers))
    })
}

const REST: Law = Law::algebraic(
    "opacity and rest are their closed form, up to rounding",
    "the opacity of the picture, and how much of the environment is seen",
);
const SUM: Law = Law::algebraic(
    "opacity and rest add up to 1, up to rounding",
    "the brightness of the picture before its environment",
);
const COLOR: Law = Law::algebraic(
    "the colour is its closed form, up to rounding",
    "the colour of every pixel where layers lie over each other",
);
const HIDES: Law = Law::exact(
    "an opaque layer hides what comes under it",
    "a loop may end at the first opaque layer, and draw the same bits",
);
const CLEAR: Law = Law::exact(
    "a clear layer changes nothing",
    "layers of opacity 0 may be left out: no bit of the picture depends on them",
);
const INFINITE: Law = Law::odd(
    "a clear layer of an infinite colour changes nothing",
    "pixels where a layer of opacity 0 has a colour that has overflowed",
);

/// Blends layers from front to back under nothing.
fn blend<R: Exact>(
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
    layers: &[(R, [R; 3])],
) -> Under<R> {
    layers.iter().fold(Under::CLEAR, |above, (alpha, color)| under(above, *alpha, *color))
}

fn equal<R: Exact>(a: &Under<R>, b: &Under<R>) -> bool {
    same(a.color, b.color) && same([a.alpha, a.through], [b.alpha, b.through])
}

/// Blending m layers from front to back equals its closed form, up to 6 (m + 1) half ulp, for the
/// colour times the greatest colour, at least 1. The opacities are in \[0, 1\] and the colours
/// finite and >= 0.
///
/// - The light let through is the product of all 1 - alpha. The opacity is the rest to 1.
/// - The colour is the sum of alpha c times the product of the 1 - alpha of the nearer layers.
///   Blending from back to front gives the same.
///
/// # Errors
/// The first counterexample.
pub fn closed_form<R: Exact>(
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
    layers: &[(R, [R; 3])],
) -> Lawful {
    let found = blend(under, layers);
    let (mut through, mut color, mut largest) = (1.0_f64, [0.0_f64; 3], 1.0_f64);
    for (alpha, value) in layers {
        for (sum, c) in color.iter_mut().zip(value.map(R::to_f64)) {
            *sum += through * alpha.to_f64() * c;
            largest = if c > largest { c } else { largest };
        }
        through *= 1.0 - alpha.to_f64();
    }
    let bound = 6.0 * (layers.len() as f64 + 1.0) * unit::<R>();
    let near = |found: f64, expected: f64, of: f64| (found - expected).abs() <= bound * of;
    let (alpha, rest) = (found.alpha.to_f64(), found.through.to_f64());
    let expected = Under { color, alpha: 1.0 - through, through };
    let holds = near(alpha, 1.0 - through, 1.0) && near(rest, through, 1.0);
    law(&REST, holds, &layers, &expected, &found)?;
    let holds = near(alpha + rest, 1.0, 1.0);
    law(&SUM, holds, &layers, &expected, &found)?;
    let holds = (0..3).all(|i| near(found.color[i].to_f64(), color[i], largest));
    law(&COLOR, holds, &layers, &expected, &found)
}

/// Exact laws. An opaque layer of the first colour on a clear pixel leaves its colour, and hides
/// the layers that come under it. A clear layer of the second colour changes nothing.
///
/// # Errors
/// The first counterexample.
pub fn ends<R: Exact>(
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
    layers: &[(R, [R; 3])],
    [opaque, clear]: [[R; 3]; 2],
) -> Lawful {
    let whole = [&[(R::ONE, opaque)], layers].concat();
    let alone = Under { color: opaque, alpha: R::ONE, through: R::ZERO };
    let found = blend(under, &whole);
    law(&HIDES, equal(&found, &alone), &whole, &alone, &found)?;
    changes_nothing(&CLEAR, under, layers, clear)
}

/// A law of odd inputs: a clear layer changes nothing, even with an infinite colour.
///
/// # Errors
/// The counterexample.
pub fn infinite<R: Exact>(
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
    layers: &[(R, [R; 3])],
) -> Lawful {
    changes_nothing(&INFINITE, under, layers, [R::INFINITY; 3])
}

/// Returns a counterexample unless a layer of opacity 0 changes nothing, to the bit.
fn changes_nothing<R: Exact>(
    what: &Law,
    under: &impl Fn(Under<R>, R, [R; 3]) -> Under<R>,
    layers: &[(R, [R; 3])],
    color: [R; 3],
) -> Lawful {
    let before = blend(under, layers);
    let found = under(before, R::ZERO, color);
    let inputs = format_args!("the clear colour {color:?} under {before:?}");
    law(what, equal(&found, &before), &inputs, &before, &found)
}
