//! Candidates of meshes, and how the samplers spread them \[BJFM19, 3.3 and 5.2\].

use crate::common::models::models;
use crate::common::plant;
use crate::common::report::{Arguments, Table};
use crate::surface;
use glam::Vec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::scene::{Cloud, Primitives, Scene, Surfels, Triangles};
use splatref::source::candidates::{Candidates, Directions, SIDE, candidates};
use splatref::source::derive;
use splatref::source::sampler::{Greedy, Order, Progressive, Schedule, Start, quality, shuffled};
use splatref::study::spread::{self, Ordered};
use std::time::Instant;

/// Surfels of Table 2.
const COUNTS: [usize; 3] = [10_000, 50_000, 100_000];
/// Prefixes of Fig. 3.
const PREFIXES: [usize; 3] = [1000, 5000, 10_000];
/// The mesh of Fig. 3.
const FIGURE: &str = "bunny";
const SAMPLERS: [&str; 4] = ["greedy", "progressive", "as shipped", "random"];

pub(crate) fn tables(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut meshes = Table::new(&["mesh", "triangles", "candidates", "time, s", "M triangles/s"]);
    let mut times = Table::new(&["mesh", "sampler", "10 k, s", "50 k, s", "100 k, s"]);
    let mut spread = Table::new(&[
        "mesh",
        "sampler",
        "1 k: least, median, covering",
        "5 k: least, median, covering",
        "10 k: least, median, covering",
    ]);
    let mut along = surface::table();
    let quiet = |_: &str, _, _| ();
    let mut all = Vec::new();
    for (name, cloud) in models(&arguments.pattern, arguments)? {
        all.push((name, scene(derive::polygons(cloud, exec, &quiet)?.0)));
    }
    for (name, mesh) in
        [("bumpy torus", plant::torus as fn() -> Result<Triangles>), ("pipes", plant::pipes)]
    {
        if name.contains(&arguments.pattern) {
            all.push((name, scene(mesh()?)));
        }
    }
    for (name, scene) in all {
        let start = Instant::now();
        let all = candidates(&scene, &Directions::Cube, SIDE, exec, &quiet)?;
        let Candidates { cloud, counts, .. } = &all;
        let (time, triangles) = (start.elapsed().as_secs_f64(), scene.primitives.triangles.len());
        let rate = (triangles * counts.len()) as f64 / time / 1e6;
        let found = cloud.position.len();
        meshes.row(&format!("{name} | {triangles} | {found} | {time:.2} | {rate:.1}"));
        let orders = of_samplers(name, cloud, exec, (&mut times, &mut spread))?;
        if name == FIGURE {
            let all = Some(&cloud.position[..]);
            let found = spread::measure(&orders, all, &PREFIXES, true, exec, &quiet)?;
            arguments.write("bjfm19-spread.svg", &spread::chart(&found)?.svg())?;
        }
        surface::row(&mut along, name, &all, exec)?;
    }
    meshes.publish_times(arguments, "bjfm19.md", "candidates")?;
    times.publish_times(arguments, "bjfm19.md", "samplers")?;
    spread.publish(arguments, "bjfm19.md", "spread")?;
    along.publish_times(arguments, "bjfm19.md", "geodesic")
}

fn of_samplers(
    name: &str,
    cloud: &Cloud,
    exec: &Exec,
    (times, spread): (&mut Table, &mut Table),
) -> Result<Vec<Ordered>> {
    let points = &cloud.position;
    let (mut unit, mut orders) = (None, Vec::new());
    for sampler in SAMPLERS {
        let mut cells = Vec::new();
        let mut last = Order::default();
        for count in COUNTS {
            let start = Instant::now();
            last = order(sampler, points, count, exec)?;
            let time = start.elapsed().as_secs_f64();
            cells.push(if last.index.len() < count {
                format!("{time:.2} ({} found)", last.index.len())
            } else {
                format!("{time:.2}")
            });
        }
        times.row(&format!("{name} | {sampler} | {}", cells.join(" | ")));
        // The first is the exact one: its least distance is the unit of all.
        let of_greedy: [f32; 3] =
            *unit.get_or_insert_with(|| PREFIXES.map(|prefix| last.distance[prefix - 1].sqrt()));
        let mut cells = Vec::new();
        for (prefix, unit) in PREFIXES.into_iter().zip(of_greedy) {
            let found = quality(points, &last.index[..prefix], exec)?;
            let mut nearest = found.nearest;
            nearest.sort_unstable_by(f32::total_cmp);
            let all = [found.packing, nearest[prefix / 2], found.covering];
            cells.push(all.map(|d| format!("{:.2}", d.sqrt() / unit)).join(", "));
        }
        spread.row(&format!("{name} | {sampler} | {}", cells.join(" | ")));
        let first = &last.index[..PREFIXES[PREFIXES.len() - 1]];
        let points = first.iter().map(|i| points[*i as usize]).collect();
        orders.push(Ordered { name: sampler.to_owned(), points });
    }
    Ok(orders)
}

fn order(sampler: &str, points: &[Vec3], count: usize, exec: &Exec) -> Result<Order> {
    let quiet = |_: &str, _, _| ();
    let start = Start::Seed(0);
    let progressive =
        |schedule| Progressive { start, seed: 0, schedule }.order(points, count, &quiet);
    match sampler {
        "greedy" => Greedy { start }.order(points, count, exec, &quiet),
        "progressive" => progressive(Schedule::Paper),
        "as shipped" => progressive(Schedule::AsShipped),
        _ => shuffled(points, 0, count, &|_, _, _| ()),
    }
}

fn scene(triangles: Triangles) -> Scene {
    let primitives = Primitives { triangles, ..Primitives::default() };
    Scene { primitives, ..Scene::unlit("mesh", Surfels::none()) }
}
