//! Verify your planes of the reconstruction with templates: which planes a correct implementation
//! may leave of each stage.
//!
//! Each stage is judged from the client's planes of the stage before. Floats are inputs as they are
//! stored, so they are exact. The formulas are the crate's, in balls of a [`Profile`].
//!
//! **Projection**: see [`mod@crate::verdict::projection`].
//!
//! **Propagation**, level by level from the client's finer level. For each cell, every outcome is
//! followed that the decisions allow: which centres move, which is foremost, which are near enough.
//! A cell is right if one outcome fits every plane. A level is judged if every plane of the finer
//! level is there; for level 0 these are the planes of the projection.
//!
//! **Reconstruction**, if every plane of every level is there: the gathering is replayed in its
//! order. Where a decision is undecided (which centre stays, whether the ellipse holds the pixel,
//! the ternary test, which is the front), all continuations are followed.
//!
//! **Normalization and shading** as in `ewa`, from the client's sums and averages.
//!
//! A cell or a pixel with more than 16 outcomes is not judged, and counts as undecided, like one
//! with several outcomes. A cell is marked at its place in its own plane, whatever its level.
//! Values that are copied from stage to stage (ids, depth and radius of the front, a centre that
//! moves alone) must be equal.

mod gathering;
mod levels;
mod pixel;
mod planes;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::pyramid;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::method::record::rows;
use crate::method::stage::Keep;
use crate::method::template::{Center, Settings, propagation};
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

/// All doubts, because in the gathering each of them may move the sums.
const ANY: u8 = u8::MAX;

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let (found, unjudged, covered) = judge::<P>(job, settings, client, Watch::All);
    let mut stages = found.stage_verdicts(job);
    let (levels, there) = (1..levels(job, settings).len(), job.there(Keep::Stages));
    stages[1].missing = missing(client, "level", &rows(&Center::<f32>::PLANES), levels, &there);
    stages[1].unjudged = unjudged;
    let undecided = stages[2].doubtful(ANY);
    Verdict::new(stages, [covered, undecided], budget, Shifts::default())
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

/// The sizes of the levels.
fn levels(job: &Job<'_>, settings: &Settings) -> Vec<[u32; 2]> {
    let mut sizes = pyramid::sizes(job.camera.width, job.camera.height);
    sizes.truncate(propagation::top(settings, &sizes) + 1);
    sizes
}

/// The findings about all stages, the levels that are not judged, and the number of pixels that may
/// be covered.
fn judge<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    watch: Watch,
) -> (MethodMarks<3>, Vec<String>, u64) {
    let sizes = levels(job, settings);
    let finest = SamplePlanes::new(client, job.scene);
    let coarser = |level| RecordPlanes::new(client, &Center::<f32>::PLANES, level);
    let coarser: Vec<_> = (1..sizes.len()).map(coarser).collect();
    let drawn = client.projection(job);
    let projection = samples::judge::<P>(&drawn, settings.cull, Snap::default(), &finest, watch);
    let levels = Levels::<P>::new(job, settings, &sizes, &finest, &coarser);
    let (propagation, unjudged) = (levels.judge(watch), levels.unjudged());
    let client_planes = PicturePlanes::new(client);
    let judge = PixelJudge::new(job, settings, levels.all(), &client_planes);
    let found = job.exec.ordered(watch.pieces(job), |(_, rect)| {
        let mut marks = [(); 3].map(|()| watch.marks(rect));
        let covered =
            counted(rect).filter(|(pixel, at)| judge.judge(*pixel, *at, &mut marks)).count();
        (marks, covered as u64)
    });
    let covered = found.iter().map(|(_, covered)| covered).sum();
    let tiles = found.into_iter().map(|(marks, _)| marks).collect();
    let stages = client_planes.stages(judge.gathers());
    (MethodMarks { levels: vec![projection, propagation], stages, tiles }, unjudged, covered)
}
