//! Propagate centres to the level that fits their radius, and merge those that meet \[MOC08,
//! section 3.1\].
//!
//! A centre **stays** at level l if rho <= [`Settings::reach`] of l, or if l is the top level; else
//! it moves on. Cell (X, Y) of the next level receives the moving centres of the finer cells j = 0
//! .. 3 at (2X + j mod 2, 2Y + j div 2). A centre that moves alone is copied, bit for bit. If
//! several move, the foremost is the one of the least depth, ties to the lower j. The foremost is
//! averaged with all moving centres for which
//!
//! ```text
//!   t_j - t_front <= r_j + r_front
//! ```
//!
//! The average ([`crate::composite::mean`], weights 1) covers place, normal, rho, r, t and colour;
//! the id is the id of the foremost. The other centres are lost. `Departs:` section 3.1 says "its
//! depth is less than the foremost depth minus the sum of their radii". No depth behind the
//! foremost can be so; the paper means the distance.
//!
//! If all radii are greater than the reach of a level, their average is greater too. So a centre
//! never stays at a level that it should have left.
//! centre never stays at a level that it should have left.

use super::{Center, Settings};
use crate::composite::decide;
use crate::composite::mean::Mean;
use crate::frame::{Exec, Plane};
use crate::method::clock::{Work, spend};
use crate::method::projection::PixelSample;
use crate::method::record::Records;
use crate::number::{Exact, MapInline, Real, Vector2, Vector3};

/// The top level, whose cells every pixel searches whole: the first level whose sides are at most
/// h + 1.
#[must_use]
pub fn top(settings: &Settings, sizes: &[[u32; 2]]) -> usize {
    let most = settings.half() + 1;
    let found = sizes.iter().position(|[w, h]| *w <= most && *h <= most);
    // The last level is one pixel.
    found.unwrap_or(sizes.len() - 1)
}

/// All levels up to the top. A level holds the centres that arrived there, both those that stay and
/// those that move on.
#[must_use]
pub fn propagate<R: Exact>(
    samples: &Plane<PixelSample<R>>,
    settings: &Settings,
    exec: &Exec,
) -> Vec<Plane<Center<R>>> {
    let sizes = crate::frame::pyramid::sizes(samples.width(), samples.height());
    let mut levels = vec![samples.map(Center::new)];
    for level in 0..top(settings, &sizes) {
        let reach = R::from_f32(settings.reach(level));
        levels.push(coarser(&levels[level], reach, exec));
    }
    levels
}

/// Whether a centre moves on; the level is not the top.
pub fn moves<R: Real>(center: &Center<R>, reach: R) -> R::Truth {
    R::Truth::from(center.is_valid()) & decide::moves(center.extent, reach)
}

/// The next level, from the centres that do not stay within `reach`.
pub(super) fn coarser<R: Exact>(
    fine: &Plane<Center<R>>,
    reach: R,
    exec: &Exec,
) -> Plane<Center<R>> {
    spend(Work::Propagate);
    let (width, height) = (fine.width().div_ceil(2), fine.height().div_ceil(2));
    let mut coarse = Plane::filled(width, height, Center::empty());
    let rows = coarse.rows_mut();
    exec.ordered((0..).zip(rows).collect(), |(y, row): (u32, &mut [Center<R>])| {
        for (x, center) in (0..).zip(row) {
            let finer = four(fine, x, y);
            *center = merged(&finer, finer.map_inline(|center| moves(&center, reach)));
        }
    });
    coarse
}

/// The four finer cells of a cell.
pub(crate) fn four<R: Real>(fine: &impl Records<Center<R>>, x: u32, y: u32) -> [Center<R>; 4] {
    let [width, height] = fine.size();
    [0, 1, 2, 3].map_inline(|j| {
        let (x, y) = (2 * x + j % 2, 2 * y + j / 2);
        if x < width && y < height { fine.record(x, y) } else { Center::empty() }
    })
}

/// One centre from the centres that move, see the module page.
fn merged<R: Exact>(finer: &[Center<R>; 4], moving: [bool; 4]) -> Center<R> {
    let Some(first) = foremost(finer, moving) else { return Center::empty() };
    let near = near(finer, first);
    merge(finer, [0, 1, 2, 3].map_inline(|j| moving[j] && near[j]), first)
}

/// The foremost of the centres that move; ties to the lower index.
pub(super) fn foremost<R: Exact>(finer: &[Center<R>; 4], moving: [bool; 4]) -> Option<usize> {
    let (mut depth, mut first) = (R::INFINITY, None);
    for j in 0..4 {
        if moving[j] && decide::before(finer[j].depth, depth) {
            (depth, first) = (finer[j].depth, Some(j));
        }
    }
    first
}

/// Which of four centres are near enough to the foremost to be merged with it.
pub fn near<R: Real>(finer: &[Center<R>; 4], first: usize) -> [R::Truth; 4] {
    let front = &finer[first];
    finer.map_inline(|c| decide::meets([c.depth, c.radius], [front.depth, front.radius]))
}

/// The new centre from four centres, if the centres in `takes` take part and `first` is the
/// foremost of them.
pub fn merge<R: Real>(finer: &[Center<R>; 4], takes: [bool; 4], first: usize) -> Center<R> {
    let mean = Mean::plain(takes);
    let number =
        |of: fn(&Center<R>) -> R| mean.average_called([0, 1, 2, 3].map_inline(|j| of(&finer[j])));
    Center {
        id: finer[first].id,
        depth: number(|c| c.depth),
        radius: number(|c| c.radius),
        extent: number(|c| c.extent),
        center: Vector2::new(number(|c| c.center.x), number(|c| c.center.y)),
        normal: Vector3::new(
            number(|c| c.normal.x),
            number(|c| c.normal.y),
            number(|c| c.normal.z),
        ),
        color: [number(|c| c.color[0]), number(|c| c.color[1]), number(|c| c.color[2])],
    }
}
