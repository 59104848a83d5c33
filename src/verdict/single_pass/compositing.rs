//! Verify a client's compositing pass: the nearest sample of all groups, and the sums that are
//! possible.

use super::images::{Sample, Samples};
use crate::composite::decide;
use crate::composite::groups::WeightedFragment;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::ewa::attributes::Sums;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Real, Truth};
use crate::scene::Surfels;
use crate::splat::View;
use crate::verdict::checks::anything;
use crate::verdict::client::Band;
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::ewa::sums::{Continuations, MOST};
use crate::verdict::marks::PixelMarks;
use crate::verdict::{Doubt, Fault};

/// The most choices of samples that are followed.
const MOST_CHOICES: usize = 16;

/// The parts that all pixels share.
pub(crate) struct Compositing<'a, P: Profile> {
    client_planes: &'a ClientPlanes<'a>,
    surfels: &'a Surfels,
    view: View<Ball<P>>,
    epsilon: Ball<P>,
}

/// One sample of each group.
type Choice<'s, P> = Vec<&'s Sample<P>>;

impl<'a, P: Profile> Compositing<'a, P> {
    pub(crate) fn new(
        job: &Job<'a>,
        client_planes: &'a ClientPlanes<'a>,
        epsilon: Ball<P>,
    ) -> Self {
        let view = View::new(job.camera);
        Self { client_planes, surfels: &job.scene.surfels, view, epsilon }
    }

    /// Marks a wrong nearest fragment of a pixel. Returns its depth and the possible sums.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        groups: &[Samples<P>],
        pixel: &mut PixelMarks<'_>,
    ) -> (Ball<P>, Continuations<P>) {
        let (own, said) = self.check_nearest(at, groups, pixel);
        let choices = choices(groups);
        let stored = groups.iter().all(|group| group.depth_stored);
        let nearest = |choice: &Choice<'_, P>| match own {
            Some(depth) if !stored => depth,
            _ => nearest(choice),
        };
        let depth = choices.iter().map(nearest).reduce(Ball::either).unwrap_or(anything());
        let several = choices.len() > 1;
        pixel.doubt(Doubt::Nearer, several);
        let mut all = Vec::new();
        for choice in &choices {
            match self.sums(choice, nearest(choice), said.filter(|_| !stored), pixel) {
                Some(sums) => all.extend(sums),
                None => return (depth, Continuations::Many),
            }
        }
        let sums = match (choices.len(), all.as_slice()) {
            // There were more choices than are followed.
            (0, _) => Continuations::Many,
            (1, [one]) => Continuations::One(*one),
            _ => Continuations::Several(all, Vec::new()),
        };
        (depth, sums)
    }

    /// Marks a wrong nearest fragment of a pixel. Returns the client's depth and surfel, if the
    /// client has them.
    pub(crate) fn check_nearest(
        &self,
        at: (u32, u32),
        groups: &[Samples<P>],
        pixel: &mut PixelMarks<'_>,
    ) -> (Option<Ball<P>>, Option<u32>) {
        let said = self.client_planes.id.map(|plane| *plane.plane.at(at.0, at.1));
        let own = self.client_planes.depth.map(|plane| plane.ball::<P>(at));
        if let Some(depth) = own {
            self.check_depth(depth, said, groups, pixel);
        }
        if let Some(id) = said {
            self.check_id(id, groups, pixel);
        }
        (own, said)
    }

    /// Checks whether the depth of the picture is the nearest sample's.
    fn check_depth(
        &self,
        depth: Ball<P>,
        said: Option<u32>,
        groups: &[Samples<P>],
        pixel: &mut PixelMarks<'_>,
    ) {
        let empty = Ball::INFINITY;
        let samples = || groups.iter().flat_map(|group| &group.all);
        // 1/t rounds, so the greatest nearness and the least depth may belong to different samples.
        let of = |sample: &Sample<P>, id: u32| {
            let mut own = samples().filter(|own| own.surfel == id);
            id == sample.surfel || own.any(|own| may_tie(own.nearness, sample.nearness))
        };
        let all = samples().filter(|sample| said.is_none_or(|id| of(sample, id)));
        let meant = all.map(|sample| sample.read.depth);
        // No single group shows that a pixel is empty, so this case is added, unless the id names a
        // surfel.
        let meant = meant.chain(said.is_none_or(|id| id == NO_ID).then_some(empty));
        let misfit = |truth: Ball<P>| truth.misfit(depth);
        let closest = meant.fold(None, |best: Option<Ball<P>>, truth| match best {
            Some(best) if misfit(best) <= misfit(truth) => Some(best),
            _ => Some(truth),
        });
        let channel = || self.client_planes.depth.map_or_else(String::new, |plane| plane.channel());
        let fault = |truth: Ball<P>| Fault::Value {
            channel: channel(),
            found: depth.middle,
            truth: truth.middle,
            radius: truth.radius + depth.radius,
        };
        // If no group has the id, the check of the id reports it.
        if let Some(closest) = closest {
            pixel.found(misfit(closest), || fault(closest));
        }
        for group in groups {
            let depths = group.all.iter().map(|sample| sample.read.depth);
            if depths.clone().all(|truth| decide::before(truth, depth).certainly()) {
                let error = depths
                    .clone()
                    .fold(f64::INFINITY, |least, truth| least.at_most(truth.distance(depth)));
                if let Some(truth) = depths.clone().next() {
                    pixel.found(error, || fault(truth));
                }
            }
        }
    }

    /// Checks whether the surfel of the picture may be the nearest.
    fn check_id(&self, id: u32, groups: &[Samples<P>], pixel: &mut PixelMarks<'_>) {
        let mut least: Option<(f64, Fault)> = None;
        let samples = groups.iter().flat_map(|group| &group.all);
        for own in samples.filter(|sample| sample.surfel == id) {
            let mut worst = (0.0, Fault::Absent { surfel: id });
            for group in groups {
                let (error, fault) = self.in_front(own, group);
                if error > worst.0 {
                    worst = (error, fault);
                }
            }
            if least.as_ref().is_none_or(|(error, _)| worst.0 < *error) {
                least = Some(worst);
            }
        }
        match least {
            Some((error, fault)) => pixel.found(error, || fault.clone()),
            None => pixel.found(f64::INFINITY, || self.unknown(id, groups)),
        }
    }

    /// The fault if no group has the surfel of the picture, with the surfel that should be there.
    fn unknown(&self, found: u32, groups: &[Samples<P>]) -> Fault {
        let samples = groups.iter().filter_map(|group| group.all.first());
        let nearest = samples.fold(None, |best: Option<&Sample<P>>, sample| match best {
            Some(best) if best.nearness.middle >= sample.nearness.middle => Some(best),
            _ => Some(sample),
        });
        let channel = self.client_planes.id.map_or_else(String::new, |plane| plane.channel());
        let truth = nearest.map_or(NO_ID, |sample| sample.surfel);
        Fault::Whole { channel, found, truth }
    }

    /// Whether every sample that a group may keep is in front of this one, as an error in bounds.
    fn in_front(&self, own: &Sample<P>, group: &Samples<P>) -> (f64, Fault) {
        let mut least = (f64::INFINITY, Fault::Absent { surfel: own.surfel });
        for other in &group.all {
            let nearer = decide::nearer(other.nearness, own.nearness);
            let error = if nearer.certainly() {
                other.nearness.distance(own.nearness).at_least(1.0_f64.next_up())
            } else if self.comes_before(other, own) {
                f64::INFINITY
            } else {
                return (0.0, least.1);
            };
            let (surfel, found) = (other.surfel, own.surfel);
            let channel =
                || self.client_planes.id.map_or_else(String::new, |plane| plane.channel());
            if error <= least.0 {
                let fault = if nearer.certainly() {
                    Fault::Whole { channel: channel(), found, truth: surfel }
                } else {
                    Fault::Tie { surfel, found }
                };
                least = (error, fault);
            }
        }
        least
    }

    /// Whether one of two samples comes before the other, if their nearness is equal in every
    /// implementation.
    fn comes_before(&self, one: &Sample<P>, other: &Sample<P>) -> bool {
        if one.surfel == other.surfel || one.surfel == NO_ID || other.surfel == NO_ID {
            return false;
        }
        let first = self.client_planes.ties.keeps(one.surfel, other.surfel);
        // The distance of two exact numbers is infinite, so this asks whether both are exact.
        let exact = one.nearness.distance(other.nearness) == f64::INFINITY
            && one.nearness.middle == other.nearness.middle;
        first && (exact || self.surfels.are_equal(one.surfel, other.surfel))
    }

    /// Whether the fragment with the greatest nearness certainly is in the band that begins at the
    /// least depth. Two roundings of reciprocals may make them different fragments.
    fn has_the_nearest(&self, least: Ball<P>) -> bool {
        // A greater depth rounds more, so take the greatest.
        let least = Ball::new(least.middle + least.radius, 0.0);
        let greatest = self.view.nearness(self.view.nearness(least));
        decide::visible(greatest, limit(least, self.epsilon)).certainly()
    }

    /// The sums of a choice of samples, for each outcome of its undecided tests. None if there are
    /// more outcomes than are followed. The surfel of the picture passes if `id` names it, unless
    /// rounding may exclude it.
    fn sums(
        &self,
        choice: &Choice<'_, P>,
        nearest: Ball<P>,
        id: Option<u32>,
        pixel: &mut PixelMarks<'_>,
    ) -> Option<Vec<Sums<Ball<P>>>> {
        let limit = self.end(nearest);
        let id = id.filter(|_| self.has_the_nearest(nearest));
        let seen: Vec<_> = choice
            .iter()
            .map(|sample| (*sample, self.visible(sample, nearest, limit, id)))
            .filter(|(_, visible)| visible.possibly())
            .collect();
        let undecided = seen.iter().filter(|(_, visible)| !visible.certainly()).count() as u32;
        pixel.doubt(Doubt::Epsilon, undecided > 0);
        if undecided > MOST {
            return None;
        }
        let of = |outcome: u32| {
            let (mut sums, mut count, mut bit) = (WeightedFragment::EMPTY, 0_u8, 0);
            for (sample, visible) in &seen {
                let taken = visible.certainly() || outcome >> bit & 1 == 1;
                bit += u32::from(!visible.certainly());
                if taken {
                    sums.add(&sample.read);
                    count += 1;
                }
            }
            let WeightedFragment { weight, normal, color, opacity, .. } = sums;
            Sums { weight, normal, color, opacity, count }
        };
        Some((0..1 << undecided).map(of).collect())
    }

    /// The end of the band behind the nearest depth, as assumed for the client.
    fn end(&self, nearest: Ball<P>) -> Ball<P> {
        match self.client_planes.band {
            Band::Before => nearest - self.epsilon,
            Band::OfNearness(unit) => {
                let least = self.view.nearness(nearest) - self.epsilon * Ball::exact(unit);
                let ends = !self.view.perspective || least.gt(Ball::ZERO).certainly();
                if ends { self.view.nearness(least) } else { Ball::INFINITY }
            }
            Band::Depth | Band::AlongRay | Band::RadiiOfNearest(_) => limit(nearest, self.epsilon),
        }
    }

    /// Whether a sample is in the sums.
    fn visible(
        &self,
        sample: &Sample<P>,
        nearest: Ball<P>,
        limit: Ball<P>,
        id: Option<u32>,
    ) -> Three {
        let depth = sample.read.depth;
        let exact = depth.radius == 0.0 && nearest.radius == 0.0;
        let some = decide::before(depth, Ball::INFINITY);
        // The sample with the least depth always passes, by the law of the test.
        let passes = self.client_planes.band != Band::Before;
        if passes
            && ((id == Some(sample.surfel) && sample.surfel != NO_ID)
                || (exact && depth.middle == nearest.middle))
        {
            return some;
        }
        some & decide::visible(depth, limit)
    }
}

/// Whether neither of two nearnesses certainly is the greater.
fn may_tie<P: Profile>(a: Ball<P>, b: Ball<P>) -> bool {
    !decide::nearer(a, b).certainly() && !decide::nearer(b, a).certainly()
}

/// `nearest + epsilon`. If epsilon is 0, no implementation rounds it.
pub(crate) fn limit<P: Profile>(nearest: Ball<P>, epsilon: Ball<P>) -> Ball<P> {
    if epsilon.middle == 0.0 && epsilon.radius == 0.0 {
        return nearest;
    }
    decide::limit(nearest, epsilon)
}

/// The nearest depth of a choice.
fn nearest<P: Profile>(choice: &Choice<'_, P>) -> Ball<P> {
    choice.iter().fold(Ball::INFINITY, |least, sample| least.at_most(sample.read.depth))
}

/// Every choice of one sample from each group; none if there are more than are followed.
fn choices<P: Profile>(groups: &[Samples<P>]) -> Vec<Choice<'_, P>> {
    let mut all: Vec<Choice<'_, P>> = vec![Vec::new()];
    for group in groups {
        // A stored sample gives the same sums whatever its surfel, so one sample is enough.
        let samples = if group.stored { &group.all[..1] } else { &group.all[..] };
        if all.len() * samples.len() > MOST_CHOICES {
            return Vec::new();
        }
        let mut longer = Vec::with_capacity(all.len() * samples.len());
        for choice in &all {
            longer.extend(samples.iter().map(|sample| {
                let mut with = choice.clone();
                with.push(sample);
                with
            }));
        }
        all = longer;
    }
    all
}
