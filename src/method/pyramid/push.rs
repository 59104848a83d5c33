//! The push phase \[MKC08, section 3.3\]: empty and occluded cells from four of the next coarser
//! level.
//!
//! The parent of the cell (x, y) is (x div 2, y div 2) of the coarser level as the push phase left
//! it. A valid cell is occluded as [`Occlusion`] says if its parent is valid. A cell that is valid
//! and not occluded is copied; so is every cell of the coarsest level.
//!
//! Any other cell is interpolated from four: the parent j = 0, its neighbour in x j = 1, that in y
//! j = 2, that in both j = 3, each on the side of the parent that the cell is on: x div 2 - 1 for
//! even x, x div 2 + 1 for odd x, and so for y. Those that do not exist are empty. With H the side
//! of the finer cell in pixels, the ellipse of cell j lies from the finer cell's centre at `v_j` =
//! `displacement_j` + (its centre - the finer centre):
//!
//! ```text
//!   in x:   parent     +H/2 for even x, -H/2 for odd x
//!           neighbour  -3H/2 for even x, +3H/2 for odd x              and so in y
//! ```
//!
//! Of the valid ones whose ellipse holds the offset `v_j`, the foremost and those whose intervals
//! overlap with its own are averaged ([`crate::composite::mean`]): front, back, normal, tangent,
//! radius, colour and `v_j`, with weight 1 or `exp(-2 (form_j / square_j))`, see [`Weights`].
//! `Decided:` "analogously to the pull phase" (section 3.3) means the test of depth too: without it
//! front and back surface run into each other at every silhouette.
//!
//! If there is no such cell: an empty cell stays empty, and an occluded one is copied. `Departs:`
//! by the words of the paper the second becomes empty; but what does not cover a cell does not hide
//! it, and there would be a hole beside every silhouette.

use super::{Cell, Occlusion, Settings, Weights};
use crate::composite::mean::Mean;
use crate::frame::{Exec, Plane};
use crate::number::{Exact, Vector2};
use crate::splat::Ellipse;

/// The finer level, as [`super::pull`] left it, from the coarser one; `side` is that of the finer
/// cells in pixels.
#[must_use]
pub fn push<R: Exact>(
    fine: &Plane<Cell<R>>,
    coarse: &Plane<Cell<R>>,
    side: R,
    settings: &Settings,
    exec: &Exec,
) -> Plane<Cell<R>> {
    let mut pushed = fine.clone();
    let rows = pushed.rows_mut();
    let exists = |x: i64, y: i64| {
        (0..i64::from(coarse.width())).contains(&x) && (0..i64::from(coarse.height())).contains(&y)
    };
    exec.ordered((0_u32..).zip(rows).collect(), |(y, row): (u32, &mut [Cell<R>])| {
        for (x, cell) in (0_u32..).zip(row) {
            let parent = *coarse.at(x / 2, y / 2);
            if cell.is_valid() && !occluded(cell, &parent, settings.occlusion) {
                continue;
            }
            let (px, py) = (i64::from(x / 2), i64::from(y / 2));
            let (nx, ny) = (beside(x), beside(y));
            let coarser = [(px, py), (nx, py), (px, ny), (nx, ny)].map(|(x, y)| {
                if exists(x, y) { *coarse.at(x as u32, y as u32) } else { Cell::empty() }
            });
            if let Some(found) = one(&coarser, (x % 2 == 0, y % 2 == 0), side, settings.weights) {
                *cell = found;
            }
        }
    });
    pushed
}

/// The column or row of the parent's neighbour.
fn beside(x: u32) -> i64 {
    let parent = i64::from(x / 2);
    if x.is_multiple_of(2) { parent - 1 } else { parent + 1 }
}

/// Whether a valid cell is occluded, see the module page.
pub(super) fn occluded<R: Exact>(cell: &Cell<R>, parent: &Cell<R>, rule: Occlusion) -> bool {
    let behind = cell.front > parent.back;
    let before = cell.front < parent.front;
    parent.is_valid() && (behind || (before && rule == Occlusion::Outside))
}

/// A cell from its parent and the three neighbours, if any holds its centre; see the module page.
fn one<R: Exact>(
    coarser: &[Cell<R>; 4],
    (even_x, even_y): (bool, bool),
    side: R,
    weights: Weights,
) -> Option<Cell<R>> {
    let shift = |neighbour: bool, even: bool| {
        let far = side * R::from_f32(if neighbour { 1.5 } else { 0.5 });
        if neighbour == even { -far } else { far }
    };
    let centers = [0, 1, 2, 3].map(|j| {
        let d = coarser[j].displacement;
        Vector2::new(d.x + shift(j % 2 == 1, even_x), d.y + shift(j / 2 == 1, even_y))
    });
    let ellipses = coarser.map(|cell| Ellipse::new(cell.normal, cell.radius));
    let forms = [0, 1, 2, 3].map(|j| ellipses[j].form(centers[j].x, centers[j].y));
    let inside = [0, 1, 2, 3].map(|j| ellipses[j].holds(forms[j]));
    let (takes, first) = Cell::foremost(coarser, inside);
    if !takes[first] {
        return None;
    }
    let weight = |j: usize| match weights {
        Weights::Gaussian if takes[j] => {
            (R::from_f32(-2.0) * (forms[j] / ellipses[j].square)).exp()
        }
        _ => R::ONE,
    };
    let mean = Mean::new(takes, [0, 1, 2, 3].map(weight));
    Some(Cell::average(coarser, centers, &mean, coarser[first].kind))
}
