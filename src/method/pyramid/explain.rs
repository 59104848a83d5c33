//! Explain every decision behind one pixel, with its operands.

use super::pull::{self, pull_all, side};
use super::push::{self, push_all};
use super::{Cell, Occlusion, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::method::projection::explain::{PixelProjection, compared, outside, replay};
use crate::method::projection::{self, SampleKind};
use crate::number::{Exact, MapInline, Vector2};
use crate::splat::Ellipse;
use std::fmt;

/// The replay of the cells over one pixel.
#[derive(Clone, Debug)]
pub(super) struct PyramidReplay<R> {
    pixel: (u32, u32),
    pub(super) projection: PixelProjection<R>,
    /// The cells over the pixel, from level 1 up.
    pub(super) pulled: Vec<Four<R>>,
    /// The cells over the pixel, from the coarsest level but one down.
    pub(super) pushed: Vec<Pushed<R>>,
    /// The cell that the pixel shows.
    pub(super) shown: Cell<R>,
}

/// A cell from four others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Four<R> {
    level: usize,
    cell: (u32, u32),
    cells: [Cell<R>; 4],
    offsets: [Vector2<R>; 4],
    takes: [bool; 4],
    first: usize,
    /// The weights of the cells that take part.
    weights: [R; 4],
    /// The new cell; empty if none takes part.
    pub(super) found: Cell<R>,
}

/// A cell in the push phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pushed<R> {
    level: usize,
    cell: (u32, u32),
    rule: Occlusion,
    /// The cell as the pull phase left it.
    own: Cell<R>,
    parent: Cell<R>,
    /// The four cells that the cell is computed from, if it is not copied.
    from: Option<Four<R>>,
    /// The cell as the push phase leaves it.
    pub(super) left: Cell<R>,
}

/// Replays all stages at one pixel.
///
/// # Errors
/// The errors of the projection.
pub(super) fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<PyramidReplay<R>> {
    let exec = job.exec;
    let snap = Snap::new(settings.subpixel_bits)?;
    let projected = projection::project::<R>(job, settings.cull, snap)?;
    let fine = pull_all(&projected.samples, exec);
    let coarse = push_all(&fine, settings, exec);
    let over = |level: usize| (pixel.0 >> level, pixel.1 >> level);
    let pulled = (1..fine.len()).map(|level| {
        let (x, y) = over(level);
        pulled(level, (x, y), pull::four(&fine[level - 1], x, y))
    });
    let pushed = (0..fine.len() - 1).rev().map(|level| {
        let (x, y) = over(level);
        let (own, parent) = (*fine[level].at(x, y), *coarse[level + 1].at(x / 2, y / 2));
        let rule = settings.occlusion;
        let kept = own.is_valid() && !push::occluded(&own, &parent, rule);
        let from = (!kept)
            .then(|| four_of_push(level, (x, y), push::four(&coarse[level + 1], x, y), settings));
        let left = from.filter(|from| from.found.is_valid()).map_or(own, |from| from.found);
        Pushed { level, cell: (x, y), rule, own, parent, from, left }
    });
    Ok(PyramidReplay {
        pixel,
        projection: replay(job, settings.cull, snap, pixel),
        pulled: pulled.collect(),
        pushed: pushed.collect(),
        shown: *coarse[0].at(pixel.0, pixel.1),
    })
}

/// A cell of the pull phase.
fn pulled<R: Exact>(level: usize, cell: (u32, u32), cells: [Cell<R>; 4]) -> Four<R> {
    let offsets = pull::offsets(&cells, side(level - 1));
    let (takes, first) = Cell::foremost(&cells, Cell::inside(&cells, &offsets));
    let found =
        if takes[first] { pull::merge(&cells, &offsets, takes, first) } else { Cell::empty() };
    Four { level, cell, cells, offsets, takes, first, weights: [R::ONE; 4], found }
}

/// A cell of the push phase from the parent and its neighbours.
fn four_of_push<R: Exact>(
    level: usize,
    (x, y): (u32, u32),
    cells: [Cell<R>; 4],
    settings: &Settings,
) -> Four<R> {
    let (even_x, even_y) = (x.is_multiple_of(2), y.is_multiple_of(2));
    let offsets = push::offsets(&cells, even_x, even_y, side(level));
    let (takes, first) = Cell::foremost(&cells, Cell::inside(&cells, &offsets));
    let weights =
        [0, 1, 2, 3].map_inline(|j| push::weight(&cells[j], offsets[j], settings.weights));
    let found = if takes[first] {
        push::merge(&cells, &offsets, settings.weights, takes, first)
    } else {
        Cell::empty()
    };
    Four { level, cell: (x, y), cells, offsets, takes, first, weights, found }
}

impl<R: Exact> Four<R> {
    /// The fate of the cell j, in words.
    fn fate(&self, j: usize) -> String {
        let (cell, first) = (&self.cells[j], &self.cells[self.first]);
        if !cell.is_valid() {
            return "empty".into();
        }
        let kind = cell.kind.name();
        let ellipse = Ellipse::new(cell.normal, cell.extent);
        let (form, square) = (ellipse.form(self.offsets[j].x, self.offsets[j].y), ellipse.square);
        if !ellipse.holds(form) {
            return format!(
                "{kind:<8}  outside  form {}",
                compared(form, outside(form, square), square)
            );
        }
        let inside = format!("form {}", compared(form, "<=", square));
        let end = format!("the foremost's back, of {}", self.first);
        if !self.takes[j] && cell.front > first.back {
            let front = compared(cell.front, ">", first.back);
            return format!("{kind:<8}  behind   {inside}, front {front}: {end}");
        }
        if !self.takes[j] {
            return format!("{kind:<8}  other    {inside}, a tube mixes with tubes alone");
        }
        let word = if j == self.first { "foremost" } else { "overlaps" };
        let (front, weight) = (compared(cell.front, "<=", first.back), self.weights[j].to_f64());
        format!("{kind:<8}  {word} {inside}, front {front}: {end}; weight {weight}")
    }
}

impl<R: Exact> fmt::Display for Four<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.cells.iter().any(Cell::is_valid) {
            return writeln!(f, "    all four are empty");
        }
        for j in 0..4 {
            writeln!(f, "    {j}  {}", self.fate(j))?;
        }
        writeln!(f, "    gives {}", CellWords(&self.found))
    }
}

/// A cell in words.
struct CellWords<'a, R>(&'a Cell<R>);

impl<R: Exact> fmt::Display for CellWords<'_, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Cell { kind, front, back, extent, .. } = self.0;
        if *kind == SampleKind::Empty {
            return write!(f, "nothing");
        }
        let [front, back, extent] = [front, back, extent].map_inline(|v| v.to_f64());
        write!(f, "a {} from {front} to {back}, radius {extent} px", kind.name())
    }
}

impl<R: Exact> fmt::Display for Pushed<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), level) = (self.cell, self.level);
        write!(f, "  level {level}, cell ({x}, {y}): ")?;
        let (own, parent) = (&self.own, &self.parent);
        if !own.is_valid() {
            writeln!(f, "empty")?;
        } else if !parent.is_valid() {
            writeln!(f, "copied, the parent is empty")?;
        } else if own.front > parent.back {
            let behind = compared(own.front, ">", parent.back);
            writeln!(f, "occluded, front {behind}: the parent's back")?;
        } else if self.from.is_some() {
            let before = compared(own.front, "<", parent.front);
            writeln!(f, "occluded, front {before}: the parent's front")?;
        } else {
            let back = compared(own.front, "<=", parent.back);
            write!(f, "copied, front {back}: the parent's back")?;
            if self.rule == Occlusion::Outside {
                let front = compared(own.front, ">=", parent.front);
                write!(f, "; front {front}: the parent's front")?;
            }
            writeln!(f)?;
        }
        let Some(from) = &self.from else { return Ok(()) };
        write!(f, "{from}")?;
        if own.is_valid() && !from.found.is_valid() {
            let stays = CellWords(&self.left);
            writeln!(
                f,
                "    so the cell stays {stays}: what does not cover a cell does not hide it"
            )?;
        }
        Ok(())
    }
}

impl<R: Exact> fmt::Display for PyramidReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        writeln!(f, "pixel ({x}, {y})\n\n{}", self.projection)?;
        writeln!(f, "pull: finer cells 0 left above, 1 right above, 2 left below, 3 right below")?;
        for four in &self.pulled {
            let ((x, y), level) = (four.cell, four.level);
            write!(f, "  level {level}, cell ({x}, {y})\n{four}")?;
        }
        writeln!(f, "\npush: coarser cells 0 the parent, 1 beside in x, 2 beside in y, 3 in both")?;
        for pushed in &self.pushed {
            write!(f, "{pushed}")?;
        }
        writeln!(f, "\nthe pixel shows {}", CellWords(&self.shown))
    }
}
