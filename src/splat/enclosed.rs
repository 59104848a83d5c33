//! Project affine discs and ellipses in balls, in lanes.
//!
//! The lanes are balls of [`Common`]. If these balls decide something about a surfel, it is
//! decided. If they know every number of a splat, the splat equals the one in plain balls, bit for
//! bit. About any other surfel they say nothing.
//!
//! A projection in balls is 80 kB of code for each vector width. So the code that uses a splat is
//! called, and not compiled into each version. One width is compiled, AVX2, because AVX-512 was no
//! faster. Without AVX2 the lanes decide nothing, because two lanes gain less than they cost to compile.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::disc_lanes::DiscLanes;
use super::shape::{COVARIANCE, Covariance, PLACED, PlacedDisc};
use super::{FOOTPRINT, Footprint, Projector, Reasons, Splat};
use crate::frame::Rect;
use crate::number::ball::{BallLanes, Common, Profile, Three};
use crate::number::lanes::{LANES, vectorized_avx2};
use crate::number::{Ball, MapInline, Truth};
use crate::scene::Surfels;
use multiversion::target::target_cfg_f;
use std::ops::Range;

/// What is known of a surfel: it is certainly not drawn, or certainly drawn as this splat, or
/// neither. These are numbers, because a choice between numbers vectorizes.
const DROPPED: u32 = 0;
const DRAWN: u32 = 1;
const OPEN: u32 = 2;

/// Calls `draw` for the affine surfels of a range, whose length is a multiple of [`LANES`], in
/// ascending order: for all, or for those of a list. Skips surfels that are certainly not drawn.
/// Passes the splat if it is certain, and none if nothing is known.
pub(crate) fn affine_surfels<P: Profile>(
    projector: &Projector<Ball<Common<P>>>,
    surfels: &Surfels,
    range: Range<usize>,
    list: Option<&[usize]>,
    draw: &mut dyn FnMut(usize, Option<Splat<Ball<P>>>),
) {
    in_lanes(projector, surfels, range, list, draw);
}

vectorized_avx2!(
    fn in_lanes<P: Profile>(
        projector: &Projector<Ball<Common<P>>>,
        surfels: &Surfels,
        range: Range<usize>,
        list: Option<&[usize]>,
        draw: &mut dyn FnMut(usize, Option<Splat<Ball<P>>>),
    ) {
        if !target_cfg_f!(target_feature = "avx2") {
            return match list {
                Some(list) => list.iter().for_each(|&surfel| draw(surfel, None)),
                None => range.for_each(|surfel| draw(surfel, None)),
            };
        }
        let projector = *projector;
        let picture = [projector.view.width, projector.view.height].map_inline(|n| n.middle as u32);
        let seen = match list {
            Some(list) => list.to_vec(),
            None => seen(&projector, surfels, range),
        };
        for some in seen.chunks(LANES) {
            // The last lanes may repeat one surfel.
            let one = |i: usize| (some[i.min(some.len() - 1)], 1.0);
            let shapes = ShapeLanes::new(&projector, surfels, one);
            // -- Project
            let mut splats = SplatLanes::<Common<P>>::new();
            for i in 0..LANES {
                let (placed, shape) = shapes.get(i);
                let reach = shapes.reach.get(i);
                let (f, b, truths, reasons) = projector.affine_shape(&placed, &shape, reach);
                splats.known[i] = known(&f, &b, picture, truths[1], &reasons);
                splats.put(i, f, &b, truths[0]);
            }
            // -- Draw those that may be visible
            for (i, &surfel) in some.iter().enumerate() {
                match splats.known[i] {
                    DROPPED => {}
                    DRAWN => draw(surfel, Some(splats.get(i, surfel as u32))),
                    _ => draw(surfel, None),
                }
            }
        }
    }
);

/// The surfels of a range, whose length is a multiple of [`LANES`], that may be seen: they are not
/// certainly out of sight and not certainly turned away. Only these get a shape.
#[inline(always)]
fn seen<P: Profile>(
    projector: &Projector<Ball<Common<P>>>,
    surfels: &Surfels,
    range: Range<usize>,
) -> Vec<usize> {
    let mut seen = Vec::with_capacity(range.len());
    for first in range.step_by(LANES) {
        let discs = DiscLanes::<true>::new(surfels, |i| (first + i, 1.0));
        let reach = reach(surfels, &discs);
        let mut unseen = [0_u32; LANES];
        for i in 0..LANES {
            let disc = discs.get(i);
            let placed = projector.place(disc.position, disc.normal);
            unseen[i] = u32::from(projector.unseen(&placed, reach.get(i)).any().certainly());
        }
        seen.extend((0..LANES).filter(|i| unseen[*i] == 0).map(|i| first + i));
    }
    seen
}

/// The radius of the bounding sphere in each lane.
///
/// Discs and ellipses have a loop each, because a choice within one loop would not vectorize. All other
/// loops are the same for both.
#[inline(always)]
fn reach<P: Profile>(surfels: &Surfels, discs: &DiscLanes<true>) -> BallLanes<P> {
    let mut reach = BallLanes::ZERO;
    if surfels.tangents().is_some() {
        (0..LANES).for_each(|i| reach.put(i, discs.get(i).reach()));
    } else {
        (0..LANES).for_each(|i| reach.put(i, discs.get(i).radius));
    }
    reach
}

/// [`LANES`] placed surfels with their shapes; each number is a vector.
struct ShapeLanes<P: Profile> {
    placed: [BallLanes<P>; PLACED],
    shape: [BallLanes<P>; COVARIANCE],
    reach: BallLanes<P>,
}

impl<P: Profile> ShapeLanes<P> {
    #[inline(always)]
    fn new(
        projector: &Projector<Ball<P>>,
        surfels: &Surfels,
        item: impl Fn(usize) -> (usize, f32),
    ) -> Self {
        let discs = DiscLanes::<true>::new(surfels, item);
        let reach = reach(surfels, &discs);
        let mut lanes =
            Self { placed: [BallLanes::ZERO; PLACED], shape: [BallLanes::ZERO; COVARIANCE], reach };
        for i in 0..LANES {
            let disc = discs.get(i);
            put(&mut lanes.placed, i, projector.place(disc.position, disc.normal).numbers());
        }
        if surfels.tangents().is_some() {
            for i in 0..LANES {
                let placed = PlacedDisc::of_numbers(get(&lanes.placed, i));
                let shape = projector.covariance(&placed, &discs.get(i));
                put(&mut lanes.shape, i, shape.numbers());
            }
        } else {
            for i in 0..LANES {
                let placed = PlacedDisc::of_numbers(get(&lanes.placed, i));
                put(&mut lanes.shape, i, projector.disc(&placed, discs.get(i).radius).numbers());
            }
        }
        lanes
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (PlacedDisc<Ball<P>>, Covariance<Ball<P>>) {
        let placed = PlacedDisc::of_numbers(get(&self.placed, i));
        (placed, Covariance::of_numbers(get(&self.shape, i)))
    }
}

/// The numbers of a lane.
#[inline(always)]
fn get<P: Profile, const N: usize>(lanes: &[BallLanes<P>; N], i: usize) -> [Ball<P>; N] {
    std::array::from_fn(|field| lanes[field].get(i))
}

/// Replaces the numbers of a lane.
#[inline(always)]
fn put<P: Profile, const N: usize>(lanes: &mut [BallLanes<P>; N], i: usize, numbers: [Ball<P>; N]) {
    for (lane, number) in lanes.iter_mut().zip(numbers) {
        lane.put(i, number);
    }
}

/// Classifies a surfel.
#[inline(always)]
fn known<P: Profile>(
    footprint: &Footprint<Ball<P>>,
    bounds: &Rect,
    [width, height]: [u32; 2],
    crosses: Three,
    reasons: &Reasons<Ball<P>>,
) -> u32 {
    let Footprint { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude } = footprint;
    let radii = (center.x.radius + center.y.radius + ux.radius + uy.radius + vy.radius)
        + (w0.radius + wx.radius + wy.radius)
        + (w_far.radius + w_near.radius + amplitude.radius);
    // Bounds reach beyond the picture if nothing is known of them.
    let bounded = (bounds.x1 <= width) & (bounds.y1 <= height);
    let dropped = reasons.any();
    let certain = !dropped.possibly() & (crosses.certainly() == crosses.possibly());
    let drawn = certain & bounded & radii.is_finite();
    let known = if drawn { DRAWN } else { OPEN };
    if dropped.certainly() { DROPPED } else { known }
}

/// [`LANES`] splats; each number of the splats is a vector.
struct SplatLanes<P: Profile> {
    /// The footprint, in the order of its fields.
    numbers: [BallLanes<P>; FOOTPRINT],
    /// The bounds, in the order of their fields.
    bounds: [[u32; LANES]; 4],
    /// Whether the back is seen: certainly, by the midpoints, possibly.
    back: [[u32; LANES]; 3],
    known: [u32; LANES],
}

impl<P: Profile> SplatLanes<P> {
    #[inline(always)]
    fn new() -> Self {
        let numbers = [BallLanes::ZERO; FOOTPRINT];
        Self { numbers, bounds: [[0; LANES]; 4], back: [[0; LANES]; 3], known: [0; LANES] }
    }

    #[inline(always)]
    fn put(&mut self, i: usize, f: Footprint<Ball<P>>, b: &Rect, back: Three) {
        put(&mut self.numbers, i, f.numbers());
        let pixels = &mut self.bounds;
        (pixels[0][i], pixels[1][i], pixels[2][i], pixels[3][i]) = (b.x0, b.y0, b.x1, b.y1);
        self.back[0][i] = u32::from(back.certainly());
        self.back[1][i] = u32::from(back.middle());
        self.back[2][i] = u32::from(back.possibly());
    }

    #[inline(always)]
    fn get<Q: Profile<Terms = P::Terms>>(&self, i: usize, surfel: u32) -> Splat<Ball<Q>> {
        let numbers = get(&self.numbers, i).map_inline(Ball::rounding_as);
        let pixel = |field: usize| self.bounds[field][i];
        let back = |field: usize| self.back[field][i] != 0;
        Splat {
            footprint: Footprint::of_numbers(numbers),
            bounds: Rect { x0: pixel(0), y0: pixel(1), x1: pixel(2), y1: pixel(3) },
            surfel,
            back: Three::new([back(0), back(1), back(2)]),
        }
    }
}
