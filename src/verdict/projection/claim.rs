//! Compare the client's claim about a pixel with everything that may lie there.

use super::candidate::Candidate;
use super::planes::{PixelContent, SamplePlanes};
use crate::composite::decide;
use crate::method::projection::PixelSample;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::client::{Storage, Ties};
use crate::verdict::marks::PixelMarks;
use crate::verdict::{Doubt, Fault};

/// The client's claim about a pixel, and the findings so far.
pub(super) struct Claim<P: Profile> {
    pub(super) says: PixelContent,
    /// The client's depth, if the client hands it in.
    depth: Option<Ball<P>>,
    depth_test: Storage,
    /// Among the candidates that certainly lie in the pixel, the one whose greatest depth is least.
    pub(super) front: Option<(u32, Ball<P>)>,
    /// Among the samples that the client may mean, the one that errs least, and its error.
    best: Option<(f64, PixelSample<Ball<P>>)>,
}

impl<P: Profile> Claim<P> {
    pub(super) fn new(planes: &SamplePlanes<'_>, at: (u32, u32), unclear: &[u32]) -> Self {
        let depth = planes.depth.map(|plane| plane.ball(at));
        let (says, depth_test) = (planes.says(at, unclear), planes.depth_test);
        Self { says, depth, depth_test, front: None, best: None }
    }

    /// Adds a candidate that certainly lies in the pixel.
    pub(super) fn meet(&mut self, id: u32, t: Ball<P>) {
        let most = |t: Ball<P>| t.middle + t.radius;
        if self.front.is_none_or(|(_, front)| most(t) < most(front)) {
            self.front = Some((id, t));
        }
    }

    /// Whether the client may mean this candidate.
    pub(super) fn may_mean(&self, one: &Candidate<'_, P>) -> bool {
        let depth = self.depth_test.tested(one.depth());
        let hidden = || self.front.is_some_and(|(_, t)| decide::before(t, depth).certainly());
        match self.says {
            PixelContent::Id(id) => id == one.id(),
            PixelContent::Some(kind) => {
                let fits = kind.is_none_or(|kind| kind == one.kind());
                fits && (self.depth.is_some() || !hidden())
            }
            PixelContent::Nothing => !hidden(),
            PixelContent::Empty | PixelContent::Unjudged(_) => false,
        }
    }

    /// Whether the client may have this candidate. Its depth must fit too, if the client gives a
    /// depth and no id.
    pub(super) fn may_have(&self, one: &Candidate<'_, P>) -> bool {
        self.may_mean(one) && self.depth.is_none_or(|depth| !(one.depth().misfit(depth) > 1.0))
    }

    /// Adds a sample that the client may mean.
    pub(super) fn consider(
        &mut self,
        planes: &SamplePlanes<'_>,
        at: (u32, u32),
        sample: PixelSample<Ball<P>>,
    ) {
        let mut worst = 0.0_f64;
        planes.check(at, &sample, &mut |_, error, _| worst = worst.at_least(error));
        if self.best.is_none_or(|(least, _)| worst < least) {
            self.best = Some((worst, sample));
        }
    }

    /// Judges the claim itself, and the candidate that certainly is in front of it.
    pub(super) fn judge(
        &self,
        planes: &SamplePlanes<'_>,
        at: (u32, u32),
        pixel: &mut PixelMarks<'_>,
    ) {
        let mut report = |_: usize, error: f64, fault: &dyn Fn() -> Fault| {
            pixel.found(error, fault);
        };
        match (&self.best, self.says) {
            (_, PixelContent::Unjudged(kind)) => {
                planes.check_kind(at, kind, &mut report);
                pixel.doubt(Doubt::Unbounded, true);
            }
            (Some((_, sample)), _) => planes.check(at, sample, &mut report),
            (None, PixelContent::Id(surfel)) => {
                report(0, f64::INFINITY, &|| Fault::Absent { surfel });
            }
            // A candidate lies here, so rule 3 applies. But the other planes may also contradict an
            // empty pixel.
            (None, _) if self.depth().middle == f64::INFINITY => {
                planes.check(at, &PixelSample::<Ball<P>>::empty(), &mut report);
            }
            (None, _) => {
                let (found, closest) = (self.depth().middle, f64::INFINITY);
                report(0, f64::INFINITY, &|| Fault::NoSuchDepth { found, closest });
            }
        }
        if let (Some((surfel, t)), true) = (self.front, self.says != PixelContent::Nothing) {
            let depth = self.tested();
            if self.says != PixelContent::Id(surfel) && decide::before(t, depth).certainly() {
                let (error, depth, found) = (t.distance(depth), t.middle, depth.middle);
                // A sample has no rim.
                pixel.found(error, || Fault::LeftOut { surfel, rim: 0.0, depth, found });
            }
        }
    }

    /// The depth that other candidates are compared with.
    fn tested(&self) -> Ball<P> {
        self.depth_test.tested(self.depth())
    }

    /// The depth of the client's sample.
    fn depth(&self) -> Ball<P> {
        let of_sample = || self.best.map_or(anywhere(), |(_, sample)| sample.depth);
        match self.says {
            PixelContent::Empty => Ball::INFINITY,
            _ => self.depth.unwrap_or_else(of_sample),
        }
    }

    /// Checks whether a surfel is exactly as near as the client's, and comes before it.
    pub(super) fn judge_tie(
        &self,
        one: &Candidate<'_, P>,
        ties: Ties,
        surfels: &Surfels,
        pixel: &mut PixelMarks<'_>,
    ) {
        let (PixelContent::Id(found), Some((_, sample)), Candidate::Surfel(surfel, _)) =
            (self.says, &self.best, one)
        else {
            return;
        };
        let (surfel, t) = (surfel.surfel, one.depth());
        let first = ties.keeps(surfel, found);
        let equal = t.middle == sample.depth.middle;
        let exact = equal && t.radius + sample.depth.radius == 0.0 && one.lies();
        if first && (exact || surfels.are_equal(surfel, found)) {
            pixel.found(f64::INFINITY, || Fault::Tie { surfel, found });
        }
    }

    /// Marks the doubts about a candidate that may be in front.
    pub(super) fn doubt(&self, one: &Candidate<'_, P>, pixel: &mut PixelMarks<'_>) {
        let nearer = decide::before(one.depth(), self.tested());
        let own = self.best.is_some_and(|(_, sample)| sample.id == one.id());
        if !own && nearer.possibly() {
            pixel.doubt(Doubt::Nearer, !nearer.certainly());
            pixel.doubt(Doubt::CutOff, !one.is_alone() && one.drawn());
            pixel.doubt(Doubt::Epsilon, !one.passes().certainly());
            pixel.doubt(Doubt::Fate, !one.drawn());
        }
    }
}

/// Any depth.
fn anywhere<P: Profile>() -> Ball<P> {
    Ball::new(0.0, f64::INFINITY)
}
