//! The speed of 3D Gaussian splats: the fast path, the definition as a plain loop, and the order of
//! each pixel's own.
//!
//! `cargo bench --bench gaussians` prints Markdown, and with `--write` puts the table into
//! `docs/gaussians.md`; an argument is a pattern that the names of scenes must contain. The capture is
//! procedural: 1 M Gaussians around the ground and some balls, in the proportions of trained files:
//! flat, of log-normal sizes, a third of them nearly opaque and a third nearly clear, harmonics of
//! degree 3; 1920 x 1080 pixels. The other scenes are the standard workloads, as surfels whose radius
//! is 3 standard deviations. Every round draws one frame of each column, from the scene to finished
//! planes. Times are medians over the rounds, the minimum in brackets; a ratio is the median over the
//! rounds.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, camera, cell, sphere};
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::gaussians::Settings;
use splatref::method::{Method, Session};
use splatref::number::elementary::{cos, exp, ln, sin};
use splatref::number::random::unit;
use splatref::scene::gaussians::{Encoding, GaussianArrays, coefficients};
use splatref::scene::{Camera, Gaussians, Lens, Pose, Scene};
use std::time::{Duration, Instant};

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(0, 32)?);
    let mut table = Table::new(&[
        "scene",
        "splats",
        "`inria`, ms",
        "definition, ms",
        "ratio",
        "`exact`, ms",
        "ratio",
    ]);
    let standard = STANDARD.iter().map(|workload| {
        let scene = Scene::unlit(workload.name, sphere(workload));
        (scene, camera())
    });
    let pose = Pose { eye: DVec3::new(0.0, 1.5, 6.0), target: DVec3::ZERO, up: DVec3::Y };
    let wide = Camera::new(1920, 1080, pose, Lens::FieldOfView(50.0))?;
    let capture = Scene::of_gaussians("capture, 1 M", capture(1_000_000)?);
    for (scene, camera) in standard.chain([(capture, wide)]) {
        if !scene.name.contains(&arguments.pattern) {
            continue;
        }
        let [mut fast, mut plain, mut exact] = draw(&scene, &camera, &exec)?;
        let ratios = [ratio(&plain, &fast), ratio(&exact, &fast)];
        let count = scene.gaussians.as_ref().map_or(scene.surfels.len(), Gaussians::len);
        table.row(&format!(
            "{} | {count} | {} | {} | {:.1} | {} | {:.1}",
            scene.name,
            cell(&mut fast),
            cell(&mut plain),
            ratios[0],
            cell(&mut exact),
            ratios[1]
        ));
    }
    table.publish_times(&arguments, "gaussians.md", "gaussians")
}

/// The times of the fast path, of the definition, and of an order of each pixel's own.
fn draw(scene: &Scene, camera: &Camera, exec: &Exec) -> Result<[Vec<Duration>; 3]> {
    let [inria, exact] = [Settings::INRIA, Settings::EXACT].map(Method::from);
    let mut fast = Session::new(scene, inria, exec)?;
    let mut own = Session::new(scene, exact, exec)?;
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    // The first round takes the memory.
    for round in 0..6 {
        let start = Instant::now();
        fast.render(camera)?;
        let drawn = start.elapsed();
        let start = Instant::now();
        fast.define::<f32>(camera, false)?;
        let defined = start.elapsed();
        let start = Instant::now();
        own.render(camera)?;
        for (times, time) in times.iter_mut().zip([drawn, defined, start.elapsed()]) {
            times.extend((round > 0).then_some(time));
        }
    }
    Ok(times)
}

/// The median of the ratios of two columns, round by round.
fn ratio(column: &[Duration], base: &[Duration]) -> f64 {
    let mut ratios: Vec<f64> =
        column.iter().zip(base).map(|(a, b)| a.as_secs_f64() / b.as_secs_f64()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

/// Gaussians around the ground and some balls.
fn capture(count: u64) -> Result<Gaussians> {
    let one = |i: u64, k: u64| f64::from(unit(3, 80 * i + k));
    // The sum of two normal numbers' halves: Box and Muller.
    let normal = |i: u64, k: u64| {
        let away = (-2.0 * ln(one(i, k) + 1e-9)).sqrt();
        away * cos(std::f64::consts::TAU * one(i, k + 1))
    };
    let position = |i: u64| {
        let (a, b) = (one(i, 0), one(i, 1));
        if i.is_multiple_of(2) {
            return DVec3::new(8.0 * a - 4.0, 0.02 * normal(i, 2) - 1.0, 8.0 * b - 5.0);
        }
        let (z, angle) = (2.0 * a - 1.0, std::f64::consts::TAU * b);
        let around =
            DVec3::new((1.0 - z * z).sqrt() * cos(angle), z, (1.0 - z * z).sqrt() * sin(angle));
        let ball = (i / 2 % 7) as f64;
        let center = DVec3::new(1.2 * (ball - 3.0), 0.2 * (ball % 3.0), -(ball % 2.0));
        center + around * (0.6 + 0.01 * normal(i, 2))
    };
    let scale = |i: u64| {
        let size = exp(0.8 * normal(i, 4) - 5.0);
        let stretch = exp(0.5 * normal(i, 6));
        DVec3::new(size * stretch, size / stretch, 0.2 * size).as_vec3()
    };
    let rotation = |i: u64| [8, 10, 12, 14].map(|k| normal(i, k) as f32);
    let opacity = |i: u64| match i % 3 {
        0 => 0.9 + 0.1 * one(i, 16),
        1 => 0.2 * one(i, 16),
        _ => one(i, 16),
    };
    let each = coefficients(3) as u64;
    let harmonic = |i: u64, k: u64| {
        let size = if k == 0 { 1.5 } else { 0.1 };
        let part = |c: u64| (size * (2.0 * one(i, 20 + 3 * k + c) - 1.0)) as f32;
        Vec3::new(part(0), part(1), part(2))
    };
    let arrays = GaussianArrays {
        position: (0..count).map(|i| position(i).as_vec3()).collect(),
        scale: (0..count).map(scale).collect(),
        rotation: (0..count).map(rotation).collect(),
        opacity: (0..count).map(|i| opacity(i) as f32).collect(),
        degree: 3,
        harmonics: (0..count).flat_map(|i| (0..each).map(move |k| harmonic(i, k))).collect(),
        encoding: Encoding::Srgb,
    };
    Ok(Gaussians::new(arrays)?.0)
}
