//! Time by the side of a tile: the table of `docs/ewa.md` that says whether the cost of a picture
//! follows what its splats touch.
//!
//! `cargo bench --bench tiles` prints Markdown, and with `--write` puts the table into that page; an
//! argument is a pattern that the names of workloads must contain. The workloads are splats that
//! touch many tiles: random surfels on a sphere of 1960 px radius in a picture of 4096 x 4096, half
//! of them culled. Each cell is the median over the frames of one run, the minimum in brackets, in
//! milliseconds: `ewa` with the projection, without shading; the sides take turns.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{Workload, camera_of, cell, sphere};
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::{Session, ewa};
use splatref::scene::Scene;
use std::time::Duration;

/// At the nearest point of the sphere a world unit is 2533 px.
const WORKLOADS: [Workload; 3] = [
    Workload { name: "100 k of 10 px", count: 200_000, radius: 0.0042 },
    Workload { name: "100 k of 35 px", count: 200_000, radius: 0.0147 },
    Workload { name: "1 k of 400 px", count: 2_000, radius: 0.168 },
];
const SIDES: [u32; 4] = [8, 16, 32, 64];
const FRAMES: usize = 5;

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let mut table =
        Table::new(&["workload", "threads", "8 px tiles", "16", "32", "64", "slowest / fastest"]);
    for workload in WORKLOADS.iter().filter(|w| w.name.contains(&arguments.pattern)) {
        let scene = Scene::unlit(workload.name, sphere(workload));
        for threads in [1, 2] {
            let mut times = measure(&scene, threads)?;
            let cells: Vec<_> = times.iter_mut().map(|times| cell(times)).collect();
            let mut medians = times.map(|times| times[FRAMES / 2].as_secs_f64());
            medians.sort_by(f64::total_cmp);
            let ratio = medians[3] / medians[0];
            table.row(&format!(
                "{} | {threads} | {} | {ratio:.2}",
                workload.name,
                cells.join(" | ")
            ));
        }
    }
    table.publish_times(&arguments, "ewa.md", "tiles")
}

/// The times of frames by the side of a tile.
fn measure(scene: &Scene, threads: usize) -> Result<[Vec<Duration>; 4]> {
    let camera = camera_of(4096);
    let execs = SIDES.map(|side| Exec::new(threads, side));
    let mut sessions = Vec::new();
    for exec in &execs {
        let exec = exec.as_ref().map_err(|error| splatref::Error::Invalid(error.to_string()))?;
        sessions.push(Session::new(scene, ewa::Settings::default().into(), exec)?);
    }
    let mut times = [const { Vec::new() }; 4];
    // One round more, whose times are those of the first use of memory.
    for round in 0..=FRAMES {
        for (session, times) in sessions.iter_mut().zip(&mut times) {
            let timings = &session.render(&camera)?.timings;
            let laps = timings.iter().filter(|(stage, _)| *stage != "shading");
            let time: Duration = laps.map(|(_, time)| *time).sum();
            if round > 0 {
                times.push(time);
            }
        }
    }
    Ok(times)
}
