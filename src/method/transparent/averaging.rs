//! The compositing pass of Algorithm 2: the average of the images of all groups.

use super::Holes;
use super::blending::GroupLayers;
use crate::composite::decide;
use crate::composite::over::Blend;
use crate::frame::NO_ID;
use crate::method::clock::{Work, spend};
use crate::number::{Exact, MapInline, Real};

/// The average of all groups at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GroupAverage<R> {
    pub(crate) blend: Blend<R>,
    /// See [`GroupLayers::opacity`].
    pub(crate) opacity: R,
    /// See [`GroupLayers::hidden`].
    pub(crate) hidden: R,
    /// Mean count of layers.
    pub(crate) layers: R,
    /// Least depth of any group.
    pub(crate) depth: R,
    /// Surfel of that depth; the lower one if depths are equal.
    pub(crate) surfel: u32,
}

/// The average at each of the first `pixels` pixels of all images: each quantity is a sum in the
/// order of the groups, divided once by their count.
pub(crate) fn averages<R: Exact>(
    images: &[impl AsRef<[GroupLayers<R>]>],
    pixels: usize,
    holes: Holes,
) -> Vec<GroupAverage<R>> {
    spend(Work::Average);
    let average = |pixel: usize| {
        let mut sum = GroupAverage::EMPTY;
        let mut count = 0_u8;
        for image in images {
            let layers = &image.as_ref()[pixel];
            count += u8::from(layers.count > 0 || holes == Holes::Background);
            sum.add(layers);
        }
        // An image that is left out has added zeros, so only the count differs.
        if count == 0 { sum } else { sum.divided(R::from_f32(f32::from(count))) }
    };
    (0..pixels).map(average).collect()
}

impl<R: Real> GroupAverage<R> {
    pub(crate) const EMPTY: Self = Self {
        blend: Blend::CLEAR,
        opacity: R::ZERO,
        hidden: R::ZERO,
        layers: R::ZERO,
        depth: R::INFINITY,
        surfel: NO_ID,
    };

    pub(crate) fn divided(self, count: R) -> Self {
        Self {
            blend: Blend {
                color: self.blend.color.map_inline(|c| c / count),
                alpha: self.blend.alpha / count,
            },
            opacity: self.opacity / count,
            hidden: self.hidden / count,
            layers: self.layers / count,
            ..self
        }
    }
}

impl<R: Exact> GroupAverage<R> {
    fn add(&mut self, layers: &GroupLayers<R>) {
        self.blend = self.blend.plus(&layers.blend);
        self.opacity = self.opacity + layers.opacity;
        self.hidden = self.hidden + layers.hidden;
        self.layers = self.layers + R::from_f32(f32::from(layers.count));
        if decide::before_or_lower((layers.depth, layers.surfel), (self.depth, self.surfel)) {
            (self.depth, self.surfel) = (layers.depth, layers.surfel);
        }
    }
}
