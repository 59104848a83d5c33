//! Verify your planes of the pull-push pyramid: which planes a correct implementation may leave of
//! each stage.
//!
//! Each stage is judged from the client's planes of the stage before. Floats are inputs as they are
//! stored, so they are exact. The formulas are the crate's, in balls of a [`Profile`].
//!
//! **Projection**: see [`mod@crate::verdict::projection`], which says which ribbons and tubes
//! are not judged. The later stages are judged whatever their inputs are.
//!
//! **Pull and push**, level by level from the client's own levels. The pull reads the client's
//! finer level. The push reads the client's coarser level and the same level after the pull. Level
//! 0 before the push is the projection's, and the end of its intervals is a computed number. For
//! each cell, every outcome is followed that the decisions allow: which ellipses hold its centre,
//! which is foremost, whose intervals overlap, whether it is occluded. A cell is right if one
//! outcome fits every plane. A level is judged if every plane that it is computed from is there.
//! Copied values must be equal.
//!
//! **Shading**: depth, kind and vectors come from the client's finest level after the push. (In a
//! picture of one pixel they come from the projection.) The colour comes from these planes of the
//! picture where they are there, as they are stored or as they were before. Without the finest
//! level these planes are not judged. The colour is judged then only in a scene without colours.
//!
//! A cell with more than 16 outcomes is not judged, and counts as undecided, like a cell with
//! several outcomes. A cell is marked at its place in its own plane, whatever its level.

mod levels;
mod pixel;
mod planes;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::pyramid;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::method::pyramid::{Cell, Settings};
use crate::method::record::rows;
use crate::method::stage::Keep;
use crate::number::MapInline;
use crate::number::ball::Profile;
use crate::verdict::client::Client;
use crate::verdict::gaps::missing;
use crate::verdict::marks::{MethodMarks, Watch, counted};
use crate::verdict::planes::RecordPlanes;
use crate::verdict::projection::{self as samples, SamplePlanes};
use crate::verdict::shift::Shifts;
use crate::verdict::{Check, Verdict};
use levels::Levels;
use pixel::PixelJudge;
use planes::PicturePlanes;

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let (found, unjudged, covered) = judge::<P>(job, settings, client, Watch::All);
    let mut stages = found.stage_verdicts(job);
    let last = pyramid::sizes(job.camera.width, job.camera.height).len() - 1;
    let there = job.there(Keep::Stages);
    let [pull, push] = [rows(&Cell::<f32>::PULL), rows(&Cell::<f32>::PUSH)];
    stages[1].missing = missing(client, "level", &pull, 1..last + 1, &there);
    stages[2].missing = missing(client, "level", &push, 0..last, &there);
    [stages[1].unjudged, stages[2].unjudged] = unjudged;
    let [pulled, pushed] = [1, 2].map_inline(|i: usize| stages[i].doubts.values());
    // Any doubt in a level may move the averages. A pixel with doubts in both stages is one pixel.
    let undecided =
        pulled.iter().zip(pushed).filter(|(pull, push)| *pull | *push != 0).count() as u64;
    Verdict::new(stages, [covered, undecided], budget, Shifts::default())
}

/// The grid of the corners.
fn snap(settings: &Settings) -> Snap {
    // The settings were checked before, so there is a grid with this many digits.
    Snap::new(settings.subpixel_bits).unwrap_or_default()
}

/// Every check at one pixel: the cells at its place in all levels, and the pixel itself.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    Ok(judge::<P>(job, settings, client, Watch::one(job, pixel)?).0.checks())
}

/// The findings about all stages, the levels of the pull and of the push that are not judged, and the
/// number of pixels that may be covered.
fn judge<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    watch: Watch,
) -> (MethodMarks<1>, [Vec<String>; 2], u64) {
    let sizes = pyramid::sizes(job.camera.width, job.camera.height);
    let last = sizes.len() - 1;
    let finest = SamplePlanes::new(client, job.scene);
    let cells = |fields| move |level| RecordPlanes::new(client, fields, level);
    let pulled: Vec<_> = (1..=last).map(cells(&Cell::<f32>::PULL)).collect();
    let pushed: Vec<_> = (0..last).map(cells(&Cell::<f32>::PUSH)).collect();
    let drawn = client.projection(job);
    let projection = samples::judge::<P>(&drawn, settings.cull, snap(settings), &finest, watch);
    let levels = Levels::<P>::new(job, &sizes, client.supposed, &finest, [&pulled, &pushed]);
    let before = vec![projection, levels.pull(watch), levels.push(settings, watch)];
    let client_planes = PicturePlanes::new(client);
    let judge = PixelJudge::new(job, levels.finest(), &client_planes);
    let found = job.exec.ordered(watch.pieces(job), |(_, rect)| {
        let mut marks = watch.marks(rect);
        let at = counted(rect);
        let covered = at.filter(|(pixel, at)| judge.judge(*at, &mut marks.at(*pixel))).count();
        ([marks], covered as u64)
    });
    let covered = found.iter().map(|(_, covered)| covered).sum();
    let tiles = found.into_iter().map(|(marks, _)| marks).collect();
    let stages = [("shading", judge.names())];
    (MethodMarks { levels: before, stages, tiles }, levels.unjudged(), covered)
}
