//! The geometry pass over one tile, compiled for every vector width.

use super::images::{Image, Images};
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
    splat: [u32; LANES],
}

impl Images {
    /// Draws every splat into the image of its group; the plain depth test if there are no bins.
    pub(super) fn draw(
        &mut self,
        tile: &mut Tile,
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

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn geometry<const RAY_CAST: bool, const VORONOI: bool>(
    images: &mut Images,
    tile: &mut Tile,
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
    let mut nearest = vec![empty; tile.blocks.len()];
    let mut layers = vec![empty; tile.blocks.len()];
    let mut start = 0;
    for (slots, &end) in images.slots.chunks_mut(tile.blocks.len()).zip(&images.ends) {
        for &index in &images.order[start..end] {
            let splat = &tile.splats[index as usize];
            splat_into::<RAY_CAST, VORONOI>(&mut layers, tile, (index, splat), &shared, bins);
        }
        start = end;
        for ((layer, slot), nearest) in layers.iter_mut().zip(slots).zip(&mut nearest) {
            let Layer { nearness, q, amplitude, splat, .. } = *layer;
            let mut kept = [0_u32; LANES];
            for i in 0..LANES {
                kept[i] = u32::from(splat[i] != empty.splat[i]);
            }
            if kept.iter().all(|&k| k == 0) {
                continue;
            }
            *layer = empty;
            fold(nearest, &nearness, &splat);
            let mut weight = [0.0; LANES];
            for i in 0..LANES {
                weight[i] = amplitude[i] * exp_f32_in_range(q[i] * -0.5);
            }
            *slot = images.images.len() as u32;
            images.images.push(Image { nearness, weight, splat });
        }
    }
    for (block, nearest) in tile.blocks.iter_mut().zip(&nearest) {
        block.nearest = nearest.nearness;
        block.id = nearest.splat;
    }
}

/// Draws one splat.
#[inline(always)]
fn splat_into<const RAY_CAST: bool, const VORONOI: bool>(
    layers: &mut [Layer],
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
            let layer = &mut layers[(row * tile.columns + column) as usize];
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
        // A select by a mask of integers: by a condition it would not become a vector.
        let bits = (values[i].to_bits() & mask[i]) | (kept[i].to_bits() & !mask[i]);
        kept[i] = f32::from_bits(bits);
    }
    *lanes = kept;
}

/// The nearer of two fragments, ties to the lower surfel.
#[inline(always)]
fn fold(nearest: &mut Layer, nearness: &Lanes, splat: &[u32; LANES]) {
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
