//! Blend discs that meet the rays of pixels into the blocks of a tile.

use super::blending::{Blocks, Limits, alphas, before};
use crate::frame::Rect;
use crate::method::fast::tile::SIDE;
use crate::method::gaussians::splats::GaussianSplat;
use crate::number::Real;
use crate::number::lanes::{LANES, Lanes, Mask, any, vectorized};
use crate::splat::ray_disc::{RayDisc, RayRules};
use multiversion::target::target_cfg_f;

vectorized!(
    /// Blends discs in their order.
    pub(super) fn blend(
        blocks: &mut Blocks,
        splats: &[(GaussianSplat<f32>, RayDisc<f32>)],
        rays: &RayRules<f32>,
        limits: &Limits,
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        blocks.each(
            splats,
            |(splat, _)| splat.bounds,
            |(splat, disc), block, opaque, corner| {
                let own = fragments::<FUSED>(splat, disc, rays, limits, corner, &block.alive);
                if let Some((alpha, takes, depth)) = own {
                    let takes = before(&takes, opaque, |i| depth[i]);
                    let (index, color) = (splat.index, splat.color);
                    block.add(limits, &alpha, &takes, |_| index, |_| color, |i| depth[i]);
                }
            },
        );
    }
);

/// The alphas of a disc in a block from this pixel on, the lanes among `of` that take them, and their
/// depths; none if no lane does.
#[inline(always)]
pub(super) fn fragments<const FUSED: bool>(
    splat: &GaussianSplat<f32>,
    disc: &RayDisc<f32>,
    rays: &RayRules<f32>,
    limits: &Limits,
    (x, y): (u32, u32),
    of: &Mask,
) -> Option<(Lanes, Mask, Lanes)> {
    let of = *of;
    let Rect { x0, y0, x1, y1 } = splat.bounds;
    let limit = limits.inside.at_most(splat.reach);
    let (mut power, mut depth, mut takes) = ([0.0; LANES], [0.0; LANES], [0_u32; LANES]);
    for i in 0..LANES {
        let (column, row) = (x + i as u32 % SIDE, y + i as u32 / SIDE);
        let own = disc.fragment(rays, (column, row));
        (power[i], depth[i]) = (0.5 * own.rho, own.depth);
        let inside = (power[i] >= 0.0)
            & (power[i] <= limit)
            & own.met
            & (column >= x0)
            & (column < x1)
            & (row >= y0)
            & (row < y1);
        takes[i] = if inside { of[i] } else { 0 };
    }
    if !any(&takes) {
        return None;
    }
    let (alpha, takes) = alphas::<FUSED>(splat, limits, &power, takes)?;
    Some((alpha, takes, depth))
}
