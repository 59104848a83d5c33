//! What a prefix leaves open where the rule of \[BJFM19, 4.1\] chooses it.

use super::common::models::models;
use super::common::report::{Arguments, Table};
use super::scene::{against, blue, draw, percent};
use glam::DVec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::ewa;
use splatref::scene::{Camera, Lens, Primitives, Scene, Similarity};
use splatref::source::candidates::{Directions, SIDE, candidates};
use splatref::source::derive;
use splatref::source::sampler::quality;
use splatref::study::atlas::orders::{geometry, mesh, objects, order, seen};

/// Sides of pictures, and sizes of surfels.
const SIDES: [u32; 3] = [256, 512, 1024];
const SIZES: [f32; 4] = [1.0, 2.0, 4.0, 8.0];
/// The most surfels of the paper's nodes.
const COUNT: usize = 200_000;
const PREFIXES: [usize; 4] = [100, 1000, 10_000, 100_000];

pub(crate) fn tables(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let columns = |first: [&'static str; 2], more: [&'static str; 4]| [&first[..], &more].concat();
    let sizes = ["1 px", "2 px", "4 px", "8 px"];
    let mut holes = Table::new(&columns(["mesh", "picture"], sizes));
    let mut all = Vec::new();
    for (name, cloud) in models("", arguments)? {
        all.push((name, mesh(derive::polygons(cloud, exec, &|_, _, _| ())?.0)));
    }
    let mut rows = Vec::new();
    for (name, mesh) in &all {
        let cells = of_mesh(name, (mesh, &Directions::Cube), &mut holes, exec)?;
        rows.push((*name, cells));
        if *name == "bunny" {
            let name = "bunny, 26 directions";
            rows.push((name, of_mesh(name, (mesh, &twenty_six()), &mut holes, exec)?));
        }
    }
    holes.publish(arguments, "bjfm19.md", "holes")?;
    let mut rules = Table::new(&columns(["mesh", "p_m, r_m"], ["100", "1 k", "10 k", "100 k"]));
    rows.iter().for_each(|(name, cells)| rules.row(&format!("{name} | {cells}")));
    rules.publish(arguments, "bjfm19.md", "estimate")
}

/// To the corners, the middles of the edges and those of the faces of a cube.
fn twenty_six() -> Directions {
    let at =
        |i: i32| DVec3::new(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1));
    Directions::These((0..27).filter(|&i| i != 13).map(at).collect())
}

/// The rows of holes, and the cells of the rule.
fn of_mesh(
    name: &str,
    (mesh, directions): (&Scene, &Directions),
    holes: &mut Table,
    exec: &Exec,
) -> Result<String> {
    let order = order(mesh, directions, SIDE, COUNT, exec)?;
    let all = candidates(mesh, directions, SIDE, exec, &|_, _, _| ())?.cloud.position;
    // The order, then all that it was chosen from.
    let points = [&order.position[..], &all].concat();
    let prefix = geometry(order, Primitives::default())?;
    let rule = prefix.prefix().map(|prefix| prefix.estimate());
    let mut cells = Vec::new();
    if let Some(estimate) = rule {
        cells.push(format!("{}, {:.5}", estimate.count, estimate.distance));
        for count in PREFIXES {
            let indices: Vec<u32> = (0..count as u32).collect();
            let found = quality(&points, &indices, exec)?;
            let radius =
                f64::from(estimate.distance) * (f64::from(estimate.count) / count as f64).sqrt();
            let [covering, packing] =
                [found.covering, found.packing].map(|d| f64::from(d).sqrt() / radius);
            cells.push(format!("{packing:.2}, {covering:.2}"));
        }
    }
    let objects = objects(prefix, &[Similarity::IDENTITY])?;
    let sphere = mesh.bounding_sphere();
    for side in SIDES {
        let from = DVec3::new(0.5, 0.375, 1.0);
        let camera = Camera::framing(side, side, sphere, from, Lens::FieldOfView(34.0))?;
        let truth = draw(mesh, blue(), &camera, exec)?;
        let mut row = Vec::new();
        for size in SIZES {
            let scene = seen(&objects, size, &camera, exec)?;
            let [discs, ewa] = [blue(), ewa::Settings::default().into()].map(|method| {
                draw(&scene, method, &camera, exec).map(|found| against(&found, &truth))
            });
            let (discs, ewa) = (discs?, ewa?);
            let of = |found: splatref::compare::metrics::Coverage| {
                format!("{:.2}", percent(found.holes, found.interior))
            };
            let count = scene.surfels.len();
            row.push(format!("{count}: {}, {}", of(discs), of(ewa)));
        }
        holes.row(&format!("{name} | {side} | {}", row.join(" | ")));
    }
    Ok(cells.join(" | "))
}
