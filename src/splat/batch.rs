//! Project many surfels: the visible ones become splats, the others are counted.

use super::disc_lanes::DiscLanes;
use super::{Disc, FOOTPRINT, Fate, Footprint, Outline, Projector, Splat, project};
use crate::frame::Rect;
use crate::number::lanes::{LANES, Lanes, vectorized};
use crate::number::{Exact, MapInline, Real, Vector3};
use crate::scene::Surfels;
use std::ops::Range;

/// How many surfels of a scene met each [`Fate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// See [`Fate::Visible`].
    pub visible: u64,
    /// See [`Fate::Behind`].
    pub behind: u64,
    /// See [`Fate::Degenerate`].
    pub degenerate: u64,
    /// See [`Fate::BackFacing`].
    pub back_facing: u64,
    /// See [`Fate::Outside`].
    pub outside: u64,
}

impl Tally {
    /// Counts one surfel.
    #[inline(always)]
    pub(crate) fn count(&mut self, fate: Fate) {
        match fate {
            Fate::Visible => self.visible += 1,
            Fate::Behind => self.behind += 1,
            Fate::Degenerate => self.degenerate += 1,
            Fate::BackFacing => self.back_facing += 1,
            Fate::Outside => self.outside += 1,
        }
    }

    /// The sum of two tallies.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            visible: self.visible + other.visible,
            behind: self.behind + other.behind,
            degenerate: self.degenerate + other.degenerate,
            back_facing: self.back_facing + other.back_facing,
            outside: self.outside + other.outside,
        }
    }
}

/// The surfel with index `i`, in the numbers of the arithmetic.
#[must_use]
pub fn disc<R: Real>(surfels: &Surfels, i: usize) -> Disc<R> {
    Disc {
        position: Vector3::from_glam(surfels.position()[i]),
        normal: Vector3::from_glam(surfels.normal()[i]),
        radius: R::from_f32(surfels.radius()[i]),
        tangents: surfels.tangents().map(|t| t[i].map_inline(Vector3::from_glam)),
    }
}

/// Calls `draw` for each visible splat of a range of surfels, in ascending order.
pub fn splats<R: Exact>(
    projector: &Projector<R>,
    surfels: &Surfels,
    range: Range<usize>,
    mut draw: impl FnMut(Splat<R>),
) -> Tally {
    let mut tally = Tally::default();
    for i in range {
        let (splat, reasons) = project(projector, &disc(surfels, i), i as u32);
        let fate = reasons.fate();
        tally.count(fate);
        if fate == Fate::Visible {
            draw(splat);
        }
    }
    tally
}

/// [`splats`] with the same bits, but affine outlines are computed in lanes.
pub fn splats_f32(
    projector: &Projector<f32>,
    surfels: &Surfels,
    range: Range<usize>,
    mut draw: impl FnMut(Splat<f32>),
) -> Tally {
    let rest = range.start + in_full_lanes(projector.outline, range.len());
    let item = |i: usize| Enlarged { surfel: i as u32, scale: 1.0, times: 1 };
    let draw_item = &mut |_, splat| draw(splat);
    let tally = in_lanes(projector, surfels, range.start..rest, item, draw_item);
    tally.plus(&splats(projector, surfels, rest..range.end, draw))
}

/// How many of the first of `count` surfels are projected in lanes: as many as fill whole lanes, if
/// the outline is affine.
pub(crate) fn in_full_lanes(outline: Outline, count: usize) -> usize {
    match outline {
        Outline::Affine => count - count % LANES,
        Outline::Perspective | Outline::RayCast => 0,
    }
}

/// A surfel that is projected once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Enlarged {
    /// The index of the surfel.
    pub(crate) surfel: u32,
    /// The factor on its radius, or on its tangents.
    pub(crate) scale: f32,
    /// How often it counts in a [`Tally`].
    pub(crate) times: u32,
}

/// Calls `draw` for each visible splat of a list, with its place in the list. Affine outlines are
/// computed in lanes, to the same bits.
pub(crate) fn enlarged_f32(
    projector: &Projector<f32>,
    surfels: &Surfels,
    list: &[Enlarged],
    mut draw: impl FnMut(usize, Splat<f32>),
) -> Tally {
    let rest = in_full_lanes(projector.outline, list.len());
    let mut tally = in_lanes(projector, surfels, 0..rest, |i| list[i], &mut draw);
    for (place, &Enlarged { surfel, scale, times }) in list.iter().enumerate().skip(rest) {
        let (splat, reasons) = project(projector, &enlarged(surfels, surfel, scale), surfel);
        let fate = reasons.fate();
        (0..times).for_each(|_| tally.count(fate));
        if fate == Fate::Visible {
            draw(place, splat);
        }
    }
    tally
}

/// A surfel whose radius, or tangents, are multiplied by a number.
pub(crate) fn enlarged<R: Real>(surfels: &Surfels, surfel: u32, scale: f32) -> Disc<R> {
    let (disc, scale): (Disc<R>, _) = (disc(surfels, surfel as usize), R::from_f32(scale));
    Disc {
        radius: disc.radius * scale,
        tangents: disc.tangents.map(|[u, v]| [u * scale, v * scale]),
        ..disc
    }
}

/// Calls `draw` for the visible affine splats of a range, whose length is a multiple of [`LANES`].
fn in_lanes(
    projector: &Projector<f32>,
    surfels: &Surfels,
    range: Range<usize>,
    item: impl Fn(usize) -> Enlarged,
    draw: &mut impl FnMut(usize, Splat<f32>),
) -> Tally {
    match surfels.tangents() {
        None => lanes::<false>(projector, surfels, range, item, draw),
        Some(_) => lanes::<true>(projector, surfels, range, item, draw),
    }
}

vectorized!(
    /// [`LANES`] splats at a time: gathered into arrays, projected in one straight loop, scattered.
    fn lanes<const TANGENTS: bool>(
        projector: &Projector<f32>,
        surfels: &Surfels,
        range: Range<usize>,
        item: impl Fn(usize) -> Enlarged,
        draw: &mut impl FnMut(usize, Splat<f32>),
    ) -> Tally {
        let projector = *projector;
        let mut counts = [0_u64; 8];
        for first in range.step_by(LANES) {
            let discs = DiscLanes::<TANGENTS>::new(surfels, |i| {
                let Enlarged { surfel, scale, .. } = item(first + i);
                (surfel as usize, scale)
            });
            // -- Project
            let mut splats = SplatLanes::new();
            let mut fates = [0_u32; LANES];
            for (i, fate) in fates.iter_mut().enumerate() {
                let (f, b, [back, _], reasons) = projector.affine_disc(&discs.get(i));
                splats.put(i, f, &b, back);
                *fate = reasons.fate() as u32;
            }
            // -- Draw the visible ones
            for i in 0..LANES {
                let Enlarged { surfel, times, .. } = item(first + i);
                // The mask shows the compiler that the index is in range.
                counts[fates[i] as usize & 7] += u64::from(times);
                if fates[i] == Fate::Visible as u32 {
                    draw(first + i, splats.get(i, surfel));
                }
            }
        }
        Tally {
            visible: counts[Fate::Visible as usize],
            behind: counts[Fate::Behind as usize],
            degenerate: counts[Fate::Degenerate as usize],
            back_facing: counts[Fate::BackFacing as usize],
            outside: counts[Fate::Outside as usize],
        }
    }
);

/// [`LANES`] splats; each number of the splats is a vector.
struct SplatLanes {
    /// The footprint, in the order of its fields.
    numbers: [Lanes; FOOTPRINT],
    /// The bounds, in the order of their fields.
    bounds: [[u32; LANES]; 4],
    back: [u32; LANES],
}

impl SplatLanes {
    #[inline(always)]
    fn new() -> Self {
        Self { numbers: [[0.0; LANES]; FOOTPRINT], bounds: [[0; LANES]; 4], back: [0; LANES] }
    }

    #[inline(always)]
    fn put(&mut self, i: usize, f: Footprint<f32>, b: &Rect, back: bool) {
        for (lanes, number) in self.numbers.iter_mut().zip(f.numbers()) {
            lanes[i] = number;
        }
        let pixels = &mut self.bounds;
        (pixels[0][i], pixels[1][i], pixels[2][i], pixels[3][i]) = (b.x0, b.y0, b.x1, b.y1);
        self.back[i] = u32::from(back);
    }

    #[inline(always)]
    fn get(&self, i: usize, surfel: u32) -> Splat<f32> {
        // Written out: a loop becomes calls or gathers, which took a third of the projection.
        let n = |field: usize| self.numbers[field][i];
        let numbers = [n(0), n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10)];
        let pixel = |field: usize| self.bounds[field][i];
        Splat {
            footprint: Footprint::of_numbers(numbers),
            bounds: Rect { x0: pixel(0), y0: pixel(1), x1: pixel(2), y1: pixel(3) },
            surfel,
            back: self.back[i] != 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use crate::source::Shape;
    use crate::splat::tests::ellipses;
    use crate::splat::{Kernel, View};

    /// The numbers of a splat, as bits.
    fn bits(splat: &Splat<f32>) -> String {
        let Splat { footprint, bounds, surfel, back } = splat;
        format!("{:?} {bounds:?} {surfel} {back}", footprint.map(f32::to_bits))
    }

    #[test]
    fn lanes_are_the_definition() {
        let discs = Shape::Torus.surfels(5003, 3).unwrap();
        let ellipses = ellipses(discs.clone());
        let lens = Shape::Torus.default_lens();
        let camera = Camera::new(57, 43, Shape::Torus.default_pose(), lens).unwrap();
        // A camera so near that surfels are behind it, beside it and at the near plane.
        let near = Camera { near: 2.0, fx: 4.0 * camera.fx, ..camera };
        for (camera, cull) in [(camera, false), (camera, true), (near, true)] {
            let projector = Projector::new(View::new(&camera), &Kernel::DEFAULT, cull);
            for surfels in [&discs, &ellipses] {
                let (mut plain, mut own) = (Vec::new(), Vec::new());
                let all = 0..surfels.len();
                let tally = splats(&projector, surfels, all.clone(), |s| plain.push(bits(&s)));
                let in_lanes = splats_f32(&projector, surfels, all, |s| own.push(bits(&s)));
                assert_eq!((own, in_lanes), (plain, tally));
                assert!(tally.visible > 50, "{tally:?}");

                // In groups, with other radii.
                let item = |i: u32| Enlarged { surfel: 3 * i, scale: 1.5, times: 2 };
                let list: Vec<_> = (0..surfels.len() as u32 / 3).map(item).collect();
                let (mut plain, mut own) = (Vec::new(), Vec::new());
                enlarged_f32(&projector, surfels, &list, |place, s| own.push((place, bits(&s))));
                for (place, item) in list.iter().enumerate() {
                    let disc = enlarged(surfels, item.surfel, item.scale);
                    let (splat, reasons) = project(&projector, &disc, item.surfel);
                    if reasons.fate() == Fate::Visible {
                        plain.push((place, bits(&splat)));
                    }
                }
                assert_eq!(own, plain);
            }
        }
    }
}
