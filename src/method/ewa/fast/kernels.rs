//! Run the geometry passes over one tile, compiled for every vector width.

use crate::method::clock::{Work, spend};
use crate::method::fast::fragments::{add, each_block, inside};
use crate::method::fast::tile::Tile;
use crate::number::elementary::exp_f32_in_range;
use crate::number::lanes::{LANES, Lanes, any, each, mask, select, select_u32, vectorized};
use crate::splat::{Footprint, Shared};
use multiversion::target::target_cfg_f;

impl Tile {
    /// Visibility splatting.
    pub(crate) fn visibility(&mut self, shared: &Shared<f32>) {
        spend(Work::Visibility);
        if shared.ray_cast {
            visibility::<true, false>(self, shared);
        } else {
            visibility::<false, false>(self, shared);
        }
    }

    /// Visibility splatting over the result of another pass; if fragments are equally near, the
    /// lower surfel stays.
    pub(crate) fn visibility_over(&mut self, shared: &Shared<f32>) {
        spend(Work::Visibility);
        if shared.ray_cast {
            visibility::<true, true>(self, shared);
        } else {
            visibility::<false, true>(self, shared);
        }
    }

    /// Attribute splatting.
    pub(crate) fn attributes(&mut self, shared: &Shared<f32>) {
        spend(Work::Attributes);
        match (shared.ray_cast, self.normal, self.color) {
            (false, false, false) => attributes::<false, false, false>(self, shared),
            (false, false, true) => attributes::<false, false, true>(self, shared),
            (false, true, false) => attributes::<false, true, false>(self, shared),
            (false, true, true) => attributes::<false, true, true>(self, shared),
            (true, false, false) => attributes::<true, false, false>(self, shared),
            (true, false, true) => attributes::<true, false, true>(self, shared),
            (true, true, false) => attributes::<true, true, false>(self, shared),
            (true, true, true) => attributes::<true, true, true>(self, shared),
        }
    }
}

vectorized!(
    fn visibility<const RAY_CAST: bool, const OVER: bool>(tile: &mut Tile, shared: &Shared<f32>) {
        let shared = *shared;
        for splat in &tile.splats {
            each_block::<RAY_CAST>(splat, &tile.grid, &shared, |block, q, w| {
                let block = &mut tile.blocks[block];
                let inside = inside(q, w, shared.limit);
                let nearer = mask(|i| {
                    let lower = OVER & (splat.surfel < block.id[i]);
                    (inside[i] > block.nearest[i]) | (lower & (inside[i] >= block.nearest[i]))
                });
                block.nearest = select(&nearer, &inside, &block.nearest);
                block.id = select_u32(&nearer, &[splat.surfel; LANES], &block.id);
            });
        }
    }
);

vectorized!(
    fn attributes<const RAY_CAST: bool, const NORMAL: bool, const COLOR: bool>(
        tile: &mut Tile,
        shared: &Shared<f32>,
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let shared = *shared;
        for splat in &tile.splats {
            let footprint = &splat.footprint;
            each_block::<RAY_CAST>(splat, &tile.grid, &shared, |block, q, w| {
                let block = &mut tile.blocks[block];
                let weight = weights::<FUSED>(q, w, &block.least, shared.limit, footprint);
                let Some(weight) = weight else { return };
                add(&mut block.weight, &weight, 1.0);
                if NORMAL {
                    for (sum, value) in block.normal.iter_mut().zip(splat.attributes.normal) {
                        add(sum, &weight, value);
                    }
                }
                if COLOR {
                    for (sum, value) in block.color.iter_mut().zip(splat.attributes.color) {
                        add(sum, &weight, value);
                    }
                }
            });
        }
    }
);

/// The weights of the fragments that are inside and visible, 0 for the others; none if no fragment
/// is.
#[inline(always)]
fn weights<const FUSED: bool>(
    q: &Lanes,
    w: &Lanes,
    least: &Lanes,
    limit: f32,
    footprint: &Footprint<f32>,
) -> Option<Lanes> {
    let inside = inside(q, w, limit);
    let visible = mask(|i| inside[i] >= least[i]);
    if !any(&visible) {
        return None;
    }
    // q of a fragment that counts is in [0, 16]; the result for other fragments is arbitrary.
    let weight = each(|i| footprint.amplitude * exp_f32_in_range::<FUSED>(q[i] * -0.5));
    Some(select(&visible, &weight, &[0.0; LANES]))
}
