//! Depth peeling by brute force: all fragments of a pixel, one band of depth after the other.

use crate::ewa::cases::Case;
use crate::ewa::model::{Oracle, Seen};
use crate::ewa::stages::{index, oracle};
use crate::kit::condition::Num;
use crate::kit::goldens;
use crate::kit::tolerance::{Arithmetic, Measured};
use crate::transparent::cases::Subject;
use crate::transparent::model::opacity;
use crate::transparent::stages::Compare;
use crate::transparent::surroundings::{radiance, world_ray};
use crate::transparent::tolerance::PEELING;
use splatref::frame::{Exec, Frame, NO_ID};
use splatref::method::peeling::{self, STAGES, Settings};
use splatref::method::{Method, transparent};
use splatref::number::Exact;
use splatref::scene::Groups;

/// One layer of a pixel.
struct Layer {
    depth: Num,
    color: [Num; 3],
    alpha: Num,
    count: usize,
}

/// The layers of a pixel from the front.
struct Peeled {
    ambiguous: bool,
    layers: Vec<Layer>,
    /// The surfels that may be the nearest of all.
    nearest: Vec<u32>,
}

fn peel(oracle: &Oracle<'_>, at: [f64; 2], most: usize) -> Peeled {
    let mut rest = oracle.fragments(at);
    let reach = |seen: &Seen<'_>| seen.1.value.q - oracle.limit();
    rest.retain(|seen| reach(seen) <= oracle.margin(&seen.1));
    let mut ambiguous = rest.iter().any(|seen| oracle.unsure(seen));
    rest.retain(|seen| reach(seen) <= 0.0);
    let nearest = oracle.nearest(&rest);
    let mut layers = Vec::new();
    while !rest.is_empty() && layers.len() < most {
        ambiguous |= oracle.grazes(&rest);
        let seen = oracle.seen(&rest);
        let entries = oracle.entries(at, &rest, &seen);
        let find = |plane| {
            let entry = entries.iter().find(|e| e.plane == plane).expect("of every pixel");
            [0, 1, 2].map(|c| Num { value: entry.value[c], condition: entry.condition[c] })
        };
        let ([depth, ..], [weight, ..]) = (find("Z"), find("weight"));
        let alpha = opacity(oracle, &seen, weight);
        layers.push(Layer { depth, color: find(""), alpha, count: seen.len() });
        rest.retain(|seen| seen.1.value.t > depth.value + oracle.epsilon);
    }
    Peeled { ambiguous, layers, nearest }
}

impl Peeled {
    /// The layers one behind the other: colour over black, opacity, and what is let through.
    fn blend(&self) -> ([Num; 3], Num, Num) {
        let one = Num::exact(1.0);
        let (mut color, mut through) = ([Num::ZERO; 3], one);
        let mut alpha = Num::ZERO;
        for layer in &self.layers {
            let part = through * layer.alpha;
            color = [0, 1, 2].map(|c| color[c] + part * layer.color[c]);
            alpha = alpha + part;
            through = through * (one - layer.alpha);
        }
        (color, alpha, through)
    }
}

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
    subject: &Subject,
    frame: &Frame<R>,
    arithmetic: Arithmetic,
    most: u32,
    measured: &mut Measured,
) -> usize {
    let Case { camera, scene, .. } = &subject.case;
    let oracle = oracle(&subject.case, arithmetic);
    let mut left_out = 0;
    for i in 0..(camera.width * camera.height) {
        let (x, y) = (i % camera.width, i / camera.width);
        let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let peeled = peel(&oracle, center, most as usize);
        if peeled.ambiguous {
            left_out += 1;
            continue;
        }
        let place = format!("{arithmetic:?} pixel ({x}, {y}) of {}", subject.case.name);
        let (place, i) = (place.as_str(), i as usize);
        let mut compare = Compare { frame, i, place, arithmetic, measured: &mut *measured };
        stages(&mut compare, &peeled, most);
        let (mut color, mut alpha, through) = peeled.blend();
        if let Some(environment) = &scene.environment {
            let sky = radiance(environment, world_ray(&oracle.optics.eye, center), oracle.step);
            color = [0, 1, 2].map(|c| color[c] + through * sky[c]);
            // 1 - A takes the rounding of A, however little is let through.
            let rounding = |c: usize| alpha.condition.max(oracle.step) * sky[c].value;
            (0..3).for_each(|c| color[c].condition += rounding(c));
            alpha = Num::exact(1.0);
        }
        compare.color("", "", color);
        compare.number("A", "A", alpha);
        compare.exact("layers", peeled.layers.len().min(255) as f64);
        let id = index(frame, "id", i).expect("a plane id");
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
    let exec = Exec::sequential();
    let (mut measured, mut worst) = (Measured::default(), [0.0_f64; 2]);
    let by_lot = (0..96).map(|number| (Subject::new(number), [64, 2, 1, 9, 256][number % 5]));
    let goldens = goldens::all().into_iter().filter_map(|golden| match golden.method {
        Method::Peeling(settings) => {
            let groups = Groups::new(vec![0; golden.case.scene.surfels.len()], vec![], vec![1.0]);
            let transparent = transparent::Settings::default();
            let groups = groups.expect("one group");
            Some((Subject { case: golden.case, groups, settings: transparent }, settings.layers))
        }
        _ => None,
    });
    for (subject, layers) in by_lot.chain(goldens::at_least(1, goldens.collect())) {
        let Case { scene, camera, exact, settings: splats, .. } = &subject.case;
        let settings = Settings { splats: *splats, layers };
        let narrow = peeling::render::<f32>(scene, camera, &settings, &exec, true);
        let wide = peeling::render::<f64>(scene, camera, &settings, &exec, true);
        let (narrow, wide) = (narrow.expect("renders").frame, wide.expect("renders").frame);
        let rounded = if *exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let pixels = f64::from(camera.width * camera.height);
        let left = [
            compare(&subject, &narrow, Arithmetic::F32, layers, &mut measured) as f64 / pixels,
            compare(&subject, &wide, rounded, layers, &mut measured) as f64 / pixels,
        ];
        for (slot, left) in left.into_iter().enumerate() {
            worst[slot] = worst[slot].max(left);
            assert!(left <= 0.01, "{} % left out of {}", left * 100.0, subject.case.name);
        }
    }
    println!("most left out: f32 {:.4}, f64 {:.4}", worst[0], worst[1]);
    for (key, (worst, place)) in &measured.0 {
        println!("{key:?}: {worst:.3e} {place}");
    }
    let complaints = measured.complaints(PEELING);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
