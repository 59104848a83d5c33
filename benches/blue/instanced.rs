//! Table 3's question \[BJFM19, 5.3\]: what the size of surfels costs and spoils in a scene of instances.
//!
//! 1,156 rings with bumps on a plain, 96,000 triangles each, 111 million in all, of one geometry: 48,000
//! surfels, half its triangles, and the triangles close by. The truth is all triangles at the centres of
//! pixels, drawn so many objects at a time, of which the nearest stays.

use super::common::report::{Arguments, Table};
use super::scene::{against, blue, draw, percent};
use glam::DVec3;
use splatref::Result;
use splatref::compare::metrics::{hierarchical_ssim, summary};
use splatref::frame::image::Image;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::number::elementary::{cos, sin};
use splatref::scene::objects::Objects;
use splatref::scene::{Camera, Geometry, Lens, Pose, Scene, Similarity, Surfels};
use splatref::scene::{Triangles, Vertices};
use splatref::source::candidates::Directions;
use splatref::source::flatten;
use splatref::study::atlas::orders::{geometry, mesh, objects, order, seen};
use std::f64::consts::TAU;
use std::time::Instant;

const SIZES: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0];
const PICTURES: [[u32; 2]; 2] = [[1920, 1080], [3840, 2160]];
/// Objects of a rank of the plain, and their distance.
const RANK: i32 = 34;
const APART: f64 = 3.5;
/// Objects of which all triangles are drawn at a time.
const SOME: usize = 20;

/// The scene: a ring, where it stands, and all of it as objects.
pub(crate) struct Rings {
    ring: Scene,
    places: Vec<Similarity>,
    pub(crate) all: Objects,
}

impl Rings {
    pub(crate) fn new(exec: &Exec) -> Result<Self> {
        let ring = mesh(ring()?);
        let order = order(&ring, &Directions::Cube, 1024, 48_000, exec)?;
        let geometry = geometry(order, ring.primitives.clone())?;
        let places: Vec<Similarity> = (0..RANK * RANK)
            .map(|i| {
                let at = |k: i32| APART * (f64::from(k) - f64::from(RANK - 1) / 2.0);
                let translation = DVec3::new(at(i % RANK), 0.0, at(i / RANK));
                Similarity { translation, ..Similarity::IDENTITY }
            })
            .collect();
        let all = objects(geometry, &places)?;
        Ok(Self { ring, places, all })
    }

    /// How many triangles all objects have.
    pub(crate) fn triangles(&self) -> usize {
        self.ring.primitives.len() * self.places.len()
    }

    /// The picture of all triangles, of some objects at a time: of each pixel the nearest.
    pub(crate) fn truth(&self, camera: &Camera, exec: &Exec) -> Result<Frame<f32>> {
        let mut nearest: Option<Frame<f32>> = None;
        for some in self.places.chunks(SOME) {
            let geometry = Geometry {
                name: "ring".into(),
                surfels: Surfels::none(),
                primitives: self.ring.primitives.clone(),
                detail: None,
            };
            let objects = Some(objects(geometry, some)?);
            let flat = flatten(&Scene { objects, ..Scene::lit("ring", Surfels::none()) }, exec)?;
            let frame = draw(&flat, blue(), camera, exec)?;
            match &mut nearest {
                None => nearest = Some(frame),
                Some(nearest) => merge(nearest, frame),
            }
        }
        nearest.ok_or_else(|| splatref::Error::Invalid("no objects".into()))
    }
}

/// Where somebody stands, and looks to.
pub(crate) struct View {
    name: &'static str,
    eye: [f64; 3],
    target: [f64; 3],
}

pub(crate) const OVERVIEW: View =
    View { name: "overview", eye: [20.0, 25.0, 75.0], target: [0.0, 0.0, 5.0] };
const GROUND: View = View { name: "ground", eye: [1.7, 1.5, 30.0], target: [0.0, 0.0, 5.0] };
/// Between four rings, low above the plain.
pub(crate) const CLOSE: View =
    View { name: "close", eye: [0.0, 0.7, 7.0], target: [0.6, 0.1, 0.0] };

impl View {
    pub(crate) fn camera(&self, [width, height]: [u32; 2]) -> Result<Camera> {
        let pose = Pose { eye: self.eye.into(), target: self.target.into(), up: DVec3::Y };
        Camera::new(width, height, pose, Lens::FieldOfView(45.0))
    }
}

pub(crate) fn table(rings: &Rings, arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut table = Table::new(&[
        "view",
        "picture",
        "size, px",
        "surfels",
        "triangles",
        "choosing and placing, ms",
        "drawing, ms",
        "SSIM",
        "hierarchical SSIM",
        "holes, %",
    ]);
    for view in [OVERVIEW, GROUND] {
        for [width, height] in PICTURES {
            let camera = view.camera([width, height])?;
            let start = Instant::now();
            let truth = rings.truth(&camera, exec)?;
            let time = 1e3 * start.elapsed().as_secs_f64();
            let picture = format!("{} | {width} x {height}", view.name);
            table.row(&format!(
                "{picture} | all triangles | 0 | {} | - | {time:.0} | 1 | 1 | 0",
                rings.triangles()
            ));
            for size in SIZES {
                let cells = of_size(&rings.all, size, &camera, &truth, exec)?;
                table.row(&format!("{picture} | {cells}"));
            }
        }
    }
    table.publish_times(arguments, "bjfm19.md", "instances")
}

fn of_size(
    all: &Objects,
    size: f32,
    camera: &Camera,
    truth: &Frame<f32>,
    exec: &Exec,
) -> Result<String> {
    let start = Instant::now();
    let scene = seen(all, size, camera, exec)?;
    let placing = 1e3 * start.elapsed().as_secs_f64();
    let start = Instant::now();
    let found = draw(&scene, blue(), camera, exec)?;
    let drawing = 1e3 * start.elapsed().as_secs_f64();
    let similar = summary(&Image::from(&found), &Image::from(truth)).and_then(|both| both.ssim);
    let covered = against(&found, truth);
    Ok(format!(
        "{size} | {} | {} | {placing:.0} | {drawing:.0} | {:.3} | {:.3} | {:.2}",
        scene.surfels.len(),
        scene.primitives.len(),
        similar.unwrap_or(f64::NAN),
        hierarchical(&found, truth).unwrap_or(f64::NAN),
        percent(covered.holes, covered.interior)
    ))
}

/// The mean hierarchical SSIM of the three channels of two pictures.
fn hierarchical(found: &Frame<f32>, truth: &Frame<f32>) -> Option<f64> {
    let [found, truth] = [found.color("").ok()?, truth.color("").ok()?];
    let channel = |plane: &Plane<[f32; 3]>, c: usize| -> Vec<f32> {
        plane.values().iter().map(|color| color[c]).collect()
    };
    let one = |c| hierarchical_ssim(&channel(found, c), &channel(truth, c), found.width() as usize);
    Some((one(0)? + one(1)? + one(2)?) / 3.0)
}

/// Takes the pixels at which another frame is nearer.
fn merge(to: &mut Frame<f32>, from: Frame<f32>) {
    let depths = |frame: &Frame<f32>| match frame.plane("Z") {
        Some(Samples::Scalar(plane)) => plane.values().to_vec(),
        _ => Vec::new(),
    };
    let nearer: Vec<bool> =
        depths(to).iter().zip(depths(&from)).map(|(old, new)| new < *old).collect();
    for (to, from) in to.planes.iter_mut().zip(from.planes) {
        match (&mut to.samples, from.samples) {
            (Samples::Scalar(to), Samples::Scalar(from)) => take(to, &from, &nearer),
            (Samples::Color(to), Samples::Color(from))
            | (Samples::Vector(to), Samples::Vector(from)) => take(to, &from, &nearer),
            (Samples::Index(to), Samples::Index(from)) => take(to, &from, &nearer),
            _ => {}
        }
    }
}

fn take<T: Copy>(to: &mut Plane<T>, from: &Plane<T>, nearer: &[bool]) {
    let both = to.values_mut().iter_mut().zip(from.values());
    both.zip(nearer).filter(|(_, nearer)| **nearer).for_each(|((to, from), _)| *to = *from);
}

/// A ring with bumps.
fn ring() -> Result<Triangles> {
    let (columns, rows) = (300, 160);
    let at = |a: f64, b: f64| {
        let ring = 1.0 + 0.4 * cos(b) + 0.02 * sin(40.0 * a) * cos(20.0 * b);
        DVec3::new(ring * cos(a), 0.4 * sin(b), ring * sin(a))
    };
    let mut vertices = Vertices::default();
    let mut corners = Vec::new();
    let mut colors = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let angle = |i: u32, of: u32| f64::from(i) / f64::from(of) * TAU;
            let (a, b, step) = (angle(i, columns), angle(j, rows), 1e-4);
            let p = at(a, b);
            let normal = (at(a, b + step) - p).cross(at(a + step, b) - p);
            vertices.position.push(p.as_vec3());
            vertices.direction.push(normal.normalize_or(DVec3::Y).as_vec3());
            vertices.radius.push(0.0);
            colors.push(DVec3::new(0.5 + 0.4 * sin(3.0 * a), 0.5 + 0.4 * sin(b), 0.4).as_vec3());
            let at = |i: u32, j: u32| i % columns * rows + j % rows;
            corners.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            corners.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    vertices.color = Some(colors);
    Ok(Triangles::new(vertices, corners)?.0)
}
