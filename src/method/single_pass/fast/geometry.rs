//! Run the geometry pass over one tile, compiled for every vector width.

use super::images::{GroupImages, ImageBlock, NearestFragments};
use crate::composite::bins::DepthBins;
use crate::method::clock::{Work, spend};
use crate::method::fast::fragments::{each_block, inside};
use crate::method::fast::tile::{Record, Tile};
use crate::number::elementary::exp_f32_in_range;
use crate::number::lanes::{LANES, Lanes, each, mask, select, select_u32, vectorized};
use crate::splat::Shared;
use multiversion::target::target_cfg_f;

/// The fragments that the image of the present group keeps at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct KeptFragments {
    /// Voronoi-enhanced depth; not used under the plain depth test.
    z: Lanes,
    nearness: Lanes,
    q: Lanes,
    amplitude: Lanes,
    /// As in [`ImageBlock`].
    splat: [u32; LANES],
}

impl GroupImages {
    /// Draws every splat into the image of its group, with the plain depth test if there are no
    /// bins.
    pub(crate) fn draw(
        &mut self,
        tile: &Tile,
        shared: &Shared<f32>,
        bins: Option<&DepthBins<f32>>,
    ) {
        spend(Work::Images);
        match (shared.ray_cast, bins) {
            (false, None) => geometry::<false, false>(self, tile, shared, bins),
            (false, Some(_)) => geometry::<false, true>(self, tile, shared, bins),
            (true, None) => geometry::<true, false>(self, tile, shared, bins),
            (true, Some(_)) => geometry::<true, true>(self, tile, shared, bins),
        }
    }
}

vectorized!(
    /// Draws one group after the other in the same blocks, which stay in the nearest cache.
    fn geometry<const RAY_CAST: bool, const VORONOI: bool>(
        images: &mut GroupImages,
        tile: &Tile,
        shared: &Shared<f32>,
        bins: Option<&DepthBins<f32>>,
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let shared = *shared;
        let empty = KeptFragments {
            z: [f32::INFINITY; LANES],
            nearness: [shared.empty(); LANES],
            q: [0.0; LANES],
            amplitude: [0.0; LANES],
            splat: [tile.splats.len() as u32; LANES],
        };
        let mut kept = vec![empty; tile.blocks.len()];
        let mut start = 0;
        for group in 0..images.ends.len() {
            let end = images.ends[group];
            // -- The splats of the group
            // One bit for each block: a tile has at most 16 x 16.
            let mut touched = [0_u64; 4];
            for &index in &images.order[start..end] {
                let splat = &tile.splats[index as usize];
                each_block::<RAY_CAST>(splat, &tile.grid, &shared, |block, q, w| {
                    touched[block / 64] |= 1 << (block % 64);
                    kept[block].meet::<VORONOI>(index, splat, q, w, &shared, bins);
                });
            }
            start = end;
            // -- The blocks that the group has touched
            for (word, mut bits) in touched.into_iter().enumerate() {
                while bits != 0 {
                    let block = 64 * word + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let kept = &mut kept[block];
                    finish::<FUSED>(images, block, kept);
                    // Empty again; the other numbers are read only where there is a splat.
                    if VORONOI {
                        kept.z = empty.z;
                    }
                    (kept.nearness, kept.splat) = (empty.nearness, empty.splat);
                }
            }
        }
    }
);

impl KeptFragments {
    /// The depth test against the fragments of a splat; `index` is its place in the list of the
    /// tile.
    #[inline(always)]
    fn meet<const VORONOI: bool>(
        &mut self,
        index: u32,
        splat: &Record,
        q: &Lanes,
        w: &Lanes,
        shared: &Shared<f32>,
        bins: Option<&DepthBins<f32>>,
    ) {
        let inside = inside(q, w, shared.limit);
        let wins = if VORONOI && let Some(bins) = bins {
            let mut z = [0.0; LANES];
            for i in 0..LANES {
                // NaN outside, which fails.
                z[i] = bins.voronoi(shared.depth(inside[i]), (q[i] / shared.limit).sqrt());
            }
            let wins = mask(|i| z[i] < self.z[i]);
            self.z = select(&wins, &z, &self.z);
            wins
        } else {
            mask(|i| inside[i] > self.nearness[i])
        };
        self.nearness = select(&wins, w, &self.nearness);
        self.q = select(&wins, q, &self.q);
        self.amplitude = select(&wins, &[splat.footprint.amplitude; LANES], &self.amplitude);
        self.splat = select_u32(&wins, &[index; LANES], &self.splat);
    }
}

/// Adds the finished block of a group to the images. A weight is computed once, for the fragment
/// that is kept.
#[inline(always)]
fn finish<const FUSED: bool>(images: &mut GroupImages, block: usize, kept: &KeptFragments) {
    let KeptFragments { nearness, q, amplitude, splat, .. } = *kept;
    fold(&mut images.nearest[block], &nearness, &splat);
    let weight = each(|i| amplitude[i] * exp_f32_in_range::<FUSED>(q[i] * -0.5));
    let count = &mut images.counts[block];
    images.lists[block * images.ends.len() + *count] = images.images.len() as u32;
    *count += 1;
    images.images.push(ImageBlock { nearness, weight, splat });
}

/// The nearer of two fragments, ties to the lower splat.
#[inline(always)]
fn fold(nearest: &mut NearestFragments, nearness: &Lanes, splat: &[u32; LANES]) {
    let before = *nearest;
    let wins = mask(|i| {
        let equal = (nearness[i] == before.nearness[i]) & (splat[i] < before.splat[i]);
        (nearness[i] > before.nearness[i]) | equal
    });
    nearest.splat = select_u32(&wins, splat, &before.splat);
    let nearer = |i: usize| nearness[i] > before.nearness[i];
    nearest.nearness = each(|i| if nearer(i) { nearness[i] } else { before.nearness[i] });
}
