//! Every layer of depth peeling against the oracle.

use crate::oracle::ewa::stages::oracle;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::index;
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::peeling::model::{Peeled, peel};
use crate::oracle::peeling::tolerance::PEELING;
use crate::oracle::transparent;
use crate::oracle::transparent::stages::Compare;
use crate::oracle::transparent::surroundings::{radiance, world_ray};
use splatref::frame::{Frame, NO_ID};
use splatref::method::peeling::{STAGES, Settings};
use splatref::number::Exact;

fn stages<R: Exact>(compare: &mut Compare<'_, R>, peeled: &Peeled, most: u32) {
    for j in 0..most.min(STAGES) as usize {
        let name = format!("layer{}", j + 1);
        let [alpha, depth, count] = ["A", "Z", "count"].map(|end| format!("{name}.{end}"));
        if let Some(layer) = peeled.layers.get(j) {
            compare.color(&name, "layer", layer.color);
            compare.number(&alpha, "layer.A", layer.alpha);
            compare.number(&depth, "layer.Z", layer.depth);
            compare.exact(&count, layer.count.min(255) as f64);
        } else {
            [&name, &alpha, &count].into_iter().for_each(|name| compare.exact(name, 0.0));
            compare.exact(&depth, f64::INFINITY);
        }
    }
}

/// Compares one picture; returns how many pixels were left out.
fn compare<R: Exact>(
    case: &Case<Settings>,
    frame: &Frame<R>,
    arithmetic: Arithmetic,
    measured: &mut Measured,
) -> usize {
    let Settings { splats, layers: most } = case.settings;
    let oracle = oracle(case, &splats, arithmetic);
    let mut left_out = 0;
    for (i, x, y) in case.pixels() {
        let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let peeled = peel(&oracle, center, most as usize);
        if peeled.ambiguous {
            left_out += 1;
            continue;
        }
        let place = format!("{arithmetic:?} pixel ({x}, {y}) of {}", case.name);
        let place = place.as_str();
        let mut compare = Compare { frame, i, place, arithmetic, measured: &mut *measured };
        stages(&mut compare, &peeled, most);
        let (mut color, mut alpha, through) = peeled.blend();
        if let Some(environment) = &case.scene.environment {
            let sky = radiance(environment, world_ray(&oracle.optics.eye, center), oracle.step);
            color = [0, 1, 2].map(|c| color[c] + through * sky[c]);
            // 1 - A takes the rounding of A, however little is let through.
            let rounding = |c: usize| alpha.condition.max(oracle.step) * sky[c].value;
            (0..3).for_each(|c| color[c].condition += rounding(c));
            alpha = Conditioned::exact(1.0);
        }
        compare.color("", "", color);
        compare.number("A", "A", alpha);
        compare.exact("layers", peeled.layers.len().min(255) as f64);
        let id = index(frame, "id", i);
        if let Some(first) = peeled.layers.first() {
            compare.number("Z", "Z", first.depth);
            assert!(peeled.nearest.contains(&id), "{place}: {id} of {:?}", peeled.nearest);
        } else {
            compare.exact("Z", f64::INFINITY);
            assert_eq!(id, NO_ID, "{place}");
        }
    }
    left_out
}

#[test]
fn every_stage_of_peeling_equals_the_oracle() {
    let (mut measured, mut worst) = (Measured::default(), [0.0_f64; 2]);
    let by_lot = (0..96).map(|number| {
        let (case, layers) = (transparent::cases::case(number), [64, 2, 1, 9, 256][number % 5]);
        let splats = case.settings.splats;
        case.with(Settings { splats, layers })
    });
    for case in by_lot.chain(goldens::of()) {
        let (narrow, wide) = (case.drawing().frame::<f32>(), case.drawing().frame::<f64>());
        let rounded = if case.exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let pixels = f64::from(case.camera.width * case.camera.height);
        let left = [
            compare(&case, &narrow, Arithmetic::F32, &mut measured) as f64 / pixels,
            compare(&case, &wide, rounded, &mut measured) as f64 / pixels,
        ];
        for (slot, left) in left.into_iter().enumerate() {
            worst[slot] = worst[slot].max(left);
            assert!(left <= 0.01, "{} % left out of {}", left * 100.0, case.name);
        }
    }
    println!("most left out: f32 {:.4}, f64 {:.4}", worst[0], worst[1]);
    measured.check(PEELING);
}
