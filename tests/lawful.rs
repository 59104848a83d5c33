//! No verdict accuses a right renderer: every method draws in a number whose operations are as
//! inexact as a promise allows.
//!
//! A stage reads the planes of the stage before as they are stored, so that each stage rounds anew.
//! `SPLATREF_PICTURES` sets how many pictures are drawn for each scene, method and promise.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

#[path = "../src/number/ball/tests/lawful.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod lawful;

/// What the number is made of.
mod number {
    pub(crate) use splatref::number::{Exact, Real, random};
}

use lawful::{Law, Lawful, begin};
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::{Method, Session};
use splatref::scene::{Camera, Cloud, Environment, Scene, Surfels};
use splatref::source::Shape;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Unlike, Verdict};
use std::collections::BTreeMap;

/// What an implementation may do, and what it promises.
const LAWS: [(Law, Rounding); 3] =
    [(Law::Ieee, Rounding::Ieee), (Law::Precise, Rounding::Precise), (Law::Gpu, Rounding::Gpu)];

/// A shape of about `count` surfels with its camera.
fn of(name: &'static str, count: usize) -> (Scene, Camera) {
    let shape = Shape::by_name(name).unwrap();
    let surfels = shape.surfels(count, 3).unwrap();
    let camera = Camera::new(48, 36, shape.default_pose(), shape.default_lens()).unwrap();
    (Scene::lit(name, surfels), camera)
}

/// Shapes with light, opacities and an environment.
fn scenes() -> Vec<(Scene, Camera)> {
    let (mut torus, camera) = of("torus", 500);
    let opacity = (0..torus.surfels.len()).map(|i| [1.0, 0.25, 0.5, 0.75][i % 4]).collect();
    let cloud = Cloud { opacity: Some(opacity), ..torus.surfels.into_cloud() };
    torus.surfels = Surfels::new(cloud).unwrap().0;
    torus.environment = Some(Environment::Sky);
    vec![of("sphere", 300), (torus, camera), of("cluster", 600), of("checkerboard", 900)]
}

/// A number as it is stored: how it came about is forgotten.
fn store(frame: &mut Frame<Lawful>) {
    let forget = |number: &mut Lawful| *number = number.value.into();
    for plane in &mut frame.planes {
        match &mut plane.samples {
            Samples::Scalar(plane) => plane.values_mut().iter_mut().for_each(forget),
            Samples::Color(plane) | Samples::Vector(plane) => {
                plane.values_mut().iter_mut().flatten().for_each(forget);
            }
            Samples::Index(_) | Samples::Count(_) => {}
        }
    }
}

/// A picture with the planes of all stages.
fn draw(session: &Session<'_>, camera: &Camera) -> Frame<Lawful> {
    match session.method() {
        // One stage draws all layers, and the next asks how many there are.
        Method::Peeling(_) => session.define(camera, true).unwrap().frame,
        _ => session.run_stages(camera, |_, left| store(left)).unwrap(),
    }
}

/// A name, and whether a plane is handed in.
type Part = (&'static str, fn(&str) -> bool);

/// What a client may hand in: all planes, those of the picture, or one of these.
const PARTS: [Part; 7] = [
    ("all planes", |_| true),
    ("the picture", |plane| {
        let stages = ["group", "level", "pull", "push", "layer"];
        !plane.contains('.') && !stages.iter().any(|stage| plane.starts_with(stage))
    }),
    ("colour", str::is_empty),
    ("opacity", |plane| plane == "A"),
    ("depth", |plane| plane == "Z"),
    ("normals", |plane| plane == "normal"),
    ("weights", |plane| plane == "weight"),
];

/// Calls `each` with the verdict on every picture, and what it is of.
fn verdicts(each: &mut dyn FnMut(&str, Rounding, &Verdict)) {
    let pictures = std::env::var("SPLATREF_PICTURES").map_or(4, |text| text.parse().unwrap());
    let exec = Exec::sequential();
    for (scene, camera) in scenes() {
        for method in Method::all() {
            // Some methods draw no opacities.
            let Ok(session) = Session::new(&scene, method, &exec) else { continue };
            let each_law = |law| (0..pictures).map(move |seed| (law, seed));
            for ((law, promise), seed) in LAWS.into_iter().flat_map(each_law) {
                begin(law, seed);
                let frame = draw(&session, &camera);
                for (part, holds) in PARTS {
                    let mut frame = frame.to_f32();
                    frame.planes.retain(|plane| holds(&plane.name));
                    if frame.planes.is_empty() {
                        continue;
                    }
                    let mut client = Client::from(&frame);
                    client.rounding = promise;
                    let verdict = session.verify(&camera, &client, 1.0).unwrap();
                    let of = format!("{}, {}, {seed}, {part}", method.name(), scene.name);
                    each(&of, promise, &verdict);
                }
            }
        }
    }
}

/// The limits of "unlike" are far above the errors of right renderers whose operations are independent.
#[test]
fn what_is_called_unlike_is_far_from_what_is_usual() {
    const PICTURES: u64 = 12;
    let exec = Exec::sequential();
    let (mut near, mut tried) = (Vec::new(), 0);
    for (scene, camera) in scenes() {
        for method in Method::all() {
            let Ok(session) = Session::new(&scene, method, &exec) else { continue };
            let mut found: BTreeMap<(&str, usize), Vec<f64>> = BTreeMap::new();
            // A seed of 3 mod 4 always errs to one side.
            for seed in (0..).filter(|seed| seed % 4 != 3).take(PICTURES as usize) {
                begin(Law::Gpu, 1_000 + seed);
                let client = Client::from(&draw(&session, &camera).to_f32());
                let verdict = session.verify(&camera, &client, 1.0).unwrap();
                for stage in &verdict.stages {
                    let Some(limits) = Unlike::limits(stage.stage) else { continue };
                    let Some(errors) = stage.quantiles(limits.map(|(quantile, _)| quantile)) else {
                        continue;
                    };
                    for (i, error) in errors.into_iter().enumerate() {
                        found.entry((stage.stage, i)).or_default().push(error);
                    }
                }
            }
            for ((stage, i), errors) in
                found.iter().filter(|(_, all)| all.len() == PICTURES as usize)
            {
                let (_, limit) = Unlike::limits(stage).unwrap()[*i];
                let mean = errors.iter().sum::<f64>() / PICTURES as f64;
                let squares: f64 = errors.iter().map(|error| (error - mean).powi(2)).sum();
                let deviation = (squares / (PICTURES - 1) as f64).sqrt();
                tried += 1;
                // An error of 1 is wrong by itself.
                if limit < 1.0 && !(mean + 6.0 * deviation <= limit) {
                    let of = format!("{}, {}: {stage}, {i}", method.name(), scene.name);
                    near.push(format!("{of}: {mean:.3} +- {deviation:.3}, limit {limit}"));
                }
            }
        }
    }
    assert!(tried > 100 && near.is_empty(), "{} of {tried}: {near:#?}", near.len());
}

#[test]
fn no_right_picture_is_called_wrong_or_unlike() {
    let mut accused = Vec::new();
    verdicts(&mut |of, promise, verdict| {
        if let Some(stage) = verdict.first_wrong() {
            accused.push(format!("{of}, {promise:?}: {}, {:?}", stage.stage, stage.worst));
        }
        accused.extend(verdict.unlike.iter().map(|unlike| format!("{of}, {promise:?}: {unlike}")));
    });
    assert!(accused.is_empty(), "{} pictures: {accused:#?}", accused.len());
}
