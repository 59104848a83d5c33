//! The compositing pass over one tile, compiled for every vector width.

use super::images::{Image, Images};
use crate::method::fast::resolve::least_nearness;
use crate::method::fast::tile::{LANES, Lanes, Tile};
use crate::number::Real;
use crate::splat::Shared;
use multiversion::multiversion;

impl Images {
    /// The nearest fragment of each pixel.
    pub(super) fn nearest(&self, tile: &mut Tile) {
        for (block, nearest) in tile.blocks.iter_mut().zip(&self.nearest) {
            block.nearest = nearest.nearness;
            for i in 0..LANES {
                block.id[i] = self.surfels[nearest.splat[i] as usize];
            }
        }
    }

    /// Sums up what passes the epsilon-z test.
    pub(super) fn composite(&mut self, tile: &mut Tile, shared: &Shared<f32>) {
        composite(self, tile, shared);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn composite(images: &mut Images, tile: &mut Tile, shared: &Shared<f32>) {
    let shared = *shared;
    let Images { ends, images, counts, lists, attributes, .. } = images;
    let lists = counts.iter().zip(lists.chunks(ends.len())).map(|(&count, list)| &list[..count]);
    // An empty pixel is no fragment, whatever epsilon.
    let finite = least_nearness(&shared, f32::MAX);
    for (block, list) in tile.blocks.iter_mut().zip(lists) {
        let mut least = block.least;
        for i in 0..LANES {
            least[i] = least[i].at_least(finite);
        }
        for &slot in list {
            pass(&mut images[slot as usize], &least);
        }
        let mut sums = [[0.0; 8]; LANES];
        for &slot in list {
            let image = &images[slot as usize];
            for i in 0..LANES {
                let (weight, attributes) = (image.weight[i], &attributes[image.splat[i] as usize]);
                for (sum, attribute) in sums[i].iter_mut().zip(attributes) {
                    *sum += weight * attribute;
                }
            }
        }
        for i in 0..LANES {
            let [r, g, b, weight, x, y, z, _] = sums[i];
            block.weight[i] = weight;
            (block.color[0][i], block.color[1][i], block.color[2][i]) = (r, g, b);
            (block.normal[0][i], block.normal[1][i], block.normal[2][i]) = (x, y, z);
        }
    }
}

/// Takes the weight of the fragments that do not pass.
#[inline(always)]
fn pass(image: &mut Image, least: &Lanes) {
    let (nearness, mut weight) = (image.nearness, image.weight);
    for i in 0..LANES {
        let mask = u32::from(nearness[i] >= least[i]).wrapping_neg();
        weight[i] = f32::from_bits(weight[i].to_bits() & mask);
    }
    image.weight = weight;
}
