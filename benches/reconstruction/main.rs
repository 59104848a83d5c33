//! The image-space methods, the pyramid \[MKC08\] and the template \[MOC08\], against EWA splatting
//! and against true pictures: what the defaults of both rest on.
//!
//! `cargo bench --bench reconstruction` prints Markdown tables, and with `--write` puts them into
//! `docs/image-space.md`; an argument is a pattern that the names of scenes must contain.
//! Pictures have 800 x 600 pixels, `f32`, from the default cameras, lit by the default headlight.
//! Where the true picture is known it is **lit too**, in f64 by the same shader, so that errors of
//! normals count as they are seen. Sections: [`means`], [`levels`], [`mirror`], [`reach`]; each states
//! what it measures.
//!
//! Scenes are shapes of 10 k and 200 k surfels, some under a parallel camera too, and scans: as
//! they are, with derived radii, and sampled evenly at random, with the radius a multiple of
//! sqrt(area / count): 7/4, at which a point lies in ten discs, but 1 for 1 M points, where discs
//! are smaller than pixels.

#[path = "../common/mod.rs"]
mod common;
mod levels;
mod means;
mod mirror;
mod reach;

use common::models::{models, resample};
use common::report::Arguments;
use common::shot::Shot;
use splatref::Result;
use splatref::frame::{Exec, Frame};
use splatref::io::scene_file;
use splatref::method::pyramid::{self, Occlusion, Weights};
use splatref::method::template::{self, LevelRule};
use splatref::method::{Method, Session, ewa};
use splatref::number::elementary::tan;
use splatref::scene::{Camera, Cloud, Lens, Scene, Surfels};
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};

const WIDTH: u32 = 800;
const HEIGHT: u32 = 600;

/// A scene before a camera, and the shape that it is a sampling of, if it is.
struct Subject {
    name: String,
    scene: Scene,
    camera: Camera,
    shape: Option<Shape>,
}

/// How pictures are made.
struct Bench {
    arguments: Arguments,
    exec: Exec,
}

fn main() -> Result<()> {
    let bench = Bench { arguments: Arguments::parse()?, exec: Exec::new(0, 32)? };
    let mut subjects = shapes(&bench.arguments.pattern)?;
    subjects.extend(bench.scans()?);
    bench.means(&subjects)?;
    bench.levels(&subjects)?;
    bench.mirror(&subjects)?;
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
            subjects.push(Subject {
                scene: Scene::lit(&name, surfels),
                name,
                camera,
                shape: Some(shape),
            });
        }
    }
    Ok(subjects)
}

/// Points, and the radius by sqrt(area / count), of the samplings of a scan.
const SAMPLINGS: [(&str, usize, f64); 3] =
    [(" 10 k", 10_000, 1.75), (" 173 k", 173_000, 1.75), (" 1 M", 1_000_000, 1.0)];

/// The area of a mesh.
fn area(cloud: &Cloud) -> f64 {
    let corner = |i: u32| cloud.position[i as usize].as_dvec3();
    let double =
        |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    cloud.triangles.iter().map(double).sum::<f64>() / 2.0
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
        pyramid("occluded = outside", Weights::Gaussian, Occlusion::Outside),
        pyramid("box", Weights::Box, Occlusion::Behind),
        pyramid("box, outside", Weights::Box, Occlusion::Outside),
        template("3, radius", 3, LevelRule::Radius),
        template("5, radius", 5, LevelRule::Radius),
        template("7, radius", 7, LevelRule::Radius),
        template("3, diameter", 3, LevelRule::Diameter),
        template("5, diameter", 5, LevelRule::Diameter),
        template("7, diameter", 7, LevelRule::Diameter),
        template("3, covering", 3, LevelRule::Covering),
        template("5, covering", 5, LevelRule::Covering),
        template("7, covering", 7, LevelRule::Covering),
    ]
}

/// EWA with its defaults.
fn splatting() -> Method {
    Method::Ewa(ewa::Settings::default())
}

impl Bench {
    /// Scans as they are, and sampled.
    fn scans(&self) -> Result<Vec<Subject>> {
        let (pattern, exec) = (self.arguments.pattern.as_str(), &self.exec);
        let word = pattern.split(' ').next().unwrap_or_default();
        let mut subjects = Vec::new();
        for (model, cloud) in models(word, &self.arguments)? {
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
                    subjects.push(Subject {
                        scene: Scene::lit(&name, surfels),
                        name,
                        camera,
                        shape: None,
                    });
                }
            };
            add(model.to_owned(), surfels);
            for (suffix, count, spacings) in SAMPLINGS {
                let mut sampled = resample(&cloud, count, 1);
                let radius = spacings * (area(&cloud) / count as f64).sqrt();
                sampled.radius = Some(vec![radius as f32; count]);
                add(format!("{model}{suffix}"), Surfels::new(sampled)?.0);
            }
        }
        Ok(subjects)
    }

    /// A picture.
    fn draw(&self, subject: &Subject, camera: &Camera, method: &Method) -> Result<Frame<f32>> {
        let scene = &subject.scene;
        Ok(Session::with_groups(scene, *method, None, &self.exec)?.render(camera)?.frame.clone())
    }

    /// The true picture of a shape.
    fn truth(&self, subject: &Subject, shape: &Shape, camera: &Camera) -> Result<Shot> {
        Shot::truth(&subject.scene, shape, camera, &self.exec)
    }
}
