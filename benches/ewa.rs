//! Speed of EWA splatting: the table of `docs/ewa.md`.
//!
//! `cargo bench --bench ewa` prints Markdown, and with `--write` puts the table into that page; an
//! argument is a pattern that the names of workloads must contain. Each row is the median over the frames of one run, the minimum in brackets, in
//! milliseconds: both geometry passes and the normalization, `f32`, back faces culled, into a
//! framebuffer that is kept from frame to frame: colour, weight, depth and id, or also normals.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, Workload, camera, cell, sphere};
use splatref::Result;
use splatref::frame::{Exec, Framebuffer, Wanted};
use splatref::method::ewa::{Settings, fast};
use splatref::scene::Surfels;
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
        let surfels = sphere(workload);
        for (name, kernel, normal) in VARIANTS {
            for threads in [1, 2] {
                let mut times = measure(&surfels, kernel, normal, threads);
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

/// The times of the frames, and of each stage.
fn measure(surfels: &Surfels, kernel: Kernel, normal: bool, threads: usize) -> [Vec<Duration>; 5] {
    let camera = camera();
    let settings = Settings { kernel, ..Settings::default() };
    let exec = Exec::new(threads, 32).expect("threads");
    let wanted = Wanted { normal, color: true, observed: false };
    let mut target = Framebuffer::new(1024, 1024, 0.0, wanted);
    let mut columns = [const { Vec::new() }; 5];
    let start = Instant::now();
    // At least 9 frames, then up to 101 within two seconds.
    while columns[0].len() < 9 || (columns[0].len() < 101 && start.elapsed().as_secs() < 2) {
        let frame = Instant::now();
        let (_, times) = fast::render(surfels, &camera, &settings, &exec, &mut target);
        let all =
            [frame.elapsed(), times.project, times.visibility, times.attributes, times.normalize];
        columns.iter_mut().zip(all).for_each(|(column, time)| column.push(time));
    }
    columns
}
