//! The certificate of a client's visibility pass: which fragment may be the nearest, and which
//! certainly is not.

use super::client_planes::ClientPlanes;
use super::swift::{Fragment, SwiftSplat, SwiftSplats, each_fragment, least_nearness};
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::ewa::possible::PossibleSplat;
use crate::method::fragment::each_pixel;
use crate::method::tiled::pixels;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};
use crate::scene::Surfels;
use crate::splat::{Shared, Splat, fragment};
use crate::verdict::client::{Storage, Ties};
use crate::verdict::marks::{Marks, PixelMarks, TilePart};
use crate::verdict::{Doubt, Fault};

/// The nearest fragment of a pixel, according to the client.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest<P: Profile> {
    /// The depth that later passes use.
    pub(crate) depth: Ball<P>,
    /// The surfel, if the client names it.
    pub(crate) id: Option<u32>,
}

impl<P: Profile> Nearest<P> {
    /// The nearest fragment from which a test in this format finds the limit of visible depths.
    pub(crate) fn tested(self, depth_test: Storage, epsilon: Ball<P>) -> Self {
        match depth_test {
            Storage::Single => self,
            _ => Self { depth: depth_test.tested(self.depth + epsilon) - epsilon, ..self },
        }
    }
}

/// A polygon, which is no splat and has no id, but may be nearest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Other<P: Profile> {
    pub(crate) depth: Ball<P>,
    /// Whether the polygon certainly lies in the pixel.
    pub(crate) lies: bool,
}

/// The polygons at a pixel of a tile; empty if no pixel has any.
fn others_of<P: Profile>(others: &[Vec<Other<P>>], pixel: usize) -> &[Other<P>] {
    others.get(pixel).map_or(&[], Vec::as_slice)
}

/// The client's claim about a pixel, before other fragments are compared with it.
#[derive(Clone, Copy, Debug)]
struct Claim<P: Profile> {
    nearest: Nearest<P>,
    /// The error of the claim itself in bounds. If several fragments may be meant, the least error.
    error: f64,
    /// The depth of the fragment with the least error.
    closest: Ball<P>,
    /// The fragment's q divided by the limit, if it certainly is outside.
    outside: Option<f64>,
    /// Whether the client says nothing about the pixel.
    open: bool,
    /// For an open claim: the least and the greatest depth that may be the nearest.
    range: [f64; 2],
}

/// Judges the nearest fragments of a tile, pixel by pixel, where polygons may be nearest. Returns
/// the nearest fragments that later passes use.
pub(crate) fn judge_among<P: Profile>(
    splats: &SwiftSplats<P>,
    others: &[Vec<Other<P>>],
    client_planes: &ClientPlanes<'_>,
    surfels: &Surfels,
    part: TilePart,
    marks: &mut Marks,
) -> Vec<Nearest<P>> {
    let certificate = Certificate::new(splats, others, client_planes, surfels, part);
    each_fragment(
        splats,
        part,
        |pixel| certificate.least(pixel),
        |fragment, pixel| certificate.meet(pixel, fragment, fragment.depth(), marks),
    );
    certificate.end(marks);
    certificate.nearest()
}

/// The certificate for the nearest fragments of a tile. Call [`Certificate::meet`] for every
/// fragment that may be nearer, then [`Certificate::end`] to judge the claims.
pub(super) struct Certificate<'a, P: Profile> {
    client_planes: &'a ClientPlanes<'a>,
    surfels: &'a Surfels,
    others: &'a [Vec<Other<P>>],
    claims: Vec<Claim<P>>,
    /// For each pixel, the depth that others are compared with: the claim's, as inexact as the
    /// client's depth test.
    tested: Vec<Ball<P>>,
    /// For each pixel, the least nearness that may be before the client's fragment. Fragments that
    /// certainly are farther are skipped. +inf where the client says nothing.
    least: Vec<f64>,
}

impl<'a, P: Profile> Certificate<'a, P> {
    pub(super) fn new(
        splats: &SwiftSplats<P>,
        others: &'a [Vec<Other<P>>],
        client_planes: &'a ClientPlanes<'a>,
        surfels: &'a Surfels,
        part: TilePart,
    ) -> Self {
        let mut claims = claims(splats, others, client_planes, part);
        bound_open(splats, &mut claims, part);
        let depth_test = client_planes.depth_test;
        let tested: Vec<_> =
            claims.iter().map(|claim| depth_test.tested(claim.nearest.depth)).collect();
        let least = |(claim, tested): (&Claim<P>, &Ball<P>)| match claim.open {
            true => f64::INFINITY,
            false => least_nearness(&splats.shared, *tested),
        };
        let least = claims.iter().zip(&tested).map(least).collect();
        Self { client_planes, surfels, others, claims, tested, least }
    }

    /// The nearest fragments that later passes use.
    pub(super) fn nearest(&self) -> Vec<Nearest<P>> {
        self.claims.iter().map(|claim| claim.nearest).collect()
    }

    /// The least nearness of a pixel that a fragment needs to be met, for [`each_fragment`].
    #[inline(always)]
    pub(super) fn least(&self, pixel: usize) -> f64 {
        self.least[pixel]
    }

    /// Compares a fragment of depth `t` with the client's claim at its pixel.
    #[inline(always)]
    pub(super) fn meet(
        &self,
        pixel: usize,
        fragment: &Fragment<'_, P>,
        t: Ball<P>,
        marks: &mut Marks,
    ) {
        let claim = &self.claims[pixel];
        // Written so that a NaN does not count as farther.
        let farther = fragment.most_near() < self.least[pixel];
        if !(claim.open || farther || fragment.is_of(claim.nearest.id)) {
            let (against, mut marks) = (Rival { fragment, t }, marks.at(pixel));
            against.judge(self.tested[pixel], &mut marks);
            against.judge_tie(claim, self.client_planes.ties, self.surfels, &mut marks);
        }
    }

    /// Judges the client's claims, and compares the polygons with them.
    pub(super) fn end(&self, marks: &mut Marks) {
        for (pixel, claim) in self.claims.iter().enumerate().filter(|(_, claim)| !claim.open) {
            claim.judge(self.client_planes, &mut marks.at(pixel));
            others_of(self.others, pixel).iter().for_each(|other| {
                other.judge(self.tested[pixel], &mut marks.at(pixel));
            });
        }
    }
}

/// Finds the depths that may be the nearest where the client says nothing.
fn bound_open<P: Profile>(splats: &SwiftSplats<P>, claims: &mut [Claim<P>], part: TilePart) {
    let open: Vec<bool> = claims.iter().map(|claim| claim.open).collect();
    if !open.contains(&true) {
        return;
    }
    let least = |pixel: usize| if open[pixel] { f64::NAN } else { f64::INFINITY };
    each_fragment(splats, part, least, |fragment, pixel| {
        Rival { fragment, t: fragment.depth() }.bound(&mut claims[pixel].range);
    });
    for claim in claims.iter_mut().filter(|claim| claim.open) {
        claim.nearest.depth = between(claim.range);
    }
}

/// The client's claim about each pixel.
fn claims<P: Profile>(
    splats: &SwiftSplats<P>,
    others: &[Vec<Other<P>>],
    client_planes: &ClientPlanes<'_>,
    TilePart { tile, rect }: TilePart,
) -> Vec<Claim<P>> {
    let mut claims: Vec<Claim<P>> = pixels(rect)
        .enumerate()
        .map(|(pixel, at)| {
            let id = client_planes.id.map(|ids| *ids.plane.at(at.0, at.1));
            let depth = client_planes.depth.map_or(Ball::INFINITY, |depth| depth.ball(at));
            let nothing = depth.middle == f64::INFINITY && id.is_none_or(|id| id == NO_ID);
            let error = if nothing { 0.0 } else { f64::INFINITY };
            let mut claim = Claim {
                nearest: Nearest { depth, id },
                error,
                closest: Ball::INFINITY,
                outside: None,
                open: client_planes.says_nothing(at),
                range: [f64::INFINITY; 2],
            };
            claim.meet_others(client_planes, others_of(others, pixel));
            claim
        })
        .collect();
    let shared = &splats.shared;
    let has_depth = client_planes.depth.is_some();
    let mut meet = |splat: &Splat<Ball<P>>, pixel: usize, at| {
        let (q, w) = fragment(shared, &splat.footprint, at);
        claims[pixel].meet(shared, q, w, has_depth);
    };
    if let Some(ids) = client_planes.id {
        // Each surfel is shown in few of the pixels in its bounds, so only these are visited.
        let shown =
            pixels(rect).enumerate().map(|(pixel, at)| (*ids.plane.at(at.0, at.1), pixel, at));
        let mut shown: Vec<_> = shown.filter(|(id, ..)| *id != NO_ID).collect();
        shown.sort_unstable();
        splats.for_each(tile, |SwiftSplat { possible: PossibleSplat { splat, .. }, .. }| {
            let first = shown.partition_point(|(id, ..)| *id < splat.surfel);
            let own = shown[first..].iter().take_while(|(id, ..)| *id == splat.surfel);
            let bounds = &splat.bounds;
            for &(_, pixel, at) in own.filter(|(.., at)| bounds.contains(at.0, at.1)) {
                meet(splat, pixel, at);
            }
        });
    } else if has_depth {
        splats.for_each(tile, |SwiftSplat { possible: PossibleSplat { splat, .. }, .. }| {
            each_pixel(splat, &rect, |pixel, at| meet(splat, pixel, at));
        });
    }
    claims
}

impl<P: Profile> Claim<P> {
    /// Compares a fragment that the client may mean with the claim.
    fn meet(&mut self, shared: &Shared<Ball<P>>, q: Ball<P>, w: Ball<P>, has_depth: bool) {
        let inside = decide::inside(q, shared.limit);
        let outside = if inside.possibly() { 0.0 } else { q.distance(shared.limit) };
        let t = shared.depth(w);
        let misfit = if has_depth { t.misfit(self.nearest.depth) } else { 0.0 };
        let error = if misfit > outside { misfit } else { outside };
        if error <= self.error {
            (self.error, self.closest) = (error, t);
            let rim = q.middle / shared.limit.middle;
            self.outside = (outside > 0.0).then_some(rim);
            if !has_depth {
                self.nearest.depth = t;
            }
        }
    }

    /// Compares the polygons that the client may mean with the claim.
    fn meet_others(&mut self, client_planes: &ClientPlanes<'_>, others: &[Other<P>]) {
        let without_id = self.nearest.id.is_none_or(|id| id == NO_ID);
        if others.is_empty() || !(self.open || without_id) {
            return;
        }
        // The picture may show a fragment with no weight here, and a polygon behind it.
        if client_planes.empty_is_open || self.open {
            (self.open, self.nearest.id) = (true, None);
        }
        others.iter().for_each(|other| other.bound(&mut self.range));
        if client_planes.depth.is_none() && !self.open {
            // Without an id the client may mean any polygon, or nothing.
            self.nearest.depth = between(self.range);
        } else if self.nearest.depth.middle < f64::INFINITY {
            for other in others {
                let error = other.depth.misfit(self.nearest.depth);
                if error < self.error {
                    (self.error, self.closest) = (error, other.depth);
                }
            }
        }
    }

    /// Judges the claim itself.
    fn judge(&self, client_planes: &ClientPlanes<'_>, pixel: &mut PixelMarks<'_>) {
        let Nearest { depth, id } = self.nearest;
        if client_planes.depth.is_none() && self.error <= 1.0 {
            return;
        }
        let channel =
            || client_planes.depth.map_or_else(String::new, |depth| depth.name.to_owned());
        pixel.found(self.error, || match id {
            Some(NO_ID) => Fault::Value {
                channel: channel(),
                found: depth.middle,
                truth: self.closest.middle,
                radius: self.closest.radius,
            },
            Some(surfel) if self.closest.middle == f64::INFINITY => Fault::Absent { surfel },
            Some(surfel) if self.outside.is_some() => {
                Fault::Outside { surfel, rim: self.outside.unwrap_or_default() }
            }
            Some(_) => Fault::Value {
                channel: channel(),
                found: depth.middle,
                truth: self.closest.middle,
                radius: self.closest.radius + depth.radius,
            },
            None => Fault::NoSuchDepth { found: depth.middle, closest: self.closest.middle },
        });
    }
}

impl<P: Profile> Other<P> {
    /// Checks whether the polygon certainly is nearer than the client's fragment, or may be.
    fn judge(&self, depth: Ball<P>, pixel: &mut PixelMarks<'_>) {
        let nearer = decide::before(self.depth, depth);
        if self.lies && nearer.certainly() {
            pixel.found(self.depth.distance(depth), || Fault::Hidden {
                depth: self.depth.middle,
                found: depth.middle,
            });
        } else if nearer.possibly() && self.depth.misfit(depth) > 0.0 {
            pixel.doubt(Doubt::Nearer, !nearer.certainly());
            pixel.doubt(Doubt::Fate, !self.lies);
        }
    }

    /// Widens the range as [`Rival::bound`] does.
    fn bound(&self, [least, most]: &mut [f64; 2]) {
        let Ball { middle, radius, .. } = self.depth;
        let radius = if radius.is_nan() { f64::INFINITY } else { radius };
        *least = least.at_most(middle - radius);
        if self.lies {
            *most = most.at_most(middle + radius);
        }
    }
}

/// A fragment that the client did not choose.
struct Rival<'a, P: Profile> {
    fragment: &'a Fragment<'a, P>,
    t: Ball<P>,
}

impl<P: Profile> Rival<'_, P> {
    /// Checks whether the fragment certainly is nearer than the client's, or may be.
    fn judge(&self, depth: Ball<P>, pixel: &mut PixelMarks<'_>) {
        let fragment = self.fragment;
        let nearer = decide::before(self.t, depth);
        if fragment.drawn && (fragment.inside & nearer).certainly() {
            // The fault is as certain as the less certain of the two decisions.
            let (gap, margin) = (self.t.distance(depth), fragment.margin());
            pixel.found(if gap < margin { gap } else { margin }, || Fault::LeftOut {
                surfel: fragment.splat.surfel,
                rim: fragment.rim(),
                depth: self.t.middle,
                found: depth.middle,
            });
        } else if nearer.possibly() {
            pixel.doubt(Doubt::Nearer, !nearer.certainly());
            pixel.doubt(Doubt::CutOff, !fragment.inside.certainly());
            pixel.doubt(Doubt::Fate, !fragment.drawn);
        }
    }

    /// Checks whether the fragment is exactly as near as the client's, and comes before it by the
    /// tie rule.
    ///
    /// Depths are equal in every implementation where nothing was rounded, or where surfels have
    /// the same numbers.
    fn judge_tie(
        &self,
        claim: &Claim<P>,
        ties: Ties,
        surfels: &Surfels,
        pixel: &mut PixelMarks<'_>,
    ) {
        let Some(id) = claim.nearest.id else { return };
        let surfel = self.fragment.splat.surfel;
        let first = ties.keeps(surfel, id);
        // The distance of two exact numbers is infinite, so this asks whether both are exact.
        let exact = self.t.distance(claim.closest) == f64::INFINITY
            && self.fragment.inside.certainly()
            && self.t.middle == claim.closest.middle;
        if first && self.fragment.drawn && (exact || surfels.are_equal(surfel, id)) {
            pixel.found(f64::INFINITY, || Fault::Tie { surfel, found: id });
        }
    }

    /// Widens the range of nearest depths that a pixel may have, for a pixel where the client says
    /// nothing.
    fn bound(&self, [least, most]: &mut [f64; 2]) {
        let Ball { middle, radius, .. } = self.t;
        *least = least.at_most(middle - radius);
        if self.fragment.drawn && self.fragment.inside.certainly() {
            *most = most.at_most(middle + radius);
        }
    }
}

/// The ball of an interval of depths. An interval without an end gives any depth.
fn between<P: Profile>([least, most]: [f64; 2]) -> Ball<P> {
    if least == f64::INFINITY {
        Ball::INFINITY
    } else if !least.is_finite() {
        Ball::new(0.0, f64::INFINITY)
    } else if most == f64::INFINITY {
        Ball::new(least, f64::INFINITY)
    } else {
        Ball::new(0.5 * (least + most), 0.5 * (most - least))
    }
}
