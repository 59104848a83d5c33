//! Verdicts on clients, and the figures of the table.

use crate::scenes::{Job, exec};
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::shift::Shifts;
use splatref::verdict::{Outcome, Verdict};

/// The verdict on a client's picture of a scene, in figures.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(crate) outcome: Outcome,
    /// The first wrong stage, and its worst pixel in words.
    pub(crate) fault: Option<String>,
    /// The stages whose errors are unlike those of right renderers.
    pub(crate) unlike: String,
    /// The largest error of each judged stage, in bounds.
    pub(crate) errors: Vec<(&'static str, f32)>,
    /// The share of covered pixels whose sums are undecided.
    pub(crate) undecided: f64,
    /// To which side the undecided decisions lean: cut-off, epsilon.
    pub(crate) shifts: Shifts,
}

/// Judges a client under a promise.
pub(crate) fn judge(job: &Job, client: &Client, rounding: Rounding) -> Judged {
    let mut client = client.clone();
    client.rounding = rounding;
    let exec = exec();
    let session = job.session(&exec);
    let verdict =
        session.verify(&job.camera, &client, Verdict::BUDGET).expect("planes that can be judged");
    let judged = verdict.stages.iter().filter(|stage| !stage.planes.is_empty());
    let largest =
        |errors: &[f32]| errors.iter().copied().fold(0.0, |a: f32, b| if b > a { b } else { a });
    let fault = verdict.first_wrong().map(|stage| {
        let (at, fault) =
            stage.worst.as_ref().map(|worst| (worst.pixel, &worst.fault)).expect("a worst pixel");
        format!("{}: {} pixels wrong, at {at:?} {fault}", stage.stage, stage.wrong)
    });
    Judged {
        outcome: verdict.outcome(),
        fault,
        unlike: verdict.unlike.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        errors: judged.map(|stage| (stage.stage, largest(stage.errors.values()))).collect(),
        undecided: verdict.undecided as f64 / verdict.covered.max(1) as f64,
        shifts: verdict.shifts,
    }
}
