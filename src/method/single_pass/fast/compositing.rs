//! The compositing pass over one tile, compiled for every vector width.

use super::images::{Image, Images, NONE};
use crate::frame::NO_ID;
use crate::method::fast::resolve::least_nearness;
use crate::method::fast::tile::{LANES, Lanes, Tile};
use crate::number::Real;
use crate::splat::Shared;
use multiversion::multiversion;

impl Images {
    /// Sums up what passes the epsilon-z test.
    pub(super) fn composite(&mut self, tile: &mut Tile, shared: &Shared<f32>) {
        composite(self, tile, shared);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn composite(images: &mut Images, tile: &mut Tile, shared: &Shared<f32>) {
    let shared = *shared;
    let Images { slots, images, attributes, .. } = images;
    let count = tile.blocks.len();
    // An empty pixel is no fragment, whatever epsilon.
    let finite = least_nearness(&shared, f32::MAX);
    for (index, block) in tile.blocks.iter_mut().enumerate() {
        let mut least = block.least;
        for i in 0..LANES {
            least[i] = least[i].at_least(finite);
        }
        for &slot in slots[index..].iter().step_by(count).filter(|&&slot| slot != NONE) {
            pass(&mut images[slot as usize], &least);
        }
        let mut sums = [[0.0; 8]; LANES];
        for &slot in slots[index..].iter().step_by(count).filter(|&&slot| slot != NONE) {
            let image = &images[slot as usize];
            for i in 0..LANES {
                let (weight, attributes) = (image.weight[i], &attributes[image.splat[i] as usize]);
                for (sum, attribute) in sums[i].iter_mut().zip(attributes) {
                    *sum += weight * attribute;
                }
            }
        }
        block.id = block.id.map(|i| tile.splats.get(i as usize).map_or(NO_ID, |s| s.surfel));
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
        weight[i] = if nearness[i] >= least[i] { weight[i] } else { 0.0 };
    }
    image.weight = weight;
}
