//! Blend the layers, from front to back.

use super::layers::PeeledLayer;
use crate::composite::under::Under;
use crate::frame::Plane;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::picture::before_environment;
use crate::method::tiled::Tiled;
use crate::number::Exact;

/// Blends the next layer under the layers before.
pub(super) fn under<R: Exact>(before: Under<R>, layer: &PeeledLayer<R>) -> Under<R> {
    spend(Work::Blend);
    before.under(layer.alpha, layer.color)
}

/// The colour and the opacity of the picture: the layers of each pixel before the environment.
pub(super) fn shown<R: Exact>(
    job: &Job<'_>,
    blended: &Tiled<Under<R>>,
) -> (Plane<[R; 3]>, Plane<R>) {
    let color = blended.plane(|blend| blend.color);
    let alpha = blended.plane(|blend| blend.alpha.at_most(R::ONE));
    before_environment(job, color, alpha)
}
