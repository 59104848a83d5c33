//! What the projections of a picture's surfels share.

use super::frustum::Frustum;
use super::{Kernel, Outline, View};
use crate::number::Real;

/// All numbers that the projection of a picture's surfels shares.
#[derive(Clone, Copy, Debug)]
pub struct Projector<R> {
    /// The camera.
    pub view: View<R>,
    /// k, the cut-off.
    pub cutoff: R,
    /// h, the variance of the low-pass filter in px^2.
    pub low_pass: R,
    /// How a disc becomes a shape.
    pub outline: Outline,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
    /// The sides of the view.
    pub(super) frustum: Frustum<R>,
}

impl<R: Real> Projector<R> {
    /// Computes the shared numbers of a picture.
    #[must_use]
    pub fn new(view: View<R>, kernel: &Kernel, cull: bool) -> Self {
        Self {
            frustum: Frustum::new(&view, kernel),
            view,
            cutoff: R::from_f32(kernel.cutoff),
            low_pass: R::from_f32(kernel.low_pass),
            outline: kernel.outline,
            cull,
        }
    }
}
