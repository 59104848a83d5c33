//! How long the exact greedy order takes, by the definition, on one thread and on two; then what
//! meshes give, see [`meshes`].
//!
//! `cargo bench --bench surfels` prints Markdown, and with `--write` puts the tables into
//! `docs/bjfm19.md` and draws its figure; an argument is a pattern that the names of point sets and
//! meshes must contain. Scans are those in the folder that `SPLATREF_MODELS` names (`../shared/models` if that
//! is not set). Each order is
//! held against the definition, for the first picks, and against that of one thread.

#[path = "../common/mod.rs"]
mod common;
mod meshes;
mod surface;

use common::report::{Arguments, Table};
use glam::Vec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::number::random;
use splatref::source::Shape;
use splatref::source::sampler::{Greedy, Order, Start};
use std::time::Instant;

const POINTS: usize = 500_000;
/// Picks that are held against the definition, whose time for more is in proportion.
const DEFINED: usize = 2000;
/// The least time of so many runs is what a run takes.
const RUNS: usize = 7;

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let execs = [Exec::sequential(), Exec::new(2, 32)?];
    let mut table = Table::new(&["points", "picks", "definition", "1 thread", "2 threads"]);
    for (name, points) in sets()? {
        if name.contains(&arguments.pattern) {
            measure(&mut table, name, &points, &execs)?;
        }
    }
    table.publish_times(&arguments, "bjfm19.md", "greedy")?;
    meshes::tables(&arguments, &execs[1])
}

/// A surface, a volume, and a grid full of ties.
fn sets() -> Result<[(&'static str, Vec<Vec3>); 3]> {
    let torus = Shape::Torus.surfels(POINTS, 0)?.position().to_vec();
    let unit = |i: u64| Vec3::from([0, 1, 2].map(|axis| random::unit(1, 3 * i + axis)));
    let cube = (0..POINTS as u64).map(unit).collect();
    let raster = (0..POINTS).map(|i| [i % 50, i / 50 % 100, i / 5000].map(|v| v as f32));
    Ok([
        ("torus, random", torus),
        ("cube, random", cube),
        ("grid, 50 x 100 x 100, in rows", raster.map(Vec3::from).collect()),
    ])
}

fn measure(table: &mut Table, name: &str, points: &[Vec3], execs: &[Exec; 2]) -> Result<()> {
    let greedy = Greedy { start: Start::Index(3) };
    let start = Instant::now();
    let defined = greedy.define(points, DEFINED)?;
    let a_pick = start.elapsed().as_secs_f64() / DEFINED as f64;
    for count in [10_000, 100_000, points.len()] {
        let (one, time) = least(&greedy, points, count, &execs[0])?;
        let (two, time_of_two) = least(&greedy, points, count, &execs[1])?;
        assert!(one == two, "{name}: the order depends on threads");
        assert_eq!(one.index[..DEFINED], defined.index, "{name}: not the definition's order");
        assert_eq!(one.distance[..DEFINED], defined.distance, "{name}");
        table.row(&format!(
            "{name} | {count} | {:.1} s | {:.0} ms | {:.0} ms",
            a_pick * count as f64,
            1e3 * time,
            1e3 * time_of_two
        ));
    }
    Ok(())
}

/// The order, and the least time that it took, in seconds.
fn least(greedy: &Greedy, points: &[Vec3], count: usize, exec: &Exec) -> Result<(Order, f64)> {
    let mut least = f64::INFINITY;
    let mut order = Order::default();
    for _ in 0..RUNS {
        let start = Instant::now();
        order = greedy.order(points, count, exec, &|_, _, _| ())?;
        let time = start.elapsed().as_secs_f64();
        if time < least {
            least = time;
        }
    }
    Ok((order, least))
}
