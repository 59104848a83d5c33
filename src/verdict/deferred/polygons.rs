//! Polygons in a client's planes: which of them may be nearest beside splats, and what a pixel may
//! show of them.

use super::LaterPasses;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::deferred::part::Whole;
use crate::method::deferred::polygons::alone;
use crate::method::ewa::attributes::Sums;
use crate::method::projection::world;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Scene;
use crate::splat::View;
use crate::verdict::Doubt;
use crate::verdict::checks::{Report, Surface, least_wrong};
use crate::verdict::ewa::certificate::{Nearest, Other};
use crate::verdict::ewa::pixel::all;
use crate::verdict::ewa::sums::Continuations;
use crate::verdict::marks::{Marks, TilePart};
use crate::verdict::projection::{AllPolygons, PossibleFragment};

/// The polygons of a scene as a scene of their own, and one colour for polygons without colours.
pub(super) struct Ground(Scene, Option<[f32; 3]>);

impl Ground {
    /// None if there are no polygons.
    pub(super) fn new(job: &Job<'_>, whole: &Whole<'_>) -> Result<Option<Self>> {
        Ok(alone(job, whole)?.map(|(scene, paint)| Self(scene, paint)))
    }
}

/// Polygons that may be drawn.
pub(super) struct Polygons<'a, P: Profile> {
    all: AllPolygons<'a, P>,
    view: View<Ball<P>>,
    paint: Option<[Ball<P>; 3]>,
}

/// The polygons that may lie in the pixels of a tile. `NOTHING` is for a scene without polygons.
pub(super) struct PolygonTile<P: Profile> {
    surfaces: Vec<Vec<Surface<P>>>,
    pub(super) others: Vec<Vec<Other<P>>>,
}

impl<P: Profile> PolygonTile<P> {
    pub(super) const NOTHING: Self = Self { surfaces: Vec::new(), others: Vec::new() };

    /// The polygons at a pixel.
    pub(super) fn others(&self, pixel: usize) -> &[Other<P>] {
        self.others.get(pixel).map_or(&[], Vec::as_slice)
    }
}

impl<'a, P: Profile> Polygons<'a, P> {
    pub(super) fn new(job: &Job<'_>, ground: &'a Ground, cull: bool) -> Self {
        let Ground(scene, paint) = ground;
        let paint = paint.map(|color| color.map_inline(Ball::from_f32));
        let all = AllPolygons::new(job, scene, cull);
        Self { all, view: View::new(job.camera), paint }
    }

    /// The polygons that may lie in the pixels of a tile.
    pub(super) fn beside(&self, part: TilePart) -> PolygonTile<P> {
        let mut found = PolygonTile { surfaces: Vec::new(), others: Vec::new() };
        for fragments in self.all.fragments(part) {
            let drawn: Vec<_> = fragments.iter().map(|fragment| self.surface(fragment)).collect();
            let other = |(fragment, surface): (&PossibleFragment<P>, &Surface<P>)| Other {
                depth: surface.depth,
                lies: fragment.lies,
            };
            found.others.push(fragments.iter().zip(&drawn).map(other).collect());
            found.surfaces.push(drawn);
        }
        found
    }

    /// The surface that a pixel shows of a fragment. Its depth goes through nearness and back, as
    /// in the method.
    fn surface(&self, fragment: &PossibleFragment<P>) -> Surface<P> {
        let PossibleFragment { depth, normal, color, .. } = *fragment;
        let nearness = self.view.nearness(depth);
        let depth = if self.view.perspective { Ball::ONE / nearness } else { -nearness };
        let normal = world(&self.view, normal);
        Surface { depth, normal, tangent: None, color: self.paint.unwrap_or(color) }
    }
}

/// The content that a pixel may show.
enum Shown<'s, P: Profile> {
    Splats(Option<&'s Sums<Ball<P>>>),
    Polygon(Option<&'s Sums<Ball<P>>>, Surface<P>),
}

/// Whether the nearest fragment may be a splat or nothing, and whether it may be a polygon.
pub(super) fn front<P: Profile>(nearest: &Nearest<P>, others: &[Other<P>]) -> [bool; 2] {
    let Ball { middle, radius, .. } = nearest.depth;
    let certain = radius.is_finite();
    match nearest.id {
        _ if middle == f64::INFINITY && certain => [true, false],
        Some(NO_ID) => [!certain, true],
        Some(_) => [true, false],
        None => [true, others.iter().any(|other| !(other.depth.misfit(nearest.depth) > 1.0))],
    }
}

impl<P: Profile> LaterPasses<'_, P> {
    /// Judges a pixel where polygons may lie, by the content with the least error among all that it
    /// may show.
    pub(super) fn judge_beside(
        &self,
        pixel: usize,
        at: (u32, u32),
        beside: &PolygonTile<P>,
        nearest: &Nearest<P>,
        sums: &Continuations<P>,
        marks: &mut [Marks; 3],
    ) {
        let shown = self.may_show(pixel, at, beside, nearest, sums);
        let several = shown.iter().any(|one| matches!(one, Shown::Splats(_)))
            && shown.iter().any(|one| matches!(one, Shown::Polygon(..)));
        marks[1].at(pixel).doubt(Doubt::Nearer, several);
        let check = |shown: &Shown<'_, P>, report: &mut Report<'_>| match shown {
            Shown::Splats(sums) => self.pixels.check(at, nearest, *sums, report),
            Shown::Polygon(sums, surface) => self.polygons.check_other(at, surface, *sums, report),
        };
        if let Some(best) = least_wrong::<_, 3>(&shown, check) {
            let mut right = true;
            check(best, &mut |part, error, fault| {
                right &= !(error > 1.0);
                marks[part].at(pixel).found(error, fault);
            });
            // The picture shows the polygon, whatever the sums are.
            if right && self.without_sums && matches!(best, Shown::Polygon(..)) {
                marks[0].at(pixel).settle();
            }
        }
    }

    fn may_show<'s>(
        &self,
        pixel: usize,
        at: (u32, u32),
        beside: &PolygonTile<P>,
        nearest: &Nearest<P>,
        sums: &'s Continuations<P>,
    ) -> Vec<Shown<'s, P>> {
        let others = beside.others(pixel);
        let [splat, polygon] = front(nearest, others);
        let covered = others.iter().any(|other| other.lies);
        let all: Vec<_> = match all(sums) {
            [] => vec![None],
            all => all.iter().map(Some).collect(),
        };
        // The surfaces that no polygon certainly hides.
        let seen: Vec<_> = beside.surfaces[pixel]
            .iter()
            .filter(|one| {
                let hides = |other: &Other<P>| {
                    other.lies && decide::before(other.depth, one.depth).certainly()
                };
                !others.iter().any(hides)
            })
            .collect();
        let own = (polygon && nearest.id == Some(NO_ID) && nearest.depth.radius.is_finite())
            .then_some(nearest.depth);
        let mut shown = Vec::new();
        for sums in all {
            let weighs = self.pixels.weight(at, sums).gt(Ball::ZERO);
            if splat && (weighs.possibly() || !covered) {
                shown.push(Shown::Splats(sums));
            }
            let weighs = self.polygons.weight(at, sums).gt(Ball::ZERO);
            if polygon || !weighs.certainly() {
                for &&surface in &seen {
                    shown.push(Shown::Polygon(sums, surface));
                    // Also the depth from the client's depth buffer, as it is stored.
                    shown.extend(
                        own.map(|depth| Shown::Polygon(sums, Surface { depth, ..surface })),
                    );
                }
            }
        }
        let polygons = shown.iter().any(|one| matches!(one, Shown::Polygon(..)));
        if polygons && self.polygons.shows_no_splats(at) {
            shown.retain(|one| matches!(one, Shown::Polygon(..)));
        } else if shown.is_empty() {
            shown.push(Shown::Splats(None));
        }
        shown
    }
}
