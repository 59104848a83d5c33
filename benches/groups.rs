//! Table 1 of Zhang and Pajarola 2006, measured again, what covering the surface takes, and how long
//! scenes of up to ten million surfels take.
//!
//! `cargo bench --bench groups` prints Markdown, and with `--write` puts the tables into
//! `docs/zp06.md`; an argument is a pattern that the names of models must contain. Of each model
//! there are the vertices, and the same surface sampled at random with the counts of the paper's
//! models. Radii are those that this crate derives, which overlap more than the paper's; in the
//! rows marked with the factor they are scaled until the average degree at c = 1 is that of the
//! paper's model.

mod common;

use common::models::{divide, models, resample, scaled};
use common::report::{Arguments, Table};
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::grouping::{Extension, Grouping, Rules, extend, group_into};
use splatref::method::{Method, single_pass, transparent};
use splatref::scene::{Cloud, Surfels};
use splatref::source::Shape;
use splatref::source::derive::{self, Derive};
use std::cell::RefCell;
use std::time::{Duration, Instant};

/// The paper's models: points, and K / max degree / average degree at each c.
const PAPER: [(&str, usize, [&str; 4], f64); 4] = [
    (
        "BallJoint",
        137_000,
        ["17 / 31 / 18.6", "12 / 23 / 13.6", "9 / 14 / 7.1", "5 / 7 / 2.3"],
        18.6,
    ),
    ("Female", 303_000, ["19 / 49 / 18.9", "15 / 32 / 13.2", "10 / 18 / 6.9", "8 / 9 / 2.3"], 18.9),
    ("Dragon", 1_100_000, ["14 / 34 / 8.8", "12 / 29 / 6.3", "8 / 15 / 3.0", "5 / 7 / 0.8"], 8.8),
    (
        "David Head",
        2_000_000,
        ["18 / 37 / 17.2", "14 / 31 / 11.6", "11 / 24 / 9.4", "7 / 8 / 3.9"],
        17.2,
    ),
];
/// How many groups, and how far a surfel that is added may be covered; \[ZP06, Fig. 11\] compares
/// four groups with eight.
const COVERINGS: [(usize, f32); 4] = [(4, 0.25), (4, 0.5), (4, 0.75), (8, 0.5)];
const OVERLAPS: [f32; 4] = [1.0, 0.8, 0.6, 0.4];

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let exec = Exec::new(0, 32)?;
    let models = models(&arguments.pattern, &arguments)?;
    let mut table = Table::new(&[
        "model",
        "points",
        "radii",
        "c = 1.0",
        "c = 0.8",
        "c = 0.6",
        "c = 0.4",
        "time at c = 1",
        "time, all four c",
    ]);
    for (name, points, cells, _) in PAPER {
        table.row(&format!("{name} (the paper) | {points} | | {} | | ", cells.join(" | ")));
    }
    for (name, cloud) in &models {
        rows(&mut table, name, &surfels(cloud.clone(), &exec), 17.5, &exec);
        for (_, count, _, degree) in PAPER {
            let sampled = surfels(resample(cloud, count, 1), &exec);
            rows(&mut table, name, &sampled, degree, &exec);
        }
    }
    table.publish_times(&arguments, "zp06.md", "groups")?;
    let mut table = Table::new(&[
        "model",
        "points",
        "K",
        "c",
        "`--most`",
        "added",
        "coverage before",
        "after",
        "time",
    ]);
    for (name, cloud) in &models {
        // As it was scanned, and as the paper's models: sampled, with radii of the paper's degree.
        let scan = surfels(cloud.clone(), &exec);
        for (count, most) in COVERINGS {
            table.row(&covering(&format!("{name}, original scan"), &scan, (count, most), &exec));
        }
        let (_, count, _, degree) = PAPER[2];
        let (scene, _) = scaled(&surfels(resample(cloud, count, 1), &exec), degree, &exec);
        for (count, most) in COVERINGS {
            table.row(&covering(name, &scene, (count, most), &exec));
        }
    }
    table.publish_times(&arguments, "zp06.md", "covering")?;
    let mut table = Table::new(&["surfels", "groups", "K", "time", "longest steps"]);
    for count in [100_000, 1_000_000, 10_000_000] {
        let sphere = Shape::Sphere.surfels(count, 0)?;
        // Enlarging ten million takes minutes, and no method asks for it.
        let enlarged = usize::from(count < 10_000_000);
        for (name, grouping) in &defaults()[..2 + enlarged] {
            table.row(&steps(name, &sphere, grouping, &exec));
        }
    }
    table.publish_times(&arguments, "zp06.md", "grouping")
}

/// The groups that methods ask for, and the other extension of those with few.
fn defaults() -> [(&'static str, Grouping); 3] {
    let of = |method: Method| method.grouping().expect("a method with groups");
    let four = of(transparent::Settings::default().into());
    [
        ("`single-pass`", of(single_pass::Settings::default().into())),
        ("`transparent`", four),
        ("`transparent`, enlarged", Grouping { extension: Extension::Enlarge, ..four }),
    ]
}

/// How long groups take, and the steps of which it takes a tenth or more.
fn steps(name: &str, surfels: &Surfels, grouping: &Grouping, exec: &Exec) -> String {
    let seen = RefCell::new((Instant::now(), String::new(), Vec::<(String, f64)>::new()));
    let note = |step: &str| {
        let (since, last, steps) = &mut *seen.borrow_mut();
        let time = since.elapsed().as_secs_f64();
        match steps.iter_mut().find(|step| step.0 == *last) {
            Some(step) => step.1 += time,
            None => steps.push((last.clone(), time)),
        }
        (*since, *last) = (Instant::now(), step.to_owned());
    };
    let start = Instant::now();
    let found = grouping.groups(surfels, exec, &|step, _, _| note(step)).expect("groups");
    let time = start.elapsed().as_secs_f64();
    note("");
    let (_, _, steps) = seen.into_inner();
    let large = steps.into_iter().filter(|step| step.1 > 0.1 * time);
    let parts = large.map(|(step, part)| format!("{step} {:.0} %", 100.0 * part / time));
    let parts = parts.collect::<Vec<_>>().join(", ");
    format!("{} | {name} | {} | {time:.2} s | {parts}", surfels.len(), found.0.len())
}

fn surfels(cloud: Cloud, exec: &Exec) -> Surfels {
    derive::surfels(cloud, &Derive::default(), exec, &|_, _, _| ()).expect("a model").0
}

/// One row with the derived radii, one with those of the paper's degree.
fn rows(table: &mut Table, name: &str, surfels: &Surfels, degree: f64, exec: &Exec) {
    table.row(&row(name, surfels, "derived", exec));
    let (scaled, factor) = scaled(surfels, degree, exec);
    table.row(&row(name, &scaled, &format!("{factor:.3}"), exec));
}

/// K / most / average degree at each c, and the times.
fn row(name: &str, surfels: &Surfels, radii: &str, exec: &Exec) -> String {
    let mut cells = Vec::new();
    let mut times = Vec::new();
    for overlap in OVERLAPS {
        let start = Instant::now();
        let found = divide(surfels, overlap, exec);
        times.push(start.elapsed());
        cells.push(found.map_or_else(
            || "over 64".into(),
            |r| format!("{} / {} / {:.1}", r.groups, r.max_degree, r.average_degree),
        ));
    }
    let all: Duration = times.iter().sum();
    let [first, all] = [times[0], all].map(|time| format!("{:.2} s", time.as_secs_f64()));
    let cells = cells.join(" | ");
    format!("{name} | {} | {radii} | {cells} | {first} | {all}", surfels.len())
}

/// Surfels added so that some groups cover the surface.
fn covering(name: &str, surfels: &Surfels, (count, most): (usize, f32), exec: &Exec) -> String {
    let silent = |_: &str, _, _| ();
    let (groups, report) =
        group_into(surfels, &Rules::default(), count, exec, &silent).expect("groups");
    let start = Instant::now();
    let extension = Extension::Add { most };
    let (_, extended) = extend(surfels, &groups, &extension, exec, &silent).expect("coverage");
    let percents = |of: fn(&splatref::index::grouping::GroupCoverage) -> f64| {
        let parts = extended.groups.iter().map(|g| format!("{:.0} %", 100.0 * of(g)));
        parts.collect::<Vec<_>>().join(", ")
    };
    format!(
        "{name} | {} | {} | {} | {most} | {:.0} % | {} | {} | {:.2} s",
        surfels.len(),
        report.groups,
        report.overlap,
        extended.percent,
        percents(|g| g.before),
        percents(|g| g.after),
        start.elapsed().as_secs_f64()
    )
}
