//! Compute the fragments of one splat: the work of all its passes at the pixels of one block.

use super::tile::{BlockGrid, Record, SIDE};
use crate::frame::Rect;
use crate::number::MapInline;
use crate::number::Real;
use crate::number::lanes::{LANES, Lanes, each};
use crate::splat::{Footprint, Shared};

/// Calls `draw` for each block of a tile that a splat may touch. `draw` receives the place of the
/// block in the list of the tile, and q and nearness of the splat at the block's pixels.
#[inline(always)]
pub(crate) fn each_block<const RAY_CAST: bool>(
    splat: &Record,
    grid: &BlockGrid,
    shared: &Shared<f32>,
    mut draw: impl FnMut(usize, &Lanes, &Lanes),
) {
    let footprint = splat.footprint;
    each_place::<RAY_CAST, _>(splat, grid, shared.limit, |block, corner| {
        let (q, w) = fragments::<RAY_CAST>(shared, &footprint, corner);
        draw(block, &q, &w);
    });
}

/// Calls `visit` for each block of a tile that a splat may touch. `visit` receives the place of the
/// block in the list of the tile, and column and row of its first pixel.
#[inline(always)]
pub(super) fn each_place<const RAY_CAST: bool, A>(
    splat: &Record<A>,
    grid: &BlockGrid,
    limit: f32,
    mut visit: impl FnMut(usize, (u32, u32)),
) {
    let rect = grid.rect;
    let blocks = splat.blocks(&rect);
    for row in blocks.y0..blocks.y1 {
        let (first, last) = columns::<RAY_CAST>(&splat.footprint, &blocks, row, &rect, limit);
        for column in first..last {
            let corner = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
            visit((row * grid.columns + column) as usize, corner);
        }
    }
}

/// q and nearness of a splat at the pixels of a block whose first pixel is (x, y).
#[inline(always)]
pub(crate) fn fragments<const RAY_CAST: bool>(
    shared: &Shared<f32>,
    footprint: &Footprint<f32>,
    (x, y): (u32, u32),
) -> (Lanes, Lanes) {
    let shared = Shared { ray_cast: RAY_CAST, ..*shared };
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let (mut q, mut w) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        let dx = (x + (i % SIDE as usize) as f32) - footprint.center.x;
        let dy = (y + (i / SIDE as usize) as f32) - footprint.center.y;
        (q[i], w[i]) = footprint.fragment(&shared, dx, dy);
    }
    (q, w)
}

/// The blocks of one row that a splat may touch: first column and column after the last.
///
/// Splats of few columns keep their bounds. A wide splat is cut to its [`span`] in these rows of
/// pixels.
#[inline(always)]
fn columns<const RAY_CAST: bool>(
    f: &Footprint<f32>,
    blocks: &Rect,
    row: u32,
    tile: &Rect,
    limit: f32,
) -> (u32, u32) {
    if RAY_CAST || blocks.x1 - blocks.x0 < WIDE {
        return (blocks.x0, blocks.x1);
    }
    let [left, right] = span(f, tile.y0 + row * SIDE, SIDE, limit);
    let origin = f.center.x - tile.x0 as f32;
    let first = (origin + left - 0.5) * (1.0 / SIDE as f32);
    let last = (origin + right - 0.5) * (1.0 / SIDE as f32) + 1.0;
    let (start, end) = (blocks.x0 as f32, blocks.x1 as f32);
    // Comparisons that NaN fails, so that such a row keeps its bounds.
    let first = if first > start { first.at_most(end) } else { start };
    let last = if last < end { last.at_least(0.0) } else { end };
    (first.to_pixel(), last.to_pixel())
}

/// The columns, as offsets from the centre, that an ellipse may reach in a band of pixel rows.
///
/// In the band, |v| is at least `v`, so |u| is at most sqrt(limit - v v), and dx lies within that
/// over ux about -(uy/ux) dy. The interval is widened for rounding, like the bounds.
#[inline(always)]
fn span(f: &Footprint<f32>, row: u32, rows: u32, limit: f32) -> [f32; 2] {
    let top = row as f32 + 0.5 - f.center.y;
    let bottom = top + (rows - 1) as f32;
    let closest = if top > 0.0 {
        top
    } else if bottom < 0.0 {
        bottom
    } else {
        0.0
    };
    let v = f.vy * closest;
    // Near the tip of the ellipse the difference is all rounding error, and its root is not small.
    let reach = ((limit - v * v).at_least(0.0) + limit * (1.0 / 1_048_576.0)).sqrt() / f.ux;
    let skew = -(f.uy / f.ux);
    let (a, b) = (skew * top, skew * bottom);
    let (left, right) = if a < b { (a, b) } else { (b, a) };
    let slack = 1.0 / 64.0 + (reach + (a.abs() + b.abs())) * (1.0 / 65_536.0);
    [left - reach - slack, right + reach + slack]
}

/// Whether a splat may touch a tile: its bounds do, and if these are wide, its ellipse does in the
/// rows of the tile.
#[inline(always)]
pub(crate) fn touches<A>(record: &Record<A>, tile: &Rect, shared: &Shared<f32>) -> bool {
    let bounds = record.bounds();
    if bounds.intersection(tile).is_empty() {
        return false;
    }
    if shared.ray_cast || bounds.x1 - bounds.x0 < WIDE * SIDE {
        return true;
    }
    let [left, right] = span(&record.footprint, tile.y0, tile.y1 - tile.y0, shared.limit);
    let [first, last] =
        [tile.x0, tile.x1 - 1].map_inline(|x| x as f32 + 0.5 - record.footprint.center.x);
    // Comparisons that NaN fails, so that such a splat keeps its bounds.
    !((left > last) | (right < first))
}

/// The number of block columns from which on the rows of a splat are cut to its ellipse.
const WIDE: u32 = 6;

/// The nearness of the fragments that are inside; NaN, which fails every comparison, for the
/// others.
#[inline(always)]
pub(crate) fn inside(q: &Lanes, w: &Lanes, limit: f32) -> Lanes {
    each(|i| if q[i] <= limit { w[i] } else { f32::NAN })
}

/// `sum + weight value` in each lane.
#[inline(always)]
pub(crate) fn add(sum: &mut Lanes, weight: &Lanes, value: f32) {
    *sum = each(|i| sum[i] + weight[i] * value);
}
