//! Projection of many surfels: the visible ones as splats, the others counted.

use super::{Disc, Fate, Footprint, Outline, Projector, Splat, project};
use crate::frame::Rect;
use crate::number::{Exact, Vector2, Vector3};
use crate::scene::Surfels;
use multiversion::multiversion;
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
pub fn disc<R: Exact>(surfels: &Surfels, i: usize) -> Disc<R> {
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
        let (splat, fate) = project(projector, &disc(surfels, i), i as u32);
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

/// Surfels that are projected side by side.
const LANES: usize = 16;

/// [`LANES`] surfels at a time: gathered into arrays, projected in one straight loop, scattered.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2",))]
fn in_lanes(
    projector: &Projector<f32>,
    surfels: &Surfels,
    range: Range<usize>,
    draw: &mut impl FnMut(Splat<f32>),
) -> Tally {
    let projector = *projector;
    let mut counts = [0_u64; 8];
    for first in range.step_by(LANES) {
        let mut input = [[0.0_f32; LANES]; 7];
        let (positions, normals) = (surfels.position(), surfels.normal());
        for i in 0..LANES {
            let (p, n) = (positions[first + i], normals[first + i]);
            let values = [p.x, p.y, p.z, n.x, n.y, n.z, surfels.radius()[first + i]];
            for (lanes, value) in input.iter_mut().zip(values) {
                lanes[i] = value;
            }
        }
        let mut numbers = [[0.0_f32; LANES]; 11];
        let mut pixels = [[0_u32; LANES]; 4];
        let mut backs = [0_u32; LANES];
        let mut fates = [0_u32; LANES];
        for i in 0..LANES {
            let position = Vector3::new(input[0][i], input[1][i], input[2][i]);
            let normal = Vector3::new(input[3][i], input[4][i], input[5][i]);
            let (f, b, back, fate) = projector.affine_disc(position, normal, input[6][i]);
            numbers[0][i] = f.center.x;
            numbers[1][i] = f.center.y;
            numbers[2][i] = f.ux;
            numbers[3][i] = f.uy;
            numbers[4][i] = f.vy;
            numbers[5][i] = f.w0;
            numbers[6][i] = f.wx;
            numbers[7][i] = f.wy;
            numbers[8][i] = f.w_far;
            numbers[9][i] = f.w_near;
            numbers[10][i] = f.amplitude;
            pixels[0][i] = b.x0;
            pixels[1][i] = b.y0;
            pixels[2][i] = b.x1;
            pixels[3][i] = b.y1;
            backs[i] = u32::from(back);
            fates[i] = fate as u32;
        }
        for i in 0..LANES {
            counts[fates[i] as usize & 7] += 1;
            if fates[i] == Fate::Visible as u32 {
                let n = |field: usize| numbers[field][i];
                draw(Splat {
                    footprint: Footprint {
                        center: Vector2::new(n(0), n(1)),
                        ux: n(2),
                        uy: n(3),
                        vy: n(4),
                        w0: n(5),
                        wx: n(6),
                        wy: n(7),
                        w_far: n(8),
                        w_near: n(9),
                        amplitude: n(10),
                    },
                    bounds: Rect {
                        x0: pixels[0][i],
                        y0: pixels[1][i],
                        x1: pixels[2][i],
                        y1: pixels[3][i],
                    },
                    surfel: (first + i) as u32,
                    back: backs[i] != 0,
                });
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
