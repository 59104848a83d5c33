//! Speed of single-pass rendering against the 2+1-pass method: the question of \[ZP06, Table 2\].
//!
//! `cargo bench --bench single_pass` prints Markdown, and with `--write` puts the table into
//! `docs/zp06.md`; an argument is a pattern that the names of workloads must contain. Every round
//! draws one frame of each row, so that all rows see the same machine. Times are the median over
//! the rounds, the minimum in brackets, in milliseconds; the ratio is the median over the rounds of
//! the time of the frame by that of the 2+1-pass method.
//!
//! The rows are groupings of this crate without relaxations, by c, and the c that gives 8 groups.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, camera, cell, sphere};
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::grouping::{GroupingReport, Rules, group, group_into};
use splatref::method::single_pass::{BinCount, DepthTest, Settings};
use splatref::method::{Method, Session};
use splatref::scene::{Camera, Groups, Light, Scene, Surfels};
use std::time::{Duration, Instant};

/// What one row draws: its name, a method, and the groups if the method draws groups.
type Row = (String, Method, Option<Groups>);

/// The time of a frame, and of projection, geometry and what comes after it.
type Times = [Duration; 4];

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let mut table = Table::new(&[
        "workload",
        "planes",
        "threads",
        "method",
        "frame",
        "ratio",
        "projection",
        "geometry",
        "compositing",
    ]);
    for workload in STANDARD.iter().filter(|w| w.name.contains(&arguments.pattern)) {
        let mut scene = Scene::unlit(workload.name, sphere(workload));
        let mut methods: Vec<Row> = vec![("2+1 passes".to_owned(), Method::default(), None)];
        for (name, groups) in groupings(&scene.surfels) {
            let by = |depth| Method::from(Settings { depth, ..Settings::default() });
            methods.push((name.clone(), by(DepthTest::Plain), Some(groups.clone())));
            let voronoi = by(DepthTest::Voronoi(BinCount::Epsilon));
            methods.push((format!("{name}, Voronoi"), voronoi, Some(groups)));
        }
        for (planes, light) in [("colour", None), ("colour, normal", Some(Light::DEFAULT))] {
            scene.lights = light.into_iter().collect();
            for threads in [1, 2] {
                let rows = measure(&scene, &methods, threads)?;
                for (index, (name, ..)) in methods.iter().enumerate() {
                    let ratio = ratio(&rows[index], &rows[0]);
                    let column =
                        |i: usize| -> Vec<_> { rows[index].iter().map(|t| t[i]).collect() };
                    let [frame, project, geometry, rest] =
                        [0, 1, 2, 3].map(|i| cell(&mut column(i)));
                    table.row(&format!(
                        "{} | {planes} | {threads} | {name} | {frame} | {ratio:.2} | {project} | \
                         {geometry} | {rest}",
                        workload.name
                    ));
                }
            }
        }
    }
    table.publish_times(&arguments, "zp06.md", "single-pass")
}

/// Groups that do not overlap, that do more and more, and 8 of them.
fn groupings(surfels: &Surfels) -> Vec<(String, Groups)> {
    let (exec, silent) = (Exec::new(0, 32).expect("threads"), |_: &str, _, _| ());
    let by_c = |overlap| group(surfels, &Rules { overlap, ..Rules::default() }, &exec, &silent);
    let eight = group_into(surfels, &Rules::default(), 8, &exec, &silent);
    let all = [1.0, 0.8, 0.6, 0.4].map(by_c).into_iter().chain([eight]);
    let named = |result: Result<(Groups, GroupingReport)>| {
        let (groups, report) = result.expect("groups");
        (format!("K = {}, c = {:.3}", report.groups, report.overlap), groups)
    };
    all.map(named).collect()
}

/// For each method the times of its frames, without shading.
fn measure(scene: &Scene, methods: &[Row], threads: usize) -> Result<Vec<Vec<Times>>> {
    let camera = camera();
    let exec = Exec::new(threads, 32)?;
    let sessions = methods
        .iter()
        .map(|(_, method, groups)| Session::with_groups(scene, *method, groups.clone(), &exec));
    let mut sessions = sessions.collect::<Result<Vec<_>>>()?;
    let mut rows = vec![Vec::new(); methods.len()];
    let start = Instant::now();
    // At least 9 rounds, then up to 51 within four seconds.
    while rows[0].len() < 9 || (rows[0].len() < 51 && start.elapsed().as_secs() < 4) {
        for (session, row) in sessions.iter_mut().zip(&mut rows) {
            row.push(frame(session, &camera)?);
        }
    }
    Ok(rows)
}

fn frame(session: &mut Session<'_>, camera: &Camera) -> Result<Times> {
    let laps = &session.render(camera)?.timings;
    let time = |stages: &[&str]| -> Duration {
        laps.iter().filter(|(name, _)| stages.contains(name)).map(|(_, time)| *time).sum()
    };
    let projection = time(&["projection"]);
    let geometry = time(&["geometry", "visibility", "attributes"]);
    let rest = time(&["compositing", "normalization"]);
    Ok([projection + geometry + rest, projection, geometry, rest])
}

/// The median of the ratios of two rows, round by round.
fn ratio(row: &[Times], base: &[Times]) -> f64 {
    let mut ratios: Vec<_> =
        row.iter().zip(base).map(|(a, b)| a[0].as_secs_f64() / b[0].as_secs_f64()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}
