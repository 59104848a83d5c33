//! Surfels made of meshes, against the meshes.
//!
//! `cargo bench --bench meshes` prints Markdown tables, and with `--write` puts them into
//! `docs/ewa.md`; an argument is a pattern that the names of scenes must contain. Scenes are the
//! scans in the folder that `SPLATREF_MODELS` names (`../shared/models` if it is not set), those that
//! are missing are skipped, and cylinders of 32 sides whose triangles are 1, 8 and 64 times as long
//! as wide. Each is drawn by four methods with their defaults, as points (a surfel a
//! vertex, its radius the longest edge around it) and as facets (an ellipse a triangle), in pictures
//! of 300, 600 and 1200 rows. The truth is the mesh, see [`common::mesh`].
//!
//! Each is the mean of the three sizes:
//!
//! - RMSE of the lit pictures
//! - holes, empty pixels inside the truth, and spill, painted ones outside; per mille of the truth

#[path = "common/mod.rs"]
mod common;

use common::mesh::Mesh;
use common::models::models;
use common::report::{Arguments, Table};
use common::shot::Shot;
use glam::Vec3;
use splatref::Result;
use splatref::compare::metrics::{coverage, rmse};
use splatref::frame::Exec;
use splatref::io::scene_file;
use splatref::method::{Method, Session, ewa, pyramid, single_pass, template};
use splatref::number::elementary::{cos, sin};
use splatref::scene::{Camera, Cloud, Lens, Scene, Sphere};
use splatref::source::derive::{self, Derive};

/// Rows; 4/3 as many columns.
const HEIGHTS: [u32; 3] = [300, 600, 1200];
const SIDES: u32 = 32;

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(0, 32)?);
    let mut clouds: Vec<_> = (models(&arguments.pattern, &arguments)?.into_iter())
        .map(|(name, cloud)| (name.to_owned(), cloud))
        .collect();
    for aspect in [1, 8, 64] {
        clouds.push((format!("cylinder, 1 : {aspect}"), cylinder(aspect)));
    }
    let methods: [(&str, Method); 4] = [
        ("EWA", ewa::Settings::default().into()),
        ("single-pass", single_pass::Settings::default().into()),
        ("pyramid", pyramid::Settings::default().into()),
        ("template", template::Settings::default().into()),
    ];
    let mut table = Table::new(&[
        "scene",
        "method",
        "points",
        "RMSE, holes, spill",
        "facets",
        "RMSE, holes, spill",
    ]);
    for (name, cloud) in clouds.into_iter().filter(|c| c.0.contains(&arguments.pattern)) {
        let points = derive::surfels(cloud.clone(), &Derive::default(), &exec, &|_, _, _| ())?.0;
        let (points, facets) = (
            Scene::lit(&name, points),
            Scene::lit(&name, derive::facets(cloud.clone(), &exec, &|_, _, _| ())?.0),
        );
        let mesh = Mesh::new(cloud, &points, &exec)?;
        let sphere = points.surfels.bounding_sphere();
        let truths = HEIGHTS.map(|height| true_picture(&mesh, sphere, height, &exec));
        let truths = truths.into_iter().collect::<Result<Vec<_>>>()?;
        for (title, method) in &methods {
            let cells = [&points, &facets].map(|scene| {
                let cell = measured(scene, method, &truths, &exec)?;
                Ok(format!("{} | {cell}", scene.surfels.len()))
            });
            let [points, facets]: [Result<String>; 2] = cells;
            table.row(&format!("{name} | {title} | {} | {}", points?, facets?));
        }
    }
    table.publish(&arguments, "ewa.md", "meshes")
}

/// A camera that frames a sphere, and the mesh before it.
fn true_picture(mesh: &Mesh, sphere: Sphere, height: u32, exec: &Exec) -> Result<(Camera, Shot)> {
    let lens = Lens::FieldOfView(scene_file::DEFAULT_FIELD_OF_VIEW);
    let side = scene_file::DEFAULT_SIDE;
    let camera = Camera::framing(height * 4 / 3, height, sphere, side, lens)?;
    let (truth, _) = mesh.truth(&camera, exec)?;
    Ok((camera, truth))
}

fn measured(
    scene: &Scene,
    method: &Method,
    truths: &[(Camera, Shot)],
    exec: &Exec,
) -> Result<String> {
    let mut session = Session::new(scene, *method, exec)?;
    let mut sums = [0.0; 3];
    for (camera, truth) in truths {
        let shot = Shot::of(session.render(camera)?.frame.clone());
        let [a, b] = [&shot, truth].map(|shot| shot.color.values().as_flattened());
        let counts = coverage(shot.alpha.values(), truth.alpha.values(), camera.width as usize);
        let per_mille = 1e3 / counts.covered.max(1) as f64;
        let found = [rmse(a, b), counts.holes as f64 * per_mille, counts.spill as f64 * per_mille];
        (0..3).for_each(|i| sums[i] += found[i] / truths.len() as f64);
    }
    let [rmse, holes, spill] = sums;
    Ok(format!("{rmse:.4}, {holes:.1}, {spill:.1}"))
}

/// A cylinder of radius 1 and height 4 along y, open, of triangles so many times as long as wide,
/// or of one row if they would be longer than it.
fn cylinder(aspect: u32) -> Cloud {
    let width = std::f64::consts::TAU / f64::from(SIDES);
    let rows = ((4.0 / (width * f64::from(aspect))).round() as u32).max(1);
    let at = |i: u32, row: u32| {
        let angle = width * f64::from(i % SIDES);
        let height = 4.0 * f64::from(row) / f64::from(rows) - 2.0;
        Vec3::new(cos(angle) as f32, height as f32, sin(angle) as f32)
    };
    let all = (0..=rows).flat_map(|row| (0..SIDES).map(move |i| (i, row)));
    let position = all.map(|(i, row)| at(i, row)).collect();
    let cells = (0..rows).flat_map(|row| (0..SIDES).map(move |i| (i, row)));
    let triangles = cells.flat_map(|(i, row)| {
        let index = |i: u32, row: u32| row * SIDES + i % SIDES;
        let [a, b] = [index(i, row), index(i + 1, row)];
        let [c, d] = [index(i, row + 1), index(i + 1, row + 1)];
        [[a, c, b], [b, c, d]]
    });
    Cloud { position, triangles: triangles.collect(), ..Cloud::default() }
}
