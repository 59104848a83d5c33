//! The rates of \[ZP06\]: Table 2, and Algorithms 2 and 3 and depth peeling of section 6.2.
//!
//! `cargo bench --bench rates` prints Markdown, and with `--write` puts the table into
//! `docs/zp06.md`; an argument is a pattern that the names of scenes must contain. Two scenes are
//! procedural; the others are scans in the folder that `SPLATREF_MODELS` names
//! (`../shared/models` if it is not set), sampled at random with the points of the paper's models
//! and with radii that give the average degree of its Table 1. The paper does not say how large
//! its pictures are, nor on which model it timed transparency; ours have 1024 x 1024 pixels, and
//! its rates of transparency stand beside the Dragon, whose rate at 2+1 passes is close to the one
//! that it gives there. Opacity is 0.4 and light the headlight. Every method has its default settings:
//! the opaque ones cull what is seen from behind, but for the row of both sides. Every round draws
//! one frame of each row. Times are of whole frames, from the scene to shaded planes: the median
//! over the rounds, the minimum in brackets. The ratio is the median over the rounds of the time of
//! a frame by that of Algorithm 1 with the groups of Algorithms 2 and 3.

mod common;

use common::models::{self, resample, scaled};
use common::report::{Arguments, Table};
use common::sphere::{STANDARD, camera, cell, sphere};
use glam::DVec3;
use splatref::frame::Exec;
use splatref::index::grouping::{Extension, Grouping, Rules};
use splatref::io::ply;
use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::{Method, Session, ewa, peeling, single_pass, transparent, transparent_hq};
use splatref::scene::{Camera, Groups, Lens, Scene, Surfels};
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};
use splatref::splat::SplatSettings;
use splatref::{Error, Result};
use std::time::{Duration, Instant};

/// The paper's models: a scan in its place, points, average degree, and frames a second with 2+1
/// passes, with c = 0.8 and with c = 0.4 and Voronoi depth.
const PAPER: [(&str, &str, usize, f64, [&str; 3]); 4] = [
    ("BallJoint", "bunny", 137_000, 18.6, ["65.68", "52.96", "70.37"]),
    ("Female", "armadillo", 303_000, 18.9, ["32.65", "32.11", "37.76"]),
    ("Dragon", "dragon", 1_100_000, 8.8, ["15.04", "19.70", "22.62"]),
    ("David Head", "igea", 2_000_000, 17.2, ["0.96", "1.2", "1.4"]),
];
/// Frames a second of Algorithms 2 and 3 and of peeling with 8 layers.
const TRANSPARENT: [&str; 3] = ["9", "5", "< 2"];

/// What is drawn, and what the paper says of it.
struct Subject {
    name: String,
    surfels: Surfels,
    camera: Camera,
    table: [&'static str; 3],
    transparent: [&'static str; 3],
}

/// What one row draws: its name, a method, the groups if the method draws groups, and the paper's
/// rate.
type Row = (String, Method, Option<Groups>, &'static str);

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(0, 32)?);
    let mut table = Table::new(&[
        "scene",
        "method",
        "K",
        "splats",
        "frame, ms",
        "ratio",
        "frames/s",
        "paper, frames/s",
    ]);
    for subject in subjects(&arguments, &exec)? {
        let rows = rows(&subject, &exec)?;
        let times = draw(&subject, &rows, &exec)?;
        for ((method, _, groups, paper), own) in rows.iter().zip(&times) {
            let size = subject.surfels.len();
            let splats = groups.as_ref().map_or(size, |groups| size + groups.added().len());
            let k = groups.as_ref().map_or_else(String::new, |groups| groups.len().to_string());
            let (ratio, mut own) = (ratio(own, &times[BASE]), own.clone());
            let cell = cell(&mut own);
            let rate = 1.0 / own[own.len() / 2].as_secs_f64();
            let Subject { name, .. } = &subject;
            table.row(&format!(
                "{name} | {method} | {k} | {splats} | {cell} | {ratio:.2} | {rate:.1} | {paper}"
            ));
        }
    }
    table.publish_times(&arguments, "zp06.md", "rates")
}

/// The scenes whose names contain the pattern.
fn subjects(arguments: &Arguments, exec: &Exec) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    let wanted = |name: &str| name.contains(&arguments.pattern);
    let (table, transparent) = ([""; 3], [""; 3]);
    let tight = &STANDARD[1];
    if wanted(tight.name) {
        let name = format!("sphere, {}", tight.name);
        subjects.push(Subject {
            name,
            surfels: sphere(tight),
            camera: camera(),
            table,
            transparent,
        });
    }
    if wanted("cluster") {
        let shape =
            Shape::by_name("cluster").ok_or_else(|| Error::Invalid("no shape cluster".into()))?;
        let camera = Camera::new(1024, 1024, shape.default_pose(), shape.default_lens())?;
        let (name, surfels) = ("cluster, 200 k".to_owned(), shape.surfels(200_000, 0)?);
        subjects.push(Subject { name, surfels, camera, table, transparent });
    }
    for (paper, scan, count, degree, table) in PAPER {
        let name = format!("{scan} for {paper}, {} k", count / 1000);
        let path = models::path(scan);
        if !wanted(&name) {
            continue;
        }
        if !path.exists() {
            arguments.without(&path)?;
            continue;
        }
        let cloud = resample(&ply::read(&path)?, count, 1);
        let (derived, _) = derive::surfels(cloud, &Derive::default(), exec, &|_, _, _| ())?;
        let (surfels, _) = scaled(&derived, degree, exec);
        let around = surfels.bounding_sphere();
        let camera = Camera::framing(1024, 1024, around, DVec3::Z, Lens::FieldOfView(40.0))?;
        let transparent = if paper == "Dragon" { TRANSPARENT } else { transparent };
        subjects.push(Subject { name, surfels, camera, table, transparent });
    }
    Ok(subjects)
}

/// Table 2, and Algorithms 1 to 3 with the groups that transparency takes, and peeling.
fn rows(subject: &Subject, exec: &Exec) -> Result<Vec<Row>> {
    let silent = |_: &str, _, _| ();
    let groups = |overlap, count, extension| -> Result<Option<Groups>> {
        let rules = Rules { overlap, opposite: true, coplanar: None };
        let grouping = Grouping { rules, count, extension };
        Ok(Some(grouping.groups(&subject.surfels, exec, &silent)?.0))
    };
    let single = |splats, depth| Method::from(single_pass::Settings { splats, depth });
    let (culled, both) = (SplatSettings::default(), SplatSettings::BOTH_SIDES);
    let voronoi = DepthTest::Voronoi(BinCount::Epsilon);
    let four = groups(1.0, Some(4), Extension::Add { most: 0.5 })?;
    let peeling = |layers| Method::from(peeling::Settings { layers, ..Default::default() });
    let row = |name: &str, method: Method, groups, paper| (name.to_owned(), method, groups, paper);
    let ([two, plain, tests], [second, third, peeled]) = (subject.table, subject.transparent);
    let (opaque, split) = (single(culled, DepthTest::Plain), groups(0.8, None, Extension::None)?);
    Ok(vec![
        row("Algorithm 1", opaque, four.clone(), ""),
        row("Algorithm 1, both sides", single(both, DepthTest::Plain), four.clone(), ""),
        row("Algorithm 2", transparent::Settings::default().into(), four.clone(), second),
        row("Algorithm 3", transparent_hq::Settings::default().into(), four, third),
        row("peeling, 8 layers", peeling(8), None, peeled),
        row("peeling, 64 layers", peeling(64), None, ""),
        row("2+1 passes", ewa::Settings::default().into(), None, two),
        row("Algorithm 1, c = 0.8", opaque, split, plain),
        row(
            "Algorithm 1, c = 0.4, Voronoi",
            single(culled, voronoi),
            groups(0.4, None, Extension::None)?,
            tests,
        ),
    ])
}

/// The row that ratios are of.
const BASE: usize = 0;

/// For each row the times of its frames.
fn draw(subject: &Subject, rows: &[Row], exec: &Exec) -> Result<Vec<Vec<Duration>>> {
    let mut cloud = subject.surfels.clone().into_cloud();
    cloud.opacity = Some(vec![0.4; cloud.position.len()]);
    let scene = Scene::lit(&subject.name, Surfels::new(cloud)?.0);
    let sessions = rows
        .iter()
        .map(|(_, method, groups, _)| Session::with_groups(&scene, *method, groups.clone(), exec));
    let mut sessions = sessions.collect::<Result<Vec<_>>>()?;
    let mut times = vec![Vec::new(); rows.len()];
    let begin = Instant::now();
    // The first round takes the memory; then at least 5, and up to 25 within eight seconds.
    let mut round = 0;
    while round < 6 || (round < 26 && begin.elapsed().as_secs() < 8) {
        for (session, times) in sessions.iter_mut().zip(&mut times) {
            let start = Instant::now();
            session.render(&subject.camera)?;
            if round > 0 {
                times.push(start.elapsed());
            }
        }
        round += 1;
    }
    Ok(times)
}

/// The median of the ratios of two rows, round by round.
fn ratio(row: &[Duration], base: &[Duration]) -> f64 {
    let mut ratios: Vec<_> =
        row.iter().zip(base).map(|(a, b)| a.as_secs_f64() / b.as_secs_f64()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}
