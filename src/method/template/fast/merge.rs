//! Propagate and merge centres in lanes; see [`super::super::levels`].

use super::level::{
    COLOR, CenterLevel, CenterRow, CenterRowMut, DEPTH, EXTENT, NORMAL, PLACE, RADIUS,
};
use crate::frame::{Exec, NO_ID};
use crate::method::clock::{Work, spend};
use crate::method::projection::fast::{MeanLanes, PAD, RowLayout};
use crate::number::lanes::{LANES, Lanes, Mask, any, each, load_halves, mask, store, vectorized};

/// Rows of a job.
const ROWS: usize = 8;

/// Makes the next level from the centres that do not stay within the first `reach`; the second
/// `reach` is the next level's.
pub(super) fn merge(fine: &CenterLevel, coarse: &mut CenterLevel, reach: [f32; 2], exec: &Exec) {
    let layouts = [fine.layout, coarse.layout];
    exec.chunks(coarse.rows_mut(), ROWS, |first, rows| {
        for (y, mut row) in (first..).zip(rows) {
            let lower = (2 * y + 1 < fine.layout.height).then(|| fine.row(2 * y + 1));
            merge_pair(fine.row(2 * y), lower, &mut row, &layouts, reach);
        }
    });
}

/// Makes a row of the next level from two rows; below the last row of an odd level there is none.
pub(super) fn merge_pair(
    upper: CenterRow<'_>,
    lower: Option<CenterRow<'_>>,
    coarse: &mut CenterRowMut<'_>,
    layouts: &[RowLayout; 2],
    reach: [f32; 2],
) {
    spend(Work::Propagate);
    *coarse.has = [false; 2];
    let moving = upper.has[1] || lower.is_some_and(|lower| lower.has[1]);
    // Where there is no row, the upper one stands for it, unread.
    let finer = [upper, lower.unwrap_or(upper)];
    merge_row(finer, lower.is_some(), moving, coarse, layouts, reach);
}

/// [`LANES`] times four centres: every second cell of two rows; four meet in one cell.
struct FourCenters {
    /// Which of them move on.
    moves: [Mask; 4],
    ids: [[u32; LANES]; 4],
}

vectorized!(
    fn merge_row(
        finer: [CenterRow<'_>; 2],
        exists: bool,
        moving: bool,
        coarse: &mut CenterRowMut<'_>,
        [fine, layout]: &[RowLayout; 2],
        [reach, own]: [f32; 2],
    ) {
        for x in (0..layout.width).step_by(LANES) {
            coarse.clear(layout, x);
            if !moving {
                continue;
            }
            // -- The four finer cells
            let number = |attribute: usize| {
                let at = fine.at(attribute, 2 * x);
                let [a, b] = load_halves(finer[0].numbers, at);
                let [c, d] = load_halves(finer[1].numbers, at);
                [a, b, c, d]
            };
            let [a, b] = load_halves(finer[0].ids, PAD + 2 * x);
            let [c, d] = load_halves(finer[1].ids, PAD + 2 * x);
            let ids = [a, b, c, d];
            // -- Which of their centres move on
            let extents = number(EXTENT);
            // Written out, because a loop over the four gathers its lanes.
            let of = |j: usize| {
                let there = exists | (j < 2);
                mask(|i| (ids[j][i] != NO_ID) & !(extents[j][i] <= reach) & there)
            };
            let moves = [of(0), of(1), of(2), of(3)];
            // -- The new centres
            if moves.iter().any(any) {
                FourCenters { moves, ids }.meet(number, coarse, layout, x);
                coarse.settle(layout, x, own);
            }
        }
    }
);

impl FourCenters {
    /// Stores the merged centres, from column x of the coarser row on.
    #[inline(always)]
    fn meet(
        &self,
        number: impl Fn(usize) -> [Lanes; 4],
        coarse: &mut CenterRowMut<'_>,
        layout: &RowLayout,
        x: usize,
    ) {
        // -- The nearest of the four
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
        store(coarse.ids, PAD + x, &id);
        // -- The average of the centres of its surface
        let takes = |j: usize| {
            each(|i| {
                let near = depths[j][i] - depth[i] <= radii[j][i] + radius[i];
                if (self.moves[j][i] != 0) & near { 1.0 } else { 0.0 }
            })
        };
        let mean = MeanLanes::new([takes(0), takes(1), takes(2), takes(3)]);
        let own = [PLACE, PLACE + 1, DEPTH, RADIUS, EXTENT].into_iter().chain(NORMAL..COLOR);
        for attribute in own.chain(COLOR..layout.attributes) {
            store(coarse.numbers, layout.at(attribute, x), &mean.average(&number(attribute)));
        }
    }
}
