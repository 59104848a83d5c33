//! Compute the fragments of a block of pixels, compiled for every vector width.

use crate::method::fast::fragments::{fragments, inside};
use crate::method::fast::tile::Record;
use crate::number::elementary::exp_f32_in_range;
use crate::number::lanes::{Lanes, any, each, mask, vectorized};
use crate::splat::Shared;
use multiversion::target::target_cfg_f;

/// The fragments that no layer has taken yet.
#[derive(Default)]
pub(super) struct Fragments {
    /// One entry for each splat, ascending.
    pub(super) left: Vec<FragmentBlock>,
    /// Each entry's splat: its surfel, and its place in the list of the tile.
    pub(super) splats: Vec<[u32; 2]>,
}

/// The fragments of a splat.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct FragmentBlock {
    /// NaN, which fails every comparison, where the splat has no fragment, or no fragment any more.
    pub(super) nearness: Lanes,
    /// An arbitrary number where there never was a fragment.
    pub(super) weight: Lanes,
}

impl Fragments {
    /// Collects the fragments of these splats of a tile at the pixels of a block, whose first pixel
    /// is `corner`.
    pub(super) fn collect(
        &mut self,
        splats: &[Record],
        list: &[u32],
        corner: (u32, u32),
        shared: &Shared<f32>,
    ) {
        self.left.clear();
        self.splats.clear();
        if shared.ray_cast {
            collect::<true>(self, splats, list, corner, shared);
        } else {
            collect::<false>(self, splats, list, corner, shared);
        }
    }
}

vectorized!(
    fn collect<const RAY_CAST: bool>(
        found: &mut Fragments,
        splats: &[Record],
        list: &[u32],
        corner: (u32, u32),
        shared: &Shared<f32>,
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let shared = *shared;
        for &index in list {
            let splat = &splats[index as usize];
            let (q, w) = fragments::<RAY_CAST>(&shared, &splat.footprint, corner);
            let nearness = inside(&q, &w, shared.limit);
            if any(&mask(|i| !nearness[i].is_nan())) {
                let amplitude = splat.footprint.amplitude;
                let weight = each(|i| amplitude * exp_f32_in_range::<FUSED>(q[i] * -0.5));
                found.left.push(FragmentBlock { nearness, weight });
                found.splats.push([splat.surfel, index]);
            }
        }
    }
);
