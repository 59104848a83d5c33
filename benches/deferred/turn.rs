//! Holes and bleeding after a fast turn, with and without pass 3 \[GBP04, Fig. 3\].
//!
//! A model stands before a board, both at rest for three frames; in the next frame the model is turned,
//! and then it rests again. The reference of a frame is the picture of `ewa` of all
//! surfels of that frame; [`super::wrong`] says which pixels are wrong.

use super::common::chart::{Axis, Series, svg};
use super::common::models::models;
use super::common::report::{Arguments, Table};
use super::stage::{REST, Stage, object_of};
use super::wrong::{Seen, Wrong};
use splatref::Result;
use splatref::frame::{Exec, Frame};
use splatref::method::{Method, Session, deferred, ewa};
use splatref::scene::{Camera, Scene};
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};
use splatref::source::flatten;

const DEGREES: [f64; 11] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
/// The side of the picture, and m, how many surfels share a flag.
const VIEWS: [(u32, u32); 4] = [(192, 64), (384, 1), (384, 64), (768, 64)];
/// The size at which kinds of errors and frames after turns are looked at, and the m of the chart.
const CHARTED: (u32, u32) = (384, 64);
/// The turns of which each kind of error is counted, at the size of the chart.
const KINDS: [f64; 2] = [0.0, 32.0];
/// What the chart shows of a share of 0, in per cent.
const LEAST: f64 = 0.001;

/// The frame of the turn and the one after it, first without pass 3 and then with it.
type Turned = [[Wrong; 2]; 2];

pub(crate) fn tables(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let titles = DEGREES.map(|degrees| format!("{degrees}°"));
    let mut columns = vec!["scene", "side, px", "m", "pass 3", "frame"];
    columns.extend(titles.iter().map(String::as_str));
    let mut shares = Table::new(&columns);
    let (mut kinds, mut series) = (Vec::new(), Vec::new());
    for (name, stage) in stages(arguments, exec)? {
        for (side, flags) in VIEWS {
            let frames = ["turned", "after"];
            let frames = &frames[..1 + usize::from(side == CHARTED.0)];
            let found = measured(&stage, flags, frames.len(), &Stage::camera(side)?, exec)?;
            for (second, pass) in ["off", "on"].into_iter().enumerate() {
                for (after, frame) in frames.iter().enumerate() {
                    let cells = found.iter().map(|of| format!("{:.3}", of[second][after].share()));
                    let cells = cells.collect::<Vec<_>>().join(" | ");
                    shares.row(&format!("{name} | {side} | {flags} | {pass} | {frame} | {cells}"));
                }
                let turned = || DEGREES.iter().zip(found.iter().map(|of| of[second][0]));
                if side == CHARTED.0 {
                    let of_kinds = turned().filter(|(degrees, _)| KINDS.contains(degrees));
                    kinds.extend(of_kinds.map(|(degrees, wrong)| {
                        format!("{name} | {degrees}° | {flags} | {pass} | {}", cells(&wrong))
                    }));
                }
                if (side, flags) == CHARTED {
                    let points = turned().filter(|(degrees, _)| **degrees > 0.0);
                    let points = points.map(|(degrees, wrong)| {
                        let share = wrong.share();
                        [*degrees, if share > LEAST { share } else { LEAST }]
                    });
                    let name = format!("{name}, pass 3 {pass}");
                    series.push(Series { name, points: points.collect() });
                }
            }
        }
    }
    shares.publish(arguments, "gbp04.md", "turn")?;
    publish_kinds(&kinds, arguments)?;
    arguments.write("gbp04-turn.svg", &chart(&series))
}

fn publish_kinds(kinds: &[String], arguments: &Arguments) -> Result<()> {
    let mut table = Table::new(&[
        "scene",
        "turn",
        "m",
        "pass 3",
        "compared, px",
        "holes, %",
        "spill, %",
        "another surface, %",
        "another colour, %",
        "all, %",
        "gaps, px",
    ]);
    kinds.iter().for_each(|row| table.row(row));
    table.publish(arguments, "gbp04.md", "kinds")
}

/// The scenes whose names contain the pattern.
fn stages(arguments: &Arguments, exec: &Exec) -> Result<Vec<(&'static str, Stage)>> {
    let mut all = Vec::new();
    for (name, shape, lean) in [("sphere", Shape::Sphere, 0.0), ("torus", Shape::Torus, 60.0)] {
        if name.contains(&arguments.pattern) {
            all.push((name, Stage::new(shape.surfels(40_000, 0)?, lean)?));
        }
    }
    for (name, cloud) in models(&arguments.pattern, arguments)? {
        if name == "bunny" {
            let derived = derive::surfels(cloud, &Derive::default(), exec, &|_, _, _| ())?;
            all.push((name, Stage::new(derived.0, 0.0)?));
        }
    }
    Ok(all)
}

/// For each turn what is wrong, in so many frames.
fn measured(
    stage: &Stage,
    flags: u32,
    frames: usize,
    camera: &Camera,
    exec: &Exec,
) -> Result<Vec<Turned>> {
    let method = |second| Method::from(deferred::Settings { second, flags, ..Default::default() });
    let rest = stage.scene(0.0, REST)?;
    let mut session = Session::new(&rest, method(true), exec)?;
    for _ in 0..=REST {
        session.render(camera)?;
    }
    let state = session.seen().cloned();
    let mut found = Vec::new();
    for degrees in DEGREES {
        let scene = stage.scene(degrees, REST + 1)?;
        let (reference, epsilon) = reference(&scene, camera, exec)?;
        let mut turned = Turned::default();
        for (second, of) in turned.iter_mut().enumerate() {
            let mut session = Session::new(&scene, method(second == 1), exec)?;
            session.resume(state.clone());
            for wrong in &mut of[..frames] {
                let drawn = seen(&session.render(camera)?.frame, &scene)?;
                *wrong = Wrong::count(&drawn, &reference, epsilon);
            }
        }
        found.push(turned);
    }
    Ok(found)
}

/// The picture of all surfels, and epsilon in world units.
fn reference(scene: &Scene, camera: &Camera, exec: &Exec) -> Result<(Seen, f32)> {
    let flat = Scene { objects: None, ..flatten(scene, exec)? };
    let settings = ewa::Settings::default();
    let epsilon = settings.epsilon.resolve(&flat.surfels);
    let mut session = Session::new(&flat, settings.into(), exec)?;
    let ids = scene.objects.as_ref().map(|objects| objects.ids());
    let object = |index| ids.and_then(|ids| object_of(ids, index));
    Ok((Seen::of(&session.render(camera)?.frame, object)?, epsilon))
}

fn seen(frame: &Frame<f32>, scene: &Scene) -> Result<Seen> {
    let ids = scene.objects.as_ref().map(|objects| objects.ids());
    Seen::of(frame, |id| ids.and_then(|ids| ids.find(u64::from(id))).map(|(object, _)| object))
}

fn cells(wrong: &Wrong) -> String {
    let Wrong { covered, holes, spill, surface, color, gaps } = *wrong;
    let kinds = [holes, spill, surface, color].map(|n| format!("{:.3}", wrong.percent(n)));
    format!("{covered} | {} | {:.3} | {gaps}", kinds.join(" | "), wrong.share())
}

fn chart(series: &[Series]) -> String {
    let x = Axis { title: "degrees between two frames", ticks: DEGREES[1..].to_vec() };
    let ticks = vec![0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
    let y = Axis { title: "wrong pixels, per cent of the covered ones", ticks };
    let (side, flags) = CHARTED;
    svg(&format!("The frame of a turn, {side} x {side}, m = {flags}"), [&x, &y], series, ("", &[]))
}
