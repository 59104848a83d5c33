//! Laws of the operator over the depth-images of groups \[ZP06, section 3.2, Fig. 5\].
//!
//! The operator is `compose(samples, epsilon)`: from the samples of all images at a pixel it
//! computes the sums, and how many samples passed.

use super::inputs::{CASES, Inputs};
use super::{Lawful, law, same, unit};
use crate::composite::groups::WeightedFragment;
use crate::number::Exact;

/// Tries the laws of [`definition`], [`empty`], [`order`] and [`apart`] at up to 24 images, some of
/// them empty and some tied. It also tries three depths at which an operator that folds over pairs
/// fails.
///
/// # Errors
/// The first counterexample.
pub fn groups<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
) -> Lawful {
    let mut inputs = Inputs::new(6);
    definition(compose, &[], R::ONE)?;
    let at = |t: f32| {
        let color = [R::from_f32(t); 3];
        WeightedFragment::new(R::from_f32(t), R::ONE, [R::ZERO, R::ZERO, R::ONE], color, R::ONE)
    };
    definition(compose, &[at(0.0), at(0.75), at(1.5)], R::ONE)?;
    definition(compose, &[at(1.5), at(0.75), at(0.0)], R::ONE)?;
    for _ in 0..CASES {
        let samples: Vec<_> = (0..=inputs.below(23)).map(|_| sample(&mut inputs)).collect();
        let (band, place) = (inputs.band(), inputs.below(samples.len()));
        definition(compose, &samples, band)?;
        empty(compose, &samples, place, band)?;
        order(compose, &samples, &inputs.order(samples.len()), band)?;
        apart(compose, &samples, place, band)?;
    }
    Ok(())
}

/// A sample. Half of the depths are among three values, so that there are ties.
fn sample<R: Exact>(inputs: &mut Inputs) -> WeightedFragment<R> {
    if inputs.below(6) == 0 {
        return WeightedFragment::EMPTY;
    }
    let depth =
        if inputs.flag() { R::from_f32(inputs.of(&[1.0, 2.0, 2.5])) } else { inputs.depth() };
    let normal = [(); 3].map(|()| inputs.between(-1.0, 1.0));
    WeightedFragment::new(depth, inputs.weight(), normal, inputs.color(), inputs.alpha())
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

/// The operator returns the sums over all samples within epsilon of the nearest, in ascending order
/// from 0, to the bit. It also returns the nearest depth and how many samples passed. An empty
/// image adds nothing.
///
/// # Errors
/// The first counterexample.
pub fn definition<R: Exact>(
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    samples: &[WeightedFragment<R>],
    epsilon: R,
) -> Lawful {
    let terms = visible(samples, epsilon);
    let mut sums = WeightedFragment::<R>::EMPTY;
    for s in &terms {
        let plus = |a: [R; 3], b: [R; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        sums.depth = if s.depth < sums.depth { s.depth } else { sums.depth };
        sums.weight = sums.weight + s.weight;
        (sums.normal, sums.color) = (plus(sums.normal, s.normal), plus(sums.color, s.color));
        sums.opacity = sums.opacity + s.opacity;
    }
    let (expected, found) = ((sums, terms.len() as u32), compose(samples, epsilon));
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?}");
    let what = "the sums are those of all samples within epsilon of the nearest, in order";
    law(what, equal(&found, &expected), &inputs, &expected, &found)
}

/// An empty image at any place changes no bit.
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
    law("an empty image is neutral", equal(&found, &expected), &inputs, &expected, &found)
}

/// Images in another order give the same result, except for the order of the sums. `order[i]` is
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
    same_but_order(
        "images may come in any order, up to rounding",
        compose,
        [samples, &permuted],
        epsilon,
    )
}

/// Moving a sample to an image of its own changes nothing but the order of the sums.
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
    same_but_order("a sample may have an image of its own", compose, [samples, &moved], epsilon)
}

/// Compares the same terms in two orders. Each sum of m terms is within (m - 1) half ulp of the sum
/// of their magnitudes, so the two sums are within twice that bound.
fn same_but_order<R: Exact>(
    what: &'static str,
    compose: &impl Fn(&[WeightedFragment<R>], R) -> (WeightedFragment<R>, u32),
    [samples, others]: [&[WeightedFragment<R>]; 2],
    epsilon: R,
) -> Lawful {
    let (expected, found) = (compose(samples, epsilon), compose(others, epsilon));
    let terms = visible(samples, epsilon);
    let roundings = 2.0 * (terms.len() as f64 - 1.0).abs() * unit::<R>() * 1.001;
    let near = |i: usize| {
        let magnitude: f64 = terms.iter().map(|s| attributes(s)[i].to_f64().abs()).sum();
        let [a, b] = [&expected.0, &found.0].map(|s| attributes(s)[i].to_f64());
        (a - b).abs() <= roundings * magnitude
    };
    let holds = expected.1 == found.1 && same([expected.0.depth], [found.0.depth]);
    let inputs = format_args!("epsilon = {epsilon:?}, {samples:?} and {others:?}");
    law(what, holds && (0..8).all(near), &inputs, &expected, &found)
}
