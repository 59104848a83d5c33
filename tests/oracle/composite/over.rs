//! Laws of alpha-blending, in `f32` and in `f64`.

use crate::composite::groups::{filled, unit};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use splatref::composite::over::Blend;
use splatref::number::Exact;

/// A layer: opacity, colour.
type Layer = [(f32, f32); 4];

fn layer() -> impl Strategy<Value = Layer> {
    let alpha =
        prop_oneof![4 => 0.0_f32..1.0, 1 => Just(0.0_f32), 1 => Just(1.0_f32), 1 => 1e-7_f32..1e-5];
    // Opacities stay at most 1 when they are filled.
    let fine = || -1.0_f32..0.0;
    (alpha, prop::array::uniform3(0.0_f32..2.0), [fine(), fine(), fine(), fine()]).prop_map(
        |(a, [r, g, b], f)| {
            let alpha = if a == 1.0 { (a, 0.0) } else { (a, f[0]) };
            [alpha, (r, f[1]), (g, f[2]), (b, f[3])]
        },
    )
}

fn blend<R: Exact>(layers: &[Layer]) -> Blend<R> {
    layers.iter().fold(Blend::CLEAR, |below, layer| {
        let [a, r, g, b] = layer.map(filled::<R>);
        below.over(a, [r, g, b])
    })
}

fn bits<R: Exact>(blend: &Blend<R>) -> [u64; 4] {
    let [r, g, b] = blend.color;
    [r, g, b, blend.alpha].map(|v| v.to_f64().to_bits())
}

/// Back to front, m layers: opacity is 1 - the product of all 1 - alpha, colour the sum of alpha c
/// times the product of 1 - alpha of the nearer ones. A layer costs four roundings of numbers that
/// are no larger than the result's bound, the closed form's own are those of f64.
fn closed_form<R: Exact>(layers: &[Layer]) -> TestCaseResult {
    let found = blend::<R>(layers);
    let (mut through, mut color, mut largest) = (1.0_f64, [0.0_f64; 3], 1.0_f64);
    for layer in layers.iter().rev() {
        let [a, r, g, b] = layer.map(|v| filled::<R>(v).to_f64());
        for (sum, c) in color.iter_mut().zip([r, g, b]) {
            *sum += through * a * c;
            largest = largest.max(c);
        }
        through *= 1.0 - a;
    }
    let bound = 4.0 * (layers.len() as f64 + 1.0) * unit::<R>() * largest;
    prop_assert!((found.alpha.to_f64() - (1.0 - through)).abs() <= bound);
    for (found, expected) in found.color.iter().zip(color) {
        prop_assert!((found.to_f64() - expected).abs() <= bound, "{:?} {}", found, expected);
    }
    // Never past 1: 1 - alpha is off by half the spacing below 1, which a sum of 1 rounds away.
    prop_assert!(found.alpha >= R::ZERO && found.alpha <= R::ONE);
    Ok(())
}

fn ends<R: Exact>(layers: &[Layer], top: &Layer) -> TestCaseResult {
    let below = blend::<R>(layers);
    let [_, r, g, b] = top.map(filled::<R>);
    let opaque = below.over(R::ONE, [r, g, b]);
    prop_assert_eq!(bits(&opaque), bits(&Blend { color: [r, g, b], alpha: R::ONE }));
    prop_assert_eq!(bits(&below.over(R::ZERO, [r, g, b])), bits(&below));
    Ok(())
}

/// Whatever is below, an opaque layer makes its own colour of it: what is nearer decides alone.
fn nothing_shines_through<R: Exact>(
    layers: &[Layer],
    others: &[Layer],
    wall: &Layer,
) -> TestCaseResult {
    let mut wall = *wall;
    wall[0] = (1.0, 0.0);
    let before = |far: &[Layer]| blend::<R>(&[far, &[wall], others].concat());
    prop_assert_eq!(bits(&before(layers)), bits(&before(&[])));
    Ok(())
}

proptest! {
    #[test]
    fn blending_is_its_closed_form(layers in prop::collection::vec(layer(), 0..24)) {
        closed_form::<f32>(&layers)?;
        closed_form::<f64>(&layers)?;
    }

    #[test]
    fn opaque_leaves_the_layer_and_clear_leaves_what_was(
        layers in prop::collection::vec(layer(), 0..8), top in layer(),
    ) {
        ends::<f32>(&layers, &top)?;
        ends::<f64>(&layers, &top)?;
    }

    #[test]
    fn nothing_shines_through_an_opaque_layer(
        layers in prop::collection::vec(layer(), 0..8),
        others in prop::collection::vec(layer(), 0..8),
        wall in layer(),
    ) {
        nothing_shines_through::<f32>(&layers, &others, &wall)?;
        nothing_shines_through::<f64>(&layers, &others, &wall)?;
    }
}
