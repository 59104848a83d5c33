//! The image-space methods, the pyramid \[MKC08\] and the template \[MOC08\], against EWA splatting
//! and against true pictures: what their papers claim about quality, as numbers.
//!
//! `cargo bench --bench reconstruction` prints Markdown tables; an argument is a pattern that the
//! names of scenes must contain. With `--pictures DIR` every picture is kept there as a PNG.
//! Pictures have 800 x 600 pixels, `f32`, from the default cameras, lit by the default headlight.
//! Where the true picture is known it is **lit too**, in f64 by the same shader, so that errors of
//! normals count as they are seen. Sections: [`accuracy`], [`stability`], [`reach`]; each states
//! what it measures.
//!
//! Scenes are shapes of 10 k and 200 k surfels, some under a parallel camera too, and scans: as
//! they are, with derived radii, and sampled evenly at random, with the radius a multiple of
//! sqrt(area / count): 7/4, at which a point lies in ten discs, but 1 for 1 M points, where discs
//! are smaller than pixels.

mod accuracy;
#[path = "../common/mod.rs"]
mod common;
mod reach;
mod stability;

use splatref::Result;
use splatref::frame::{Exec, Frame, NamedPlane, Plane, Samples};
use splatref::io::{png, scene_file};
use splatref::method::pyramid::{self, Occlusion, Weights};
use splatref::method::template::{self, LevelRule};
use splatref::method::{Method, Preparation, ewa, render_f32};
use splatref::number::elementary::tan;
use splatref::scene::{Camera, Cloud, Lens, Light, Phong, Primitives, Scene, Surfels};
use splatref::shade::phong::Shader;
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};
use splatref::splat::View;
use std::path::PathBuf;

const WIDTH: u32 = 800;
const HEIGHT: u32 = 600;

/// A scene before a camera, and the shape that it is a sampling of, if it is.
struct Subject {
    name: String,
    scene: Scene,
    camera: Camera,
    shape: Option<Shape>,
}

/// How pictures are made, and where they are kept.
struct Bench {
    exec: Exec,
    pictures: Option<PathBuf>,
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (mut pattern, mut pictures) = (String::new(), None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--pictures" => pictures = arguments.next().map(PathBuf::from),
            // cargo passes --bench.
            option if option.starts_with('-') => {}
            other => pattern = other.to_owned(),
        }
    }
    let bench = Bench { exec: Exec::new(0, 32)?, pictures };
    let mut subjects = shapes(&pattern)?;
    subjects.extend(scans(&pattern, &bench.exec)?);
    bench.accuracy(&subjects)?;
    bench.stability(&subjects)?;
    bench.reach()
}

/// Shapes in two samplings; two of them also under a parallel camera of the same opening, where the
/// ellipses of both papers, which are orthogonal projections, are exact.
fn shapes(pattern: &str) -> Result<Vec<Subject>> {
    let all = [("sphere", false), ("torus", false), ("cluster", false), ("checkerboard", false)];
    let parallel = [("torus", true), ("cluster", true)];
    let mut subjects = Vec::new();
    for (name, parallel) in all.into_iter().chain(parallel) {
        let Some(shape) = Shape::by_name(name) else { continue };
        for (count, suffix) in [(10_000, "10 k"), (200_000, "200 k")] {
            let camera = if parallel { ", parallel" } else { "" };
            let name = format!("{name} {suffix}{camera}");
            if !name.contains(pattern) {
                continue;
            }
            let surfels = shape.surfels(count, 0)?;
            let (pose, mut lens) = (shape.default_pose(), shape.default_lens());
            if let (true, Lens::FieldOfView(degrees)) = (parallel, lens) {
                let height = 2.0 * tan(degrees.to_radians() / 2.0);
                lens = Lens::Orthographic(height * (pose.target - pose.eye).length());
            }
            let camera = Camera::new(WIDTH, HEIGHT, pose, lens)?;
            subjects.push(Subject { scene: lit(&name, surfels), name, camera, shape: Some(shape) });
        }
    }
    Ok(subjects)
}

/// Points, and the radius by sqrt(area / count), of the samplings of a scan.
const SAMPLINGS: [(&str, usize, f64); 3] =
    [(" 10 k", 10_000, 1.75), (" 173 k", 173_000, 1.75), (" 1 M", 1_000_000, 1.0)];

/// Scans as they are, and sampled.
fn scans(pattern: &str, exec: &Exec) -> Result<Vec<Subject>> {
    let word = pattern.split(' ').next().unwrap_or_default();
    let mut subjects = Vec::new();
    for (model, cloud) in common::models(word) {
        if !["bunny", "dragon", "igea", "koala"].contains(&model) {
            continue;
        }
        let side = scene_file::DEFAULT_SIDE;
        let lens = Lens::FieldOfView(scene_file::DEFAULT_FIELD_OF_VIEW);
        let complete =
            |cloud: Cloud| derive::surfels(cloud, &Derive::default(), exec, &|_, _, _| ());
        let (surfels, _) = complete(cloud.clone())?;
        let camera = Camera::framing(WIDTH, HEIGHT, surfels.bounding_sphere(), side, lens)?;
        let mut add = |name: String, surfels: Surfels| {
            if name.contains(pattern) {
                subjects.push(Subject { scene: lit(&name, surfels), name, camera, shape: None });
            }
        };
        add(model.to_owned(), surfels);
        for (suffix, count, spacings) in SAMPLINGS {
            let mut sampled = common::resample(&cloud, count, 1);
            let radius = spacings * (area(&cloud) / count as f64).sqrt();
            sampled.radius = Some(vec![radius as f32; count]);
            add(format!("{model}{suffix}"), Surfels::new(sampled)?.0);
        }
    }
    Ok(subjects)
}

/// The area of a mesh.
fn area(cloud: &Cloud) -> f64 {
    let corner = |i: u32| cloud.position[i as usize].as_dvec3();
    let double =
        |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    cloud.triangles.iter().map(double).sum::<f64>() / 2.0
}

/// Surfels under the headlight of scenes that name no light.
fn lit(name: &str, surfels: Surfels) -> Scene {
    Scene {
        name: name.to_owned(),
        surfels,
        primitives: Primitives::default(),
        lights: vec![Light::DEFAULT],
        material: Phong::default(),
        environment: None,
    }
}

const EWA: &str = "EWA";

/// The methods in the order of the tables, with their columns' titles; the settings that are open
/// questions, and of the template each size.
fn methods() -> Vec<(&'static str, Method)> {
    let pyramid = |name, weights, occlusion| {
        let settings = pyramid::Settings { weights, occlusion, ..pyramid::Settings::default() };
        (name, Method::Pyramid(settings))
    };
    let template = |name, size, levels| {
        (name, Method::Template(template::Settings { size, levels, ..Default::default() }))
    };
    vec![
        pyramid("pyramid", Weights::Gaussian, Occlusion::Behind),
        pyramid("outside", Weights::Gaussian, Occlusion::Outside),
        pyramid("box", Weights::Box, Occlusion::Behind),
        pyramid("box, outside", Weights::Box, Occlusion::Outside),
        template("3 x 3", 3, LevelRule::Covering),
        template("5 x 5", 5, LevelRule::Covering),
        template("7 x 7", 7, LevelRule::Covering),
        template("3, published", 3, LevelRule::Published),
        template("5, published", 5, LevelRule::Published),
        template("7, published", 7, LevelRule::Published),
    ]
}

/// EWA with its defaults.
fn splatting() -> Method {
    Method::Ewa(ewa::Settings::default())
}

/// The planes of a picture that are measured.
struct Shot {
    color: Plane<[f32; 3]>,
    alpha: Plane<f32>,
    depth: Plane<f32>,
}

impl Bench {
    /// A picture.
    fn draw(&self, subject: &Subject, camera: &Camera, method: &Method) -> Result<Frame<f32>> {
        let scene = &subject.scene;
        let preparation = Preparation::new(&scene.surfels, None, method, &self.exec);
        Ok(render_f32(scene, &preparation, camera, method, &self.exec, None)?.frame)
    }

    /// The true picture of a shape, lit in f64 and rounded.
    fn truth(&self, subject: &Subject, shape: &Shape, camera: &Camera) -> Result<Shot> {
        let Frame { width, height, planes } = shape.true_picture(camera)?;
        let (mut color, mut depth, mut normal) = (None, Plane::filled(width, height, 0.0), None);
        for NamedPlane { name, samples } in planes {
            match (name.as_str(), samples) {
                ("", Samples::Color(plane)) => color = Some(plane),
                ("Z", Samples::Scalar(plane)) => depth = plane,
                ("normal", Samples::Vector(plane)) => normal = Some(plane),
                _ => {}
            }
        }
        let Scene { lights, material, .. } = &subject.scene;
        let shader = Shader::<f64>::new(View::new(camera), lights, *material);
        let color = shader.shade(&depth, normal.as_ref(), None, color, &self.exec);
        Ok(Shot {
            color: color.map(|color| color.map(|v| v as f32)),
            alpha: depth.map(|depth| f32::from(u8::from(depth.is_finite()))),
            depth: depth.map(|depth| *depth as f32),
        })
    }

    /// Keeps a picture if that was asked for.
    fn keep(&self, subject: &Subject, title: &str, shot: &Shot) -> Result<()> {
        let Some(folder) = &self.pictures else { return Ok(()) };
        let name = format!("{}-{title}.png", subject.name).replace([' ', ','], "_");
        png::write(&folder.join(name), &shot.color, None)
    }
}

impl Shot {
    /// The planes of a picture.
    fn of(frame: Frame<f32>) -> Self {
        let (width, height) = (frame.width, frame.height);
        let mut shot = Self {
            color: Plane::filled(width, height, [0.0; 3]),
            alpha: Plane::filled(width, height, 0.0),
            depth: Plane::filled(width, height, f32::INFINITY),
        };
        for NamedPlane { name, samples } in frame.planes {
            match (name.as_str(), samples) {
                ("", Samples::Color(plane)) => shot.color = plane,
                ("A", Samples::Scalar(plane)) => shot.alpha = plane,
                ("Z", Samples::Scalar(plane)) => shot.depth = plane,
                _ => {}
            }
        }
        shot
    }
}
