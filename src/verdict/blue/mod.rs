//! Verify your planes of progressive blue surfels: which planes a correct implementation may leave
//! of each stage.
//!
//! Surfels and their fragments are placed in [`Ball`]s of a [`Profile`].
//!
//! - A surfel *may lie* in a pixel unless one of these is certain: it is not drawn, the pixel is
//!   not in its square, or its fragment is discarded.
//! - A surfel *lies* in a pixel if the contrary of all three is certain.
//! - Triangles are as in [`projection`](crate::verdict::projection).
//! - A fragment that stays is within the radius of its centre, and so is its depth. This bounds the
//!   depth where the plane is nearly edge-on.
//!
//! **Discs.**
//!
//! 1. The surfel or triangle of the id may lie in the pixel. An empty pixel has no id.
//! 2. Depth, offset, normal, weight and colour are those of one fragment of it, seen from either
//!    side where the side is undecided. In an empty pixel they are the values of an empty pixel.
//! 3. Nothing else lies in the pixel whose depth certainly is less than Z. Without Z, its depth is
//!    compared with the fragment's. In an empty pixel Z is +inf.
//! 4. No surfel that lies there at an equal depth comes before the id's surfel by the client's tie
//!    rule. Depths are equal if they are the same and exact in balls, or if all numbers of the two
//!    surfels are the same.
//!
//! Without ids, the verdict takes the fragment that errs least, among those that nothing certainly
//! hides. The pixel may be empty where nothing certainly lies. It is empty where Z, else the
//! weight, says so.
//!
//! **Shading** uses the client's depth, normal, weight and colour. A plane that the client does not
//! hand in is taken from the fragment.
//!
//! Where a fragment is in front of all others that may lie in the pixel, the id shows whether the
//! client took it as inside. Together these decisions give a [`crate::verdict::shift`] of the
//! cut-off.
//!
//! A pixel is undecided if it is not certain which fragments may lie there in front of the
//! client's, or as the client's. A near tie does not make a pixel undecided: the client's choice is
//! taken, and the later stages are judged from it.

mod fragments;
mod planes;
#[cfg(test)]
mod tests;

use crate::composite::decide;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::blue::Settings;
use crate::method::projection::Has;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::checks::{Report, Shading, least_wrong};
use crate::verdict::client::Client;
use crate::verdict::marks::{self, Counts, Marks, PixelMarks, TilePart, counted};
use crate::verdict::shift::ShiftSums;
use crate::verdict::{Check, Doubt, Fault, Verdict};
use fragments::{Fragments, PossibleFragment};
use planes::{BluePlanes, PixelContent, PixelSurface};

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let client_planes = BluePlanes::new(client);
    let judge = Judge::<P>::new(job, settings, &client_planes);
    marks::verdict(job, client_planes.stages(), budget, |tile, marks| judge.judge(tile, marks))
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let client_planes = BluePlanes::new(client);
    let judge = Judge::<P>::new(job, settings, &client_planes);
    let stages = client_planes.stages().map(|(stage, _)| stage);
    marks::checks(job, stages, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    surfels: &'a Surfels,
    client_planes: &'a BluePlanes<'a>,
    fragments: Fragments<'a, P>,
    shading: Shading<'a, P>,
}

/// Records an id's outcome for each fragment whose cut-off alone is undecided, and which is in
/// front of all others that may lie there. Such a fragment is seen if and only if it is inside. An
/// empty pixel shows that it is not.
fn tell<P: Profile>(id: u32, all: &[PossibleFragment<P>], shifts: &mut ShiftSums) {
    let in_front = |may: &PossibleFragment<P>| {
        let mut others = all.iter().filter(|other| other.id != may.id);
        others.all(|other| decide::before(may.depth, other.depth).certainly())
    };
    for may in all.iter().filter(|may| in_front(may)) {
        if let Some(open) = &may.open {
            shifts.take(open, id == may.id);
        }
    }
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(job: &Job<'a>, settings: &Settings, client_planes: &'a BluePlanes<'a>) -> Self {
        Self {
            surfels: &job.scene.surfels,
            client_planes,
            fragments: Fragments::new(job, settings.cull),
            shading: Shading::new(job, Has::in_scene(job.scene).color),
        }
    }

    /// Marks the wrong pixels of a rectangle in a tile.
    fn judge(&self, part: TilePart, marks: &mut [Marks; 2]) -> Counts {
        let rect = part.rect;
        let mut counts = Counts::default();
        let all = self
            .fragments
            .of_tile(part, self.client_planes.depth_test, |at| self.client_planes.id(at));
        for ((pixel, at), own) in counted(rect).zip(&all) {
            let doubts = self.judge_pixel(pixel, at, own, marks);
            counts.covered += u64::from(!own.is_empty());
            counts.undecided += u64::from(doubts & Doubt::OF_SUMS != 0);
            if self.client_planes.id.is_some() {
                tell(self.client_planes.id(at), own, &mut counts.shifts);
            }
        }
        counts
    }

    /// Judges one pixel, and returns its doubts.
    fn judge_pixel(
        &self,
        pixel: usize,
        at: (u32, u32),
        all: &[PossibleFragment<P>],
        marks: &mut [Marks; 2],
    ) -> u8 {
        let says = self.client_planes.says(at);
        // Among the fragments that certainly lie there, the one whose greatest depth is least.
        let front = all.iter().filter(|may| may.lies).reduce(|front, may| {
            let most = |may: &PossibleFragment<P>| may.depth.middle + may.depth.radius;
            if most(may) < most(front) { may } else { front }
        });
        let shown = self.may_show(says, all, front);
        let check =
            |shown: &PixelSurface<P>, report: &mut Report<'_>| self.check(at, shown, report);
        let best = least_wrong::<_, 2>(&shown, check);
        if let Some(best) = best {
            check(best, &mut |part, error, fault| marks[part].at(pixel).found(error, fault));
        }
        let mut discs = marks[0].at(pixel);
        if best.is_none() {
            discs.found(f64::INFINITY, || self.absent(says, at));
        }
        let depth = self.client_planes.depth.map(|plane| plane.ball(at));
        let depth = depth.or(best.map(|best| best.surface.depth)).unwrap_or(Ball::INFINITY);
        let depth = self.client_planes.depth_test.tested(depth);
        let id = match says {
            PixelContent::Id(id) => id,
            _ => best.map_or(NO_ID, |best| best.id),
        };
        let before = |front: &&PossibleFragment<P>| {
            says != PixelContent::Nothing
                && front.id != id
                && decide::before(front.depth, depth).certainly()
        };
        if let Some(front) = front.filter(before) {
            let (error, rim) = (front.depth.distance(depth), front.rim);
            let (surfel, depth, found) = (front.id, front.depth.middle, depth.middle);
            discs.found(error, || Fault::LeftOut { surfel, rim, depth, found });
        }
        if let PixelContent::Id(id) = says {
            self.judge_ties(id, all, &mut discs);
        }
        let doubts = doubts(id, depth, all);
        discs.doubts(doubts);
        doubts
    }

    /// Every surface that the pixel may show.
    fn may_show(
        &self,
        says: PixelContent,
        all: &[PossibleFragment<P>],
        front: Option<&PossibleFragment<P>>,
    ) -> Vec<PixelSurface<P>> {
        let hidden = |may: &PossibleFragment<P>| {
            let depth = self.client_planes.depth_test.tested(may.depth);
            front.is_some_and(|front| decide::before(front.depth, depth).certainly())
        };
        let takes = |may: &PossibleFragment<P>| match says {
            PixelContent::Empty => false,
            PixelContent::Id(id) => id == may.id,
            PixelContent::Some => self.client_planes.depth.is_some() || !hidden(may),
            PixelContent::Nothing => !hidden(may),
        };
        let mut shown: Vec<_> =
            all.iter().filter(|may| takes(may)).flat_map(|may| self.shown(may)).collect();
        if says == PixelContent::Empty || (says == PixelContent::Nothing && front.is_none()) {
            shown.push(PixelSurface::EMPTY);
        }
        shown
    }

    /// The surfaces that the pixel may show of a fragment: one, or one for each side.
    fn shown(&self, may: &PossibleFragment<P>) -> impl Iterator<Item = PixelSurface<P>> {
        self.fragments.surfaces(may).into_iter().flatten().map(|surface| PixelSurface {
            id: may.id,
            offset: may.offset,
            surface,
            weight: Ball::ONE,
        })
    }

    /// Compares every plane at a pixel with a surface that it may show.
    fn check(&self, at: (u32, u32), shown: &PixelSurface<P>, report: &mut Report<'_>) {
        self.client_planes.check(at, shown, report);
        let surface = self.client_planes.surface(at, &shown.surface);
        self.client_planes.check_picture(at, self.shading.color(at, &surface), report);
        let alpha = self.shading.alpha(self.client_planes.seen(at, shown.weight));
        self.client_planes.check_alpha(at, alpha, report);
    }

    /// The fault where nothing that the client names may lie.
    fn absent(&self, says: PixelContent, at: (u32, u32)) -> Fault {
        match says {
            PixelContent::Id(surfel) => match self.fragments.rim(surfel, at) {
                Some(rim) => Fault::Outside { surfel, rim },
                None => Fault::Absent { surfel },
            },
            _ => {
                let found =
                    self.client_planes.depth.map_or(f64::NAN, |plane| *plane.plane.at(at.0, at.1));
                Fault::NoSuchDepth { found, closest: f64::INFINITY }
            }
        }
    }

    /// Checks whether a surfel is exactly as near as the client's, and comes before it.
    fn judge_ties(&self, found: u32, all: &[PossibleFragment<P>], pixel: &mut PixelMarks<'_>) {
        let Some(own) = all.iter().find(|may| may.id == found) else { return };
        let count = self.surfels.len();
        for may in all.iter().filter(|may| may.lies && (may.id as usize) < count) {
            let surfel = may.id;
            let first = self.client_planes.ties.keeps(surfel, found);
            let exact =
                may.depth.middle == own.depth.middle && may.depth.radius + own.depth.radius == 0.0;
            let equal = || (found as usize) < count && self.surfels.are_equal(surfel, found);
            if first && (exact || equal()) {
                pixel.found(f64::INFINITY, || Fault::Tie { surfel, found });
            }
        }
    }
}

/// The doubts at a pixel where the client has this id at this depth.
fn doubts<P: Profile>(id: u32, depth: Ball<P>, all: &[PossibleFragment<P>]) -> u8 {
    let mut doubts = 0;
    for may in all {
        let nearer = decide::before(may.depth, depth);
        let own = may.id == id;
        if !own && !nearer.possibly() {
            continue;
        }
        let mut doubt = |doubt: Doubt, there: bool| doubts |= if there { doubt as u8 } else { 0 };
        doubt(Doubt::Nearer, !own && !nearer.certainly());
        doubt(Doubt::Side, own && may.back.decided().is_none());
        doubt(Doubt::Fate, !may.drawn);
        doubt(Doubt::CutOff, may.drawn && !may.lies);
    }
    doubts
}
