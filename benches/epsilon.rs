//! The width of the visible band, epsilon, against true pictures.
//!
//! `cargo bench --bench epsilon` prints Markdown tables, and with `--write` puts them into
//! `docs/ewa.md`; an argument is a pattern that the names of scenes must contain. Scenes are shapes
//! of 20,000 surfels, and the scans in the folder that `SPLATREF_MODELS` names (`../shared/models`
//! if it is not set), as they are, with derived radii; those that are missing are skipped. EWA draws
//! each, and the single pass, with their defaults but for epsilon, in pictures of 300, 600 and 1200
//! rows, lit by the headlight. The truth of a shape is exact; that of a scan are its triangles, see
//! [`common::mesh`].
//!
//! Of the inside of the truth, each the mean of the three sizes:
//!
//! - RMSE of the lit pictures
//! - torn: pixels whose normal is more than 20 degrees off the truth's axis, per mille

#[path = "common/mod.rs"]
mod common;

use common::mesh::Mesh;
use common::models::models;
use common::report::{Arguments, Table};
use common::shot::Shot;
use glam::Vec3;
use splatref::Result;
use splatref::compare::metrics::{Region, regions};
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::io::scene_file;
use splatref::method::{Method, Session, single_pass};
use splatref::number::elementary::sin;
use splatref::scene::{Camera, Lens, Scene};
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};
use splatref::splat::{Epsilon, SplatSettings};

/// Rows; 4/3 as many columns.
const HEIGHTS: [u32; 3] = [300, 600, 1200];
/// Epsilon in median radii.
const RADII: [f32; 8] = [0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 8.0];
const SHAPES: [&str; 6] = ["sphere", "torus", "cluster", "sheets", "staircase", "checkerboard"];
const SURFELS: usize = 20_000;
/// A method with these settings of its splats.
type With = fn(SplatSettings) -> Method;
const METHODS: [(&str, With); 2] = [("EWA", splatting), ("single-pass", single_pass)];

/// What is known of a scene's true picture.
enum Truth {
    Shape(Shape),
    Mesh(Box<Mesh>),
}

/// A scene, and its cameras by their height.
struct Subject {
    name: String,
    scene: Scene,
    camera: Box<dyn Fn(u32) -> Result<Camera>>,
    truth: Truth,
}

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(0, 32)?);
    let mut subjects = shapes(&arguments.pattern)?;
    subjects.extend(scans(&arguments, &exec)?);
    let columns = RADII.map(|radii| format!("{radii} r"));
    let columns: Vec<_> = ["method", "scene", "surfels"]
        .into_iter()
        .chain(columns.iter().map(String::as_str))
        .collect();
    let mut table = Table::new(&columns);
    for (method, with) in METHODS {
        let mut rows = Vec::new();
        for subject in &subjects {
            let found = subject.measure(with, &exec)?;
            let surfels = subject.scene.surfels.len();
            table.row(&format!("{method} | {} | {surfels} | {}", subject.name, cells(&found)));
            rows.push(found);
        }
        let mean = |i: usize, k: usize| {
            rows.iter().map(|row| row[i][k]).sum::<f64>() / rows.len().max(1) as f64
        };
        let means: Vec<_> = (0..RADII.len()).map(|i| [0, 1].map(|k| mean(i, k))).collect();
        table.row(&format!("{method} | mean | | {}", cells(&means)));
    }
    table.publish(&arguments, "ewa.md", "epsilon")
}

fn cells(found: &[[f64; 2]]) -> String {
    let cell = |[rmse, torn]: &[f64; 2]| format!("{rmse:.4}, {torn:.1}");
    found.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

fn splatting(splats: SplatSettings) -> Method {
    splats.into()
}

fn single_pass(splats: SplatSettings) -> Method {
    single_pass::Settings { splats, ..Default::default() }.into()
}

fn shapes(pattern: &str) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    for name in SHAPES.into_iter().filter(|name| name.contains(pattern)) {
        let Some(shape) = Shape::by_name(name) else { continue };
        let scene = Scene::lit(name, shape.surfels(SURFELS, 0)?);
        let camera = move |height: u32| {
            Camera::new(height * 4 / 3, height, shape.default_pose(), shape.default_lens())
        };
        let (name, truth) = (name.to_owned(), Truth::Shape(shape));
        subjects.push(Subject { name, scene, camera: Box::new(camera), truth });
    }
    Ok(subjects)
}

fn scans(arguments: &Arguments, exec: &Exec) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    for (name, cloud) in models(&arguments.pattern, arguments)? {
        let (surfels, _) = derive::surfels(cloud.clone(), &Derive::default(), exec, &|_, _, _| ())?;
        let sphere = surfels.bounding_sphere();
        let camera = move |height: u32| {
            let lens = Lens::FieldOfView(scene_file::DEFAULT_FIELD_OF_VIEW);
            Camera::framing(height * 4 / 3, height, sphere, scene_file::DEFAULT_SIDE, lens)
        };
        let scene = Scene::lit(name, surfels);
        let truth = Truth::Mesh(Box::new(Mesh::new(cloud, &scene, exec)?));
        subjects.push(Subject { name: name.to_owned(), scene, camera: Box::new(camera), truth });
    }
    Ok(subjects)
}

impl Subject {
    /// RMSE and torn of each epsilon.
    fn measure(&self, with: With, exec: &Exec) -> Result<Vec<[f64; 2]>> {
        let mut found = vec![[0.0; 2]; RADII.len()];
        let grouping = with(SplatSettings::default()).grouping();
        let groups = grouping.map(|of| of.groups(&self.scene.surfels, exec, &|_, _, _| ()));
        let groups = groups.transpose()?.map(|(groups, ..)| groups);
        for height in HEIGHTS {
            let camera = (self.camera)(height)?;
            let (truth, normals) = self.truth(&camera, exec)?;
            for (radii, found) in RADII.into_iter().zip(&mut found) {
                let epsilon = Epsilon::MedianRadii(radii);
                let method = with(SplatSettings { epsilon, ..SplatSettings::default() });
                let mut session = Session::with_groups(&self.scene, method, groups.clone(), exec)?;
                let frame = session.render(&camera)?.frame.clone();
                for (sum, error) in found.iter_mut().zip(errors(frame, &truth, &normals)) {
                    *sum += error / HEIGHTS.len() as f64;
                }
            }
        }
        Ok(found)
    }

    fn truth(&self, camera: &Camera, exec: &Exec) -> Result<(Shot, Plane<[f32; 3]>)> {
        match &self.truth {
            Truth::Mesh(mesh) => mesh.truth(camera, exec),
            Truth::Shape(shape) => {
                let shot = Shot::truth(&self.scene, shape, camera, exec)?;
                let picture = shape.true_picture(camera)?;
                let Some(Samples::Vector(normals)) = picture.plane("normal") else {
                    unreachable!("a true picture has normals")
                };
                Ok((shot, normals.map(|n| n.map(|v| v as f32))))
            }
        }
    }
}

/// RMSE and torn of a picture, inside the truth.
fn errors(frame: Frame<f32>, truth: &Shot, normals: &Plane<[f32; 3]>) -> [f64; 2] {
    let Some(Samples::Vector(found)) = frame.plane("normal") else {
        unreachable!("a lit picture has normals")
    };
    let (found, shot) = (found.clone(), Shot::of(frame));
    let (mut squares, mut torn, mut inside) = (0.0, 0, 0);
    let all = regions(truth.alpha.values(), truth.alpha.width() as usize);
    for (i, region) in all.into_iter().enumerate() {
        if region != Region::Interior {
            continue;
        }
        inside += 1;
        for (a, b) in shot.color.values()[i].into_iter().zip(truth.color.values()[i]) {
            squares += f64::from(a - b) * f64::from(a - b);
        }
        let [a, b] = [&found, normals].map(|plane| Vec3::from(plane.values()[i]));
        torn += u64::from(f64::from(a.cross(b).length()) > sin(20_f64.to_radians()));
    }
    let inside = f64::from(inside.max(1));
    [(squares / (3.0 * inside)).sqrt(), 1e3 * torn as f64 / inside]
}
