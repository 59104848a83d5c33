//! The attribute pass of a client: the sums over the fragments that certainly are visible, and both
//! continuations of every decision that may be either way.

use super::certificate::Nearest;
use super::swift::{SwiftSplats, each_fragment, least_nearness};
use crate::composite::decide;
use crate::frame::Rect;
use crate::method::ewa::attributes::Sums;
use crate::method::ewa::possible::PossibleSplat;
use crate::method::judged::{Marks, PixelMarks};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Truth};
use crate::scene::Surfels;
use crate::verify::shift::{CUT_OFF, EPSILON, Open};
use crate::verify::verdict::Doubt;

/// The most undecided fragments of a pixel of which all continuations are followed, 2^n of them.
pub(in crate::method) const MOST: u32 = 4;

/// What the sums of a pixel may be.
#[derive(Clone, Debug)]
pub(in crate::method) enum Continuations<P: Profile> {
    /// No decision is undecided.
    One(Sums<Ball<P>>),
    /// One of these: number n takes undecided decision i if bit i of n is set. Which these are is empty
    /// where a method does not say.
    Several(Vec<Sums<Ball<P>>>, Vec<Open>),
    /// More than are followed: anything.
    Many,
}

/// The fragments of a pixel whose sums are undecided.
type Fragments<P> = Vec<(usize, Part<P>)>;

/// A fragment that is or may be in the sums.
#[derive(Clone, Copy, Debug)]
struct Part<P: Profile> {
    surfel: u32,
    back: Three,
    weight: Ball<P>,
    /// The decision on it, if it is undecided.
    open: Option<Open>,
}

/// The sums of each pixel of a tile, given the nearest fragments.
pub(in crate::method) fn continuations<P: Profile>(
    splats: &SwiftSplats<P>,
    surfels: &Surfels,
    nearest: &[Nearest<P>],
    (tile, rect): (usize, &Rect),
    marks: &mut Marks,
) -> Vec<Continuations<P>> {
    let mut sums = vec![(Sums::NONE, 0_u32); rect.pixels()];
    let limits = limits(splats, nearest);
    each_part(splats, (nearest, &limits), (tile, rect), |pixel, part, asked| {
        let (sums, undecided) = &mut sums[pixel];
        if part.open.is_none() {
            sums.add_opaque(surfels, (part.surfel, part.back), part.weight);
        } else {
            *undecided += 1;
            asked.mark(&mut marks.at(pixel));
        }
        marks.at(pixel).doubt(Doubt::Side, part.back.decided().is_none());
    });
    let parts = undecided_parts(splats, (nearest, limits), (tile, rect), &sums);
    let of_pixel = |pixel, undecided| match undecided {
        0 => None,
        1..=MOST => Some(several(surfels, &parts, pixel, undecided)),
        _ => Some(Continuations::Many),
    };
    sums.into_iter()
        .enumerate()
        .map(|(pixel, (sums, undecided))| {
            of_pixel(pixel, undecided).unwrap_or(Continuations::One(sums))
        })
        .collect()
}

/// The decisions on a fragment.
struct Asked {
    drawn: bool,
    inside: Three,
    visible: Three,
}

impl Asked {
    fn mark(&self, pixel: &mut PixelMarks<'_>) {
        pixel.doubt(Doubt::CutOff, self.inside.decided().is_none());
        pixel.doubt(Doubt::Epsilon, self.visible.decided().is_none());
        pixel.doubt(Doubt::Fate, !self.drawn);
    }

    /// The decision: of the cut-off or of epsilon, if only the one is undecided, each a number, its
    /// limit, and what the limit is a share of.
    fn open<P: Profile>(
        &self,
        surfel: u32,
        limits: impl FnOnce() -> [([Ball<P>; 2], Ball<P>); 2],
    ) -> Open {
        let limit = match (self.drawn, self.inside.decided(), self.visible.decided()) {
            (true, None, Some(_)) => Some(CUT_OFF),
            (true, Some(_), None) => Some(EPSILON),
            _ => None,
        };
        let share = limit.map(|which| {
            let ([value, limit], whole) = limits()[which];
            [limit.middle - value.middle, limit.radius + value.radius].map(|x| x / whole.middle)
        });
        let [distance, radius] = share.unwrap_or_default();
        Open { surfel, limit, distance, radius }
    }
}

/// The greatest depth of a pixel that is visible, and the least nearness that may be of this depth.
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

/// Runs `take` for every fragment that is or may be in the sums, in ascending surfel index.
fn each_part<P: Profile>(
    splats: &SwiftSplats<P>,
    (nearest, limits): (&[Nearest<P>], &[Limit<P>]),
    (tile, rect): (usize, &Rect),
    mut take: impl FnMut(usize, Part<P>, &Asked),
) {
    let shared = &splats.shared;
    each_fragment(
        splats,
        (tile, rect),
        |pixel| limits[pixel].least,
        |possible, pixel, q, w| {
            let PossibleSplat { splat, certain } = possible;
            let inside = decide::inside(q, shared.limit);
            if !inside.possibly() {
                return;
            }
            // The nearest fragment always passes: it is the law of the test.
            let visible = if nearest[pixel].id == Some(splat.surfel) {
                true.into()
            } else {
                decide::visible(shared.depth(w), limits[pixel].depth)
            };
            if visible.possibly() {
                let asked = Asked { drawn: *certain, inside, visible };
                let certain = *certain && (inside & visible).certainly();
                let open = (!certain).then(|| {
                    asked.open(splat.surfel, || {
                        let depth = [shared.depth(w), limits[pixel].depth];
                        [([q, shared.limit], shared.limit), (depth, splats.epsilon)]
                    })
                });
                let weight = splat.footprint.weight(q);
                let part = Part { surfel: splat.surfel, back: splat.back, weight, open };
                take(pixel, part, &asked);
            }
        },
    );
}

/// All fragments of the pixels with an undecided one, as far as they are followed.
fn undecided_parts<P: Profile>(
    splats: &SwiftSplats<P>,
    (nearest, mut limits): (&[Nearest<P>], Vec<Limit<P>>),
    tile: (usize, &Rect),
    sums: &[(Sums<Ball<P>>, u32)],
) -> Fragments<P> {
    let mut parts = Vec::new();
    let followed = |pixel: usize| (1..=MOST).contains(&sums[pixel].1);
    if (0..sums.len()).any(followed) {
        for (pixel, limit) in limits.iter_mut().enumerate() {
            if !followed(pixel) {
                limit.least = f64::INFINITY;
            }
        }
        each_part(splats, (nearest, &limits), tile, |pixel, part, _| {
            if followed(pixel) {
                parts.push((pixel, part));
            }
        });
        // Those of a pixel stay in their order.
        parts.sort_by_key(|(pixel, _)| *pixel);
    }
    parts
}

/// The sums of a pixel with each choice of its undecided fragments.
fn several<P: Profile>(
    surfels: &Surfels,
    parts: &Fragments<P>,
    pixel: usize,
    undecided: u32,
) -> Continuations<P> {
    let first = parts.partition_point(|(at, _)| *at < pixel);
    let parts = parts[first..].iter().take_while(|(at, _)| *at == pixel);
    let all = (0..1_u32 << undecided).map(|choice| {
        let (mut sums, mut bit) = (Sums::NONE, 0);
        for (_, part) in parts.clone() {
            let taken = part.open.is_none() || choice >> bit & 1 == 1;
            bit += u32::from(part.open.is_some());
            if taken {
                sums.add_opaque(surfels, (part.surfel, part.back), part.weight);
            }
        }
        sums
    });
    let open = parts.clone().filter_map(|(_, part)| part.open);
    Continuations::Several(all.collect(), open.collect())
}
