//! The definition: every level of both phases.

use super::{Cell, Settings, pull, push};
use crate::frame::{Exec, Plane};
use crate::method::projection::Projected;
use crate::number::Exact;

/// The levels of a picture, the finest first.
#[derive(Clone, Debug)]
pub struct Pyramid<R> {
    /// As the pull phase left them.
    pub pulled: Vec<Plane<Cell<R>>>,
    /// As the push phase left them.
    pub pushed: Vec<Plane<Cell<R>>>,
}

/// The side of a cell of a level in pixels, 2^level.
pub(super) fn side<R: Exact>(level: usize) -> R {
    R::from_f32((1_u32 << level) as f32)
}

/// Pulls all levels from the projected scene.
#[must_use]
pub fn pull_all<R: Exact>(projected: &Projected<R>, exec: &Exec) -> Vec<Plane<Cell<R>>> {
    let mut fine = projected.samples.map(Cell::new);
    let mut levels = Vec::new();
    while fine.width() > 1 || fine.height() > 1 {
        let coarse = pull::pull(&fine, side(levels.len()), exec);
        levels.push(std::mem::replace(&mut fine, coarse));
    }
    levels.push(fine);
    levels
}

/// Pushes from the coarsest level to the finest.
#[must_use]
pub fn push_all<R: Exact>(
    pulled: &[Plane<Cell<R>>],
    settings: &Settings,
    exec: &Exec,
) -> Vec<Plane<Cell<R>>> {
    let mut pushed: Vec<Plane<Cell<R>>> = pulled.last().cloned().into_iter().collect();
    for (level, fine) in pulled.iter().enumerate().rev().skip(1) {
        let coarse = &pushed[pushed.len() - 1];
        pushed.push(push::push(fine, coarse, side(level), settings, exec));
    }
    pushed.reverse();
    pushed
}
