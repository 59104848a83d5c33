//! Verify your planes of transparent layers in high quality: which planes a correct implementation
//! may leave of each stage.
//!
//! Each stage is judged from the client's planes of the stage before, as the client stores them. A
//! plane that the client lacks is taken from the balls of the stage before. If there are several
//! continuations, it is taken from all of them.
//!
//! **Geometry** and **nearest**: the depth-image of each group, and the composite of these images,
//! by the rules of [`single-pass`](crate::verdict::single_pass). Beside `Z`, `id`, `normal` and
//! `weight`, a continuation of the sums gives three more values:
//!
//! - the opacity: the sum of opacities divided by the sum of weights, at most 1
//! - the mask: 1 where a fragment is in the sums
//! - the colour, shaded at the client's `Z` with its normal
//!
//! An average colour leaves no plane, so the colour that is shaded comes from the continuation.
//!
//! **Blending** and **averaging** by the rules of [`transparent`](crate::verdict::transparent). A
//! fragment stays where the client's mask is 1 and its depth is greater than Z + epsilon, with the
//! client's Z. Without a mask, Z must be finite instead. Where that is undecided, both
//! continuations are followed.
//!
//! **Compositing** of the client's nearest layer and averages: `l`, `layers`, and the picture. It
//! is before the environment as in `transparent`. With refraction it is
//! [`mod@crate::shade::optics`] in balls, with the client's normal. A decision that is undecided
//! there gives a ball that holds both outcomes: which side of a surface is seen, whether light is
//! reflected totally, which form of a cosine is taken. If the direction may come from either side
//! of a surface, its ball holds too much of a map to be judged. Without the client's normals a
//! picture with refraction is not judged.
//!
//! A pixel is undecided in three cases:
//!
//! - The sums of its nearest layer have more than one continuation.
//! - A group of the other layers has several continuations, or is not judged.
//! - Its colour is not judged.

mod picture;
#[cfg(test)]
mod tests;

use crate::composite::decide;
use crate::error::Result;
use crate::frame::{NO_ID, Rect};
use crate::method::Job;
use crate::method::record::rows;
use crate::method::single_pass::geometry::ImagePixel;
use crate::method::transparent_hq::Settings;
use crate::method::transparent_hq::nearest::{BEHIND, FrontLayer, single_pass};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Real};
use crate::verdict::checks::anything;
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::marks::{self, Counts, Marks, TilePart, counted};
use crate::verdict::single_pass::compositing::limit;
use crate::verdict::single_pass::{self as groups, GroupsOf, PixelFindings, sum_rows};
use crate::verdict::transparent::averages::AveragePlanes;
use crate::verdict::transparent::layers::LayersJudge;
use crate::verdict::{Check, Verdict};
use picture::PictureJudge;

/// The names of the stages.
const STAGES: [&str; 5] = ["geometry", "nearest", "blending", "averaging", "compositing"];

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
    let of = nearest(client);
    let judge = Judge::<P>::new(job, settings, &of)?;
    let [geometry, compositing, shading] = judge.nearest.names();
    let names = [
        geometry,
        [shading, compositing].concat(),
        judge.others.names(),
        judge.averages.names(),
        judge.shown.names(),
    ];
    let mut names = names.into_iter();
    let stages = STAGES.map(|stage| (stage, names.next().unwrap_or_default()));
    let mut verdict = marks::verdict(job, stages, budget, |tile, marks| judge.judge(tile, marks));
    verdict.stages[0].missing = judge.nearest.missing(job);
    verdict.stages[2].missing = judge.others.missing(job, client);
    Ok(verdict)
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let of = nearest(client);
    let judge = Judge::<P>::new(job, settings, &of)?;
    marks::checks(job, STAGES, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The planes of the nearest layer. Its sums leave no planes, and it shares the picture with other
/// layers.
fn nearest(client: &Client) -> GroupsOf<'_> {
    let [color, alpha, mask] = rows(&FrontLayer::<f32>::STAGES);
    let client_planes = ClientPlanes {
        normal_sum: None,
        color_sum: None,
        count: None,
        color: None,
        opacity: client.scalar(&alpha),
        mask: client.count(&mask),
        shaded: client.triple(&color),
        alpha: None,
        ..ClientPlanes::from_client(client, &sum_rows())
    };
    GroupsOf { client, client_planes, images: rows(&ImagePixel::<f32>::NEAREST), layer: true }
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    settings: &'a Settings,
    client_planes: &'a ClientPlanes<'a>,
    nearest: groups::Judge<'a, P>,
    others: LayersJudge<'a, P>,
    averages: AveragePlanes<'a>,
    shown: PictureJudge<'a, P>,
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(job: &Job<'a>, settings: &'a Settings, of: &'a GroupsOf<'a>) -> Result<Self> {
        Ok(Self {
            settings,
            client_planes: &of.client_planes,
            nearest: groups::Judge::new(job, &single_pass(settings), of)?,
            others: LayersJudge::project(job, &settings.layers, of.client)?,
            averages: AveragePlanes::new(job, of.client),
            shown: PictureJudge::new(job, settings, of.client),
        })
    }

    /// Marks the wrong pixels of a rectangle in a tile, stage by stage.
    fn judge(&self, TilePart { tile, rect }: TilePart, marks: &mut [Marks; 5]) -> Counts {
        let mut counts = Counts::default();
        for y in rect.y0..rect.y1 {
            let row = Rect { y0: y, y1: y + 1, ..rect };
            self.judge_row(tile, (y - rect.y0) as usize, row, marks, &mut counts);
        }
        counts
    }

    fn judge_row(
        &self,
        tile: usize,
        above: usize,
        row: Rect,
        [geometry, nearest, blending, averaging, compositing]: &mut [Marks; 5],
        counts: &mut Counts,
    ) {
        let mut parts = [(); 3].map(|()| nearest.beside(row));
        let fronts = self.nearest.judge_row(tile, above, row, geometry, &mut parts);
        parts.into_iter().for_each(|part| nearest.put(part));
        let drawings = self.others.of_row(tile, &row);
        for ((column, at), front) in counted(row).zip(fronts) {
            let pixel = above * row.columns() + column;
            let near = self.front(at, &front);
            let behind = self.behind(at, near.depth);
            let marks = &mut blending.at(pixel);
            let others = self.others.judge(column, at, &drawings, behind, marks);
            let (groups, holes) = (others.groups.as_slice(), self.settings.layers.holes);
            let average = self.averages.judge(at, groups, holes, &mut averaging.at(pixel));
            let judged = self.shown.judge(at, &near, &average, &mut compositing.at(pixel));
            counts.covered += u64::from(front.covered());
            counts.undecided += u64::from(!front.certain() || others.open || !judged);
        }
    }

    /// The nearest layer as the next passes read it, without surfel, weight and mask.
    fn front(&self, at: (u32, u32), found: &PixelFindings<P>) -> FrontLayer<Ball<P>> {
        let (opacity, color) = self.nearest.read(at, found);
        FrontLayer {
            depth: self.client_planes.depth.map_or(found.nearest.depth, |plane| plane.ball(at)),
            id: NO_ID,
            weight: Ball::ZERO,
            normal: self.client_planes.normal.map_or([anything(); 3], |plane| plane.balls(at)),
            color,
            opacity,
            mask: 0,
        }
    }

    /// Whether a fragment with a depth belongs to the other layers, behind a nearest layer at depth
    /// `z`.
    fn behind(&self, (x, y): (u32, u32), z: Ball<P>) -> impl Fn(Ball<P>) -> Three {
        let masked = |plane: StoredPlane<'_, u8>| BEHIND.test(*plane.plane.at(x, y)).into();
        let there = self.client_planes.mask.map_or_else(|| z.is_finite(), masked);
        let limit = limit(z, self.nearest.epsilon());
        move |t| there & !decide::visible(t, limit)
    }
}
