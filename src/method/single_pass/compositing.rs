//! The compositing pass: the operator of \[ZP06, Fig. 5\] over the depth-images, and normalization.

use super::geometry::ImagePixel;
use crate::composite::groups::{WeightedFragment, compose};
use crate::composite::{decide, sum};
use crate::frame::NO_ID;
use crate::method::clock::{Work, spend};
use crate::method::surface::SurfacePixel;
use crate::number::Exact;

/// The result of the compositing pass at one pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Composite<R> {
    /// The sums, with the nearest depth.
    pub(crate) sums: WeightedFragment<R>,
    /// How many groups passed the epsilon-z test.
    pub(crate) count: u32,
    /// The surfel of the greatest nearness.
    pub(crate) id: u32,
}

/// The compositing pass over the first `pixels` pixels of all images; `empty` is the nearness of an
/// empty pixel.
pub(crate) fn composites<R: Exact>(
    images: &[impl AsRef<[ImagePixel<R>]>],
    pixels: usize,
    epsilon: R,
    empty: R,
) -> Vec<Composite<R>> {
    spend(Work::Composite);
    let mut samples = Vec::with_capacity(images.len());
    let composite = |pixel: usize| {
        samples.clear();
        let (mut nearness, mut id) = (empty, NO_ID);
        for image in images {
            let kept = &image.as_ref()[pixel];
            samples.push(kept.sample);
            if decide::nearer_or_lower((kept.nearness, kept.surfel), (nearness, id)) {
                (nearness, id) = (kept.nearness, kept.surfel);
            }
        }
        let (sums, count) = compose(&samples, epsilon);
        Composite { sums, count, id }
    };
    (0..pixels).map(composite).collect()
}

impl<R: Exact> Composite<R> {
    /// Normalizes the sums.
    pub(crate) fn surface(&self) -> SurfacePixel<R> {
        spend(Work::Normalize);
        let Self { sums, id, .. } = *self;
        SurfacePixel {
            depth: sums.depth,
            id,
            weight: sums.weight,
            normal: sum::direction(sums.normal, sums.weight),
            color: sum::average(sums.color, sums.weight),
        }
    }

    /// The average opacity.
    pub(crate) fn opacity(&self) -> R {
        let WeightedFragment { opacity, weight, .. } = self.sums;
        let [alpha, ..] = sum::average([opacity, R::ZERO, R::ZERO], weight);
        // The quotient of two sums may exceed 1 by their rounding.
        alpha.at_most(R::ONE)
    }
}
