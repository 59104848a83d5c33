//! The workloads of the benchmarks: random surfels on a sphere.

use glam::{DVec3, Vec3};
use splatref::number::elementary::{cos, sin};
use splatref::number::random::unit;
use splatref::scene::{Camera, Cloud, Lens, Pose, Surfels};
use std::time::Duration;

/// A workload: random surfels on the unit sphere, seen so that its radius is 490 of 1024 px.
pub(crate) struct Workload {
    pub(crate) name: &'static str,
    pub(crate) count: usize,
    pub(crate) radius: f32,
}

/// The three standard workloads.
pub(crate) const STANDARD: [Workload; 3] = [
    Workload { name: "100 k small", count: 100_000, radius: 0.0045 },
    Workload { name: "100 k tight", count: 100_000, radius: 0.0142 },
    Workload { name: "1 M", count: 1_000_000, radius: 0.0045 },
];

/// The camera of all workloads, 1024 x 1024.
pub(crate) fn camera() -> Camera {
    camera_of(1024)
}

/// The same view in this many pixels a side.
pub(crate) fn camera_of(side: u32) -> Camera {
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let focal = 1900.0 * f64::from(side) / 1024.0;
    Camera::new(side, side, pose, Lens::Focal(focal)).expect("a camera")
}

/// Median and minimum in milliseconds, the minimum in brackets.
pub(crate) fn cell(times: &mut [Duration]) -> String {
    times.sort();
    let [median, least] = [times[times.len() / 2], times[0]].map(|t| t.as_secs_f64() * 1e3);
    format!("{median:.1} ({least:.1})")
}

/// Uniform random surfels on the unit sphere, coloured by a smooth function of the position.
pub(crate) fn sphere(workload: &Workload) -> Surfels {
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
