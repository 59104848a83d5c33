//! Laws of alpha-blending, in `f32` and in `f64`.

use crate::oracle::composite::groups::filled;
use crate::oracle::composite::lawful;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use splatref::composite::over::Blend;
use splatref::laws;
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

/// The operator of the crate, which the laws are asked of.
fn over<R: Exact>(below: Blend<R>, alpha: R, color: [R; 3]) -> Blend<R> {
    below.over(alpha, color)
}

fn layers<R: Exact>(all: &[Layer]) -> Vec<(R, [R; 3])> {
    let layer = |layer: &Layer| {
        let [a, r, g, b] = layer.map(filled::<R>);
        (a, [r, g, b])
    };
    all.iter().map(layer).collect()
}

fn closed_form<R: Exact>(all: &[Layer]) -> TestCaseResult {
    lawful(laws::over::closed_form(&over::<R>, &layers(all)))
}

fn ends<R: Exact>(all: &[Layer], top: &Layer) -> TestCaseResult {
    lawful(laws::over::ends(&over::<R>, &layers(all), layers(&[*top])[0].1))
}

fn nothing_shines_through<R: Exact>(
    all: &[Layer],
    others: &[Layer],
    wall: &Layer,
) -> TestCaseResult {
    let color = layers(&[*wall])[0].1;
    lawful(laws::over::wall(&over::<R>, &layers(all), color, &layers(others)))
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
