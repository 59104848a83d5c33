//! Lines beside the triangles they stand for: \[MKC08, Fig. 13 and 14\] in numbers.
//!
//! The truth is the triangles at 3 x 3 samples a pixel. Beside it the triangles at one sample, which
//! is what the paper compares with, and the lines. *Painted* is the sum of the opacities, the truth's
//! being 1: a line is never thinner than a pixel.

use crate::common::mesh::Mesh;
use crate::common::report::{Arguments, Table};
use crate::common::shot::Shot;
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::compare::metrics::{rmse, ssim};
use splatref::frame::{Exec, Plane};
use splatref::io::scene_file;
use splatref::method::{Session, pyramid};
use splatref::scene::{Camera, Lens, Primitives, Scene, Sphere, Surfels};
use splatref::source::plant::{LEAVES, apple_tree};

/// What is seen, as the centre and the radius of a sphere that fills the picture.
const VIEWS: [(&str, [f64; 3], f64); 4] = [
    ("far", [0.0, 1.5, 0.0], 6.0),
    ("tree", [0.0, 1.5, 0.0], 1.8),
    ("crown", [0.0, 2.2, 0.0], 0.7),
    ("twigs", [0.3, 2.4, 0.9], 0.2),
];
/// Rows; 4/3 as many columns.
const HEIGHTS: [u32; 3] = [150, 300, 600];
/// Samples of the truth along a side of a pixel.
const SAMPLES: u32 = 3;

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let plant = apple_tree(LEAVES, 0)?;
    let (polygons, lines) = (scene(plant.polygons()?), scene(plant.lines()?));
    let mesh = Mesh::of(polygons);
    let mut table = Table::new(&[
        "view",
        "rows",
        "triangles: RMSE, SSIM, painted",
        "lines: RMSE, SSIM, painted",
    ]);
    for (name, center, radius) in VIEWS.into_iter().filter(|v| v.0.contains(&arguments.pattern)) {
        for height in HEIGHTS {
            let camera = |scale: u32| {
                let lens = Lens::FieldOfView(scene_file::DEFAULT_FIELD_OF_VIEW);
                let sphere = Sphere { center: DVec3::from_array(center), radius };
                let [width, height] = [height * 4 / 3 * scale, height * scale];
                Camera::framing(width, height, sphere, DVec3::Z, lens)
            };
            let truth = reduced(&mesh.truth(&camera(SAMPLES)?, exec)?.0);
            let (triangles, _) = mesh.truth(&camera(1)?, exec)?;
            let drawn = Session::new(&lines, pyramid::Settings::default().into(), exec)?
                .render(&camera(1)?)?
                .frame
                .clone();
            let cells = [&triangles, &Shot::of(drawn)].map(|shot| against(shot, &truth));
            table.row(&format!("{name} | {height} | {}", cells.join(" | ")));
        }
    }
    table.publish(arguments, "image-space.md", "tree")
}

/// Primitives under the headlight.
pub(crate) fn scene(primitives: Primitives) -> Scene {
    Scene { primitives, ..Scene::lit("tree", Surfels::none()) }
}

fn against(shot: &Shot, truth: &Shot) -> String {
    let [a, b] = [shot, truth].map(|shot| shot.color.values().as_flattened());
    let [seen, true_one] = [shot, truth].map(|shot| sum(&shot.alpha));
    let width = truth.color.width() as usize;
    let [x, y] = [shot, truth].map(|shot| gray(&shot.color));
    let ssim = ssim(&x, &y, width).unwrap_or(0.0);
    format!("{:.4}, {ssim:.3}, {:.2}", rmse(a, b), seen / true_one)
}

fn sum(plane: &Plane<f32>) -> f64 {
    plane.values().iter().map(|value| f64::from(*value)).sum()
}

fn gray(plane: &Plane<[f32; 3]>) -> Vec<f32> {
    plane.values().iter().map(|[r, g, b]| (r + g + b) / 3.0).collect()
}

/// The mean of the samples of each pixel.
fn reduced(shot: &Shot) -> Shot {
    let [width, height] = [shot.alpha.width() / SAMPLES, shot.alpha.height() / SAMPLES];
    let share = 1.0 / (SAMPLES * SAMPLES) as f32;
    let samples = |i: usize| {
        let (x, y) = (i as u32 % width * SAMPLES, i as u32 / width * SAMPLES);
        (y..y + SAMPLES).flat_map(move |y| (x..x + SAMPLES).map(move |x| (x, y)))
    };
    let pixels = 0..(width * height) as usize;
    let color = pixels.clone().map(|i| {
        let sum = samples(i).fold(Vec3::ZERO, |sum, (x, y)| sum + Vec3::from(*shot.color.at(x, y)));
        (sum * share).to_array()
    });
    let alpha = pixels.map(|i| samples(i).map(|(x, y)| shot.alpha.at(x, y)).sum::<f32>() * share);
    Shot {
        color: Plane::from_values(width, height, color.collect()),
        alpha: Plane::from_values(width, height, alpha.collect()),
        depth: Plane::filled(width, height, f32::INFINITY),
    }
}
