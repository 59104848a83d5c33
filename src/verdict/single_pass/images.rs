//! Verify a client's depth-images at a pixel: which fragment each group may keep, and which it
//! certainly does not.

use super::client_planes::ImagePlanes;
use super::fragments::{Fragment, GroupFragments, PixelFragments};
use crate::composite::decide;
use crate::composite::groups::WeightedFragment;
use crate::frame::NO_ID;
use crate::method::fragment::facing;
use crate::method::single_pass::geometry::opacity;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::checks::{Report, number};
use crate::verdict::client::{Client, Storage, StoredPlane, Ties};
use crate::verdict::marks::PixelMarks;
use crate::verdict::{Doubt, Fault};

/// A sample that a group may keep at a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<P: Profile> {
    /// The surfel of the sample; [`NO_ID`] if nothing is kept.
    pub(crate) surfel: u32,
    /// The nearness of the sample. If nothing is kept, the nearness of an empty pixel.
    pub(crate) nearness: Ball<P>,
    /// The sample as the compositing pass reads it.
    pub(crate) read: WeightedFragment<Ball<P>>,
}

/// The samples that a group may keep at a pixel, at least one.
#[derive(Clone, Debug)]
pub(crate) struct Samples<P: Profile> {
    pub(crate) all: Vec<Sample<P>>,
    /// Whether all samples add the same to the sums, because the client stores the summands.
    pub(crate) stored: bool,
    /// Whether all samples have the one depth that the client stores.
    pub(crate) depth_stored: bool,
}

/// A fragment that may be kept, or none.
type Candidate<'f, P> = Option<&'f Fragment<P>>;

/// The parts that the groups share.
pub(super) struct Images<'a, P: Profile> {
    fragments: &'a GroupFragments<'a, P>,
    surfels: &'a Surfels,
    planes: &'a [ImagePlanes<'a>],
    ties: Ties,
    depth_test: Storage,
}

impl<'a, P: Profile> Images<'a, P> {
    pub(super) fn new(
        fragments: &'a GroupFragments<'a, P>,
        surfels: &'a Surfels,
        planes: &'a [ImagePlanes<'a>],
        client: &Client,
    ) -> Self {
        let Client { ties, depth_test, .. } = *client;
        Self { fragments, surfels, planes, ties, depth_test }
    }

    /// Marks wrong images at a pixel, and returns the samples that each group may keep.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        fragments: &PixelFragments<'_, P>,
        pixel: &mut PixelMarks<'_>,
    ) -> Vec<Samples<P>> {
        let groups = self.planes.iter().enumerate();
        groups.map(|(k, planes)| self.group(at, planes, fragments.in_group(k), pixel)).collect()
    }

    /// Judges one group.
    fn group<'f>(
        &self,
        at: (u32, u32),
        planes: &ImagePlanes<'_>,
        fragments: impl Iterator<Item = &'f Fragment<P>> + Clone,
        pixel: &mut PixelMarks<'_>,
    ) -> Samples<P>
    where
        P: 'f,
    {
        let group = Group { images: self, planes, at };
        let said = planes.surfel(at);
        let is_said = |candidate: &Candidate<'_, P>| {
            let surfel = candidate.map_or(NO_ID, |fragment| fragment.surfel);
            said.is_none_or(|id| id == surfel)
        };
        let all = std::iter::once(None).chain(fragments.clone().map(Some)).filter(is_said);
        let tried: Vec<_> = all
            .map(|candidate| {
                let mut worst = 1.0_f64;
                group.check(candidate, fragments.clone(), &mut |_, error, _| {
                    worst = worst.at_least(error);
                });
                (worst, candidate)
            })
            .collect();
        // Among equal errors a fragment is preferred to none, because it explains more.
        let least = tried.iter().fold(f64::INFINITY, |least, (worst, _)| least.at_most(*worst));
        let best = tried.iter().rev().find(|(worst, _)| *worst == least).map(|(_, best)| *best);
        if !planes.nothing() {
            if let Some(best) = best {
                group.check(best, fragments.clone(), &mut |_, error, fault| {
                    pixel.found(error, fault);
                });
                group.doubts(best, fragments.clone(), pixel);
            } else {
                let surfel = said.unwrap_or(NO_ID);
                pixel.found(f64::INFINITY, || Fault::Absent { surfel });
            }
        }
        // Opacities come from the surfel and leave no plane, so they need the id.
        let stored = planes.complete(self.surfels.color().is_some())
            && (planes.id.is_some() || self.surfels.opacity().is_none());
        let right = tried.iter().filter(|(worst, _)| *worst <= least);
        let mut all: Vec<_> = right.map(|(_, candidate)| group.sample(*candidate)).collect();
        if all.is_empty() {
            all.push(Sample { surfel: said.unwrap_or(NO_ID), ..group.sample(None) });
        }
        Samples { all, stored, depth_stored: planes.depth.is_some() }
    }
}

/// A group at a pixel.
struct Group<'a, P: Profile> {
    images: &'a Images<'a, P>,
    planes: &'a ImagePlanes<'a>,
    at: (u32, u32),
}

impl<P: Profile> Group<'_, P> {
    /// Every check of a group that keeps this candidate.
    fn check<'f>(
        &self,
        candidate: Candidate<'_, P>,
        fragments: impl Iterator<Item = &'f Fragment<P>>,
        report: &mut Report<'_>,
    ) where
        P: 'f,
    {
        let outside = candidate.filter(|fragment| !fragment.inside.possibly());
        if let Some(Fragment { surfel, rim, margin, .. }) = outside.copied() {
            report(0, margin, &|| Fault::Outside { surfel, rim });
        }
        self.planes.check(self.at, &self.truth(candidate), report);
        if let Some(plane) = self.voronoi() {
            let found = plane.ball(self.at);
            let truth = candidate.map_or(Ball::INFINITY, |fragment| fragment.keys.closest(found));
            number(0, plane, self.at, truth, report);
        }
        let key = self.key(candidate);
        for other in fragments.filter(|other| Some(other.surfel) != candidate.map(|c| c.surfel)) {
            self.check_other(candidate, key, other, report);
        }
    }

    /// Checks whether another fragment should be kept.
    fn check_other(
        &self,
        candidate: Candidate<'_, P>,
        key: Ball<P>,
        other: &Fragment<P>,
        report: &mut Report<'_>,
    ) {
        if !other.drawn || !other.inside.certainly() {
            return;
        }
        let surfel = other.surfel;
        let greatest = other.keys.greatest();
        if self.before(greatest, key).certainly() {
            // The fault is as certain as the less certain of the two decisions.
            let error = greatest.distance(key).at_most(other.margin);
            let stored = self.planes.depth.map(|plane| plane.ball::<P>(self.at).middle);
            let own = candidate.map_or(f64::INFINITY, |fragment| fragment.t.middle);
            let (rim, depth, found) = (other.rim, other.t.middle, stored.unwrap_or(own));
            report(0, error, &|| Fault::LeftOut { surfel, rim, depth, found });
        } else if let Some(kept) = candidate {
            let first = self.images.ties.keeps(surfel, kept.surfel);
            let same = || self.images.surfels.are_equal(surfel, kept.surfel);
            if first && (other.keys.are_equal(&kept.keys) || same()) {
                report(0, f64::INFINITY, &|| Fault::Tie { surfel, found: kept.surfel });
            }
        }
    }

    /// Marks the decisions that may be either way, if this candidate is kept.
    fn doubts<'f>(
        &self,
        candidate: Candidate<'_, P>,
        fragments: impl Iterator<Item = &'f Fragment<P>>,
        pixel: &mut PixelMarks<'_>,
    ) where
        P: 'f,
    {
        let key = self.key(candidate);
        for other in fragments.filter(|other| Some(other.surfel) != candidate.map(|c| c.surfel)) {
            let nearer = self.before(other.keys.least(), key);
            let certainly = self.before(other.keys.greatest(), key).certainly();
            if other.inside.possibly() && nearer.possibly() {
                pixel.doubt(Doubt::Nearer, !certainly);
                pixel.doubt(Doubt::CutOff, !other.inside.certainly());
                pixel.doubt(Doubt::Fate, !other.drawn);
            }
        }
        let side = candidate.is_some_and(|fragment| fragment.back.decided().is_none());
        pixel.doubt(Doubt::Side, side);
    }

    /// The depth test.
    fn before(&self, key: Ball<P>, than: Ball<P>) -> Three {
        if self.images.fragments.voronoi() {
            decide::nearer_bin(key, than)
        } else {
            decide::before(key, than)
        }
    }

    /// The key that others are compared with: the client's, else the least of the candidate's.
    /// Voronoi-enhanced depths are bins already, whatever format tests depths.
    fn key(&self, candidate: Candidate<'_, P>) -> Ball<P> {
        let own = || candidate.map_or(Ball::INFINITY, |fragment| fragment.keys.least());
        if self.images.fragments.voronoi() {
            return self.voronoi().map_or_else(own, |plane| plane.ball(self.at));
        }
        let depth = self.planes.depth.map_or_else(own, |plane| plane.ball(self.at));
        self.images.depth_test.tested(depth)
    }

    /// The plane of Voronoi-enhanced depths, if the depth test uses it.
    fn voronoi(&self) -> Option<&StoredPlane<'_, f64>> {
        self.planes.voronoi.as_ref().filter(|_| self.images.fragments.voronoi())
    }

    /// The values that the image leaves of a candidate.
    fn truth(&self, candidate: Candidate<'_, P>) -> WeightedFragment<Ball<P>> {
        let Some(fragment) = candidate else { return WeightedFragment::EMPTY };
        let (surfels, i) = (self.images.surfels, fragment.surfel as usize);
        let of = |value: [f32; 3]| value.map_inline(Ball::from_f32);
        let normal = facing(of(surfels.normal()[i].to_array()), fragment.back);
        let color = surfels.color().map_or([Ball::ZERO; 3], |colors| of(colors[i].to_array()));
        let opacity = opacity(surfels, fragment.surfel);
        WeightedFragment::new(fragment.t, fragment.weight, normal, color, opacity)
    }

    /// The sample of a candidate as the compositing pass reads it.
    fn sample(&self, candidate: Candidate<'_, P>) -> Sample<P> {
        let read = self.planes.read(self.at, &self.truth(candidate));
        let shared = self.images.fragments.shared();
        let own = candidate.map_or(shared.empty(), |fragment| fragment.w);
        let nearness = match self.planes.depth {
            None => own,
            Some(_) if read.depth.middle == f64::INFINITY => shared.empty(),
            Some(_) => self.images.fragments.view.nearness(read.depth),
        };
        let surfel = candidate.map_or(NO_ID, |fragment| fragment.surfel);
        Sample { surfel, nearness, read }
    }
}
