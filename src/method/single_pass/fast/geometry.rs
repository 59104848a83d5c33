//! The geometry pass over one tile, compiled for every vector width.

use super::images::{Image, Images, Nearest};
use crate::composite::bins::DepthBins;
use crate::method::fast::lanes::{columns, fragments, inside};
use crate::method::fast::tile::{LANES, Lanes, Record, SIDE, Tile};
use crate::number::elementary::exp_f32_in_range;
use crate::splat::Shared;
use multiversion::multiversion;

/// What the image of the group that is being drawn keeps at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Layer {
    /// Voronoi-enhanced depth; not used under the plain depth test.
    z: Lanes,
    nearness: Lanes,
    q: Lanes,
    amplitude: Lanes,
    /// As in [`Image`].
    splat: [u32; LANES],
}

impl Images {
    /// Draws every splat into the image of its group, with the plain depth test if there are no
    /// bins.
    pub(super) fn draw(
        &mut self,
        tile: &Tile,
        shared: &Shared<f32>,
        bins: Option<&DepthBins<f32>>,
    ) {
        match (shared.ray_cast, bins) {
            (false, None) => geometry::<false, false>(self, tile, shared, bins),
            (false, Some(_)) => geometry::<false, true>(self, tile, shared, bins),
            (true, None) => geometry::<true, false>(self, tile, shared, bins),
            (true, Some(_)) => geometry::<true, true>(self, tile, shared, bins),
        }
    }
}

/// One group after the other in the same blocks, which stay in the nearest cache.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn geometry<const RAY_CAST: bool, const VORONOI: bool>(
    images: &mut Images,
    tile: &Tile,
    shared: &Shared<f32>,
    bins: Option<&DepthBins<f32>>,
) {
    let shared = *shared;
    let empty = Layer {
        z: [f32::INFINITY; LANES],
        nearness: [shared.empty(); LANES],
        q: [0.0; LANES],
        amplitude: [0.0; LANES],
        splat: [tile.splats.len() as u32; LANES],
    };
    let mut layers = vec![empty; tile.blocks.len()];
    let mut start = 0;
    for group in 0..images.ends.len() {
        let end = images.ends[group];
        // A bit for each block: a tile has at most 16 x 16.
        let mut touched = [0_u64; 4];
        for &index in &images.order[start..end] {
            let splat = (index, &tile.splats[index as usize]);
            draw::<RAY_CAST, VORONOI>(&mut layers, &mut touched, tile, splat, &shared, bins);
        }
        start = end;
        for (word, mut bits) in touched.into_iter().enumerate() {
            while bits != 0 {
                let block = 64 * word + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let layer = &mut layers[block];
                finish(images, block, layer);
                if VORONOI {
                    layer.z = empty.z;
                }
                (layer.nearness, layer.splat) = (empty.nearness, empty.splat);
            }
        }
    }
}

/// Draws a splat, given with its place in the list of the tile.
#[inline(always)]
fn draw<const RAY_CAST: bool, const VORONOI: bool>(
    layers: &mut [Layer],
    touched: &mut [u64; 4],
    tile: &Tile,
    (index, splat): (u32, &Record),
    shared: &Shared<f32>,
    bins: Option<&DepthBins<f32>>,
) {
    let (rect, footprint) = (tile.rect, splat.footprint);
    let blocks = splat.blocks(&rect);
    for row in blocks.y0..blocks.y1 {
        let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
        for column in first..last {
            let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
            let (q, w) = fragments::<RAY_CAST>(shared, &footprint, x, y);
            let inside = inside(&q, &w, shared.limit);
            let block = (row * tile.columns + column) as usize;
            touched[block / 64] |= 1 << (block % 64);
            let layer = &mut layers[block];
            let mut wins = [0_u32; LANES];
            if VORONOI && let Some(bins) = bins {
                let (before, mut z) = (layer.z, [0.0; LANES]);
                for i in 0..LANES {
                    // NaN, which fails, outside.
                    z[i] = bins.voronoi(shared.depth(inside[i]), (q[i] / shared.limit).sqrt());
                }
                for i in 0..LANES {
                    wins[i] = u32::from(z[i] < before[i]).wrapping_neg();
                }
                keep(&mut layer.z, &wins, &z);
            } else {
                let before = layer.nearness;
                for i in 0..LANES {
                    wins[i] = u32::from(inside[i] > before[i]).wrapping_neg();
                }
            }
            keep(&mut layer.nearness, &wins, &w);
            keep(&mut layer.q, &wins, &q);
            keep(&mut layer.amplitude, &wins, &[footprint.amplitude; LANES]);
            let mut splat = layer.splat;
            for i in 0..LANES {
                splat[i] = (index & wins[i]) | (splat[i] & !wins[i]);
            }
            layer.splat = splat;
        }
    }
}

/// Replaces the lanes that a mask has.
#[inline(always)]
fn keep(lanes: &mut Lanes, mask: &[u32; LANES], values: &Lanes) {
    let mut kept = *lanes;
    for i in 0..LANES {
        // A select by a mask of integers: by a condition it would not always become a vector.
        let bits = (values[i].to_bits() & mask[i]) | (kept[i].to_bits() & !mask[i]);
        kept[i] = f32::from_bits(bits);
    }
    *lanes = kept;
}

/// Adds what a block has become to the images: a weight is computed once, for the fragment that is
/// kept.
#[inline(always)]
fn finish(images: &mut Images, block: usize, layer: &Layer) {
    let Layer { nearness, q, amplitude, splat, .. } = *layer;
    fold(&mut images.nearest[block], &nearness, &splat);
    let mut weight = [0.0; LANES];
    for i in 0..LANES {
        weight[i] = amplitude[i] * exp_f32_in_range(q[i] * -0.5);
    }
    let count = &mut images.counts[block];
    images.lists[block * images.ends.len() + *count] = images.images.len() as u32;
    *count += 1;
    images.images.push(Image { nearness, weight, splat });
}

/// The nearer of two fragments, ties to the lower splat.
#[inline(always)]
fn fold(nearest: &mut Nearest, nearness: &Lanes, splat: &[u32; LANES]) {
    let (mut best, mut own) = (nearest.nearness, nearest.splat);
    for i in 0..LANES {
        let equal = u32::from(nearness[i] == best[i]) & u32::from(splat[i] < own[i]);
        let mask = (u32::from(nearness[i] > best[i]) | equal).wrapping_neg();
        own[i] = (splat[i] & mask) | (own[i] & !mask);
    }
    for i in 0..LANES {
        best[i] = if nearness[i] > best[i] { nearness[i] } else { best[i] };
    }
    (nearest.nearness, nearest.splat) = (best, own);
}
