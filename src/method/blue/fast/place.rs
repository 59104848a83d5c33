//! Place surfels as squares, [`LANES`] at a time.

use crate::frame::Rect;
use crate::method::blue::squares::{Disc, Square, SquareProjector};
use crate::number::Vector3;
use crate::number::lanes::{LANES, Lanes, components, put_vector, vectorized};
use crate::splat::{Fate, Tally};
use glam::Vec3;
use std::ops::Range;

/// [`LANES`] surfels.
struct Block {
    fate: [u32; LANES],
    bounds: [[u32; LANES]; 4],
    back: [u32; LANES],
    p: [Lanes; 3],
    n: [Lanes; 3],
    through: Lanes,
    limit: Lanes,
}

impl Block {
    const EMPTY: Self = Self {
        fate: [0; LANES],
        bounds: [[0; LANES]; 4],
        back: [0; LANES],
        p: [[0.0; LANES]; 3],
        n: [[0.0; LANES]; 3],
        through: [0.0; LANES],
        limit: [0.0; LANES],
    };

    #[inline(always)]
    fn square(&self, i: usize, surfel: u32) -> Square<f32> {
        let [x0, y0, x1, y1] = &self.bounds;
        let vector = |of: &[Lanes; 3]| {
            let [x, y, z] = components(of, i);
            Vector3::new(x, y, z)
        };
        let disc = Disc {
            p: vector(&self.p),
            n: vector(&self.n),
            through: self.through[i],
            limit: self.limit[i],
        };
        let bounds = Rect { x0: x0[i], y0: y0[i], x1: x1[i], y1: y1[i] };
        Square { bounds, surfel, back: self.back[i] != 0, disc }
    }
}

/// Appends the squares of a range of surfels that are drawn, and counts the fates of all.
pub(super) fn squares(
    projector: &SquareProjector<'_, f32>,
    range: Range<usize>,
    squares: &mut Vec<Square<f32>>,
) -> Tally {
    const FATES: [Fate; 5] =
        [Fate::Visible, Fate::Behind, Fate::Degenerate, Fate::BackFacing, Fate::Outside];
    let surfels = projector.surfels;
    let (mut input, mut block) = (Input::default(), Block::EMPTY);
    let mut tally = Tally::default();
    for first in range.clone().step_by(LANES) {
        // Lanes without a surfel repeat the last surfel, and are not counted.
        let count = (range.end - first).min(LANES);
        for i in 0..LANES {
            let at = first + i.min(count - 1);
            input.position[i] = surfels.position()[at];
            input.normal[i] = surfels.normal()[at];
            input.radius[i] = surfels.radius()[at];
            input.side[i] = projector.side(at);
        }
        place(projector, &input, &mut block);
        for i in 0..count {
            let fate = FATES[block.fate[i] as usize];
            tally.count(fate);
            if fate == Fate::Visible {
                squares.push(block.square(i, (first + i) as u32));
            }
        }
    }
    tally
}

#[derive(Default)]
struct Input {
    position: [Vec3; LANES],
    normal: [Vec3; LANES],
    radius: Lanes,
    /// 0 for a surfel without one.
    side: Lanes,
}

vectorized!(
    fn place(projector: &SquareProjector<'_, f32>, input: &Input, block: &mut Block) {
        // A copy, so that the compiler knows that no write changes it.
        let projector = &{ *projector };
        let (mut fates, mut bounds) = ([0; LANES], [[0; LANES]; 4]);
        let (mut p, mut n) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        let (mut back, mut through, mut limit) = ([0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let position = Vector3::from_glam(input.position[i]);
            let normal = Vector3::from_glam(input.normal[i]);
            let placed = projector.square(position, normal, input.radius[i], input.side[i]);
            let (pixels, fate) = placed.fate(&projector.points.view);
            fates[i] = fate as u32;
            (bounds[0][i], bounds[1][i]) = (pixels.x0, pixels.y0);
            (bounds[2][i], bounds[3][i]) = (pixels.x1, pixels.y1);
            back[i] = u32::from(placed.g > 0.0);
            put_vector(&mut p, i, placed.disc.p);
            put_vector(&mut n, i, placed.disc.n);
            (through[i], limit[i]) = (placed.disc.through, placed.disc.limit);
        }
        *block = Block { fate: fates, bounds, back, p, n, through, limit };
    }
);
