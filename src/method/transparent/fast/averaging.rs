//! Average the groups over a block of pixels: the compositing pass.

use super::blending::LayersBlock;
use crate::frame::NO_ID;
use crate::method::clock::{Work, spend};
use crate::method::transparent::Holes;
use crate::number::lanes::{LANES, Lanes, each, mask, select, select_u32};

/// The average of the groups at a block's pixels: sums first, then averages.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct AverageBlock {
    /// The colour over black.
    pub(crate) color: [Lanes; 3],
    pub(crate) alpha: Lanes,
    /// See [`LayersBlock::opacity`].
    pub(crate) opacity: Lanes,
    /// See [`LayersBlock::hidden`].
    pub(crate) hidden: Lanes,
    /// Count of layers.
    pub(crate) layers: Lanes,
    /// Least depth of any group.
    pub(crate) depth: Lanes,
    /// Surfel of that depth; the lower one if depths are equal.
    pub(crate) id: [u32; LANES],
    /// How many groups have a fragment.
    groups: Lanes,
}

impl AverageBlock {
    /// No group.
    pub(crate) const EMPTY: Self = Self {
        color: [[0.0; LANES]; 3],
        alpha: [0.0; LANES],
        opacity: [0.0; LANES],
        hidden: [0.0; LANES],
        layers: [0.0; LANES],
        depth: [f32::INFINITY; LANES],
        id: [NO_ID; LANES],
        groups: [0.0; LANES],
    };

    /// Adds a group; a group without a fragment would add zeros.
    #[inline(always)]
    pub(super) fn add<const TOTALS: bool>(&mut self, layers: &LayersBlock) {
        // Written line by line, because a loop over the channels would become the vector.
        plus(&mut self.color[0], &layers.color[0]);
        plus(&mut self.color[1], &layers.color[1]);
        plus(&mut self.color[2], &layers.color[2]);
        plus(&mut self.alpha, &layers.alpha);
        if TOTALS {
            plus(&mut self.opacity, &layers.opacity);
            plus(&mut self.hidden, &layers.hidden);
        }
        plus(&mut self.layers, &layers.count);
        plus(&mut self.groups, &each(|i| if layers.count[i] > 0.0 { 1.0 } else { 0.0 }));
        let (depth, id) = (self.depth, self.id);
        let wins = mask(|i| {
            let equal = (layers.depth[i] <= depth[i]) & (layers.id[i] < id[i]);
            (layers.depth[i] < depth[i]) | equal
        });
        self.depth = select(&wins, &layers.depth, &depth);
        self.id = select_u32(&wins, &layers.id, &id);
    }

    /// Divides the sums by the count of the groups that [`Holes`] takes.
    #[inline(always)]
    pub(super) fn divide<const TOTALS: bool>(&mut self, holes: Holes, groups: usize) {
        spend(Work::Average);
        let count = match holes {
            // An average of no group is 0, like its sums.
            Holes::Skipped => each(|i| if self.groups[i] > 0.0 { self.groups[i] } else { 1.0 }),
            Holes::Background => [groups as f32; LANES],
        };
        over(&mut self.color[0], &count);
        over(&mut self.color[1], &count);
        over(&mut self.color[2], &count);
        over(&mut self.alpha, &count);
        if TOTALS {
            over(&mut self.opacity, &count);
            over(&mut self.hidden, &count);
        }
        over(&mut self.layers, &count);
    }
}

#[inline(always)]
fn plus(sum: &mut Lanes, value: &Lanes) {
    *sum = each(|i| sum[i] + value[i]);
}

#[inline(always)]
fn over(sum: &mut Lanes, count: &Lanes) {
    *sum = each(|i| sum[i] / count[i]);
}
