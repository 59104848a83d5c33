//! Verify a client's attribute pass: add the fragments that certainly are visible, and follow both
//! continuations of every undecided decision.

use super::certificate::{Certificate, Nearest};
use super::swift::{Fragment, SwiftSplats, each_fragment, least_nearness};
use crate::composite::decide;
use crate::frame::stencil::{Outcome, Stencil};
use crate::method::ewa::attributes::Sums;
use crate::method::fragment::facing;
use crate::number::ball::{Common, Profile, Three, Totals};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::Doubt;
use crate::verdict::marks::{Marks, PixelMarks, TilePart};
use crate::verdict::shift::{CUT_OFF, EPSILON, OpenDecision};
use crate::verdict::supposed::Supposed;

/// The most undecided fragments of a pixel for which all continuations are followed, 2^n of them.
pub(crate) const MOST: u32 = 4;

/// The sums that a pixel may have.
#[derive(Clone, Debug)]
pub(crate) enum Continuations<P: Profile> {
    /// The only possible sums, because every decision is certain.
    One(Sums<Ball<P>>),
    /// The possible sums. Number n takes undecided decision i if bit i of n is set. The list of
    /// decisions is empty where a method does not keep it.
    Several(Vec<Sums<Ball<P>>>, Vec<OpenDecision>),
    /// More than are followed: any sums.
    Many,
}

/// The fragments of pixels with undecided sums.
type Fragments<P> = Vec<(usize, Part<P>)>;

/// A fragment that is in the sums, or may be.
#[derive(Clone, Copy, Debug)]
struct Part<P: Profile> {
    surfel: u32,
    back: Three,
    weight: Ball<P>,
    /// The decision on the fragment, if it is undecided.
    open: Option<OpenDecision>,
}

/// The sums of each pixel of a tile, for the given nearest fragments.
pub(crate) fn continuations<'a, P: Profile>(
    splats: &SwiftSplats<P>,
    surfels: &'a Surfels,
    nearest: &[Nearest<P>],
    tile: TilePart,
    marks: &mut Marks,
) -> TileSums<'a, P> {
    add(splats, surfels, Supposed::Nothing, nearest, tile, None, marks).followed(|_| true)
}

/// Adds the fragments that certainly are in the sums of each pixel of a tile, by the supposed rules
/// and for the given nearest fragments. It also shows each fragment to the certificate, because most such fragments are in
/// the sums.
pub(super) fn add<'s, 'a, P: Profile>(
    splats: &'s SwiftSplats<P>,
    surfels: &'a Surfels,
    supposed: Supposed,
    nearest: &'s [Nearest<P>],
    tile: TilePart,
    mut certificate: Option<(&Certificate<'_, P>, &mut Marks)>,
    marks: &mut Marks,
) -> Accumulation<'s, 'a, P> {
    let mut sums = AllSums::new(surfels, tile.rect.pixels());
    let limits = limits(splats, nearest);
    let least = |pixel: usize| {
        let own = limits[pixel].least;
        certificate.as_ref().map_or(own, |(certificate, _)| lesser(own, certificate.least(pixel)))
    };
    let least: Vec<f64> = (0..limits.len()).map(least).collect();
    each_part(
        splats,
        Limited { supposed, nearest, limits: &limits, least: &least },
        tile,
        |pixel, fragment, depth| {
            if let Some((certificate, marks)) = &mut certificate {
                certificate.meet(pixel, fragment, depth, marks);
            }
        },
        |pixel, part, asked| {
            if part.open.is_none() {
                sums.add(surfels, pixel, &part);
            } else {
                sums.undecided[pixel] += 1;
                asked.mark(&mut marks.at(pixel));
            }
            marks.at(pixel).doubt(Doubt::Side, part.back.decided().is_none());
        },
    );
    Accumulation { splats, surfels, supposed, nearest, limits, tile, sums }
}

/// The lesser of two bounds on a nearness. A NaN bounds nothing, so it is less than all.
fn lesser(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The sums added up at the pixels of a tile.
pub(super) struct Accumulation<'s, 'a, P: Profile> {
    splats: &'s SwiftSplats<P>,
    surfels: &'a Surfels,
    supposed: Supposed,
    nearest: &'s [Nearest<P>],
    limits: Vec<Limit<P>>,
    tile: TilePart,
    pub(super) sums: AllSums<P>,
}

impl<'a, P: Profile> Accumulation<'_, 'a, P> {
    /// Follows the possible sums of the pixels that `asked` names.
    pub(super) fn followed(self, asked: impl Fn(usize) -> bool) -> TileSums<'a, P> {
        let Self { splats, surfels, supposed, nearest, limits, tile, sums } = self;
        let followed = |pixel: usize| {
            asked(pixel)
                && match sums.undecided[pixel] {
                    0 => sums.bounded(pixel).is_none(),
                    n => n <= MOST,
                }
        };
        let parts = parts(splats, supposed, nearest, &limits, tile, followed);
        TileSums { surfels, sums, parts }
    }
}

/// The possible sums of the pixels of a tile.
pub(crate) struct TileSums<'a, P: Profile> {
    surfels: &'a Surfels,
    sums: AllSums<P>,
    parts: Fragments<P>,
}

impl<P: Profile> TileSums<'_, P> {
    /// The possible sums of a pixel that was asked for.
    pub(crate) fn continuations(&self, pixel: usize) -> Continuations<P> {
        match self.sums.undecided[pixel] {
            0 => {
                let plain = || chosen(self.surfels, of_one(&self.parts, pixel), 0);
                Continuations::One(self.sums.bounded(pixel).unwrap_or_else(plain))
            }
            n @ 1..=MOST => several(self.surfels, of_one(&self.parts, pixel), n),
            _ => Continuations::Many,
        }
    }
}

/// The sums of the pixels of a tile, and the number of undecided fragments.
pub(super) struct AllSums<P: Profile> {
    /// Weight and normal.
    pub(super) weighted: Vec<Totals<P, 4>>,
    /// The colour, if there are colours.
    pub(super) color: Vec<Totals<P, 3>>,
    pub(super) count: Vec<u8>,
    pub(super) undecided: Vec<u32>,
}

impl<P: Profile> AllSums<P> {
    fn new(surfels: &Surfels, pixels: usize) -> Self {
        let colored = if surfels.color().is_some() { pixels } else { 0 };
        Self {
            weighted: vec![Totals::NONE; pixels],
            color: vec![Totals::NONE; colored],
            count: vec![0; pixels],
            undecided: vec![0; pixels],
        }
    }

    /// Adds a fragment as [`Sums::add_opaque`] does.
    #[inline(always)]
    fn add(&mut self, surfels: &Surfels, pixel: usize, part: &Part<P>) {
        let i = part.surfel as usize;
        let weight: Ball<Common<P>> = part.weight.rounding_as();
        let number = |value: f32| Ball::<Common<P>>::from_f32(value);
        let normal = surfels.normal()[i];
        let [x, y, z] = facing([number(normal.x), number(normal.y), number(normal.z)], part.back);
        self.weighted[pixel].add([weight, weight * x, weight * y, weight * z]);
        if let Some(colors) = surfels.color() {
            let color = colors[i];
            let [r, g, b] = [number(color.x), number(color.y), number(color.z)];
            self.color[pixel].add([weight * r, weight * g, weight * b]);
        }
        self.count[pixel] = Stencil::COUNT.update(self.count[pixel], Outcome::Pass);
    }

    /// The sums of a pixel, if they are bounded.
    fn bounded(&self, pixel: usize) -> Option<Sums<Ball<P>>> {
        let [weight, x, y, z] = self.weighted[pixel].balls()?;
        let color = match self.color.get(pixel) {
            Some(color) => color.balls()?,
            None => Sums::NONE.color,
        };
        let count = self.count[pixel];
        Some(Sums { weight, normal: [x, y, z], color, count, ..Sums::NONE })
    }
}

/// The decisions on a fragment.
struct FragmentDecisions {
    drawn: bool,
    inside: Three,
    visible: Three,
}

impl FragmentDecisions {
    fn mark(&self, pixel: &mut PixelMarks<'_>) {
        pixel.doubt(Doubt::CutOff, self.inside.decided().is_none());
        pixel.doubt(Doubt::Epsilon, self.visible.decided().is_none());
        pixel.doubt(Doubt::Fate, !self.drawn);
    }

    /// The open decision on this fragment. It names a limit only if the cut-off or epsilon alone is
    /// undecided. `limits` gives for each a number, its limit, and the whole that distances are
    /// fractions of.
    fn open<P: Profile>(
        &self,
        surfel: u32,
        limits: impl FnOnce() -> [([Ball<P>; 2], Ball<P>); 2],
    ) -> OpenDecision {
        let limit = match (self.drawn, self.inside.decided(), self.visible.decided()) {
            (true, None, Some(_)) => Some(CUT_OFF),
            (true, Some(_), None) => Some(EPSILON),
            _ => None,
        };
        let share = limit.map(|which| {
            let ([value, limit], whole) = limits()[which];
            [limit.middle - value.middle, limit.radius + value.radius]
                .map_inline(|x| x / whole.middle)
        });
        let [distance, radius] = share.unwrap_or_default();
        OpenDecision { surfel, limit, distance, radius }
    }
}

/// The greatest visible depth of a pixel, and the least nearness that may have this depth.
#[derive(Clone, Copy, Debug)]
struct Limit<P: Profile> {
    depth: Ball<P>,
    least: f64,
}

/// The limits of the pixels of a tile.
fn limits<P: Profile>(splats: &SwiftSplats<P>, nearest: &[Nearest<P>]) -> Vec<Limit<P>> {
    let of_pixel = |nearest: &Nearest<P>| {
        let depth = decide::limit(nearest.depth, splats.epsilon);
        Limit { depth, least: least_nearness(&splats.shared, depth) }
    };
    nearest.iter().map(of_pixel).collect()
}

/// What decides which fragments are in the sums of the pixels.
#[derive(Clone, Copy)]
struct Limited<'l, P: Profile> {
    supposed: Supposed,
    /// The nearest fragment of each pixel.
    nearest: &'l [Nearest<P>],
    /// The limit of each pixel.
    limits: &'l [Limit<P>],
    /// The least nearness that is asked for at each pixel.
    least: &'l [f64],
}

/// Runs `take` for every fragment that is or may be in the sums, in ascending surfel index. Runs
/// `meet` for all fragments other than the nearest whose nearness is not certainly below `least`.
#[inline(always)]
fn each_part<P: Profile>(
    splats: &SwiftSplats<P>,
    Limited { supposed, nearest, limits, least }: Limited<'_, P>,
    tile: TilePart,
    mut meet: impl FnMut(usize, &Fragment<'_, P>, Ball<P>),
    mut take: impl FnMut(usize, Part<P>, &FragmentDecisions),
) {
    let shared = &splats.shared;
    each_fragment(
        splats,
        tile,
        |pixel| least[pixel],
        |fragment, pixel| {
            let &Fragment { splat, drawn, q, inside, .. } = fragment;
            // The nearest fragment always passes, by the law of the test.
            let is_nearest = fragment.is_of(nearest[pixel].id);
            let visible = if is_nearest {
                true.into()
            } else {
                let depth = fragment.depth();
                meet(pixel, fragment, depth);
                decide::visible(depth, limits[pixel].depth)
            };
            if visible.possibly() {
                let asked = FragmentDecisions { drawn, inside, visible };
                let certain = drawn && (inside & visible).certainly();
                let open = (!certain).then(|| {
                    asked.open(splat.surfel, || {
                        let depth = [fragment.depth(), limits[pixel].depth];
                        [([q, shared.limit], shared.limit), (depth, splats.epsilon)]
                    })
                });
                let weight = supposed.weight(&splat.footprint, q);
                let back = supposed.turned(splat.back);
                let part = Part { surfel: splat.surfel, back, weight, open };
                for _ in 0..supposed.times(splat.surfel, is_nearest) {
                    take(pixel, part, &asked);
                }
            }
        },
    );
}

/// All fragments of the pixels that are followed.
fn parts<P: Profile>(
    splats: &SwiftSplats<P>,
    supposed: Supposed,
    nearest: &[Nearest<P>],
    limits: &[Limit<P>],
    tile: TilePart,
    followed: impl Fn(usize) -> bool,
) -> Fragments<P> {
    let least = |pixel: usize| if followed(pixel) { limits[pixel].least } else { f64::INFINITY };
    let least: Vec<f64> = (0..limits.len()).map(least).collect();
    let mut parts = Vec::new();
    if least.iter().any(|least| *least != f64::INFINITY) {
        each_part(
            splats,
            Limited { supposed, nearest, limits, least: &least },
            tile,
            |_, _, _| (),
            |pixel, part, _| parts.push((pixel, part)),
        );
        // A stable sort keeps the fragments of a pixel in their order.
        parts.sort_by_key(|(pixel, _)| *pixel);
    }
    parts
}

/// The fragments of one pixel.
fn of_one<P: Profile>(parts: &Fragments<P>, pixel: usize) -> &[(usize, Part<P>)] {
    let first = parts.partition_point(|(at, _)| *at < pixel);
    let count = parts[first..].partition_point(|(at, _)| *at == pixel);
    &parts[first..first + count]
}

/// The sums of a pixel for each choice of its undecided fragments.
fn several<P: Profile>(
    surfels: &Surfels,
    parts: &[(usize, Part<P>)],
    undecided: u32,
) -> Continuations<P> {
    let all = (0..1_u32 << undecided).map(|choice| chosen(surfels, parts, choice));
    let open = parts.iter().filter_map(|(_, part)| part.open);
    Continuations::Several(all.collect(), open.collect())
}

/// The sums of a pixel for one choice: undecided fragment i is taken if bit i is set.
fn chosen<P: Profile>(surfels: &Surfels, parts: &[(usize, Part<P>)], choice: u32) -> Sums<Ball<P>> {
    let (mut sums, mut bit) = (Sums::NONE, 0);
    for (_, part) in parts {
        let taken = part.open.is_none() || choice >> bit & 1 == 1;
        bit += u32::from(part.open.is_some());
        if taken {
            sums.add_opaque(surfels, part.surfel, part.back, part.weight);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Job;
    use crate::method::Method;
    use crate::number::ball::{Gpu, Ieee};
    use crate::splat::SplatSettings;
    use crate::verdict::ewa::swift;
    use crate::verdict::ewa::tests::each_scene;

    /// Compares the sums of all pixels without an undecided fragment with sums that are added one
    /// by one. Returns how many have several fragments and are known.
    fn compare<P: Profile>(job: &Job<'_>, settings: &SplatSettings) -> usize {
        let (surfels, splats) =
            (&job.scene.surfels, swift::project::<P>(job, settings, Supposed::Nothing));
        let mut found = 0;
        for (tile, rect) in job.grid().rects().into_iter().enumerate() {
            let at_3 = Nearest { depth: Ball::exact(3.0), id: None };
            let nearest = vec![at_3; rect.pixels()];
            let mut marks = Marks::new(rect);
            let tile = TilePart { tile, rect };
            let sums = continuations(&splats, surfels, &nearest, tile, &mut marks);
            let limits = limits(&splats, &nearest);
            let all = parts(&splats, Supposed::Nothing, &nearest, &limits, tile, |_| true);
            for pixel in 0..rect.pixels() {
                let Continuations::One(own) = sums.continuations(pixel) else { continue };
                let plain = chosen(surfels, of_one(&all, pixel), 0);
                assert_eq!(own.count, plain.count);
                let numbers = |sums: &Sums<Ball<P>>| {
                    let Sums { weight, normal: [x, y, z], color: [r, g, b], .. } = *sums;
                    [weight, x, y, z, r, g, b].map(|n| [n.middle, n.radius].map(f64::to_bits))
                };
                assert_eq!(numbers(&own), numbers(&plain));
                found += usize::from(own.count > 1 && sums.sums.bounded(pixel).is_some());
            }
        }
        found
    }

    #[test]
    fn totals_are_the_sums_of_the_definition() {
        let mut found = [0; 2];
        each_scene(|session, camera| {
            let Method::Ewa(settings) = *session.method() else { return };
            session.with_job(camera, |job| {
                found[0] += compare::<Ieee>(job, &settings);
                found[1] += compare::<Gpu>(job, &settings);
            });
        });
        assert!(found.iter().all(|n| *n > 1000), "{found:?}");
    }
}
