//! List what a verdict does not judge: planes that the client does not hand in, and planes that it
//! hands in without those that they follow from.

use super::client::Client;
use super::{StageVerdict, Verdict};
use crate::frame::Frame;
use crate::method::stage::{Conditions, Holds, Keep, PlaneRow};
use crate::method::{Job, Stage};
use std::ops::Range;

/// Lists the planes of numbered rows that a client lacks. A number without any plane is listed as a
/// whole, by this word.
pub(crate) fn missing(
    client: &Client,
    word: &str,
    rows: &[PlaneRow],
    numbers: Range<usize>,
    there: &Conditions,
) -> Vec<String> {
    let mut missing = Vec::new();
    for number in numbers {
        let rows = rows.iter().filter(|row| there.hold(row) && row.holds != Holds::Diagnostic);
        let names = rows.map(|row| row.numbered(number));
        let (there, not): (Vec<_>, Vec<_>) =
            names.partition(|name| client.frame().plane(name).is_some());
        missing.extend(if there.is_empty() { vec![format!("{word} {number}")] } else { not });
    }
    missing
}

/// Completes the lists of a verdict. The judge of a method has listed the planes of numbered rows;
/// this adds all others.
pub(super) fn list(verdict: &mut Verdict, stages: &[Stage], job: &Job<'_>, frame: &Frame<f64>) {
    let there = job.there(Keep::Stages);
    for stage in stages {
        let Some(at) = verdict.stages.iter().position(|own| own.stage == stage.name) else {
            continue;
        };
        let any = frame.planes.iter().any(|plane| stage.row(&plane.name).is_some());
        let singles = || stage.leaves.iter().filter(|row| is_single(row));
        let (handed_in, lacking): (Vec<_>, Vec<_>) =
            singles().partition(|row| frame.plane(row.name).is_some());
        let unjudged = handed_in.into_iter().filter(|row| !is_judged(&verdict.stages, stage, row));
        let unjudged: Vec<String> = unjudged.map(|row| shown(row.name)).collect();
        let StageVerdict { missing, unjudged: own, .. } = &mut verdict.stages[at];
        own.extend(unjudged);
        if any {
            let lacking = lacking.into_iter().filter(|row| there.hold(row));
            missing.extend(lacking.map(|row| shown(row.name)));
        } else {
            // The stage as a whole is not judged, which its empty list of planes says.
            missing.clear();
        }
    }
}

/// Whether a row stands for one plane of a renderer.
fn is_single(row: &PlaneRow) -> bool {
    !row.name.contains('#') && row.holds != Holds::Diagnostic
}

/// Whether a stage judges the plane of a row. The highest bits of ids are judged with the lowest.
fn is_judged(judged: &[StageVerdict], stage: &Stage, row: &PlaneRow) -> bool {
    let lists = |row: &PlaneRow| judged.iter().any(|own| own.planes.contains(&row.name));
    let mut ids = stage.leaves.iter().filter(|own| own.holds == Holds::Index);
    lists(row) || (row.holds == Holds::HighIndex && ids.any(lists))
}

/// The name of a plane as reports write it.
fn shown(name: &str) -> String {
    if name.is_empty() { "RGB".into() } else { name.into() }
}
