//! Run the passes over a tile's blocks that every method has, compiled for every vector width.

use super::tile::{PixelBlock, Tile};
use crate::composite::{decide, sum};
use crate::method::clock::{Work, spend};
use crate::number::lanes::{LANES, components, vectorized};
use crate::splat::Shared;

impl Tile {
    /// The least nearness of each pixel that passes the epsilon-z test.
    pub(crate) fn limits(&mut self, shared: &Shared<f32>, epsilon: f32) {
        spend(Work::Limits);
        limits(&mut self.blocks, shared, epsilon);
    }

    /// Normalizes in place.
    pub(crate) fn normalize(&mut self, shared: &Shared<f32>) {
        spend(Work::Normalize);
        match (self.normal, self.color) {
            (false, false) => normalize::<false, false>(&mut self.blocks, shared),
            (false, true) => normalize::<false, true>(&mut self.blocks, shared),
            (true, false) => normalize::<true, false>(&mut self.blocks, shared),
            (true, true) => normalize::<true, true>(&mut self.blocks, shared),
        }
    }
}

vectorized!(
    fn limits(blocks: &mut [PixelBlock], shared: &Shared<f32>, epsilon: f32) {
        let shared = *shared;
        for block in blocks {
            for i in 0..LANES {
                let limit = decide::limit(shared.depth(block.nearest[i]), epsilon);
                block.least[i] = least_nearness(&shared, limit);
            }
        }
    }
);

/// The smallest nearness whose depth, rounded, is at most `limit`.
///
/// Under a perspective camera the correctly rounded 1/w never grows with w. It is at most `limit`
/// from the w on that is 1/(limit + ulp/2). That w is less than an ulp below 1/limit, so the answer
/// is the rounded 1/limit or one of its neighbours. `limit` is > 0; +inf gives 0.
#[inline(always)]
pub(crate) fn least_nearness(shared: &Shared<f32>, limit: f32) -> f32 {
    if !shared.perspective {
        return -limit;
    }
    let middle = 1.0 / limit;
    let above = f32::from_bits(middle.to_bits().wrapping_add(1));
    let below = f32::from_bits(middle.to_bits().saturating_sub(1));
    let least = if 1.0 / middle <= limit { middle } else { above };
    if 1.0 / below <= limit { below } else { least }
}

vectorized!(
    fn normalize<const NORMAL: bool, const COLOR: bool>(
        blocks: &mut [PixelBlock],
        shared: &Shared<f32>,
    ) {
        let shared = *shared;
        for block in blocks {
            let weight = block.weight;
            let (mut depth, mut normal, mut color) = (block.nearest, block.normal, block.color);
            for i in 0..LANES {
                depth[i] = shared.depth(depth[i]);
                if NORMAL {
                    let sums = components(&normal, i);
                    [normal[0][i], normal[1][i], normal[2][i]] = sum::direction(sums, weight[i]);
                }
                if COLOR {
                    let sums = components(&color, i);
                    [color[0][i], color[1][i], color[2][i]] = sum::average(sums, weight[i]);
                }
            }
            (block.nearest, block.normal, block.color) = (depth, normal, color);
        }
    }
);
