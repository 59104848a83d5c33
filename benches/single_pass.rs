//! Speed of single-pass rendering against the 2+1-pass method: the question of \[ZP06, Table 2\].
//!
//! `cargo bench --bench single_pass` prints Markdown, and with `--write` puts the table into
//! `docs/zp06.md`; an argument is a pattern that the names of workloads must contain. Every round draws one frame of each row, so that all rows see the same
//! machine. Times are the median over the rounds, the minimum in brackets, in milliseconds; the
//! ratio is the median over the rounds of the time of the frame by that of the 2+1-pass method.
//!
//! The rows are groupings of this crate without relaxations, by c, and the c that gives 8 groups.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, camera, cell, sphere};
use splatref::Result;
use splatref::frame::{Exec, Framebuffer, Wanted};
use splatref::index::grouping::{GroupingReport, Rules, group, group_into};
use splatref::method::ewa;
use splatref::method::single_pass::{BinCount, DepthTest, Settings, fast};
use splatref::scene::Groups;
use splatref::scene::{Camera, Surfels};
use std::time::{Duration, Instant};

/// What one row draws: the 2+1-pass method, or groups and a depth test.
enum Method<'a> {
    TwoPass,
    SinglePass(&'a Groups, DepthTest),
}

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
        let surfels = sphere(workload);
        let groupings = groupings(&surfels);
        let mut methods = vec![("2+1 passes".to_owned(), Method::TwoPass)];
        for (name, groups) in &groupings {
            methods.push((name.clone(), Method::SinglePass(groups, DepthTest::Plain)));
            let voronoi = DepthTest::Voronoi(BinCount::Epsilon);
            methods.push((format!("{name}, Voronoi"), Method::SinglePass(groups, voronoi)));
        }
        for (planes, normal) in [("colour", false), ("colour, normal", true)] {
            for threads in [1, 2] {
                let rows = measure(&surfels, &methods, normal, threads);
                for (index, (name, _)) in methods.iter().enumerate() {
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

/// For each method the times of its frames.
fn measure(
    surfels: &Surfels,
    methods: &[(String, Method<'_>)],
    normal: bool,
    threads: usize,
) -> Vec<Vec<Times>> {
    let camera = camera();
    let exec = Exec::new(threads, 32).expect("threads");
    let wanted = Wanted { normal, color: true, observed: false };
    let mut target = Framebuffer::new(1024, 1024, 0.0, wanted);
    let mut rows = vec![Vec::new(); methods.len()];
    let start = Instant::now();
    // At least 9 rounds, then up to 51 within four seconds.
    while rows[0].len() < 9 || (rows[0].len() < 51 && start.elapsed().as_secs() < 4) {
        for ((_, method), row) in methods.iter().zip(&mut rows) {
            row.push(frame(surfels, method, &camera, &exec, &mut target));
        }
    }
    rows
}

fn frame(
    surfels: &Surfels,
    method: &Method<'_>,
    camera: &Camera,
    exec: &Exec,
    target: &mut Framebuffer<f32>,
) -> Times {
    let start = Instant::now();
    match method {
        Method::TwoPass => {
            let settings = ewa::Settings::default();
            let (_, times) = ewa::fast::render(surfels, camera, &settings, exec, target);
            let geometry = times.visibility + times.attributes;
            [start.elapsed(), times.project, geometry, times.normalize]
        }
        Method::SinglePass(groups, depth) => {
            let settings = Settings { depth: *depth, ..Settings::default() };
            let (_, times) = fast::render(surfels, groups, camera, &settings, exec, target)
                .expect("few enough bins");
            [start.elapsed(), times.project, times.geometry, times.compositing]
        }
    }
}

/// The median of the ratios of two rows, round by round.
fn ratio(row: &[Times], base: &[Times]) -> f64 {
    let mut ratios: Vec<_> =
        row.iter().zip(base).map(|(a, b)| a[0].as_secs_f64() / b[0].as_secs_f64()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}
