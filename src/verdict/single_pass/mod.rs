//! Verify your planes of the single pass: which planes a correct implementation may leave of each
//! stage.
//!
//! Surfels are projected in [`Ball`]s of a [`Profile`], each as its own group draws it. Each stage
//! is judged from the client's planes of the stage before, as the client stores them. A plane that
//! the client lacks is taken from the balls.
//!
//! **Geometry**, a certificate for each group and pixel, over those planes of the group that are
//! there. The *key* of a fragment is the number that the depth test compares: its depth, or its
//! Voronoi-enhanced depth. A depth within a radius of a bin's border has two bins, hence two keys.
//!
//! 1. A fragment of the group that possibly is inside fits every plane. Its surfel is the id.
//!    Depth, weight, weight times normal and colour are in its balls. The Voronoi-enhanced depth is
//!    in the ball of one of its keys. Or every plane says that there is no fragment.
//! 2. No fragment of another surfel of the group that certainly is drawn and inside has keys that
//!    are all certainly less than the client's stored key. Without a stored key, they are compared
//!    with the least key of the fragment. Where there is no fragment, none certainly is inside.
//! 3. No surfel with an equal key comes before the id's surfel by the client's tie rule. Keys are
//!    equal if they are the same and exact in balls, or if all numbers of the two surfels are the
//!    same.
//!
//! The *samples* of a group are all fragments (or that there is none) that satisfy 1 to 3. Each
//! number that the client stores replaces its ball. A group has one sample if it stores depth,
//! weight, normal, and the colours of a scene that has some. Without any plane of the group, the
//! samples are all that satisfy 2 and 3.
//!
//! **Compositing.**
//!
//! - Z is the depth of one of the samples, and no group has only samples with less depth.
//! - The id belongs to a sample, and no group has only samples that certainly are nearer. Among
//!   equal nearness, the surfel follows the client's tie rule. (Two depths that are equal or
//!   neighbours may have either order of nearness, because 1/t rounds. So Z and the id may belong
//!   to two samples, neither of which certainly is nearer than the other.)
//! - The sums are over the samples with a depth of at most nearest + epsilon. nearest is the least
//!   of the stored depths of all groups, else Z, else the least of the samples' balls. The nearest
//!   sample always passes. The id's sample passes too, unless nearest + epsilon lies within the
//!   rounding of two reciprocals.
//! - Where a group has several samples or a test is undecided, all continuations are followed: up
//!   to 16 choices of samples, and for each up to 2^4 outcomes of the tests. A pixel is right if
//!   one continuation fits every plane. Beyond that its sums are not judged.
//! - Averages follow from the client's sums.
//!
//! **Shading** as in `ewa`.
//!
//! A pixel is undecided if its sums have more than one continuation. The error of a number, and of
//! a certificate that fails, is defined as in `ewa`.

mod client_planes;
pub(crate) mod compositing;
pub(crate) mod fragments;
pub(crate) mod images;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::PlaneRow;
use crate::method::record::rows;
use crate::method::single_pass::Settings;
use crate::method::single_pass::geometry::ImagePixel;
use crate::method::stage::Keep;
use crate::number::Ball;
use crate::number::ball::Profile;
use crate::scene::Surfels;
use crate::verdict::client::Client;
use crate::verdict::ewa::certificate::Nearest;
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::ewa::pixel::PixelJudge;
use crate::verdict::ewa::sums::Continuations;
use crate::verdict::marks::{self, Counts, Marks, TilePart, counted};
use crate::verdict::{Check, Verdict, gaps};
use client_planes::ImagePlanes;
pub(crate) use client_planes::sum_rows;
use compositing::Compositing;
use fragments::GroupFragments;
use images::Images;

/// The rows of a method that works by groups: its images and its stages, and the client's planes of
/// them.
#[derive(Debug)]
pub(crate) struct GroupsOf<'a> {
    pub(crate) client: &'a Client,
    pub(crate) client_planes: ClientPlanes<'a>,
    pub(crate) images: [PlaneRow; 6],
    /// Whether the colour is a layer's, behind which others may be seen.
    pub(crate) layer: bool,
}

/// The names of the stages: geometry, compositing, and shading.
const STAGES: [&str; 3] = ["geometry", "compositing", "shading"];

impl<'a> GroupsOf<'a> {
    fn new(client: &'a Client) -> Self {
        let client_planes = ClientPlanes::from_client(client, &sum_rows());
        Self { client, client_planes, images: rows(&ImagePixel::<f32>::GROUPS), layer: false }
    }
}

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
    let of = GroupsOf::new(client);
    let judge = Judge::<P>::new(job, settings, &of)?;
    let [first, second, third] = STAGES;
    let [geometry, compositing, shading] = judge.names();
    let stages = [(first, geometry), (second, compositing), (third, shading)];
    let mut verdict = marks::verdict(job, stages, budget, |tile, marks| judge.judge(tile, marks));
    verdict.stages[0].missing = judge.missing(job);
    Ok(verdict)
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let of = GroupsOf::new(client);
    let judge = Judge::<P>::new(job, settings, &of)?;
    marks::checks(job, STAGES, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The findings at a pixel.
#[derive(Clone, Debug)]
pub(crate) struct PixelFindings<P: Profile> {
    pub(crate) nearest: Nearest<P>,
    /// The possible sums.
    sums: Continuations<P>,
}

impl<P: Profile> PixelFindings<P> {
    /// Whether there is only one continuation.
    pub(crate) fn certain(&self) -> bool {
        matches!(self.sums, Continuations::One(_))
    }

    /// Whether the pixel may be covered.
    pub(crate) fn covered(&self) -> bool {
        self.nearest.depth.middle.is_finite() || !self.certain()
    }
}

/// The parts that all tiles share.
pub(crate) struct Judge<'a, P: Profile> {
    surfels: &'a Surfels,
    of: &'a GroupsOf<'a>,
    images: Vec<ImagePlanes<'a>>,
    fragments: GroupFragments<'a, P>,
    compositing: Compositing<'a, P>,
    pixels: PixelJudge<'a, P>,
}

impl<'a, P: Profile> Judge<'a, P> {
    /// Projects the surfels of all groups.
    pub(crate) fn new(job: &Job<'a>, settings: &Settings, of: &'a GroupsOf<'a>) -> Result<Self> {
        let GroupsOf { client, client_planes, images: rows, layer } = of;
        let fragments = GroupFragments::project(job, settings, client)?;
        let images = (0..fragments.groups()).map(|k| ImagePlanes::new(client, rows, k)).collect();
        let surfels = &job.scene.surfels;
        let epsilon = fragments.epsilon();
        let compositing = Compositing::new(job, client_planes, epsilon);
        let pixels =
            if *layer { PixelJudge::of_layer } else { PixelJudge::new }(job, client_planes);
        Ok(Self { surfels, of, images, fragments, compositing, pixels })
    }

    /// The planes that each stage judges: geometry, compositing and shading.
    pub(crate) fn names(&self) -> [Vec<&'static str>; 3] {
        let [(_, nearest), (_, sums), (_, averages), (_, shading)] = self.of.client_planes.stages();
        let compositing = [sums, averages, nearest].concat();
        [client_planes::names(&self.images), compositing, shading]
    }

    /// The planes of groups that the client lacks.
    pub(crate) fn missing(&self, job: &Job<'_>) -> Vec<String> {
        let (groups, there) = (0..self.images.len(), job.there(Keep::Stages));
        gaps::missing(self.of.client, "group", &self.of.images, groups, &there)
    }

    /// Opacity and colour of a pixel as the next pass reads them.
    pub(crate) fn read(&self, at: (u32, u32), found: &PixelFindings<P>) -> (Ball<P>, [Ball<P>; 3]) {
        self.pixels.read(at, &found.nearest, &found.sums)
    }

    /// Marks the wrong pixels of a rectangle in a tile, stage by stage.
    fn judge(&self, TilePart { tile, rect }: TilePart, marks: &mut [Marks; 3]) -> Counts {
        let mut counts = Counts::default();
        let [geometry, compositing, shading] = marks;
        for y in rect.y0..rect.y1 {
            let row = Rect { y0: y, y1: y + 1, ..rect };
            let mut parts = [(); 3].map(|()| compositing.beside(row));
            let above = (y - rect.y0) as usize;
            for found in self.judge_row(tile, above, row, geometry, &mut parts) {
                counts.undecided += u64::from(!found.certain());
                counts.covered += u64::from(found.covered());
            }
            let [sums, averages, shaded] = parts;
            compositing.put(sums);
            compositing.put(averages);
            shading.put(shaded);
        }
        counts
    }

    /// Judges one row of pixels, because the fragments of all groups take too much memory for more.
    /// `above` rows lie above it in the tile.
    pub(crate) fn judge_row(
        &self,
        tile: usize,
        above: usize,
        row: Rect,
        geometry: &mut Marks,
        parts: &mut [Marks; 3],
    ) -> Vec<PixelFindings<P>> {
        let said = |group: usize, at| self.images[group].surfel(at);
        let fragments = self.fragments.of_row(tile, &row, said);
        let images = Images::new(&self.fragments, self.surfels, &self.images, self.of.client);
        let of_pixel = |(column, at)| {
            let pixel = above * row.columns() + column;
            let samples = images.judge(at, &fragments.at(column), &mut geometry.at(pixel));
            let (depth, sums) = self.compositing.judge(at, &samples, &mut parts[0].at(column));
            let nearest = Nearest { depth, id: None };
            self.pixels.judge(column, at, &nearest, &sums, parts);
            PixelFindings { nearest, sums }
        };
        counted(row).map(of_pixel).collect()
    }

    /// The depth of the visible band in world units.
    pub(crate) fn epsilon(&self) -> Ball<P> {
        self.fragments.epsilon()
    }
}
