//! The pixels that a splat can touch.

use super::View;
use crate::frame::Rect;
use crate::number::{Pixel, Real, Vector2};

/// The pixels of the picture whose centres lie in `center` +- `extent`, widened for rounding.
///
/// The bounds are a guarantee, not a part of the kernel: no pixel outside has q <= k^2. The extents
/// grow by the factor 1 + 2^-18 `stretch` and by 1/128 px. That exceeds the rounding errors of q at
/// the rim of an ellipse whose axes are skewed by `stretch`, and the rounding errors of a column
/// below 65,536. So an ellipse that ends at a pixel centre keeps that pixel.
#[inline(always)]
pub fn around<R: Real>(view: &View<R>, center: Vector2<R>, extent: Vector2<R>, stretch: R) -> Rect {
    let grow = R::ONE + stretch * R::from_f32(1.0 / 262_144.0);
    let slack = R::from_f32(1.0 / 128.0);
    let (ex, ey) = (extent.x * grow + slack, extent.y * grow + slack);
    between(
        view,
        Vector2::new(center.x - ex, center.y - ey),
        Vector2::new(center.x + ex, center.y + ey),
    )
}

/// The pixels of the picture whose centres lie, or may lie, between two corners.
#[inline(always)]
pub fn between<R: Real>(view: &View<R>, low: Vector2<R>, high: Vector2<R>) -> Rect {
    Rect {
        x0: first_pixel(low.x, view.width).least(),
        y0: first_pixel(low.y, view.height).least(),
        x1: first_pixel(high.x, view.width).greatest(),
        y1: first_pixel(high.y, view.height).greatest(),
    }
}

/// The first pixel whose centre lies after `position`, at most `count`; 0 for NaN.
#[inline(always)]
fn first_pixel<R: Real>(position: R, count: R) -> R::Pixel {
    let position = position + R::from_f32(0.5);
    // NaN fails this comparison.
    let position = R::select(position.gt(R::ZERO), position, R::ZERO);
    position.at_most(count).to_pixel()
}
