//! Verify the blending of a client's layers.

use super::planes::PeelingPlanes;
use crate::composite::over::Blend;
use crate::composite::under::Under;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::verdict::checks::{Backdrop, input, inputs, is_bounded, number, triple};
use crate::verdict::marks::PixelMarks;

/// Marks a wrong picture at a pixel. Returns whether the picture is judged, or there is none.
pub(super) fn judge<P: Profile>(
    client_planes: &PeelingPlanes<'_>,
    backdrop: &Backdrop<'_, P>,
    at: (u32, u32),
    pixel: &mut PixelMarks<'_>,
) -> bool {
    if client_planes.shaded.is_none() && client_planes.alpha.is_none() {
        return true;
    }
    if !client_planes.blends() || more(client_planes, at) {
        return false;
    }
    let mut blend = Under::<Ball<P>>::CLEAR;
    for layer in &client_planes.layers {
        if let (Some(alpha), Some(color)) = (&layer.alpha, &layer.color) {
            blend = blend.under(input(alpha, at), inputs(color, at));
        }
    }
    let layers = Blend { color: blend.color, alpha: blend.alpha.at_most(Ball::ONE) };
    let Blend { color, alpha } = backdrop.behind(layers, at);
    let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
    if let Some(plane) = &client_planes.shaded {
        triple(0, plane, at, color, report);
    }
    if let Some(plane) = &client_planes.alpha {
        number(0, plane, at, alpha, report);
    }
    client_planes.shaded.is_none() || is_bounded(&color)
}

/// Whether a pixel may have more layers than leave planes.
fn more(client_planes: &PeelingPlanes<'_>, (x, y): (u32, u32)) -> bool {
    let last = client_planes.layers.len();
    if client_planes.most as usize <= last {
        return false;
    }
    match (&client_planes.number, client_planes.layers.last().and_then(|layer| layer.alpha)) {
        (Some(number), _) => usize::from(*number.plane.at(x, y)) > last,
        // If the last layer is there, more may follow.
        (None, Some(alpha)) => *alpha.plane.at(x, y) != 0.0,
        (None, None) => true,
    }
}
