//! Propagation and merging; see [`super::super::levels`].

use super::level::{COLOR, DEPTH, EXTENT, Level, NORMAL, PAD, PLACE, RADIUS, Row, RowMut, Shape};
use crate::composite::mean::Mean;
use crate::frame::{Exec, NO_ID};
use crate::method::projection::fast::{LANES, Lanes, halves};
use multiversion::multiversion;

/// Rows of a job.
const ROWS: usize = 8;

/// The next level, from what does not stay within the first `reach`; the second is its own.
pub(super) fn merge(fine: &Level, coarse: &mut Level, reach: [f32; 2], exec: &Exec) {
    let shapes = [fine.shape, coarse.shape];
    exec.chunks(coarse.rows_mut(), ROWS, |first, rows| {
        for (y, mut row) in (first..).zip(rows) {
            let upper = fine.row(2 * y);
            // Below the last row of an odd level there is none: the upper one stands for it, unread.
            let exists = 2 * y + 1 < fine.shape.height;
            let lower = if exists { fine.row(2 * y + 1) } else { upper };
            *row.has = [false; 2];
            let moving = upper.has[1] || (exists && lower.has[1]);
            merge_row([upper, lower], (exists, moving), &mut row, &shapes, reach);
        }
    });
}

/// [`LANES`] centres: every second cell of two rows, the four that meet in one.
struct Four {
    moves: [[u32; LANES]; 4],
    ids: [[u32; LANES]; 4],
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn merge_row(
    finer: [Row<'_>; 2],
    (exists, moving): (bool, bool),
    coarse: &mut RowMut<'_>,
    [fine, shape]: &[Shape; 2],
    [reach, own]: [f32; 2],
) {
    for x in (0..shape.width).step_by(LANES) {
        coarse.clear(shape, x);
        if !moving {
            continue;
        }
        let number = |attribute: usize| {
            let at = fine.at(attribute, 2 * x);
            let [a, b] = halves(finer[0].numbers, at);
            let [c, d] = halves(finer[1].numbers, at);
            [a, b, c, d]
        };
        let ids = {
            let [a, b] = halves(finer[0].ids, PAD + 2 * x);
            let [c, d] = halves(finer[1].ids, PAD + 2 * x);
            [a, b, c, d]
        };
        let extents = number(EXTENT);
        let mut moves = [[0; LANES]; 4];
        let mut any = 0;
        for j in 0..4 {
            for i in 0..LANES {
                let moved = (ids[j][i] != NO_ID) & !(extents[j][i] <= reach) & (exists | (j < 2));
                moves[j][i] = u32::from(moved);
                any |= moves[j][i];
            }
        }
        if any != 0 {
            Four { moves, ids }.meet(number, coarse, shape, x);
            coarse.settle(shape, x, own);
        }
    }
}

impl Four {
    /// The centres that become of them, from column x of the coarser row on.
    #[inline(always)]
    fn meet(
        &self,
        number: impl Fn(usize) -> [Lanes; 4],
        coarse: &mut RowMut<'_>,
        shape: &Shape,
        x: usize,
    ) {
        let (depths, radii) = (number(DEPTH), number(RADIUS));
        let (mut depth, mut radius) = ([f32::INFINITY; LANES], [0.0; LANES]);
        let mut id = [NO_ID; LANES];
        for j in 0..4 {
            for i in 0..LANES {
                let nearer = (self.moves[j][i] != 0) & (depths[j][i] < depth[i]);
                depth[i] = if nearer { depths[j][i] } else { depth[i] };
                radius[i] = if nearer { radii[j][i] } else { radius[i] };
                id[i] = if nearer { self.ids[j][i] } else { id[i] };
            }
        }
        let mut takes = [[0.0; LANES]; 4];
        for j in 0..4 {
            for i in 0..LANES {
                let near = depths[j][i] - depth[i] <= radii[j][i] + radius[i];
                takes[j][i] = if (self.moves[j][i] != 0) & near { 1.0 } else { 0.0 };
            }
        }
        coarse.ids[PAD + x..PAD + x + LANES].copy_from_slice(&id);
        let own = [PLACE, PLACE + 1, DEPTH, RADIUS, EXTENT].into_iter().chain(NORMAL..COLOR);
        for attribute in own.chain(COLOR..shape.attributes) {
            let a = number(attribute);
            let at = shape.at(attribute, x);
            let mut average = [0.0; LANES];
            for i in 0..LANES {
                let mean = Mean::plain([0, 1, 2, 3].map(|j| takes[j][i] > 0.0));
                average[i] = mean.of([a[0][i], a[1][i], a[2][i], a[3][i]]);
            }
            coarse.numbers[at..at + LANES].copy_from_slice(&average);
        }
    }
}
