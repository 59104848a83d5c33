//! Run the compositing pass over one tile, compiled for every vector width.

use super::images::{GroupImages, ImageBlock};
use crate::method::clock::{Work, spend};
use crate::method::fast::resolve::least_nearness;
use crate::method::fast::tile::Tile;
use crate::number::MapInline;
use crate::number::Real;
use crate::number::lanes::{LANES, Lanes, each, mask, select, vectorized};
use crate::splat::Shared;

impl GroupImages {
    /// The nearest fragment of each pixel.
    pub(crate) fn nearest(&self, tile: &mut Tile) {
        spend(Work::Composite);
        for (block, nearest) in tile.blocks.iter_mut().zip(&self.nearest) {
            block.nearest = nearest.nearness;
            block.id = each(|i| self.surfels[nearest.splat[i] as usize]);
        }
    }

    /// Sums the fragments that pass the epsilon-z test; fragments that do not pass lose their
    /// weight.
    pub(crate) fn composite(&mut self, tile: &mut Tile, shared: &Shared<f32>) {
        spend(Work::Composite);
        composite(self, tile, shared);
    }
}

vectorized!(
    fn composite(images: &mut GroupImages, tile: &mut Tile, shared: &Shared<f32>) {
        // An empty pixel is no fragment, whatever epsilon is.
        let finite = least_nearness(shared, f32::MAX);
        let places = images.ends.len();
        for (index, block) in tile.blocks.iter_mut().enumerate() {
            // -- The fragments that pass the epsilon-z test
            let list = &images.lists[index * places..][..images.counts[index]];
            let mut least = block.least;
            for lane in &mut least {
                *lane = lane.at_least(finite);
            }
            // A separate loop in lanes, because the next loop reads single numbers.
            for &image in list {
                hide(&mut images.images[image as usize], &least);
            }
            // -- The sums, a pixel's numbers side by side
            let mut sums = [[0.0; 8]; LANES];
            for &image in list {
                let image = &images.images[image as usize];
                for (i, sums) in sums.iter_mut().enumerate() {
                    let attributes = &images.attributes[image.splat[i] as usize];
                    for k in 0..8 {
                        sums[k] += image.weight[i] * attributes[k];
                    }
                }
            }
            if let Some(opacities) = images.opacities.get_mut(index) {
                *opacities = sums.map_inline(|[.., opacity]| opacity);
            }
            for (i, &[r, g, b, weight, x, y, z, _]) in sums.iter().enumerate() {
                block.weight[i] = weight;
                (block.color[0][i], block.color[1][i], block.color[2][i]) = (r, g, b);
                (block.normal[0][i], block.normal[1][i], block.normal[2][i]) = (x, y, z);
            }
        }
    }
);

/// Sets the weight of fragments that are less near to 0.
#[inline(always)]
fn hide(image: &mut ImageBlock, least: &Lanes) {
    let visible = mask(|i| image.nearness[i] >= least[i]);
    image.weight = select(&visible, &image.weight, &[0.0; LANES]);
}
