//! How far each stage of each method is from what the machine can do: the tables of
//! `docs/limits.md`.
//!
//! `cargo bench --profile release --bench limits` prints Markdown, and with `--write` puts the tables into that page;
//! an argument is a pattern that the names of workloads must contain. One thread, `f32`, default
//! settings, lit scenes, in the memory of a session. A time is the median over the frames of one
//! run.
//!
//! The operations of a stage are counted by drawing with a number that counts: the stage runs alone,
//! by its definition, on the planes of the stages before it. What it repeats of the projection is
//! counted apart and taken away. Counting is slow, so it draws a sixteenth of the surfels, each of
//! four times the radius, in 256 x 256 pixels: a splat has as many pixels, and a pixel as many
//! splats. Bytes are those that must cross memory at least: the surfels that a projection reads, and
//! the planes of the picture that a stage leaves.

#[path = "../common/mod.rs"]
mod common;
mod counted;
mod operations;
mod roofs;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, Workload, camera, camera_of, sphere};
use counted::Counted;
use operations::Operations;
use roofs::Roofs;
use splatref::Result;
use splatref::composite::decide;
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::{Method, Session, Stage};
use splatref::scene::{Scene, Surfels};
use splatref::splat::gaussian::{GaussianProjector, GaussianShape};
use splatref::splat::{Projector, Shared, SplatSettings, View, batch, fragment, project};
use std::time::{Duration, Instant};

/// How many times as many surfels and pixels are drawn as are counted.
const PART: usize = 16;
/// The side of a picture with a part of the pixels.
const SMALL: u32 = 256;
/// Position, normal, radius and colour.
const SURFEL_BYTES: f64 = 40.0;

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(1, 32)?);
    let roofs = Roofs::measure();
    let mut table = Table::new(&["one thread of this machine", "rate"]);
    for (what, seconds, unit) in [
        ("copy, bytes read and written", roofs.byte, "GB/s"),
        ("+ - * < in lanes", roofs.short, "10^9/s"),
        ("/ and sqrt in lanes", roofs.long, "10^9/s"),
        ("exp and pow in lanes", roofs.exp, "10^9/s"),
    ] {
        table.row(&format!("{what} | {:.1} {unit}", 1e-9 / seconds));
    }
    table.publish_times(&arguments, "limits.md", "roofs")?;

    let mut table = Table::new(&[
        "workload",
        "method",
        "stage",
        "ms",
        "ns a fragment",
        "operations, 10^6",
        "MB",
        "least, ms",
        "bound by",
        "times the least",
    ]);
    for workload in STANDARD.iter().filter(|w| w.name.contains(&arguments.pattern)) {
        let scene = Scene::lit(workload.name, sphere(workload));
        let small = Workload {
            count: workload.count / PART,
            radius: workload.radius * (PART as f32).sqrt(),
            ..*workload
        };
        let small = Scene::lit(workload.name, sphere(&small));
        for method in Method::all() {
            let fragments = fragments(&scene.surfels, method.splats());
            for Row { stages, time, work } in rows(&scene, &small, method, &exec)? {
                let Work { operations, bytes } = work;
                let (ms, bound) = (time.as_secs_f64() * 1e3, roofs.bound(&operations, bytes));
                let each = fragments.map_or_else(String::new, |n| format!("{:.2}", ms * 1e6 / n));
                table.row(&format!(
                    "{} | {} | {stages} | {ms:.1} | {each} | {:.1} | {:.1} | {:.2} | {} | {:.1}",
                    workload.name,
                    method.name(),
                    (operations.short + operations.long + operations.exp) / 1e6,
                    bytes / 1e6,
                    bound.seconds * 1e3,
                    bound.by,
                    ms / (bound.seconds * 1e3),
                ));
            }
        }
    }
    table.publish_times(&arguments, "limits.md", "limits")
}

/// A stage, or several that the fast path runs in one: its time, and what it must do.
struct Row {
    stages: &'static str,
    time: Duration,
    work: Work,
}

/// The laps of a method, in their order.
fn rows(scene: &Scene, small: &Scene, method: Method, exec: &Exec) -> Result<Vec<Row>> {
    let all = work(small, method, exec)?;
    let mut rows = Vec::new();
    for (stages, time) in measured(scene, method, exec)? {
        let own = all.iter().filter(|(name, _)| stages.split(" and ").any(|stage| stage == *name));
        if let Some(work) = own.map(|(_, work)| *work).reduce(Work::plus) {
            rows.push(Row { stages, time, work });
        }
    }
    Ok(rows)
}

/// The median time of each lap, of the fast path.
fn measured(scene: &Scene, method: Method, exec: &Exec) -> Result<Vec<(&'static str, Duration)>> {
    let mut session = Session::new(scene, method, exec)?;
    let mut frames = Vec::new();
    let begin = Instant::now();
    // The first frame takes the memory; then at least 5, and up to 31 within two seconds.
    while frames.len() < 6 || (frames.len() < 32 && begin.elapsed().as_secs() < 2) {
        frames.push(session.render(&camera())?.timings.clone());
    }
    let steady = &frames[1..];
    let median = |stage: usize| {
        let mut times: Vec<_> = steady.iter().map(|laps| laps[stage].1).collect();
        times.sort();
        times[times.len() / 2]
    };
    let names = steady[0].iter().enumerate();
    Ok(names.map(|(stage, (name, _))| (*name, median(stage))).collect())
}

/// What a stage must do in the whole picture.
#[derive(Clone, Copy)]
struct Work {
    operations: Operations,
    bytes: f64,
}

impl Work {
    /// Both.
    fn plus(self, other: Self) -> Self {
        let operations = self.operations.plus(other.operations);
        Self { operations, bytes: self.bytes + other.bytes }
    }
}

/// What each stage does in a picture of a part of the scene, times the parts.
fn work(scene: &Scene, method: Method, exec: &Exec) -> Result<Vec<(&'static str, Work)>> {
    let session = Session::new(scene, method, exec)?;
    let camera = camera_of(SMALL);
    let frame = session.define::<Counted>(&camera, true)?.frame;
    let shown = session.define::<Counted>(&camera, false)?.frame;
    let projection = projected(&scene.surfels, &method);
    let of_stage = |stage: &Stage| {
        let own = match session.stage(&camera, stage.name, &frame) {
            // Its records are no planes.
            Err(_) => projection,
            Ok(_) => {
                let (_, all) = Operations::of(|| session.stage(&camera, stage.name, &frame));
                let again = stage.reads.contains(&"projection") && !leaves_planes(method);
                if again { all.without(projection) } else { all }
            }
        };
        let parts = PART as f64;
        let read =
            if stage.reads.is_empty() { SURFEL_BYTES * scene.surfels.len() as f64 } else { 0.0 };
        let bytes = parts * (read + written(stage, &shown));
        (stage.name, Work { operations: own.times(parts), bytes })
    };
    Ok(method.stages().iter().map(of_stage).collect())
}

/// Whether the projection of a method leaves planes, which later stages read.
fn leaves_planes(method: Method) -> bool {
    let first = &method.stages()[0];
    first.name == "projection" && !first.leaves.is_empty()
}

/// The bytes of the planes of the picture that a stage leaves, in `f32`.
fn written(stage: &Stage, shown: &Frame<Counted>) -> f64 {
    let bytes = |name| match shown.plane(name) {
        Some(Samples::Scalar(plane)) => 4 * plane.values().len(),
        Some(Samples::Color(plane) | Samples::Vector(plane)) => 12 * plane.values().len(),
        Some(Samples::Index(plane)) => 4 * plane.values().len(),
        Some(Samples::Count(plane)) => plane.values().len(),
        None => 0,
    };
    stage.leaves.iter().map(|row| bytes(row.name)).sum::<usize>() as f64
}

/// What the projection of all surfels to splats or Gaussians does.
fn projected(surfels: &Surfels, method: &Method) -> Operations {
    let view = View::<Counted>::new(&camera_of(SMALL));
    let work = || match (method, method.splats()) {
        (Method::Gaussians(settings), _) => {
            let projector = GaussianProjector::new(view, &settings.kernel);
            for i in 0..surfels.len() {
                let shape = GaussianShape::of_surfel(surfels, i, settings.cutoff);
                let _ = projector.project(&shape);
            }
        }
        (_, Some(splats)) => {
            let projector = Projector::new(view, &splats.kernel, splats.cull);
            for i in 0..surfels.len() {
                let _ = project(&projector, &batch::disc(surfels, i), i as u32);
            }
        }
        _ => {}
    };
    Operations::of(work).1
}

/// How many fragments the splats of a method have; none: it draws no splats.
fn fragments(surfels: &Surfels, splats: Option<&SplatSettings>) -> Option<f64> {
    let (splats, view) = (splats?, View::<f32>::new(&camera()));
    let shared = Shared::new(&view, &splats.kernel);
    let projector = Projector::new(view, &splats.kernel, splats.cull);
    let mut sum = 0_u64;
    for i in 0..surfels.len() {
        let (splat, reasons) = project(&projector, &batch::disc(surfels, i), i as u32);
        if reasons.any() {
            continue;
        }
        let bounds = splat.bounds;
        for at in (bounds.y0..bounds.y1).flat_map(|y| (bounds.x0..bounds.x1).map(move |x| (x, y))) {
            let (q, _) = fragment(&shared, &splat.footprint, at);
            sum += u64::from(decide::inside(q, shared.limit));
        }
    }
    Some(sum as f64)
}
