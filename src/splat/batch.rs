//! Projection of many surfels: the visible ones as splats, the others counted.

use super::{Disc, Fate, Footprint, Outline, Projector, Splat, project};
use crate::frame::Rect;
use crate::number::lanes::{LANES, Lanes, vectorized};
use crate::number::{Exact, Real, Vector2, Vector3};
use crate::scene::Surfels;
use std::ops::Range;

/// What became of the surfels of a scene: how many met each [`Fate`].
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

/// The surfel of index `i`, in the numbers of the arithmetic.
#[must_use]
pub fn disc<R: Real>(surfels: &Surfels, i: usize) -> Disc<R> {
    Disc {
        position: Vector3::from_glam(surfels.position()[i]),
        normal: Vector3::from_glam(surfels.normal()[i]),
        radius: R::from_f32(surfels.radius()[i]),
        tangents: surfels.tangents().map(|t| t[i].map(Vector3::from_glam)),
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

/// As [`splats`], to the same bits; affine discs in lanes.
pub fn splats_f32(
    projector: &Projector<f32>,
    surfels: &Surfels,
    range: Range<usize>,
    mut draw: impl FnMut(Splat<f32>),
) -> Tally {
    if projector.outline != Outline::Affine || surfels.tangents().is_some() {
        return splats(projector, surfels, range, draw);
    }
    let lanes = range.start..range.end - range.len() % LANES;
    let rest = lanes.end..range.end;
    let tally = in_lanes(projector, surfels, lanes, &mut draw);
    tally.plus(&splats(projector, surfels, rest, draw))
}

vectorized!(
    /// [`LANES`] surfels at a time: gathered into arrays, projected in one straight loop, scattered.
    fn in_lanes(
        projector: &Projector<f32>,
        surfels: &Surfels,
        range: Range<usize>,
        draw: &mut impl FnMut(Splat<f32>),
    ) -> Tally {
        let projector = *projector;
        let mut counts = [0_u64; 8];
        for first in range.step_by(LANES) {
            // -- The discs
            let mut input = [[0.0_f32; LANES]; 7];
            let (positions, normals) = (surfels.position(), surfels.normal());
            for i in 0..LANES {
                let (p, n) = (positions[first + i], normals[first + i]);
                let values = [p.x, p.y, p.z, n.x, n.y, n.z, surfels.radius()[first + i]];
                for (lanes, value) in input.iter_mut().zip(values) {
                    lanes[i] = value;
                }
            }
            // -- Their projections
            let mut splats = SplatLanes::new();
            let mut fates = [0_u32; LANES];
            for i in 0..LANES {
                let position = Vector3::new(input[0][i], input[1][i], input[2][i]);
                let normal = Vector3::new(input[3][i], input[4][i], input[5][i]);
                let (f, b, back, reasons) = projector.affine_disc(position, normal, input[6][i]);
                splats.put(i, &f, &b, back);
                fates[i] = reasons.fate() as u32;
            }
            // -- The visible ones
            for i in 0..LANES {
                counts[fates[i] as usize & 7] += 1;
                if fates[i] == Fate::Visible as u32 {
                    draw(splats.get(i, (first + i) as u32));
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

/// [`LANES`] splats, each of their numbers a vector.
struct SplatLanes {
    /// The footprint, in the order of its fields.
    numbers: [Lanes; 11],
    /// The bounds, in the order of their fields.
    bounds: [[u32; LANES]; 4],
    back: [u32; LANES],
}

impl SplatLanes {
    #[inline(always)]
    fn new() -> Self {
        Self { numbers: [[0.0; LANES]; 11], bounds: [[0; LANES]; 4], back: [0; LANES] }
    }

    #[inline(always)]
    fn put(&mut self, i: usize, f: &Footprint<f32>, b: &Rect, back: bool) {
        let n = &mut self.numbers;
        (n[0][i], n[1][i]) = (f.center.x, f.center.y);
        (n[2][i], n[3][i], n[4][i]) = (f.ux, f.uy, f.vy);
        (n[5][i], n[6][i], n[7][i]) = (f.w0, f.wx, f.wy);
        (n[8][i], n[9][i], n[10][i]) = (f.w_far, f.w_near, f.amplitude);
        let pixels = &mut self.bounds;
        (pixels[0][i], pixels[1][i], pixels[2][i], pixels[3][i]) = (b.x0, b.y0, b.x1, b.y1);
        self.back[i] = u32::from(back);
    }

    #[inline(always)]
    fn get(&self, i: usize, surfel: u32) -> Splat<f32> {
        let [x, y, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude] =
            self.numbers.each_ref().map(|lanes| lanes[i]);
        let [x0, y0, x1, y1] = self.bounds.each_ref().map(|lanes| lanes[i]);
        let center = Vector2::new(x, y);
        Splat {
            footprint: Footprint { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude },
            bounds: Rect { x0, y0, x1, y1 },
            surfel,
            back: self.back[i] != 0,
        }
    }
}
