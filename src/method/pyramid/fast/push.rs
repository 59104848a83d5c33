//! Push in lanes; see [`super::super::push`]. A level is changed in place, and only where it must
//! change.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::level::{BACK, CellLevel, FRONT, FURTHER, KIND, NORMAL, PLACE, RADIUS, TILT, tangent};
use super::mix::{FourCells, Mix, pairs, tilts};
use crate::frame::Exec;
use crate::method::clock::{Work, spend};
use crate::method::projection::fast::{PAD, RowLayout};
use crate::method::pyramid::{Occlusion, Settings, Weights};
use crate::number::MapInline;
use crate::number::lanes::{
    LANES, Lanes, Mask, any, any_above_0, each, load, load_halves, mask, select, store_halves,
    vectorized,
};

/// Rows of a job.
const ROWS: usize = 8;

/// How a level is pushed.
pub(super) struct PushRules<'a> {
    /// The side of a cell in pixels.
    pub(super) side: f32,
    /// Whether the scene has tubes.
    pub(super) tubes: bool,
    pub(super) settings: &'a Settings,
}

/// Computes the cells of a level that are empty or occluded, from the coarser level. `done` then
/// receives each row, while it is in the cache, with the row's item of `beside`.
pub(super) fn push<T: Send>(
    fine: &mut CellLevel,
    coarse: &CellLevel,
    rules: &PushRules<'_>,
    exec: &Exec,
    beside: impl Iterator<Item = T>,
    done: impl Fn(&[f32], T) + Sync + Send,
) {
    spend(Work::Push);
    let layouts = [fine.layout, coarse.layout];
    let PushRules { side, settings, .. } = *rules;
    let outside = settings.occlusion == Occlusion::Outside;
    let run = match (settings.weights, rules.tubes) {
        (Weights::Box, false) => push_row::<false, false>,
        (Weights::Box, true) => push_row::<false, true>,
        (Weights::Gaussian, false) => push_row::<true, false>,
        (Weights::Gaussian, true) => push_row::<true, true>,
    };
    exec.chunks(fine.rows_mut().zip(beside), ROWS, |first, rows| {
        for (y, (row, own)) in (first..).zip(rows) {
            let parent = (y / 2) as isize;
            let even = y % 2 == 0;
            let beside = if even { parent - 1 } else { parent + 1 };
            run([coarse.row(parent), coarse.row(beside)], row, &layouts, side, even, outside);
            done(row, own);
        }
    });
}

/// A number of the parents and their three neighbours, for the columns of one parity.
#[inline(always)]
fn four(
    coarser: [&[f32]; 2],
    layout: &RowLayout,
    attribute: usize,
    x: usize,
    odd: usize,
) -> [Lanes; 4] {
    let own = layout.at(attribute, x);
    let beside = own - 1 + 2 * odd;
    [
        load(coarser[0], own),
        load(coarser[0], beside),
        load(coarser[1], own),
        load(coarser[1], beside),
    ]
}

/// Which cells must be computed: 1, else 0. Only the first `left` are within the level's width.
#[inline(always)]
fn needed(kind: &Lanes, front: &Lanes, parent: [&Lanes; 3], outside: bool, left: usize) -> Lanes {
    let [parent_kind, parent_front, parent_back] = parent;
    each(|i| {
        let before = outside & (front[i] < parent_front[i]);
        let occluded = (parent_kind[i] > 0.0) & ((front[i] > parent_back[i]) | before);
        let must = !(kind[i] > 0.0) | occluded;
        if must & (i < left) { 1.0 } else { 0.0 }
    })
}

vectorized!(
    fn push_row<const GAUSSIAN: bool, const TUBES: bool>(
        coarser: [&[f32]; 2],
        fine: &mut [f32],
        [fine_layout, layout]: &[RowLayout; 2],
        side: f32,
        even_y: bool,
        outside: bool,
    ) {
        let finest = side == 1.0;
        let shifts = [shifts(side, [true, even_y]), shifts(side, [false, even_y])];
        for x in (0..layout.width).step_by(LANES) {
            // An empty neighbourhood changes nothing: 2 rows of cells from x - 1 to x + LANES.
            let around = PAD + x - 1..PAD + x + LANES + 1;
            if !any_above_0(&coarser[0][around.clone()]) && !any_above_0(&coarser[1][around]) {
                continue;
            }
            // -- Which cells are needed, and who takes part in those
            let at = |attribute: usize| fine_layout.at(attribute, 2 * x);
            let (kinds, fronts) = (load_halves(fine, at(KIND)), load_halves(fine, at(FRONT)));
            let own = |attribute: usize| load(coarser[0], layout.at(attribute, x));
            let (kind, front, back) = (own(KIND), own(FRONT), own(BACK));
            let number = |attribute: usize, odd: usize| four(coarser, layout, attribute, x, odd);
            let find = |odd: usize| {
                // Columns 2x + odd, 2x + odd + 2 ... of the width.
                let left = (fine_layout.width + 1 - odd).saturating_sub(2 * x) / 2;
                let parent = [&kind, &front, &back];
                let needed = needed(&kinds[odd], &fronts[odd], parent, outside, left);
                let number = |attribute: usize| number(attribute, odd);
                NewCells::new::<GAUSSIAN, TUBES>(number, &needed, &shifts[odd])
            };
            let cells = [find(0), find(1)];
            if cells[0].is_none() && cells[1].is_none() {
                continue;
            }
            // -- The numbers of them that every level has
            put(fine, at(KIND), &cells, |_, new| new.mix.kind);
            let tangent = tangent(layout, TUBES);
            for attribute in [FRONT].into_iter().chain(FURTHER..tangent) {
                put(fine, at(attribute), &cells, |odd, new| {
                    new.mix.mean.average(&number(attribute, odd))
                });
            }
            if TUBES {
                let all = |odd: usize| [0, 1, 2].map_inline(|axis| number(tangent + axis, odd));
                let aligned = [0, 1].map_inline(|odd| {
                    let none = [[[0.0; LANES]; 4]; 3];
                    cells[odd].as_ref().map_or(none, |new| new.mix.aligned(all(odd)))
                });
                for axis in 0..3 {
                    let value =
                        |odd: usize, new: &NewCells| new.mix.mean.average(&aligned[odd][axis]);
                    put(fine, at(tangent + axis), &cells, value);
                }
            }
            let mut normal = [[[0.0; LANES]; 3]; 2];
            for axis in 0..3 {
                let new =
                    |odd: usize, new: &NewCells| new.mix.mean.average(&number(NORMAL + axis, odd));
                let [even, odd] = put(fine, at(NORMAL + axis), &cells, new);
                (normal[0][axis], normal[1][axis]) = (even, odd);
            }
            if finest {
                continue;
            }
            // -- The numbers that the next level is pushed from; the picture needs no more of the
            // finest level
            for attribute in [BACK, RADIUS] {
                put(fine, at(attribute), &cells, |odd, new| {
                    new.mix.mean.average(&number(attribute, odd))
                });
            }
            for axis in 0..2 {
                put(fine, at(PLACE + axis), &cells, |_, new| {
                    new.mix.mean.average(&new.four.place(axis))
                });
            }
            let tilt = [tilts(&normal[0]), tilts(&normal[1])];
            for axis in 0..2 {
                put(fine, at(TILT + axis), &cells, |odd, _| tilt[odd][axis]);
            }
        }
    }
);

/// Replaces a number of the new cells of both parities, and returns it for all cells.
#[inline(always)]
fn put(
    fine: &mut [f32],
    at: usize,
    cells: &[Option<NewCells>; 2],
    value: impl Fn(usize, &NewCells) -> Lanes,
) -> [Lanes; 2] {
    let mut lanes = load_halves(fine, at);
    for odd in 0..2 {
        if let Some(new) = &cells[odd] {
            lanes[odd] = select(&new.here, &value(odd, new), &lanes[odd]);
        }
    }
    store_halves(fine, at, &lanes);
    lanes
}

/// The cells of one parity that become new, and who takes part in them.
struct NewCells {
    four: FourCells,
    mix: Mix,
    /// Where a cell is needed and something was found for it.
    here: Mask,
}

impl NewCells {
    /// Which cells take part in the needed cells; none if no needed cell has any.
    #[inline(always)]
    fn new<const GAUSSIAN: bool, const TUBES: bool>(
        number: impl Fn(usize) -> [Lanes; 4],
        needed: &Lanes,
        shift: &[[f32; 2]; 4],
    ) -> Option<Self> {
        if !any_above_0(needed) {
            return None;
        }
        let four = FourCells {
            kind: number(KIND),
            front: number(FRONT),
            back: number(BACK),
            radius: number(RADIUS),
            displacement: pairs(&number(PLACE), &number(PLACE + 1)),
            shift: *shift,
            tilt: pairs(&number(TILT), &number(TILT + 1)),
        };
        let mix = four.mix::<GAUSSIAN, TUBES>();
        let here = mask(|i| (mix.kind[i] > 0.0) & (needed[i] > 0.0));
        any(&here).then_some(Self { four, mix, here })
    }
}

/// From the centres of the finer cells to the centres of their parents and of the parents'
/// neighbours.
#[inline(always)]
fn shifts(side: f32, [even_x, even_y]: [bool; 2]) -> [[f32; 2]; 4] {
    let shift = |neighbour: bool, even: bool| {
        let far = side * if neighbour { 1.5 } else { 0.5 };
        if neighbour == even { -far } else { far }
    };
    [0, 1, 2, 3].map_inline(|j| [shift(j % 2 == 1, even_x), shift(j / 2 == 1, even_y)])
}
