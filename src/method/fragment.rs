//! Visit the fragments of splats: what every method that draws splats does with a fragment.

use super::prepare::Prepared;
use crate::composite::decide;
use crate::frame::Rect;
use crate::number::{Exact, Real};
use crate::splat::{Shared, Splat, fragment};

/// The splats that may touch some pixels of one tile.
#[derive(Debug)]
pub(crate) struct TileSplats<'a, R: Exact> {
    prepared: &'a Prepared<R, Splat<R>>,
    tile: usize,
    /// The pixels.
    pub(crate) rect: Rect,
}

impl<'a, R: Exact> TileSplats<'a, R> {
    /// The splats of a tile, at the pixels of `rect`.
    pub(crate) fn new(prepared: &'a Prepared<R, Splat<R>>, tile: usize, rect: Rect) -> Self {
        Self { prepared, tile, rect }
    }

    /// The constants that the fragments of all splats share.
    pub(crate) fn shared(&self) -> &'a Shared<R> {
        &self.prepared.shared
    }

    /// The depth of the visible band in world units.
    pub(crate) fn epsilon(&self) -> R {
        self.prepared.epsilon
    }

    /// Runs `draw` for every pixel in the bounds of every splat, in ascending surfel index. `draw`
    /// receives the splat, the pixel counted row by row, q and nearness.
    #[inline(always)]
    pub(crate) fn each_in_bounds(&self, mut draw: impl FnMut(&Splat<R>, usize, R, R)) {
        self.prepared.for_each(self.tile, |splat| {
            each_in_bounds(self.shared(), splat, &self.rect, |pixel, q, w| {
                draw(splat, pixel, q, w);
            });
        });
    }

    /// Runs `draw` for every fragment that is inside, in ascending surfel index. `draw` receives
    /// the splat, the pixel counted row by row, q and nearness.
    #[inline(always)]
    pub(crate) fn each_inside(&self, mut draw: impl FnMut(&Splat<R>, usize, R, R)) {
        self.prepared.for_each(self.tile, |splat| {
            each_inside(self.shared(), splat, &self.rect, |pixel, q, w| draw(splat, pixel, q, w));
        });
    }
}

/// Runs `visit` for the pixels of `rect` in the bounds of a splat. `visit` receives the pixel,
/// counted row by row, and its column and row.
#[inline(always)]
pub(crate) fn each_pixel<R: Real>(
    splat: &Splat<R>,
    rect: &Rect,
    mut visit: impl FnMut(usize, (u32, u32)),
) {
    let columns = rect.x1 - rect.x0;
    let Rect { x0, y0, x1, y1 } = splat.bounds.intersection(rect);
    for y in y0..y1 {
        for x in x0..x1 {
            visit(((y - rect.y0) * columns + (x - rect.x0)) as usize, (x, y));
        }
    }
}

/// Runs `draw` for the pixels of `rect` in the bounds of a splat. `draw` receives the pixel,
/// counted row by row, q and nearness.
#[inline(always)]
pub(crate) fn each_in_bounds<R: Real>(
    shared: &Shared<R>,
    splat: &Splat<R>,
    rect: &Rect,
    mut draw: impl FnMut(usize, R, R),
) {
    each_pixel(splat, rect, |pixel, at| {
        let (q, w) = fragment(shared, &splat.footprint, at);
        draw(pixel, q, w);
    });
}

/// As [`each_in_bounds`], for the fragments that are inside only.
#[inline(always)]
pub(crate) fn each_inside<R: Exact>(
    shared: &Shared<R>,
    splat: &Splat<R>,
    rect: &Rect,
    mut draw: impl FnMut(usize, R, R),
) {
    each_in_bounds(shared, splat, rect, |pixel, q, w| {
        if decide::inside(q, shared.limit) {
            draw(pixel, q, w);
        }
    });
}

/// The normal, reversed if the back is seen.
#[inline(always)]
pub(crate) fn facing<R: Real>(normal: [R; 3], back: R::Truth) -> [R; 3] {
    let part = |component: R| R::select(back, -component, component);
    [part(normal[0]), part(normal[1]), part(normal[2])]
}
