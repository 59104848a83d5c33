//! Laws of the operator over the depth-images of groups \[ZP06, section 3.2, Fig. 5\].
//!
//! The operator is `compose(samples, epsilon)`: from the samples of all images at a pixel it
//! computes the sums, and how many samples passed.

use super::inputs::Inputs;
use super::search::{Asked, search};
use super::{Kind, Law, Lawful, law, same, unit};
use crate::composite::groups::WeightedFragment;
use crate::number::Exact;
use std::fmt::Debug;

/// Tries the laws of [`near`], [`definition`], [`empty`], [`order`] and [`apart`] at up to 24
/// images, some of them empty and some tied. It also tries three depths at which an operator that
/// folds over pairs fails.
///
/// # Errors
/// The first counterexample.
pub fn groups<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
) -> Lawful {
    of_kinds(&Kind::ALL, compose)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
) -> Lawful {
    let at = |t: f32| {
        let color = [R::from_f32(t); 3];
        WeightedFragment::new(R::from_f32(t), R::ONE, [R::ZERO, R::ZERO, R::ONE], color, R::ONE)
    };
    let defined = |asked: &Asked<'_>, samples: &[WeightedFragment<R>], band: R| {
        asked.check(Kind::Algebraic, || near(compose, samples, band))?;
        asked.check(Kind::Exact, || definition(compose, samples, band))
    };
    for depths in [&[][..], &[0.0, 0.75, 1.5], &[1.5, 0.75, 0.0]] {
        let samples: Vec<_> = depths.iter().map(|t| at(*t)).collect();
        defined(&Asked::ordinary(kinds), &samples, R::ONE)?;
    }
    search(6, kinds, &|inputs, asked| {
        let samples: Vec<_> = (0..=inputs.below(23)).map(|_| sample(inputs)).collect();
        let (band, place) = (inputs.band(), inputs.below(samples.len()));
        defined(asked, &samples, band)?;
        asked.check(Kind::Exact, || empty(compose, &samples, place, band))?;
        asked.check(Kind::Algebraic, || {
            order(compose, &samples, &inputs.order(samples.len()), band)
        })?;
        asked.check(Kind::Algebraic, || apart(compose, &samples, place, band))
    })
}

const NEAR: Law = Law::algebraic(
    "the sums are those of all samples within epsilon of the nearest, up to rounding",
    "every pixel where groups lie over each other",
);
const DEFINITION: Law = Law::exact(
    "the sums are those of all samples within epsilon of the nearest, in order",
    "two renderers that add in the order of the groups draw the same bits",
);
const NEUTRAL: Law = Law::exact(
    "an empty image is neutral",
    "groups that draw nothing may be left out: no bit of the picture depends on them",
);
const ORDER: Law = Law::algebraic(
    "images may come in any order, up to rounding",
    "the numbering of the groups changes nothing that can be seen",
);
const APART: Law = Law::algebraic(
    "a sample may have an image of its own",
    "more groups never lose a surfel that fewer groups show",
);

/// A sample. Half of the depths are among three values, so that there are ties.
fn sample<R: Exact>(inputs: &mut Inputs) -> WeightedFragment<R> {
    let (full, own, tied) =
        (inputs.below(6) > 0, inputs.flag(), R::from_f32(inputs.of(&[1.0, 2.0, 2.5])));
    let depth = inputs.depth();
    let normal = [(); 3].map(|()| inputs.signed(1.0));
    let depth = if own { depth } else { tied };
    let sample =
        WeightedFragment::new(depth, inputs.weight(), normal, inputs.color(), inputs.alpha());
    if full { sample } else { WeightedFragment::EMPTY }
}

/// The attributes that are summed: weight, normal, colour, opacity.
fn attributes<R: Exact>(s: &WeightedFragment<R>) -> [R; 8] {
    let ([nx, ny, nz], [r, g, b]) = (s.normal, s.color);
    [s.weight, nx, ny, nz, r, g, b, s.opacity]
}

/// The samples that pass the epsilon-z test, straight from its definition.
fn visible<R: Exact>(samples: &[WeightedFragment<R>], epsilon: R) -> Vec<WeightedFragment<R>> {
    let full = || samples.iter().filter(|s| s.depth < R::INFINITY);
    let nearest = full().fold(R::INFINITY, |a, s| if s.depth < a { s.depth } else { a });
    full().filter(|s| s.depth <= nearest + epsilon).copied().collect()
}

fn equal<R: Exact>(a: &(WeightedFragment<R>, u32), b: &(WeightedFragment<R>, u32)) -> bool {
    same(attributes(&a.0), attributes(&b.0)) && same([a.0.depth], [b.0.depth]) && a.1 == b.1
}

/// The sums over all samples within epsilon of the nearest, in ascending order from 0.
fn defined<R: Exact>(samples: &[WeightedFragment<R>], epsilon: R) -> (WeightedFragment<R>, u32) {
    let terms = visible(samples, epsilon);
    let mut sums = WeightedFragment::<R>::EMPTY;
    for s in &terms {
        let plus = |a: [R; 3], b: [R; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        sums.depth = if s.depth < sums.depth { s.depth } else { sums.depth };
        sums.weight = sums.weight + s.weight;
        (sums.normal, sums.color) = (plus(sums.normal, s.normal), plus(sums.color, s.color));
        sums.opacity = sums.opacity + s.opacity;
    }
    (sums, terms.len() as u32)
}

/// Algebraic law: the operator returns the sums over all samples within epsilon of the nearest, up
/// to the rounding of sums in another order. It also returns the nearest depth and how many samples
/// passed.
///
/// # Errors
/// The counterexample.
pub fn near<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    epsilon: R,
) -> Lawful {
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?}");
    let both = [defined(samples, epsilon), compose(samples, epsilon)];
    same_but_order(&NEAR, &visible(samples, epsilon), &inputs, both)
}

/// Exact law: the same to the bit. An empty image adds nothing.
///
/// # Errors
/// The counterexample.
pub fn definition<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    epsilon: R,
) -> Lawful {
    let (expected, found) = (defined(samples, epsilon), compose(samples, epsilon));
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?}");
    law(&DEFINITION, equal(&found, &expected), &inputs, &expected, &found)
}

/// Exact law: an empty image at any place changes no bit.
///
/// # Errors
/// The first counterexample.
pub fn empty<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    place: usize,
    epsilon: R,
) -> Lawful {
    let mut with = samples.to_vec();
    with.insert(place % (samples.len() + 1), WeightedFragment::EMPTY);
    let (expected, found) = (compose(samples, epsilon), compose(&with, epsilon));
    let inputs = format_args!("epsilon = {epsilon:?}, {with:?}");
    law(&NEUTRAL, equal(&found, &expected), &inputs, &expected, &found)
}

/// Algebraic law: images in another order give the same result, except for the order of the sums. `order[i]` is
/// the image that comes i-th.
///
/// # Errors
/// The first counterexample.
pub fn order<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    order: &[usize],
    epsilon: R,
) -> Lawful {
    let permuted: Vec<_> = order.iter().map(|i| samples[*i]).collect();
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?} and {permuted:?}");
    let both = [samples, &permuted].map(|samples| compose(samples, epsilon));
    same_but_order(&ORDER, &visible(samples, epsilon), &inputs, both)
}

/// Algebraic law: moving a sample to an image of its own changes nothing but the order of the sums.
///
/// # Errors
/// The first counterexample.
pub fn apart<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    place: usize,
    epsilon: R,
) -> Lawful {
    let mut moved = samples.to_vec();
    let place = place % samples.len();
    moved.push(moved[place]);
    moved[place] = WeightedFragment::EMPTY;
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?} and {moved:?}");
    let both = [samples, &moved].map(|samples| compose(samples, epsilon));
    same_but_order(&APART, &visible(samples, epsilon), &inputs, both)
}

/// Compares sums of the same terms in two orders. Each sum of m terms is within (m - 1) half ulp of
/// the sum of their magnitudes, so the two sums are within twice that bound.
fn same_but_order<R: Exact>(
    what: &Law,
    terms: &[WeightedFragment<R>],
    inputs: &dyn Debug,
    [expected, found]: [(WeightedFragment<R>, u32); 2],
) -> Lawful {
    let roundings = 2.0 * (terms.len() as f64 - 1.0).abs() * unit::<R>() * 1.001;
    let near = |i: usize| {
        let magnitude: f64 = terms.iter().map(|s| attributes(s)[i].to_f64().abs()).sum();
        let [a, b] = [&expected.0, &found.0].map(|s| attributes(s)[i].to_f64());
        (a - b).abs() <= roundings * magnitude
    };
    let holds = expected.1 == found.1 && same([expected.0.depth], [found.0.depth]);
    law(what, holds && (0..8).all(near), inputs, &expected, &found)
}
