//! Verify the layers of a client at a pixel, each beyond the client's layer before.

use super::planes::{LayerPlanes, PeelingPlanes};
use crate::composite::{decide, sum};
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::ewa::attributes::Sums;
use crate::method::peeling::Settings;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::checks::{
    Report, Shading, Surface, input, least_wrong, number, triple, whole, widened,
};
use crate::verdict::client::StoredPlane;
use crate::verdict::ewa::sums::MOST;
use crate::verdict::marks::PixelMarks;
use crate::verdict::single_pass::compositing::limit as band_end;
use crate::verdict::single_pass::fragments::Fragment;
use crate::verdict::{Doubt, Fault};

/// The parts that all pixels share.
pub(super) struct LayerJudge<'a, P: Profile> {
    surfels: &'a Surfels,
    client_planes: &'a PeelingPlanes<'a>,
    shading: Shading<'a, P>,
    epsilon: Ball<P>,
    /// The most layers a pixel may have.
    most: u32,
    /// The greatest component of any colour, at least 1.
    brightest: f64,
}

/// The findings at a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PixelFindings {
    /// Whether the pixel may be covered.
    pub(super) covered: bool,
    /// Whether the sums of a layer are undecided.
    pub(super) undecided: bool,
}

/// A fragment that may be beyond the layer before.
struct Beyond<'f, P: Profile> {
    fragment: &'f Fragment<P>,
    /// Whether it is beyond, and inside.
    there: Three,
    /// How certain that decision is, in bounds.
    margin: f64,
}

impl<P: Profile> Beyond<'_, P> {
    fn certainly(&self) -> bool {
        self.fragment.drawn && self.there.certainly()
    }
}

impl<'a, P: Profile> LayerJudge<'a, P> {
    pub(super) fn new(
        job: &Job<'a>,
        settings: &Settings,
        client_planes: &'a PeelingPlanes<'a>,
        epsilon: Ball<P>,
    ) -> Self {
        let surfels = &job.scene.surfels;
        let colors = surfels.color().unwrap_or_default();
        let brightest = colors.iter().fold(1.0_f64, |brightest, color| {
            let [r, g, b] = color.to_array().map_inline(f64::from);
            brightest.at_least(r).at_least(g).at_least(b)
        });
        let shading = Shading::new(job, surfels.color().is_some());
        Self { surfels, client_planes, shading, epsilon, most: settings.layers, brightest }
    }

    /// Marks wrong layers of a pixel.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        fragments: &[Fragment<P>],
        pixel: &mut PixelMarks<'_>,
    ) -> PixelFindings {
        let client_planes = self.client_planes;
        let mut found = PixelFindings { covered: client_planes.known() == 0, undecided: false };
        let (mut limit, mut layers) = (-Ball::INFINITY, 0);
        for (layer, planes) in client_planes.layers.iter().enumerate() {
            let depth = client_planes.depth_of(layer);
            let id = client_planes.surfel(at).filter(|_| layer == 0);
            if depth.is_none() && id.is_none() {
                break;
            }
            let beyond = beyond(fragments, limit, id);
            let nearest = Nearest { judge: self, at, depth, id };
            let t = nearest.judge(&beyond, pixel);
            let Some(plane) = depth else { break };
            let stored = input(&plane, at);
            let nothing = stored.middle == f64::INFINITY;
            found.covered |= !nothing;
            layers += u32::from(layers as usize == layer && !nothing);
            limit = client_planes.depth_test.tested(band_end(stored, self.epsilon));
            let all = match nothing {
                true => Some(vec![Sums::NONE]),
                false => self.sums(&beyond, t, limit, id, pixel),
            };
            found.undecided |= all.as_ref().is_none_or(|all| all.len() > 1);
            self.check_layer(at, planes, stored, &all.unwrap_or_default(), pixel);
        }
        if let (Some(plane), Some(copy)) = (client_planes.layers[0].depth, &client_planes.depth) {
            number(0, copy, at, plane.ball::<P>(at), &mut |_, e, fault| pixel.found(e, fault));
        }
        if let Some(plane) =
            client_planes.number.filter(|_| client_planes.known() == client_planes.layers.len())
        {
            self.check_number(at, &plane, layers, &beyond(fragments, limit, None), pixel);
        }
        found
    }

    /// Checks the number of layers, from the layers that have planes and the fragments beyond the
    /// last.
    fn check_number(
        &self,
        at: (u32, u32),
        plane: &StoredPlane<'_, u8>,
        layers: u32,
        beyond: &[Beyond<'_, P>],
        pixel: &mut PixelMarks<'_>,
    ) {
        let all = layers as usize == self.client_planes.layers.len();
        let more = self.most > layers;
        let [least, most] = if !all || !more || beyond.is_empty() {
            [layers; 2]
        } else {
            [layers + u32::from(beyond.iter().any(Beyond::certainly)), self.most]
        };
        let found = u32::from(*plane.plane.at(at.0, at.1));
        let truth = if found < least.min(255) { least } else { most };
        let right = (least.min(255)..=most.min(255)).contains(&found);
        let error = if right { 0.0 } else { f64::INFINITY };
        let channel = || plane.channel();
        let truth = if right { found } else { truth };
        pixel.found(error, || Fault::Whole { channel: channel(), found, truth });
    }

    /// The sums of a layer, for each outcome of its undecided decisions. None if there are more
    /// outcomes than are followed.
    fn sums(
        &self,
        beyond: &[Beyond<'_, P>],
        t: Ball<P>,
        limit: Ball<P>,
        id: Option<u32>,
        pixel: &mut PixelMarks<'_>,
    ) -> Option<Vec<Sums<Ball<P>>>> {
        let fits = |one: &Beyond<'_, P>| {
            one.there.possibly()
                && id.is_none_or(|id| id == one.fragment.surfel)
                && one.fragment.t.misfit(t) <= 1.0
        };
        let alone = beyond.iter().filter(|one| fits(one)).count() == 1;
        let mut parts = Vec::new();
        let mut undecided = 0;
        for one in beyond {
            let fragment = one.fragment;
            // The nearest fragment always passes, by the law of the test.
            let nearest = alone && fits(one);
            let visible = decide::visible(fragment.t, limit);
            let there = if nearest { true.into() } else { one.there & visible };
            if !there.possibly() {
                continue;
            }
            let certain = nearest || (fragment.drawn && there.certainly());
            undecided += u32::from(!certain);
            pixel.doubt(Doubt::Epsilon, !certain && visible.decided().is_none());
            pixel.doubt(Doubt::CutOff, !certain && fragment.inside.decided().is_none());
            pixel.doubt(Doubt::Fate, !certain && !fragment.drawn);
            pixel.doubt(Doubt::Side, fragment.back.decided().is_none());
            parts.push((fragment, certain));
        }
        if undecided > MOST {
            return None;
        }
        let of = |outcome: u32| {
            let (mut sums, mut bit) = (Sums::NONE, 0);
            for (fragment, certain) in &parts {
                let taken = *certain || outcome >> bit & 1 == 1;
                bit += u32::from(!certain);
                if taken {
                    sums.add(self.surfels, fragment.surfel, fragment.back, fragment.weight);
                }
            }
            sums
        };
        Some((0..1 << undecided).map(of).collect())
    }

    /// Checks count, opacity and colour of a layer, by the continuation that errs least.
    fn check_layer(
        &self,
        at: (u32, u32),
        planes: &LayerPlanes<'_>,
        depth: Ball<P>,
        all: &[Sums<Ball<P>>],
        pixel: &mut PixelMarks<'_>,
    ) {
        let check = |sums: &Sums<Ball<P>>, report: &mut Report<'_>| {
            self.check_sums(at, planes, depth, sums, report);
        };
        if let Some(sums) = least_wrong::<_, 1>(all, check) {
            check(sums, &mut |_, error, fault| pixel.found(error, fault));
        }
    }

    fn check_sums(
        &self,
        at: (u32, u32),
        planes: &LayerPlanes<'_>,
        depth: Ball<P>,
        sums: &Sums<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &planes.count {
            whole(0, plane, at, sums.count, report);
        }
        // Each addition rounds a sum that is at most this large.
        let heaviest = sums.weight.middle + sums.weight.radius;
        let lost = |largest: f64| {
            f64::from(sums.count) * self.client_planes.accumulator.radius(heaviest * largest)
        };
        let weight = widened(sums.weight, lost(1.0));
        if let Some(plane) = &planes.alpha {
            let opacity = widened(sums.opacity, lost(1.0));
            let [truth, ..] = sum::average([opacity; 3], weight);
            number(0, plane, at, truth, report);
        }
        if let Some(plane) = &planes.color {
            let nothing = depth.middle == f64::INFINITY;
            let truth = if nothing {
                [Ball::ZERO; 3]
            } else {
                let normal = sums.normal.map_inline(|part| widened(part, lost(1.0)));
                let color = sums.color.map_inline(|part| widened(part, lost(self.brightest)));
                let normal = sum::direction(normal, weight);
                let color = sum::average(color, weight);
                let surface = Surface { depth, normal, tangent: None, color };
                self.shading.color(at, &surface)
            };
            triple(0, plane, at, truth, report);
        }
    }
}

/// The fragments that may be inside and beyond a limit, and the fragments of the surfel that the
/// client names.
fn beyond<P: Profile>(
    fragments: &[Fragment<P>],
    limit: Ball<P>,
    id: Option<u32>,
) -> Vec<Beyond<'_, P>> {
    let all = fragments.iter().map(|fragment| {
        let there = fragment.inside & decide::beyond(fragment.t, limit);
        let margin = fragment.t.distance(limit).at_most(fragment.margin);
        Beyond { fragment, there, margin }
    });
    all.filter(|one| one.there.possibly() || id == Some(one.fragment.surfel)).collect()
}

/// The nearest fragment of a layer, according to the client.
struct Nearest<'j, 'a, P: Profile> {
    judge: &'j LayerJudge<'a, P>,
    at: (u32, u32),
    depth: Option<StoredPlane<'a, f64>>,
    /// The surfel, only in the first layer.
    id: Option<u32>,
}

impl<P: Profile> Nearest<'_, '_, P> {
    /// Marks a wrong nearest fragment, and returns its depth.
    fn judge(&self, beyond: &[Beyond<'_, P>], pixel: &mut PixelMarks<'_>) -> Ball<P> {
        let own = self.depth.map(|plane| plane.ball::<P>(self.at));
        let meant = self.meant(beyond, own);
        let t = own.unwrap_or_else(|| meant.map_or(Ball::INFINITY, |(_, one)| one.fragment.t));
        self.check_own(t, meant, pixel);
        let surfel = meant.map(|(_, one)| one.fragment.surfel).filter(|_| self.id.is_some());
        let tested = self.judge.client_planes.depth_test.tested(t);
        for other in beyond.iter().filter(|other| Some(other.fragment.surfel) != surfel) {
            let fragment = other.fragment;
            let before = decide::before(fragment.t, tested);
            if other.certainly() && before.certainly() {
                let error = fragment.t.distance(tested).at_most(other.margin);
                pixel.found(error, || Fault::LeftOut {
                    surfel: fragment.surfel,
                    rim: fragment.rim,
                    depth: fragment.t.middle,
                    found: t.middle,
                });
            } else if let (true, Some((_, one))) = (other.certainly(), meant) {
                self.judge_tie(fragment, one.fragment, pixel);
            }
            pixel.doubt(Doubt::Nearer, before.possibly() && !before.certainly());
        }
        t
    }

    /// The fragment that the client may mean with the least error, and that error in bounds.
    fn meant<'b, 'f>(
        &self,
        beyond: &'b [Beyond<'f, P>],
        own: Option<Ball<P>>,
    ) -> Option<(f64, &'b Beyond<'f, P>)> {
        let all = beyond.iter().filter(|one| self.id.is_none_or(|id| id == one.fragment.surfel));
        all.fold(None, |best, one| {
            let misfit = own.map_or(0.0, |own| one.fragment.t.misfit(own));
            let outside = if one.there.possibly() { 0.0 } else { one.fragment.margin };
            let error = misfit.at_least(outside);
            match best {
                Some((least, _)) if least <= error => best,
                _ => Some((error, one)),
            }
        })
    }

    /// Checks whether the client's own claim is possible.
    fn check_own(
        &self,
        t: Ball<P>,
        meant: Option<(f64, &Beyond<'_, P>)>,
        pixel: &mut PixelMarks<'_>,
    ) {
        let nothing = t.middle == f64::INFINITY;
        let channel = || self.depth.map_or_else(String::new, |plane| plane.channel());
        match (meant, self.id) {
            (None, Some(NO_ID)) => {
                let (found, truth) = (t.middle, f64::INFINITY);
                let error = if nothing { 0.0 } else { f64::INFINITY };
                let fault = || Fault::Value { channel: channel(), found, truth, radius: 0.0 };
                pixel.found(error, fault);
            }
            (None, Some(surfel)) => pixel.found(f64::INFINITY, || Fault::Absent { surfel }),
            // Whether the layer may be empty follows from the fragments that are left.
            (_, None) if nothing => {}
            (None, None) => {
                let (found, closest) = (t.middle, f64::INFINITY);
                pixel.found(f64::INFINITY, || Fault::NoSuchDepth { found, closest });
            }
            (Some((error, one)), id) => {
                let Fragment { surfel, rim, t: closest, .. } = *one.fragment;
                pixel.found(error, || match id {
                    Some(_) if !one.there.possibly() => Fault::Outside { surfel, rim },
                    Some(_) => Fault::Value {
                        channel: channel(),
                        found: t.middle,
                        truth: closest.middle,
                        radius: closest.radius + t.radius,
                    },
                    None => Fault::NoSuchDepth { found: t.middle, closest: closest.middle },
                });
            }
        }
    }

    /// Checks whether another fragment is exactly as near as the id's, and comes before it.
    fn judge_tie(&self, other: &Fragment<P>, own: &Fragment<P>, pixel: &mut PixelMarks<'_>) {
        let Some(id) = self.id else { return };
        let surfel = other.surfel;
        let first = self.judge.client_planes.ties.keeps(surfel, id);
        let exact = other.t.distance(own.t) == f64::INFINITY && other.t.middle == own.t.middle;
        if first && (exact || self.judge.surfels.are_equal(surfel, id)) {
            pixel.found(f64::INFINITY, || Fault::Tie { surfel, found: id });
        }
    }
}
