//! Pull in lanes; see [`super::super::pull`].

use super::level::{BACK, CellLevel, FRONT, FURTHER, KIND, NORMAL, PLACE, RADIUS, TILT, tangent};
use super::mix::{FourCells, pairs, tilts};
use crate::frame::Exec;
use crate::method::clock::{Work, spend};
use crate::method::projection::fast::RowLayout;
use crate::number::MapInline;
use crate::number::lanes::{LANES, Lanes, any_above_0, load_halves, store, vectorized};

/// Rows of a job.
const ROWS: usize = 4;

/// Pulls a coarser level from the finer one; `side` is the side of a finer cell in pixels.
pub(super) fn pull(fine: &CellLevel, coarse: &mut CellLevel, side: f32, tubes: bool, exec: &Exec) {
    let layouts = [fine.layout, coarse.layout];
    exec.chunks(coarse.rows_mut(), ROWS, |first, rows| {
        for (y, row) in (first as isize..).zip(rows) {
            pull_pair([fine.row(2 * y), fine.row(2 * y + 1)], row, &layouts, side, tubes);
        }
    });
}

/// Pulls a row of a coarser level from two finer rows.
pub(super) fn pull_pair(
    finer: [&[f32]; 2],
    coarse: &mut [f32],
    layouts: &[RowLayout; 2],
    side: f32,
    tubes: bool,
) {
    spend(Work::Pull);
    let run = match (side == 1.0, tubes) {
        (false, false) => pull_row::<false, false>,
        (false, true) => pull_row::<false, true>,
        (true, false) => pull_row::<true, false>,
        (true, true) => pull_row::<true, true>,
    };
    run(finer, coarse, layouts, side);
}

/// A number of the four finer cells of [`LANES`] coarser ones from column x on.
#[inline(always)]
fn four(finer: [&[f32]; 2], layout: &RowLayout, attribute: usize, x: usize) -> [Lanes; 4] {
    let at = layout.at(attribute, 2 * x);
    let [a, b] = load_halves(finer[0], at);
    let [c, d] = load_halves(finer[1], at);
    [a, b, c, d]
}

vectorized!(
    fn pull_row<const FINEST: bool, const TUBES: bool>(
        finer: [&[f32]; 2],
        coarse: &mut [f32],
        [fine, layout]: &[RowLayout; 2],
        side: f32,
    ) {
        let half = side * 0.5;
        let shift = [[-half, -half], [half, -half], [-half, half], [half, half]];
        for x in (0..layout.width).step_by(LANES) {
            let number = |attribute: usize| four(finer, fine, attribute, x);
            let mut put = |attribute: usize, lanes: &Lanes| {
                store(coarse, layout.at(attribute, x), lanes);
            };
            let kind = number(KIND);
            if !any_above_0(kind.as_flattened()) {
                put(KIND, &[0.0; LANES]);
                continue;
            }
            // -- The numbers that decide who takes part
            // The displacements of the finest level are 0.
            let own = |axis| if FINEST { [[0.0; LANES]; 4] } else { number(PLACE + axis) };
            let (left, upper) = (own(0), own(1));
            let displacement = pairs(&left, &upper);
            let [nx, ny, nz] = [number(NORMAL), number(NORMAL + 1), number(NORMAL + 2)];
            let tilt = if FINEST {
                let of = |j: usize| tilts(&[nx[j], ny[j], nz[j]]);
                [of(0), of(1), of(2), of(3)]
            } else {
                pairs(&number(TILT), &number(TILT + 1))
            };
            let (front, back, radius) = (number(FRONT), number(BACK), number(RADIUS));
            let four = FourCells { kind, front, back, radius, displacement, shift, tilt };
            let mix = four.mix::<false, TUBES>();
            put(KIND, &mix.kind);
            if !any_above_0(&mix.kind) {
                continue;
            }
            // -- The new cells
            put(FRONT, &mix.mean.least(&four.front));
            put(BACK, &mix.mean.greatest(&four.back));
            put(RADIUS, &mix.mean.average(&four.radius));
            for axis in 0..2 {
                put(PLACE + axis, &mix.mean.average(&four.place(axis)));
            }
            let normal = [mix.mean.average(&nx), mix.mean.average(&ny), mix.mean.average(&nz)];
            (0..3).for_each(|axis| put(NORMAL + axis, &normal[axis]));
            let tilt = tilts(&normal);
            (0..2).for_each(|axis| put(TILT + axis, &tilt[axis]));
            let tangent = tangent(layout, TUBES);
            for attribute in FURTHER..tangent {
                put(attribute, &mix.mean.average(&number(attribute)));
            }
            if TUBES {
                let aligned = mix.aligned([0, 1, 2].map_inline(|axis| number(tangent + axis)));
                (0..3).for_each(|axis| put(tangent + axis, &mix.mean.average(&aligned[axis])));
            }
        }
    }
);
