//! Verify your planes of depth peeling: which planes a correct implementation may leave of each
//! stage.
//!
//! Surfels are projected in [`Ball`](crate::number::Ball)s of a [`Profile`]. Each layer is judged
//! from the client's depth of the layer before, as it is stored: `limit_j = t_j + epsilon` for that
//! depth. `Z` and `id` are depth and surfel of layer 1.
//!
//! **Layers.** These rules hold at a pixel and in a layer j whose depth the client stores, together
//! with the depth of layer j - 1:
//!
//! 1. `t_j` is in the ball of the depth of a fragment that possibly is inside and beyond
//!    `limit_(j-1)`. In layer 1 the fragment belongs to the surfel of the id.
//! 2. No fragment that certainly is drawn, inside and beyond `limit_(j-1)` certainly is nearer than
//!    `t_j`. Where there is no layer, no fragment certainly is inside and beyond.
//! 3. In layer 1 no surfel with an equal depth comes before the id's surfel by the client's tie
//!    rule. Depths are equal if they are the same and exact in balls, or if all numbers of the two
//!    surfels are the same.
//! 4. Count, opacity and colour come from the fragments inside, beyond `limit_(j-1)` and within
//!    `limit_j`, summed, averaged and shaded in balls. The fragment of the depth always passes, if
//!    only one fragment can be it. Where a decision is undecided, both continuations are kept, 2^n
//!    for n <= 4 fragments. Beyond that these planes are not judged.
//! 5. `layers` is the number of layers with a depth. If the last layer that leaves planes has a
//!    depth, fragments beyond its limit count too. `layers` is at least one more if a fragment
//!    certainly is beyond, at most the setting, and not more if no fragment possibly is beyond.
//!
//! **Blending** of the client's opacities and colours, if all layers that leave planes are there. A
//! pixel with more layers than leave planes is not judged. An environment is seen behind the layers
//! as in [`transparent`](crate::verdict::transparent). From the picture alone nothing is judged,
//! because the picture does not show its layers.
//!
//! A pixel is undecided if the sums of one of its layers have several continuations. It also is
//! undecided if its blending is not judged, because of the number of layers or because of the
//! environment.

mod blending;
mod layer;
mod planes;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::peeling::Settings;
use crate::method::peeling::layers::PeeledLayer;
use crate::method::record::rows;
use crate::method::stage::Keep;
use crate::number::ball::Profile;
use crate::verdict::checks::Backdrop;
use crate::verdict::client::Client;
use crate::verdict::gaps::missing;
use crate::verdict::marks::{self, Counts, Marks, TilePart, counted};
use crate::verdict::single_pass::fragments::GroupFragments;
use crate::verdict::{Check, Verdict};
use layer::LayerJudge;
use planes::PeelingPlanes;

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let client_planes = PeelingPlanes::new(client, settings);
    let judge = Judge::<P>::new(job, settings, &client_planes);
    let stages = client_planes.stages();
    let mut verdict = marks::verdict(job, stages, budget, |tile, marks| judge.judge(tile, marks));
    let (rows, there) = (rows(&PeeledLayer::<f32>::PLANES), job.there(Keep::Stages));
    let layers = 1..client_planes.layers.len() + 1;
    verdict.stages[0].missing = missing(client, "layer", &rows, layers, &there);
    verdict.stages[0].unjudged = client_planes.unjudged();
    verdict
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let client_planes = PeelingPlanes::new(client, settings);
    let judge = Judge::<P>::new(job, settings, &client_planes);
    let stages = client_planes.stages().map(|(stage, _)| stage);
    marks::checks(job, stages, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    client_planes: &'a PeelingPlanes<'a>,
    fragments: GroupFragments<'a, P>,
    layers: LayerJudge<'a, P>,
    backdrop: Backdrop<'a, P>,
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(job: &Job<'a>, settings: &'a Settings, client_planes: &'a PeelingPlanes<'a>) -> Self {
        let fragments = GroupFragments::whole(job, &settings.splats);
        let layers = LayerJudge::new(job, settings, client_planes, fragments.epsilon());
        Self { client_planes, fragments, layers, backdrop: Backdrop::new(job) }
    }

    /// Marks the wrong pixels of a rectangle in a tile.
    fn judge(&self, TilePart { tile, rect }: TilePart, marks: &mut [Marks; 2]) -> Counts {
        let [layers, blending] = marks;
        let mut counts = Counts::default();
        for y in rect.y0..rect.y1 {
            let row = Rect { y0: y, y1: y + 1, ..rect };
            let fragments =
                self.fragments.of_row(tile, &row, |_, at| self.client_planes.surfel(at));
            for (column, at) in counted(row) {
                let pixel = (y - rect.y0) as usize * row.columns() + column;
                let own: Vec<_> = fragments.at(column).in_group(0).copied().collect();
                let found = self.layers.judge(at, &own, &mut layers.at(pixel));
                let blends = blending::judge::<P>(
                    self.client_planes,
                    &self.backdrop,
                    at,
                    &mut blending.at(pixel),
                );
                counts.covered += u64::from(found.covered);
                counts.undecided += u64::from(found.undecided || !blends);
            }
        }
        counts
    }
}
