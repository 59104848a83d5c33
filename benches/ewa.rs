//! Speed and memory of EWA splatting: the tables of the README.
//!
//! `cargo bench --bench ewa` prints Markdown; an argument is a pattern that the names of workloads
//! must contain. Each row is the median over the frames of one run, the minimum in brackets, in
//! milliseconds: both geometry passes and the normalization, `f32`, back faces culled, into a
//! framebuffer that is kept from frame to frame: colour, weight, depth and id, or also normals.

use glam::{DVec3, Vec3};
use splatref::frame::{Exec, Framebuffer, Wanted};
use splatref::method::ewa::{Settings, fast};
use splatref::number::elementary::{cos, sin};
use splatref::number::random::unit;
use splatref::scene::{Camera, Cloud, Lens, Pose, Surfels};
use splatref::splat::Kernel;
use std::time::{Duration, Instant};

/// A workload: random surfels on the unit sphere, seen so that its radius is 490 of 1024 px.
struct Workload {
    name: &'static str,
    count: usize,
    radius: f32,
}

/// The three standard workloads, and a series of about five layers of discs a pixel.
const WORKLOADS: [Workload; 7] = [
    Workload { name: "100 k small", count: 100_000, radius: 0.0045 },
    Workload { name: "100 k tight", count: 100_000, radius: 0.0142 },
    Workload { name: "1 M", count: 1_000_000, radius: 0.0045 },
    Workload { name: "10 k", count: 10_000, radius: 0.045 },
    Workload { name: "10 M", count: 10_000_000, radius: 0.00142 },
    Workload { name: "1 k of 300 px", count: 2_000, radius: 0.6 },
    Workload { name: "1 M of 1 px", count: 1_000_000, radius: 0.0015 },
];

fn main() {
    // cargo passes --bench.
    let pattern = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    println!(
        "| workload | kernel | planes | threads | frame | projection | visibility | attributes | normalization |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for workload in WORKLOADS.iter().filter(|w| w.name.contains(&pattern)) {
        let surfels = sphere(workload);
        for (name, kernel, normal) in VARIANTS {
            for threads in [1, 2] {
                let times = measure(&surfels, kernel, normal, threads);
                let planes = if normal { "colour, normal" } else { "colour" };
                let cells: Vec<_> =
                    times.iter().map(|t| format!("{} ({})", ms(t.0), ms(t.1))).collect();
                let cells = cells.join(" | ");
                println!("| {} | {name} | {planes} | {threads} | {cells} |", workload.name);
            }
        }
    }
}

/// Kernel, and whether normals are wanted.
const VARIANTS: [(&str, Kernel, bool); 3] = [
    ("ZPvBG01", Kernel::ZPVBG01, false),
    ("default", Kernel::DEFAULT, false),
    ("default", Kernel::DEFAULT, true),
];

fn ms(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1e3)
}

/// Median and minimum of the frame and of each stage.
fn measure(
    surfels: &Surfels,
    kernel: Kernel,
    normal: bool,
    threads: usize,
) -> Vec<(Duration, Duration)> {
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(1024, 1024, pose, Lens::Focal(1900.0)).expect("a camera");
    let settings = Settings { kernel, ..Settings::default() };
    let exec = Exec::new(threads, 32).expect("threads");
    let wanted = Wanted { normal, color: true, observed: false };
    let mut target = Framebuffer::new(1024, 1024, 0.0, wanted);
    let mut columns = vec![Vec::new(); 5];
    let start = Instant::now();
    // At least 9 frames, then up to 101 within two seconds.
    while columns[0].len() < 9 || (columns[0].len() < 101 && start.elapsed().as_secs() < 2) {
        let frame = Instant::now();
        let (_, times) = fast::render(surfels, &camera, &settings, &exec, &mut target);
        let all =
            [frame.elapsed(), times.project, times.visibility, times.attributes, times.normalize];
        columns.iter_mut().zip(all).for_each(|(column, time)| column.push(time));
    }
    let summary = |column: &mut Vec<Duration>| {
        column.sort();
        (column[column.len() / 2], column[0])
    };
    columns.iter_mut().map(summary).collect()
}

/// Uniform random surfels on the unit sphere, coloured by a smooth function of the position.
fn sphere(workload: &Workload) -> Surfels {
    let point = |i: usize| {
        let z = 2.0 * f64::from(unit(1, 2 * i as u64)) - 1.0;
        let angle = std::f64::consts::TAU * f64::from(unit(1, 2 * i as u64 + 1));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos(angle), r * sin(angle), z)
    };
    let position: Vec<Vec3> = (0..workload.count).map(|i| point(i).as_vec3()).collect();
    let wave = |p: &Vec3| {
        let [x, y, z] = p.to_array().map(f64::from);
        DVec3::new(sin(9.0 * x), sin(11.0 * y + 1.0), sin(7.0 * z + 2.0)).as_vec3() * 0.5 + 0.5
    };
    let cloud = Cloud {
        color: Some(position.iter().map(wave).collect()),
        normal: Some(position.clone()),
        radius: Some(vec![workload.radius; workload.count]),
        position,
        ..Cloud::default()
    };
    Surfels::new(cloud).expect("a sphere").0
}
