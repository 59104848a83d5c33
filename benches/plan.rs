//! The regret of `splatref plan`: what it chooses against the best of all candidates, each timed.
//!
//! `cargo bench --bench plan` prints a Markdown table, and with `--write` puts the table into `docs/plan.md`; an argument
//! is a pattern that the names of scenes must contain. Scenes are the six shapes, sparse and dense, in pictures
//! of 320 x 240. Budgets are errors (RMSE), halfway from the least error of a candidate to the median one and at
//! the median. All candidates are timed by turns, those that may be the best more often, then the plan is made, without what
//! these times tell.
//!
//! Regret is the time of what was planned by that of the fastest candidate within the error, both as all were timed,
//! less 1. A clock that ticks twice gives two times: *again* is the same of the exhaustive choice made from
//! a second round of times, which is what any choice by measuring must regret on this machine.

#[path = "common/mod.rs"]
mod common;

use common::report::{Arguments, Table};
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::scene_file::{SceneFile, Source};
use splatref::study::plan::{Budget, Known, choose, timed};
use splatref::study::run::Loss;
use splatref::study::run::measure::losses;
use splatref::study::run::truths;
use splatref::study::run::{Bench, Record, time};
use splatref::study::sweep::{Candidate, candidates};
use std::path::Path;

const SHAPES: [&str; 6] = ["sphere", "torus", "checkerboard", "sheets", "staircase", "cluster"];
const COUNTS: [usize; 2] = [3000, 30_000];

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(2, 32)?);
    let mut table = Table::new(&[
        "scene",
        "surfels",
        "candidates",
        "in small alone",
        "error at most",
        "planned",
        "its error",
        "best",
        "regret, %",
        "again, %",
    ]);
    let (mut regrets, mut floor) = (Vec::new(), Vec::new());
    for shape in SHAPES.iter().filter(|shape| shape.contains(&arguments.pattern)) {
        for count in COUNTS {
            for row in scene(shape, count, &exec)? {
                table.row(&format!("{shape} | {count} | {}", row.cells));
                regrets.push(row.regret);
                floor.push(row.again);
            }
        }
    }
    for (name, all) in [("planned", &mut regrets), ("again", &mut floor)] {
        all.sort_by(f64::total_cmp);
        if let (Some(most), median) = (all.last(), all.get(all.len() / 2)) {
            let median = median.copied().unwrap_or(0.0);
            println!("\n{name}: median {median:.1} %, most {most:.1} %");
        }
    }
    table.publish_times(&arguments, "plan.md", "plan")
}

struct Row {
    cells: String,
    regret: f64,
    again: f64,
}

/// The rows of a scene, one for each budget.
fn scene(shape: &str, count: usize, exec: &Exec) -> Result<Vec<Row>> {
    let mut file = SceneFile::open(Path::new(shape))?;
    file.camera.size = Some([320, 240]);
    if let Source::Shape { count: own, .. } = &mut file.models[0].source {
        *own = count;
    }
    let quiet = |_: &str, _, _| ();
    let all = candidates(&file, None)?.into_iter().filter(|candidate| !candidate.imitates);
    let (mut bench, all, _) = Bench::load(all.collect(), exec, &quiet)?;
    let ready = bench.visit(&all[0], exec, &quiet)?.ready;
    let camera = ready.camera;
    let truth = truths::Known::about(&file, &ready.loaded.scene, exec, &quiet)?;
    let truth = truth.still(&camera, exec, &quiet)?;
    let rmse = losses()
        .into_iter()
        .find(|loss| loss.figure == "rmse")
        .unwrap_or_else(|| losses()[0].clone());
    let measure = |bench: &mut Bench, budget| {
        choose(bench, &all, &truth, budget, &rmse as &Loss, exec, &quiet)
    };
    let errors: Vec<f64> =
        measure(&mut bench, Budget::Error(0.0))?.iter().map(|known| known.loss).collect();
    let mut sorted = errors.clone();
    sorted.sort_by(f64::total_cmp);
    let (least, median) = (sorted[0], sorted[sorted.len() / 2]);
    let mut rows = Vec::new();
    for most in [f64::midpoint(least, median), median] {
        let budget = Budget::Error(most);
        let timed = exhaustive(&mut bench, &all, (budget, &errors), exec)?;
        let second = exhaustive(&mut bench, &all, (budget, &errors), exec)?;
        let known = measure(&mut bench, budget)?;
        let (planned, small) =
            (budget.ranked(&known), known.iter().filter(|k| !k.is_whole).count());
        let (planned, best) = (planned[0], budget.ranked(&timed)[0]);
        let regret = |i: usize| 100.0 * (timed[i].time / timed[best].time - 1.0);
        let (regret, again) = (regret(planned), regret(budget.ranked(&second)[0]));
        let cells = format!(
            "{} | {small} | {most:.4} | `{}` | {:.4} | `{}` | {regret:.1} | {again:.1}",
            all.len(),
            all[planned].options,
            errors[planned],
            all[best].options
        );
        rows.push(Row { cells, regret, again });
    }
    Ok(rows)
}

/// Every candidate's median time, by turns. Those that may be the fastest within the error have more turns.
fn exhaustive(
    bench: &mut Bench,
    all: &[Candidate],
    (budget, errors): (Budget, &[f64]),
    exec: &Exec,
) -> Result<Vec<Known>> {
    let mut records: Vec<Record> = all.iter().map(Record::new).collect();
    for round in 0..time::ROUNDS {
        for i in time::order(round, all.len()) {
            time::turn(bench, &all[i], round, &mut records[i].times, exec)?;
        }
    }
    let time = |record: &Record| record.quartiles().map_or(f64::INFINITY, |[_, median, _]| median);
    let both = records.iter().zip(errors);
    let mut known: Vec<Known> = both
        .map(|(record, loss)| Known { time: time(record), loss: *loss, is_whole: true })
        .collect();
    timed(bench, all, &budget.hopeful(&known), &mut known, exec, &|_, _, _| ())?;
    Ok(known)
}
