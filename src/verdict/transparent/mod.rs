//! Verify your planes of transparent layers: which planes a correct implementation may leave of
//! each stage.
//!
//! The order of the surfels is exact. The bin of a fragment is exact too, except close to the
//! border of a bin. Surfels are projected and shaded in [`Ball`](crate::number::Ball)s of a
//! [`Profile`], each in all of its groups.
//!
//! **Blending**, group by group: the fragments are replayed in their order. Where it is undecided
//! whether a surfel is drawn, whether its fragment is inside, or in which of two bins it lies, both
//! continuations are followed. Continuations with the same result count as one. A pixel of a group
//! is right if one continuation fits every plane of the group that is there. A pixel with more than
//! 16 continuations, or with a fragment that may be in more than two bins, is not judged.
//!
//! **Averaging** of the values that the client stores for each group. A value that it does not
//! store is taken from the continuations that fit, where they agree. If a value is not known for
//! one group, the average of this value is not judged. `Z` is the depth of one of the groups, and
//! no group certainly is nearer. `id` is the surfel of a group that may be the nearest (among equal
//! depths any of them). The picture follows from the client's average, before the environment if
//! there is one.
//!
//! **Environment.** Where the opacity is less than 1, the light of the ray is taken in balls. The
//! sky follows its formula. A map uses all squares of four pixel centres that the ray may lie
//! between; they meet without a jump, at the seam too. Where these are more than 8 in a row or a
//! column, as beside a pole, the colour is not judged. Weights are `f32` weights: a texture unit
//! that rounds them to 8 bits is not within a map's balls.
//!
//! A pixel is undecided if a group has several continuations or is not judged, or if the pixel's
//! colour is not judged.

pub(crate) mod averages;
pub(crate) mod drawings;
pub(crate) mod layers;
mod picture;
pub(crate) mod planes;
mod replay;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::transparent::{Holes, Settings};
use crate::number::ball::Profile;
use crate::verdict::client::{Client, Ties};
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::marks::{self, Counts, Marks, TilePart, counted};
use crate::verdict::single_pass::sum_rows;
use crate::verdict::{Check, Verdict};
use averages::AveragePlanes;
use layers::LayersJudge;
use picture::PictureJudge;
use planes::GroupFound;

/// The names of the stages.
const STAGES: [&str; 2] = ["blending", "averaging"];

/// Judges the planes of a client.
///
/// # Errors
/// As the projection of the method.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Result<Verdict> {
    let client_planes = client_planes(client);
    let judge = Judge::<P>::new(job, settings, client, &client_planes)?;
    let [first, second] = STAGES;
    let averaging = [judge.averages.names(), judge.shown.names()].concat();
    let stages = [(first, judge.layers.names()), (second, averaging)];
    let mut verdict = marks::verdict(job, stages, budget, |tile, marks| judge.judge(tile, marks));
    verdict.stages[0].missing = judge.layers.missing(job, client);
    Ok(verdict)
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let client_planes = client_planes(client);
    let judge = Judge::<P>::new(job, settings, client, &client_planes)?;
    marks::checks(job, STAGES, pixel, |tile, marks| judge.judge(tile, marks))
}

/// Depth and surfel of the picture. Each group scales a surfel, so the depths of one surfel in two
/// groups, or of two equal surfels, may tie or not.
fn client_planes(client: &Client) -> ClientPlanes<'_> {
    ClientPlanes { ties: Ties::Any, ..ClientPlanes::from_client(client, &sum_rows()) }
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    layers: LayersJudge<'a, P>,
    averages: AveragePlanes<'a>,
    holes: Holes,
    shown: PictureJudge<'a, P>,
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(
        job: &Job<'a>,
        settings: &Settings,
        client: &'a Client,
        client_planes: &'a ClientPlanes<'a>,
    ) -> Result<Self> {
        Ok(Self {
            layers: LayersJudge::project(job, settings, client)?,
            averages: AveragePlanes::new(job, client),
            holes: settings.holes,
            shown: PictureJudge::new(job, client, client_planes),
        })
    }

    /// Marks the wrong pixels of a rectangle in a tile.
    fn judge(&self, TilePart { tile, rect }: TilePart, marks: &mut [Marks; 2]) -> Counts {
        let mut counts = Counts::default();
        let [blending, averaging] = marks;
        for y in rect.y0..rect.y1 {
            let row = Rect { y0: y, y1: y + 1, ..rect };
            let drawings = self.layers.of_row(tile, &row);
            for (column, at) in counted(row) {
                let pixel = (y - rect.y0) as usize * row.columns() + column;
                let all = |_| true.into();
                let found = self.layers.judge(column, at, &drawings, all, &mut blending.at(pixel));
                let pixel = &mut averaging.at(pixel);
                let average = self.averages.judge(at, &found.groups, self.holes, pixel);
                let judged = self.shown.judge(at, &found.groups, &average, pixel);
                counts.covered += u64::from(found.groups.iter().any(GroupFound::covered));
                counts.undecided += u64::from(found.open || !judged);
            }
        }
        counts
    }
}
