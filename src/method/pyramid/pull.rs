//! Pull: average four cells into one of the next coarser level \[MKC08, section 3.2\].
//!
//! The four finer cells of (X, Y) are j = 0 .. 3 at (2X + j mod 2, 2Y + j div 2); cells that do not
//! exist are empty. H is the side of a finer cell in pixels, a power of two. The finer cell's
//! ellipse lies from the new cell's centre at
//!
//! ```text
//!   v_j = displacement_j + (-+H/2, -+H/2)      - for the left column and the upper row, + for the others
//! ```
//!
//! The new cell's centre is inside the ellipse if the ellipse holds the offset `v_j`. Take the
//! valid cells whose ellipse holds it. The foremost of them and the cells whose intervals overlap
//! with its interval are averaged ([`crate::composite::mean`], weights 1): normal, tangent, radius,
//! colour and `v_j`, which is the new displacement. The interval is the hull: the least front and
//! the greatest back. If there is no such cell, the new cell is empty.
//!
//! `Decided:` a tangent is an axis, whose sign means nothing. So each tangent whose dot product
//! with the foremost tangent is < 0 is turned first. Tubes whose tangents have other signs then
//! have the same picture, bit for bit, unless two tangents meet at right angles.
//!
//! `v_j` is exact: multiples of 1/2 below 2^17, as long as a cell is passed on alone.
//!
//! The phase is not symmetric, for two reasons:
//!
//! - If several cells are foremost, the end of the first counts, in the order of j.
//! - In a level of odd width or height the last column or row is halved alone. So a mirrored scene
//!   has a mirrored picture, along an axis, only if that side is a power of two and not the shorter
//!   one.

use super::Cell;
use crate::composite::mean::Mean;
use crate::frame::{Exec, Plane};
use crate::method::clock::{Work, spend};
use crate::method::projection::PixelSample;
use crate::method::record::Records;
use crate::number::{Exact, MapInline, Real, Vector2};

/// The side of a cell of a level in pixels, 2^level.
pub(crate) fn side<R: Real>(level: usize) -> R {
    R::from_f32((1_u32 << level) as f32)
}

/// Pulls all levels from the projected scene, the finest first.
#[must_use]
pub fn pull_all<R: Exact>(samples: &Plane<PixelSample<R>>, exec: &Exec) -> Vec<Plane<Cell<R>>> {
    let mut fine = samples.map(Cell::new);
    let mut levels = Vec::new();
    while fine.width() > 1 || fine.height() > 1 {
        let coarse = pull(&fine, side(levels.len()), exec);
        levels.push(std::mem::replace(&mut fine, coarse));
    }
    levels.push(fine);
    levels
}

/// Pulls the next coarser level; `side` is the side of the finer cells in pixels.
#[must_use]
pub fn pull<R: Exact>(fine: &Plane<Cell<R>>, side: R, exec: &Exec) -> Plane<Cell<R>> {
    spend(Work::Pull);
    let (width, height) = (fine.width().div_ceil(2), fine.height().div_ceil(2));
    let mut coarse = Plane::filled(width, height, Cell::empty());
    let rows = coarse.rows_mut();
    exec.ordered((0..).zip(rows).collect(), |(y, row): (u32, &mut [Cell<R>])| {
        for (x, cell) in (0..).zip(row) {
            *cell = one(&four(fine, x, y), side);
        }
    });
    coarse
}

/// The four finer cells of a cell.
pub(crate) fn four<R: Real>(fine: &impl Records<Cell<R>>, x: u32, y: u32) -> [Cell<R>; 4] {
    let [width, height] = fine.size();
    [0, 1, 2, 3].map_inline(|j| {
        let (x, y) = (2 * x + j % 2, 2 * y + j / 2);
        if x < width && y < height { fine.record(x, y) } else { Cell::empty() }
    })
}

/// One cell from four, see the module page.
fn one<R: Exact>(finer: &[Cell<R>; 4], side: R) -> Cell<R> {
    let offsets = offsets(finer, side);
    let (takes, first) = Cell::foremost(finer, Cell::inside(finer, &offsets));
    if takes[first] { merge(finer, &offsets, takes, first) } else { Cell::empty() }
}

/// `v_j`: from the new cell's centre to the centres of the finer ellipses, in pixels; `side` is the
/// side of the finer cells.
pub fn offsets<R: Real>(finer: &[Cell<R>; 4], side: R) -> [Vector2<R>; 4] {
    let half = side * R::from_f32(0.5);
    [0, 1, 2, 3].map_inline(|j| {
        let d = finer[j].displacement;
        let x = if j % 2 == 0 { d.x - half } else { d.x + half };
        let y = if j / 2 == 0 { d.y - half } else { d.y + half };
        Vector2::new(x, y)
    })
}

/// The new cell from four cells at these [`offsets`], if the cells in `takes` take part and `first`
/// is the foremost of them.
pub fn merge<R: Real>(
    finer: &[Cell<R>; 4],
    offsets: &[Vector2<R>; 4],
    takes: [bool; 4],
    first: usize,
) -> Cell<R> {
    let mean = Mean::plain(takes);
    Cell {
        front: mean.least(finer.map_inline(|cell| cell.front)),
        back: mean.greatest(finer.map_inline(|cell| cell.back)),
        ..Cell::average(finer, *offsets, &mean, first)
    }
}
