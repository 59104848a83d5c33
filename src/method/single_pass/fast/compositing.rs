//! The compositing pass over one tile, compiled for every vector width.

use super::images::{Image, Images, NONE};
use crate::frame::NO_ID;
use crate::method::fast::lanes::add;
use crate::method::fast::resolve::least_nearness;
use crate::method::fast::tile::{Block, LANES, Lanes, Record, Tile};
use crate::number::elementary::exp_f32_in_range;
use crate::splat::Shared;
use multiversion::multiversion;

impl Images {
    /// The images of a block, by group.
    fn of_block(&self, block: usize, blocks: usize) -> impl Iterator<Item = &Image> {
        let slots = self.slots[block..].iter().step_by(blocks);
        slots.filter(|&&slot| slot != NONE).map(|&slot| &self.images[slot as usize])
    }

    /// The greatest nearness of each pixel, and its surfel.
    pub(super) fn nearest(&self, tile: &mut Tile) {
        nearest(self, tile);
    }

    /// Sums up what passes the epsilon-z test.
    pub(super) fn composite(&self, tile: &mut Tile, shared: &Shared<f32>) {
        match (tile.normal, tile.color) {
            (false, false) => composite::<false, false>(self, tile, shared),
            (false, true) => composite::<false, true>(self, tile, shared),
            (true, false) => composite::<true, false>(self, tile, shared),
            (true, true) => composite::<true, true>(self, tile, shared),
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn nearest(images: &Images, tile: &mut Tile) {
    let Tile { splats, blocks, .. } = tile;
    let count = blocks.len();
    for (index, block) in blocks.iter_mut().enumerate() {
        let (mut nearest, mut splat) = (block.nearest, [NONE; LANES]);
        for image in images.of_block(index, count) {
            let (nearness, own) = (image.nearness, image.splat);
            for i in 0..LANES {
                let equal = u32::from(nearness[i] == nearest[i]) & u32::from(own[i] < splat[i]);
                let mask = (u32::from(nearness[i] > nearest[i]) | equal).wrapping_neg();
                splat[i] = (own[i] & mask) | (splat[i] & !mask);
            }
            for i in 0..LANES {
                nearest[i] = if nearness[i] > nearest[i] { nearness[i] } else { nearest[i] };
            }
        }
        block.nearest = nearest;
        block.id = splat.map(|i| splats.get(i as usize).map_or(NO_ID, |splat| splat.surfel));
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn composite<const NORMAL: bool, const COLOR: bool>(
    images: &Images,
    tile: &mut Tile,
    shared: &Shared<f32>,
) {
    let shared = *shared;
    let Tile { splats, blocks, .. } = tile;
    let count = blocks.len();
    // An empty pixel is no fragment, whatever epsilon.
    let finite = least_nearness(&shared, f32::MAX);
    for (index, block) in blocks.iter_mut().enumerate() {
        for image in images.of_block(index, count) {
            let Some(weight) = weights(image, block, finite, splats) else { continue };
            add(&mut block.weight, &weight, 1.0);
            if NORMAL {
                gather_add(&mut block.normal, &weight, image, splats, |splat| splat.normal);
            }
            if COLOR {
                gather_add(&mut block.color, &weight, image, splats, |splat| splat.color);
            }
        }
    }
}

#[inline(always)]
fn weights(image: &Image, block: &Block, finite: f32, splats: &[Record]) -> Option<Lanes> {
    let (nearness, least, q) = (image.nearness, block.least, image.q);
    let mut hit = [0_u32; LANES];
    for i in 0..LANES {
        hit[i] = u32::from(nearness[i] >= least[i]) & u32::from(nearness[i] >= finite);
    }
    if hit.iter().all(|&h| h == 0) {
        return None;
    }
    let mut amplitude = [0.0; LANES];
    let last = splats.len() - 1;
    for i in 0..LANES {
        amplitude[i] = splats[(image.splat[i] as usize).min(last)].footprint.amplitude;
    }
    let mut weight = [0.0; LANES];
    for i in 0..LANES {
        let value = amplitude[i] * exp_f32_in_range(q[i] * -0.5);
        weight[i] = if hit[i] != 0 { value } else { 0.0 };
    }
    Some(weight)
}

#[inline(always)]
fn gather_add(
    sums: &mut [Lanes; 3],
    weight: &Lanes,
    image: &Image,
    splats: &[Record],
    value: impl Fn(&Record) -> [f32; 3],
) {
    let last = splats.len() - 1;
    let mut values = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let v = value(&splats[(image.splat[i] as usize).min(last)]);
        (values[0][i], values[1][i], values[2][i]) = (v[0], v[1], v[2]);
    }
    for (sum, value) in sums.iter_mut().zip(&values) {
        let mut lanes = *sum;
        for i in 0..LANES {
            lanes[i] += weight[i] * value[i];
        }
        *sum = lanes;
    }
}
