//! Speed of EWA splatting: the table of `docs/ewa.md`.
//!
//! `cargo bench --bench ewa` prints Markdown, and with `--write` puts the table into that page; an
//! argument is a pattern that the names of workloads must contain. Each row is the median over the
//! frames of one run, the minimum in brackets, in milliseconds: both geometry passes and the
//! normalization, `f32`, back faces culled, in the memory of a session: colour, weight, depth and
//! id, or also normals, which a lit scene needs. The shading that follows is not in the times.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, Workload, camera, cell, sphere};
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::{Session, ewa};
use splatref::scene::{Light, Scene};
use splatref::splat::Kernel;
use std::time::{Duration, Instant};

/// With the tight and the 1 M one, a series of about five layers of discs a pixel; extremes of
/// size.
const MORE: [Workload; 4] = [
    Workload { name: "10 k", count: 10_000, radius: 0.045 },
    Workload { name: "10 M", count: 10_000_000, radius: 0.00142 },
    Workload { name: "1 k of 300 px", count: 2_000, radius: 0.6 },
    Workload { name: "1 M of 1 px", count: 1_000_000, radius: 0.0015 },
];

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let mut table = Table::new(&[
        "workload",
        "kernel",
        "planes",
        "threads",
        "frame",
        "projection",
        "visibility",
        "attributes",
        "normalization",
    ]);
    let workloads = STANDARD.iter().chain(&MORE);
    for workload in workloads.filter(|w| w.name.contains(&arguments.pattern)) {
        let mut scene = Scene::unlit(workload.name, sphere(workload));
        for (name, kernel, normal) in VARIANTS {
            scene.lights = if normal { vec![Light::DEFAULT] } else { Vec::new() };
            for threads in [1, 2] {
                let mut times = measure(&scene, kernel, threads)?;
                let planes = if normal { "colour, normal" } else { "colour" };
                let cells: Vec<_> = times.iter_mut().map(|column| cell(column)).collect();
                let cells = cells.join(" | ");
                table.row(&format!("{} | {name} | {planes} | {threads} | {cells}", workload.name));
            }
        }
    }
    table.publish_times(&arguments, "ewa.md", "ewa")
}

/// Kernel, and whether normals are wanted.
const VARIANTS: [(&str, Kernel, bool); 3] = [
    ("ZPvBG01", Kernel::ZPVBG01, false),
    ("default", Kernel::DEFAULT, false),
    ("default", Kernel::DEFAULT, true),
];

/// The times of the frames without shading, and of each stage.
fn measure(scene: &Scene, kernel: Kernel, threads: usize) -> Result<[Vec<Duration>; 5]> {
    let camera = camera();
    let settings = ewa::Settings { kernel, ..ewa::Settings::default() };
    let exec = Exec::new(threads, 32)?;
    let mut session = Session::new(scene, settings.into(), &exec)?;
    let mut columns = [const { Vec::new() }; 5];
    let start = Instant::now();
    // At least 9 frames, then up to 101 within two seconds.
    while columns[0].len() < 9 || (columns[0].len() < 101 && start.elapsed().as_secs() < 2) {
        let laps = session.render(&camera)?.timings.iter().filter(|(stage, _)| *stage != "shading");
        let laps: Vec<Duration> = laps.map(|(_, time)| *time).collect();
        let all = std::iter::once(laps.iter().sum()).chain(laps);
        columns.iter_mut().zip(all).for_each(|(column, time)| column.push(time));
    }
    Ok(columns)
}
