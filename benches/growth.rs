//! How the time of a picture grows with its surfels, pixels, tiles and threads, and what the order of
//! the surfels costs: four tables and two charts of `docs/limits.md`.
//!
//! `cargo bench --profile release --bench growth` prints Markdown, and with `--write` puts tables and
//! charts into that page; an argument is a pattern that the names of methods must contain. Scans are those
//! in the folder that `SPLATREF_MODELS` names (`../shared/models` if that is not set). The scene is
//! the sphere of the standard workloads, lit, with default settings. However many surfels it has, they
//! cover each pixel equally often. A time is the median of whole frames in the memory of a session, one
//! thread and tiles of 32 pixels where the table does not say otherwise.
//!
//! An exponent is that of the last step: 1 is as fast as what is drawn grows. Of surfels and pixels
//! alone it stays below 1, as the other one costs time too.

mod common;

use common::chart::{Axis, Series, svg};
use common::models::models;
use common::order::along_a_curve;
use common::report::{Arguments, Table};
use common::sphere::{STANDARD, Workload, camera_of, sphere};
use glam::Vec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::{Method, Session};
use splatref::number::elementary::ln;
use splatref::scene::{Cloud, Scene, Surfels};
use splatref::source::derive::{self, Derive};
use std::time::Instant;

const SURFELS: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];
/// Pixels a side.
const SIDES: [u32; 4] = [256, 1024, 4096, 8192];
/// Pixels a side of a tile.
const TILES: [u32; 4] = [8, 16, 32, 64];

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let one = Exec::new(1, 32)?;
    let scenes = SURFELS.map(scene);
    let methods: Vec<Method> =
        Method::all().into_iter().filter(|m| m.name().contains(&arguments.pattern)).collect();

    let mut by_surfels = Growth::new(&["10^4 surfels", "10^5", "10^6", "10^7"]);
    for method in &methods {
        let times = measured(SURFELS.len(), |i| frame(&scenes[i], *method, 1024, &one))?;
        by_surfels.add(*method, SURFELS.map(|n| n as f64), &times);
    }
    by_surfels.publish(&arguments, "surfels", "growth-surfels")?;

    let mut by_pixels =
        Growth::new(&["256 x 256 pixels", "1024 x 1024", "4096 x 4096", "8192 x 8192"]);
    for method in &methods {
        let times = measured(SIDES.len(), |i| frame(&scenes[1], *method, SIDES[i], &one))?;
        by_pixels.add(*method, SIDES.map(|side| f64::from(side * side)), &times);
    }
    by_pixels.publish(&arguments, "pixels", "growth-pixels")?;

    by_tiles(&arguments, &scenes[2], &methods)?;
    by_order(&arguments, &methods)
}

/// The table of tiles and threads.
fn by_tiles(arguments: &Arguments, scene: &Scene, methods: &[Method]) -> Result<()> {
    let threads: Vec<usize> = [1, 2, 4, 8, 16].into_iter().filter(|&n| n <= cores()).collect();
    let mut columns: Vec<String> =
        ["method", "8 px tiles", "16", "32", "64"].map(str::to_owned).to_vec();
    columns.push("slowest by fastest".to_owned());
    columns.extend(threads[1..].iter().map(|n| format!("{n} threads: times as fast")));
    let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
    for &method in methods {
        let time = |exec: &Exec| frame(scene, method, 1024, exec);
        let tiles = measured(TILES.len(), |i| time(&Exec::new(1, TILES[i])?))?;
        let parallel = measured(threads.len(), |i| time(&Exec::new(threads[i], 32)?))?;
        let [least, most] = ends(&tiles);
        let gains = parallel[1..].iter().map(|time| format!("{:.2}", parallel[0] / time));
        let cells = tiles
            .iter()
            .map(|time| format!("{time:.1}"))
            .chain([format!("{:.2}", most / least)])
            .chain(gains);
        table.row(&format!("{} | {}", method.name(), cells.collect::<Vec<_>>().join(" | ")));
    }
    table.publish_times(arguments, "limits.md", "growth-tiles")
}

/// The table of orders: the time in random order, or in the order of a scan's file, by the time along a
/// space-filling curve.
fn by_order(arguments: &Arguments, methods: &[Method]) -> Result<()> {
    let exec = Exec::new(1, 32)?;
    let random = |workload: &Workload| (format!("{}, random", workload.name), sphere(workload));
    let mut subjects: Vec<(String, Surfels)> = STANDARD.iter().map(random).collect();
    for pattern in ["bunny", "igea", "dragon"] {
        for (name, cloud) in models(pattern, arguments)? {
            let points = in_unit_sphere(cloud);
            let (surfels, _) = derive::surfels(points, &Derive::default(), &exec, &|_, _, _| ())?;
            subjects.push((format!("{name}, {} k", surfels.len() / 1000), surfels));
        }
    }
    let names = subjects.iter().map(|(name, _)| name.as_str());
    let mut table = Table::new(&std::iter::once("method").chain(names).collect::<Vec<_>>());
    let mut rows: Vec<String> = methods.iter().map(|method| method.name().to_owned()).collect();
    let mut sorting = "to sort once, ms".to_owned();
    for (name, surfels) in &subjects {
        let start = Instant::now();
        let along = Scene::lit(name, along_a_curve(surfels.clone())?);
        sorting += &format!(" | {:.0}", start.elapsed().as_secs_f64() * 1e3);
        let as_it_is = Scene::lit(name, surfels.clone());
        for (row, &method) in rows.iter_mut().zip(methods) {
            let [own, best] = [&as_it_is, &along].map(|scene| frame(scene, method, 1024, &exec));
            *row += &format!(" | {:.2}", own? / best?);
        }
    }
    rows.iter().chain([&sorting]).for_each(|row| table.row(row));
    table.publish_times(arguments, "limits.md", "growth-order")
}

/// The points of a cloud, moved and scaled into the unit sphere.
fn in_unit_sphere(cloud: Cloud) -> Cloud {
    let corners = |choose: fn(Vec3, Vec3) -> Vec3| cloud.position.iter().copied().reduce(choose);
    let (low, high) =
        (corners(Vec3::min).unwrap_or_default(), corners(Vec3::max).unwrap_or_default());
    let (middle, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
    let position = cloud.position.iter().map(|&p| (p - middle) / radius).collect();
    Cloud { position, normal: cloud.normal, color: cloud.color, ..Cloud::default() }
}

/// The sphere of this many surfels, each of an area that is inverse to it.
fn scene(count: usize) -> Scene {
    let radius = 4.5 / (count as f32).sqrt();
    Scene::lit("sphere", sphere(&Workload { name: "sphere", count, radius }))
}

/// The median milliseconds of a frame.
fn frame(scene: &Scene, method: Method, side: u32, exec: &Exec) -> Result<f64> {
    let (mut session, camera) = (Session::new(scene, method, exec)?, camera_of(side));
    let mut times = Vec::new();
    let begin = Instant::now();
    // The first frame takes the memory; then at least 3, and up to 15 within a second.
    while times.len() < 4 || (times.len() < 16 && begin.elapsed().as_secs() < 1) {
        let start = Instant::now();
        session.render(&camera)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let steady = &mut times[1..];
    steady.sort_by(f64::total_cmp);
    Ok(steady[steady.len() / 2])
}

/// The times of some steps.
fn measured(steps: usize, time: impl Fn(usize) -> Result<f64>) -> Result<Vec<f64>> {
    (0..steps).map(time).collect()
}

/// The least and the greatest time.
fn ends(times: &[f64]) -> [f64; 2] {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    [sorted[0], sorted[sorted.len() - 1]]
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Times of methods over sizes: a table and a chart.
struct Growth {
    table: Table,
    series: Vec<Series>,
}

impl Growth {
    /// An empty table with these sizes.
    fn new(sizes: &[&str]) -> Self {
        let table = Table::new(&[&["method"], sizes, &["exponent"]].concat());
        Self { table, series: Vec::new() }
    }

    /// A method's times, in milliseconds.
    fn add(&mut self, method: Method, sizes: [f64; 4], times: &[f64]) {
        let cells: Vec<_> = times.iter().map(|time| format!("{time:.1}")).collect();
        let exponent = ln(times[3] / times[2]) / ln(sizes[3] / sizes[2]);
        self.table.row(&format!("{} | {} | {exponent:.2}", method.name(), cells.join(" | ")));
        let points = sizes.into_iter().zip(times.iter().copied()).map(|(x, y)| [x, y]).collect();
        self.series.push(Series { name: method.name().to_owned(), points });
    }

    /// Puts table and chart into the page.
    fn publish(&self, arguments: &Arguments, what: &'static str, block: &str) -> Result<()> {
        let values = |axis: usize| {
            self.series.iter().flat_map(move |s| s.points.iter().map(move |p| p[axis]))
        };
        let x = Axis {
            title: what,
            ticks: self
                .series
                .first()
                .map_or_else(Vec::new, |s| s.points.iter().map(|p| p[0]).collect()),
        };
        let y = Axis::around("milliseconds a frame", values(1));
        let title = format!("Milliseconds a frame by {what}, one thread");
        let chart = svg(&title, [&x, &y], &self.series, ("", &[]));
        arguments.write(&format!("{block}.svg"), &chart)?;
        self.table.publish_times(arguments, "limits.md", block)
    }
}
