//! The push phase in lanes; see [`super::super::push`]. A level is changed in place, where it must
//! be.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::level::{
    BACK, FRONT, FURTHER, KIND, Level, NORMAL, PAD, PLACE, RADIUS, Shape, TILT, lanes,
};
use super::mix::{Four, Mix, pairs, tilts};
use crate::frame::Exec;
use crate::method::projection::fast::{LANES, Lanes, any_above_0, halves};
use crate::method::pyramid::{Occlusion, Settings, Weights};
use multiversion::multiversion;

/// Rows of a job.
const ROWS: usize = 8;

/// The cells of a level that are empty or occluded, from the coarser level; `side` is that of a
/// cell in pixels. Each row is then handed to `done`, while it is in the cache, with what `beside`
/// has for it.
pub(super) fn push<T: Send>(
    fine: &mut Level,
    coarse: &Level,
    (side, tubes, settings): (f32, bool, &Settings),
    exec: &Exec,
    beside: impl Iterator<Item = T>,
    done: impl Fn(&[f32], T) + Sync + Send,
) {
    let shapes = [fine.shape, coarse.shape];
    let outside = settings.occlusion == Occlusion::Outside;
    let run = match (settings.weights, tubes) {
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
            run([coarse.row(parent), coarse.row(beside)], row, &shapes, (side, even), outside);
            done(row, own);
        }
    });
}

/// A number of the parents and their three neighbours, for the columns of one parity.
#[inline(always)]
fn four(coarser: [&[f32]; 2], shape: &Shape, attribute: usize, x: usize, odd: usize) -> [Lanes; 4] {
    let own = shape.at(attribute, x);
    let beside = own - 1 + 2 * odd;
    [
        lanes(coarser[0], own),
        lanes(coarser[0], beside),
        lanes(coarser[1], own),
        lanes(coarser[1], beside),
    ]
}

/// Where cells must be computed: 1, else 0. Cells beyond the level's width never are.
#[inline(always)]
fn needed(
    kind: &Lanes,
    front: &Lanes,
    parent: [&Lanes; 3],
    (left, outside): (usize, bool),
) -> Lanes {
    let [parent_kind, parent_front, parent_back] = parent;
    let mut needed = [0.0; LANES];
    for i in 0..LANES {
        let before = outside & (front[i] < parent_front[i]);
        let occluded = (parent_kind[i] > 0.0) & ((front[i] > parent_back[i]) | before);
        let must = !(kind[i] > 0.0) | occluded;
        needed[i] = if must & (i < left) { 1.0 } else { 0.0 };
    }
    needed
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn push_row<const GAUSSIAN: bool, const TUBES: bool>(
    coarser: [&[f32]; 2],
    fine: &mut [f32],
    [fine_shape, shape]: &[Shape; 2],
    (side, even_y): (f32, bool),
    outside: bool,
) {
    let finest = side == 1.0;
    let shifts = [shifts(side, (true, even_y)), shifts(side, (false, even_y))];
    for x in (0..shape.width).step_by(LANES) {
        // An empty neighbourhood changes nothing: 2 rows of cells from x - 1 to x + LANES.
        let around = PAD + x - 1..PAD + x + LANES + 1;
        if !any_above_0(&coarser[0][around.clone()]) && !any_above_0(&coarser[1][around]) {
            continue;
        }
        let at = |attribute: usize| fine_shape.at(attribute, 2 * x);
        let (kinds, fronts) = (halves(fine, at(KIND)), halves(fine, at(FRONT)));
        let own = |attribute: usize| lanes(coarser[0], shape.at(attribute, x));
        let (kind, front, back) = (own(KIND), own(FRONT), own(BACK));
        let number = |attribute: usize, odd: usize| four(coarser, shape, attribute, x, odd);
        let find = |odd: usize| {
            // Columns 2x + odd, 2x + odd + 2 ... of the width.
            let left = (fine_shape.width + 1 - odd).saturating_sub(2 * x) / 2;
            let parent = [&kind, &front, &back];
            let needed = needed(&kinds[odd], &fronts[odd], parent, (left, outside));
            let number = |attribute: usize| number(attribute, odd);
            Found::new::<GAUSSIAN, TUBES>(number, &needed, &shifts[odd])
        };
        let found = [find(0), find(1)];
        if found[0].is_none() && found[1].is_none() {
            continue;
        }
        put(fine, at(KIND), &found, |_, found| found.mix.kind);
        for attribute in [FRONT].into_iter().chain(FURTHER..shape.attributes) {
            put(fine, at(attribute), &found, |odd, found| found.mix.of(&number(attribute, odd)));
        }
        let mut normal = [[[0.0; LANES]; 3]; 2];
        for axis in 0..3 {
            let new = |odd: usize, found: &Found| found.mix.of(&number(NORMAL + axis, odd));
            let [even, odd] = put(fine, at(NORMAL + axis), &found, new);
            (normal[0][axis], normal[1][axis]) = (even, odd);
        }
        // Of the finest level the picture wants no more.
        if !finest {
            for attribute in [BACK, RADIUS] {
                put(fine, at(attribute), &found, |odd, found| {
                    found.mix.of(&number(attribute, odd))
                });
            }
            for axis in 0..2 {
                put(fine, at(PLACE + axis), &found, |_, found| {
                    found.mix.of(&found.four.place(axis))
                });
            }
            let tilt = [tilts(&normal[0]), tilts(&normal[1])];
            for axis in 0..2 {
                put(fine, at(TILT + axis), &found, |odd, _| tilt[odd][axis]);
            }
        }
    }
}

/// Replaces a number of the cells of both parities where they were found, and returns it for all
/// cells.
#[inline(always)]
fn put(
    fine: &mut [f32],
    at: usize,
    found: &[Option<Found>; 2],
    new: impl Fn(usize, &Found) -> Lanes,
) -> [Lanes; 2] {
    let mut cells = halves(fine, at);
    for odd in 0..2 {
        if let Some(found) = &found[odd] {
            let new = new(odd, found);
            for i in 0..LANES {
                // By bits: of a choice LLVM makes a choice of what to load, lane by lane.
                let (mask, old) = (found.here[i], cells[odd][i].to_bits());
                cells[odd][i] = f32::from_bits((new[i].to_bits() & mask) | (old & !mask));
            }
        }
    }
    let mut pairs = [0.0; 2 * LANES];
    for i in 0..LANES {
        (pairs[2 * i], pairs[2 * i + 1]) = (cells[0][i], cells[1][i]);
    }
    fine[at..at + 2 * LANES].copy_from_slice(&pairs);
    cells
}

/// What was found for the cells of one parity.
struct Found {
    four: Four,
    mix: Mix,
    /// Where it is wanted and something was found: all bits, else none.
    here: [u32; LANES],
}

impl Found {
    /// Who takes part in the cells of one parity that are needed, if any.
    #[inline(always)]
    fn new<const GAUSSIAN: bool, const TUBES: bool>(
        number: impl Fn(usize) -> [Lanes; 4],
        needed: &Lanes,
        shift: &[[f32; 2]; 4],
    ) -> Option<Self> {
        if !any_above_0(needed) {
            return None;
        }
        let four = Four {
            kind: number(KIND),
            front: number(FRONT),
            back: number(BACK),
            radius: number(RADIUS),
            displacement: pairs(&number(PLACE), &number(PLACE + 1)),
            shift: *shift,
            tilt: pairs(&number(TILT), &number(TILT + 1)),
        };
        let mix = four.mix::<GAUSSIAN, TUBES>();
        let mut here = [0; LANES];
        for i in 0..LANES {
            here[i] = u32::from((mix.kind[i] > 0.0) & (needed[i] > 0.0)).wrapping_neg();
        }
        let any = here.iter().fold(0, |any, here| any | here);
        (any > 0).then_some(Self { four, mix, here })
    }
}

/// From the centres of the finer cells to those of their parents and the neighbours of those.
#[inline(always)]
fn shifts(side: f32, (even_x, even_y): (bool, bool)) -> [[f32; 2]; 4] {
    let shift = |neighbour: bool, even: bool| {
        let far = side * if neighbour { 1.5 } else { 0.5 };
        if neighbour == even { -far } else { far }
    };
    [0, 1, 2, 3].map(|j| [shift(j % 2 == 1, even_x), shift(j / 2 == 1, even_y)])
}
