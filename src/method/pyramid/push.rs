//! Push: fill empty and occluded cells from four cells of the next coarser level \[MKC08, section
//! 3.3\].
//!
//! The parent of the cell (x, y) is (x div 2, y div 2) of the coarser level as the push phase left
//! it. If the parent is valid, [`Occlusion`] says whether a valid cell is occluded. A cell that is
//! valid and not occluded is copied; so is every cell of the coarsest level.
//!
//! Any other cell is interpolated from four cells: the parent j = 0, its neighbour in x j = 1, its
//! neighbour in y j = 2, its neighbour in both j = 3. Each neighbour is on the side of the parent
//! that the cell is on: x div 2 - 1 for even x, x div 2 + 1 for odd x, and so for y. Cells that do
//! not exist are empty. H is the side of the finer cell in pixels. The ellipse of cell j lies from
//! the finer cell's centre at `v_j` = `displacement_j` + (its centre - the finer centre):
//!
//! ```text
//!   in x:   parent     +H/2 for even x, -H/2 for odd x
//!           neighbour  -3H/2 for even x, +3H/2 for odd x              and so in y
//! ```
//!
//! Take the valid cells whose ellipse holds the offset `v_j`. The foremost of them and the cells
//! whose intervals overlap with its interval are averaged ([`crate::composite::mean`], tangents
//! turned as in the pull): front, back, normal, tangent, radius, colour and `v_j`, with weight 1 or
//! `exp(-2 (form_j / square_j))`, see [`Weights`]. `Decided:` "analogously to the pull phase"
//! (section 3.3) means the test of depth too, because without it front and back surface run into
//! each other at every silhouette.
//!
//! If there is no such cell, an empty cell stays empty, and an occluded cell is copied. `Departs:`
//! by the words of the paper the occluded cell becomes empty. But a surface that does not cover a
//! cell does not hide it, and there would be a hole beside every silhouette.

use super::pull::side;
use super::{Cell, Occlusion, Settings, Weights};
use crate::composite::decide;
use crate::composite::mean::Mean;
use crate::frame::{Exec, Plane};
use crate::method::clock::{Work, spend};
use crate::method::record::Records;
use crate::number::{Exact, MapInline, Real, Vector2};
use crate::splat::Ellipse;

/// Pushes all levels, from the levels of the pull phase, the finest first.
#[must_use]
pub fn push_all<R: Exact>(
    pulled: &[Plane<Cell<R>>],
    settings: &Settings,
    exec: &Exec,
) -> Vec<Plane<Cell<R>>> {
    let mut pushed: Vec<Plane<Cell<R>>> = pulled.last().cloned().into_iter().collect();
    for (level, fine) in pulled.iter().enumerate().rev().skip(1) {
        let coarse = &pushed[pushed.len() - 1];
        pushed.push(push(fine, coarse, side(level), settings, exec));
    }
    pushed.reverse();
    pushed
}

/// Pushes the finer level, as [`super::pull`] left it, from the coarser level; `side` is the side
/// of the finer cells in pixels.
#[must_use]
pub fn push<R: Exact>(
    fine: &Plane<Cell<R>>,
    coarse: &Plane<Cell<R>>,
    side: R,
    settings: &Settings,
    exec: &Exec,
) -> Plane<Cell<R>> {
    spend(Work::Push);
    let mut pushed = fine.clone();
    let rows = pushed.rows_mut();
    exec.ordered((0_u32..).zip(rows).collect(), |(y, row): (u32, &mut [Cell<R>])| {
        for (x, cell) in (0_u32..).zip(row) {
            let parent = *coarse.at(x / 2, y / 2);
            if cell.is_valid() && !occluded(cell, &parent, settings.occlusion) {
                continue;
            }
            let coarser = four(coarse, x, y);
            if let Some(found) = one(&coarser, x % 2 == 0, y % 2 == 0, side, settings.weights) {
                *cell = found;
            }
        }
    });
    pushed
}

/// The parent of a cell and the parent's three neighbours.
pub(crate) fn four<R: Real>(coarse: &impl Records<Cell<R>>, x: u32, y: u32) -> [Cell<R>; 4] {
    let [width, height] = coarse.size().map_inline(i64::from);
    let exists = |x: i64, y: i64| (0..width).contains(&x) && (0..height).contains(&y);
    let (px, py) = (i64::from(x / 2), i64::from(y / 2));
    let (nx, ny) = (beside(x), beside(y));
    [(px, py), (nx, py), (px, ny), (nx, ny)].map_inline(|(x, y)| {
        if exists(x, y) { coarse.record(x as u32, y as u32) } else { Cell::empty() }
    })
}

/// The column or row of the parent's neighbour.
fn beside(x: u32) -> i64 {
    let parent = i64::from(x / 2);
    if x.is_multiple_of(2) { parent - 1 } else { parent + 1 }
}

/// Whether a valid cell is occluded, see the module page.
pub fn occluded<R: Real>(cell: &Cell<R>, parent: &Cell<R>, rule: Occlusion) -> R::Truth {
    let interval = [parent.front, parent.back];
    R::Truth::from(parent.is_valid())
        & decide::occluded(cell.front, interval, rule == Occlusion::Outside)
}

/// A cell from its parent and the three neighbours, if one of their ellipses holds the cell's
/// centre; see the module page.
fn one<R: Exact>(
    coarser: &[Cell<R>; 4],
    even_x: bool,
    even_y: bool,
    side: R,
    weights: Weights,
) -> Option<Cell<R>> {
    let offsets = offsets(coarser, even_x, even_y, side);
    let (takes, first) = Cell::foremost(coarser, Cell::inside(coarser, &offsets));
    takes[first].then(|| merge(coarser, &offsets, weights, takes, first))
}

/// `v_j`: from the finer cell's centre to the centres of the coarser ellipses, in pixels. The
/// arguments say whether the column and the row of the finer cell are even, and the side of finer
/// cells.
pub fn offsets<R: Real>(
    coarser: &[Cell<R>; 4],
    even_x: bool,
    even_y: bool,
    side: R,
) -> [Vector2<R>; 4] {
    let shift = |neighbour: bool, even: bool| {
        let far = side * R::from_f32(if neighbour { 1.5 } else { 0.5 });
        if neighbour == even { -far } else { far }
    };
    [0, 1, 2, 3].map_inline(|j| {
        let d = coarser[j].displacement;
        Vector2::new(d.x + shift(j % 2 == 1, even_x), d.y + shift(j / 2 == 1, even_y))
    })
}

/// The weight of a cell at this offset, see [`Weights`].
pub(super) fn weight<R: Real>(cell: &Cell<R>, offset: Vector2<R>, weights: Weights) -> R {
    match weights {
        Weights::Box => R::ONE,
        Weights::Gaussian => {
            let ellipse = Ellipse::new(cell.normal, cell.extent);
            let form = ellipse.form(offset.x, offset.y);
            (R::from_f32(-2.0) * (form / ellipse.square)).exp()
        }
    }
}

/// The new cell from four cells at these [`offsets`], if the cells in `takes` take part and `first`
/// is the foremost of them.
pub fn merge<R: Real>(
    coarser: &[Cell<R>; 4],
    offsets: &[Vector2<R>; 4],
    weights: Weights,
    takes: [bool; 4],
    first: usize,
) -> Cell<R> {
    let of = |j: usize| if takes[j] { weight(&coarser[j], offsets[j], weights) } else { R::ONE };
    let mean = Mean::new(takes, [0, 1, 2, 3].map_inline(of));
    Cell::average(coarser, *offsets, &mean, first)
}
