//! The pull phase \[MKC08, section 3.2\]: four cells to one of the next coarser level.
//!
//! The four finer cells of (X, Y) are j = 0 .. 3 at (2X + j mod 2, 2Y + j div 2); those that do not
//! exist are empty. With H the side of a finer cell in pixels, a power of two, its ellipse lies
//! from the new cell's centre at
//!
//! ```text
//!   v_j = displacement_j + (-+H/2, -+H/2)      - for the left column and the upper row, + for the others
//! ```
//!
//! and the new cell's centre is inside it if the ellipse holds the offset `v_j`. Of the valid cells
//! for which that is so the foremost and those whose intervals overlap with its own are averaged
//! ([`crate::composite::mean`], weights 1): normal, tangent, radius, colour and `v_j`, which is the
//! new displacement. The interval is the hull: the least front and the greatest back. If there is
//! no such cell the new one is empty.
//!
//! `v_j` is exact: multiples of 1/2 below 2^17, as long as a cell is passed on alone.
//!
//! Not symmetric: of several foremost cells the end of the first counts, in the order of j. And in
//! a level of odd width or height the last column or row is halved alone, so that a mirrored scene
//! has a mirrored picture, along an axis, only if that side is a power of two and not the shorter
//! one.

use super::Cell;
use crate::composite::mean::Mean;
use crate::frame::{Exec, Plane};
use crate::number::{Exact, Vector2};
use crate::splat::Ellipse;

/// The next coarser level; `side` is that of the finer cells in pixels.
#[must_use]
pub fn pull<R: Exact>(fine: &Plane<Cell<R>>, side: R, exec: &Exec) -> Plane<Cell<R>> {
    let (width, height) = (fine.width().div_ceil(2), fine.height().div_ceil(2));
    let mut coarse = Plane::filled(width, height, Cell::empty());
    let rows = coarse.rows_mut();
    exec.ordered((0..).zip(rows).collect(), |(y, row): (u32, &mut [Cell<R>])| {
        for (x, cell) in (0..).zip(row) {
            let finer = [0, 1, 2, 3].map(|j| {
                let (x, y) = (2 * x + j % 2, 2 * y + j / 2);
                let exists = x < fine.width() && y < fine.height();
                if exists { *fine.at(x, y) } else { Cell::empty() }
            });
            *cell = one(&finer, side);
        }
    });
    coarse
}

/// One cell from four, see the module page.
fn one<R: Exact>(finer: &[Cell<R>; 4], side: R) -> Cell<R> {
    let half = side * R::from_f32(0.5);
    let centers = [0, 1, 2, 3].map(|j| {
        let d = finer[j].displacement;
        let x = if j % 2 == 0 { d.x - half } else { d.x + half };
        let y = if j / 2 == 0 { d.y - half } else { d.y + half };
        Vector2::new(x, y)
    });
    let inside = [0, 1, 2, 3].map(|j| {
        let ellipse = Ellipse::new(finer[j].normal, finer[j].radius);
        ellipse.holds(ellipse.form(centers[j].x, centers[j].y))
    });
    let (takes, first) = Cell::foremost(finer, inside);
    if !takes[first] {
        return Cell::empty();
    }
    let mean = Mean::plain(takes);
    Cell {
        front: mean.least(finer.map(|cell| cell.front)),
        back: mean.greatest(finer.map(|cell| cell.back)),
        ..Cell::average(finer, centers, &mean, finer[first].kind)
    }
}
