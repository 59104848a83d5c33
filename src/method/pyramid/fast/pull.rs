//! The pull phase in lanes; see [`super::super::pull`].

use super::level::{BACK, FRONT, FURTHER, KIND, Level, NORMAL, PAD, PLACE, RADIUS, Shape, TILT};
use super::mix::{Four, pairs, tilts};
use crate::frame::Exec;
use crate::method::projection::fast::{LANES, Lanes, any_above_0, halves};
use multiversion::multiversion;

/// Rows of a job.
const ROWS: usize = 4;

/// A coarser level from the finer one, of which `side` is the side of a cell in pixels.
pub(super) fn pull(fine: &Level, coarse: &mut Level, side: f32, tubes: bool, exec: &Exec) {
    let finest = side == 1.0;
    let run = match (finest, tubes) {
        (false, false) => pull_row::<false, false>,
        (false, true) => pull_row::<false, true>,
        (true, false) => pull_row::<true, false>,
        (true, true) => pull_row::<true, true>,
    };
    let shapes = [fine.shape, coarse.shape];
    exec.chunks(coarse.rows_mut(), ROWS, |first, rows| {
        for (y, row) in (first as isize..).zip(rows) {
            run([fine.row(2 * y), fine.row(2 * y + 1)], row, &shapes, side);
        }
    });
}

/// A number of the four finer cells of [`LANES`] coarser ones from column x on.
#[inline(always)]
fn four(finer: [&[f32]; 2], shape: &Shape, attribute: usize, x: usize) -> [Lanes; 4] {
    let at = shape.at(attribute, 2 * x);
    let [a, b] = halves(finer[0], at);
    let [c, d] = halves(finer[1], at);
    [a, b, c, d]
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn pull_row<const FINEST: bool, const TUBES: bool>(
    finer: [&[f32]; 2],
    coarse: &mut [f32],
    [fine, shape]: &[Shape; 2],
    side: f32,
) {
    let half = side * 0.5;
    let shift = [[-half, -half], [half, -half], [-half, half], [half, half]];
    for x in (0..shape.width).step_by(LANES) {
        let kind = four(finer, fine, KIND, x);
        let at = PAD + x;
        if !any_above_0(kind.as_flattened()) {
            coarse[at..at + LANES].fill(0.0);
            continue;
        }
        let number = |attribute: usize| four(finer, fine, attribute, x);
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
        let four = Four { kind, front, back, radius, displacement, shift, tilt };
        let mix = four.mix::<false, TUBES>();
        let mut put = |attribute: usize, lanes: &Lanes| {
            let at = attribute * shape.stride + at;
            coarse[at..at + LANES].copy_from_slice(lanes);
        };
        put(KIND, &mix.kind);
        if !any_above_0(&mix.kind) {
            continue;
        }
        put(FRONT, &mix.least(&four.front));
        put(BACK, &mix.greatest(&four.back));
        put(RADIUS, &mix.of(&four.radius));
        for axis in 0..2 {
            put(PLACE + axis, &mix.of(&four.place(axis)));
        }
        let turned = [mix.of(&nx), mix.of(&ny), mix.of(&nz)];
        (0..3).for_each(|axis| put(NORMAL + axis, &turned[axis]));
        let tilt = tilts(&turned);
        (0..2).for_each(|axis| put(TILT + axis, &tilt[axis]));
        for attribute in FURTHER..shape.attributes {
            put(attribute, &mix.of(&number(attribute)));
        }
    }
}
