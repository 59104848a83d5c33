//! Verify your planes of EWA: which planes a correct implementation may leave of each stage.
//!
//! The verdict projects surfels in [`Ball`](crate::number::Ball)s of a [`Profile`]. It tests a
//! fragment as for the [margin](super#the-margin). Each stage is judged from the client's planes of
//! the stage before, as the client stores them. A plane that the client lacks is taken from the
//! balls.
//!
//! **Projection**, if the client hands in its records:
//!
//! - Each number of a record is in its ball.
//! - Normal, opacity and colour are the surfel's.
//! - Every surfel that certainly is drawn has a record.
//! - No surfel that certainly is not drawn has a record.
//!
//! A record is marked at the pixel of its centre. The later stages are judged from the records, as
//! they are stored.
//!
//! **Visibility**, a certificate. Z and id come from `visibility`, else from the picture.
//!
//! 1. The surfel of the id has a fragment at the pixel that possibly is inside.
//! 2. Z is in the ball of its depth. With Z alone some fragment must satisfy 1 and 2.
//! 3. No other surfel that certainly is drawn has a fragment that certainly is inside and whose
//!    depth certainly is less than Z. Without Z, its depth is compared with the depth of the id's
//!    fragment. In an empty pixel Z is +inf, so no fragment may certainly be inside.
//!
//! 4. No surfel with an equal depth comes before the id's surfel by the client's tie rule. Depths
//!    are equal if they are the same and exact in balls, or if all numbers of the two surfels are
//!    the same.
//!
//! In other near ties the id is one of a set. This is harmless, because the sums take their limit
//! from the client's Z.
//!
//! **Attributes.** A fragment is in the sums if it is drawn, inside, and of a depth of at most Z +
//! epsilon. The id's fragment always passes. Where a decision is undecided, both continuations are
//! kept, 2^n for n <= 4 fragments. A pixel is right if one continuation fits every plane. With more
//! than four undecided fragments the sums are not judged. Without Z and id, Z is any depth from the
//! least that may be the nearest to the least that certainly is inside.
//!
//! **Normalization and shading**: the formulas of the crate in balls. The environment shows where
//! nothing else is seen, as in [`transparent`](crate::verdict::transparent).
//!
//! The error of a number is its distance from the midpoint of its ball, divided by the sum of the
//! ball's radius and the loss that its format allows. An error up to 1 is right. If a certificate
//! fails, the error is the distance of the decision that should be otherwise. The error of a wrong
//! id or count is +inf.

mod band;
pub(crate) mod certificate;
pub(crate) mod client_planes;
pub(crate) mod pixel;
mod records;
mod right;
pub(crate) mod sums;
pub(crate) mod swift;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::ewa::Settings;
use crate::number::ball::Profile;
use crate::number::lanes::LANES;
use crate::scene::Surfels;
use crate::verdict::client::Client;
use crate::verdict::marks::{self, Counts, Marks, TilePart, counted};
use crate::verdict::shift::ShiftSums;
use crate::verdict::{Check, Doubt, Verdict};
use band::Bands;
use certificate::{Certificate, Nearest};
use client_planes::ClientPlanes;
use pixel::PixelJudge;
pub(super) use records::{WrongField, wrong_fields};
use right::{Errors, RightPixels};
use sums::{AllSums, Continuations};
use swift::SwiftSplats;

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let client_planes = ClientPlanes::new(client);
    let judge = Judge::<P>::new(job, settings, client, &client_planes);
    let verdict =
        marks::verdict(job, client_planes.stages(), budget, |tile, marks| judge.judge(tile, marks));
    match &client.records {
        Some(records) => {
            verdict.after(records::judge::<P>(job, settings, records, client.supposed))
        }
        None => verdict,
    }
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let client_planes = ClientPlanes::new(client);
    let judge = Judge::<P>::new(job, settings, client, &client_planes);
    let stages = client_planes.stages().map(|(stage, _)| stage);
    marks::checks(job, stages, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    surfels: &'a Surfels,
    client_planes: &'a ClientPlanes<'a>,
    splats: SwiftSplats<P>,
    bands: Bands<'a, P>,
    pixels: PixelJudge<'a, P>,
    right: Option<RightPixels<'a, P>>,
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(
        job: &Job<'a>,
        settings: &Settings,
        client: &Client,
        client_planes: &'a ClientPlanes<'a>,
    ) -> Self {
        let splats = match client_planes.records {
            Some(records) => records::project(job, settings, records),
            None => {
                let job = client.projection(job);
                let mut splats = swift::project(&job, settings, client_planes.supposed);
                splats.shared.limit = client_planes.supposed.limit(splats.shared.limit);
                splats
            }
        };
        let bands = Bands::new(job, client_planes.band, client_planes.depth_test, splats.epsilon);
        let pixels = PixelJudge::new(job, client_planes);
        let right = RightPixels::new(job, client_planes);
        Self { surfels: &job.scene.surfels, client_planes, splats, bands, pixels, right }
    }

    /// Marks the wrong pixels of a rectangle in a tile, stage by stage.
    fn judge(&self, part: TilePart, marks: &mut [Marks; 4]) -> Counts {
        let rect = part.rect;
        let Self { surfels, client_planes, splats, bands, pixels, .. } = self;
        let [first, rest @ ..] = marks;
        let certificate = Certificate::new(splats, &[], client_planes, surfels, part);
        let nearest = certificate.nearest();
        let limits = bands.moved(&nearest, &rect);
        let beside = Some((&certificate, &mut *first));
        let supposed = client_planes.supposed;
        let added = sums::add(splats, surfels, supposed, &limits, part, beside, &mut rest[0]);
        certificate.end(first);
        let right = self.right(rect, &nearest, &added.sums, &rest[0]);
        let sums = added.followed(|pixel| right[pixel].is_none());
        let (mut covered, mut shifts) = (0, ShiftSums::default());
        for (pixel, at) in counted(rect) {
            let is_finite = nearest[pixel].depth.middle.is_finite();
            if let Some(errors) = right[pixel] {
                for (marks, error) in rest.iter_mut().zip(errors) {
                    marks.at(pixel).right(error);
                }
                covered += u64::from(is_finite);
                continue;
            }
            let sums = sums.continuations(pixel);
            let taken = pixels.judge(pixel, at, &nearest[pixel], &sums, rest);
            if let (Continuations::Several(_, open), Some(taken)) = (&sums, taken) {
                shifts.take_all(open, taken);
            }
            let certain = matches!(sums, Continuations::One(_));
            covered += u64::from(is_finite || !certain);
        }
        Counts { covered, undecided: rest[0].doubtful(Doubt::OF_SUMS), shifts }
    }

    /// The errors of those pixels of a rectangle that the fast path finds right.
    fn right(
        &self,
        rect: Rect,
        nearest: &[Nearest<P>],
        sums: &AllSums<P>,
        marks: &Marks,
    ) -> Vec<Option<Errors>> {
        let mut found = vec![None; rect.pixels()];
        // An explanation needs every check, so it takes no shortcut.
        let Some(right) = self.right.as_ref().filter(|_| !marks.logs()) else { return found };
        let mut asked = Vec::with_capacity(found.len());
        for (pixel, at) in counted(rect).filter(|(pixel, _)| sums.undecided[*pixel] == 0) {
            if sums.count[pixel] > 0 {
                asked.push((pixel, at));
            } else if self.pixels.is_right_of_nothing(at) {
                found[pixel] = Some([0.0; 3]);
            }
        }
        for some in asked.chunks(LANES) {
            let errors = right.errors(some, nearest, sums);
            for ((pixel, _), errors) in some.iter().zip(errors) {
                found[*pixel] = errors;
            }
        }
        found
    }
}
