//! The geometry passes over one tile, each compiled for every vector width.

use crate::method::fast::lanes::{add, columns, fragments, inside};
use crate::method::fast::tile::{LANES, Lanes, SIDE, Tile};
use crate::number::elementary::exp_f32_in_range;
use crate::splat::{Footprint, Shared};
use multiversion::multiversion;

impl Tile {
    /// Visibility splatting.
    pub(super) fn visibility(&mut self, shared: &Shared<f32>) {
        if shared.ray_cast {
            visibility::<true>(self, shared);
        } else {
            visibility::<false>(self, shared);
        }
    }

    /// Attribute splatting.
    pub(super) fn attributes(&mut self, shared: &Shared<f32>) {
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

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn visibility<const RAY_CAST: bool>(tile: &mut Tile, shared: &Shared<f32>) {
    let (shared, rect) = (*shared, tile.rect);
    for splat in &tile.splats {
        let (footprint, surfel) = (splat.footprint, splat.surfel);
        let blocks = splat.blocks(&rect);
        for row in blocks.y0..blocks.y1 {
            let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
            for column in first..last {
                let block = &mut tile.blocks[(row * tile.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let inside = inside(&q, &w, shared.limit);
                let (before, mut id) = (block.nearest, block.id);
                let mut nearest = before;
                for i in 0..LANES {
                    nearest[i] = if inside[i] > before[i] { inside[i] } else { before[i] };
                }
                for i in 0..LANES {
                    // A select of integers by a comparison of floats would not become a vector.
                    let mask = u32::from(inside[i] > before[i]).wrapping_neg();
                    id[i] = (surfel & mask) | (id[i] & !mask);
                }
                (block.nearest, block.id) = (nearest, id);
            }
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn attributes<const RAY_CAST: bool, const NORMAL: bool, const COLOR: bool>(
    tile: &mut Tile,
    shared: &Shared<f32>,
) {
    let (shared, rect) = (*shared, tile.rect);
    for splat in &tile.splats {
        let (footprint, normal, color) = (splat.footprint, splat.normal, splat.color);
        let blocks = splat.blocks(&rect);
        for row in blocks.y0..blocks.y1 {
            let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
            for column in first..last {
                let block = &mut tile.blocks[(row * tile.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let Some(weight) = weights(&q, &w, &block.least, shared.limit, &footprint) else {
                    continue;
                };
                add(&mut block.weight, &weight, 1.0);
                if NORMAL {
                    for (sum, value) in block.normal.iter_mut().zip(normal) {
                        add(sum, &weight, value);
                    }
                }
                if COLOR {
                    for (sum, value) in block.color.iter_mut().zip(color) {
                        add(sum, &weight, value);
                    }
                }
            }
        }
    }
}

/// The weights of the fragments that are inside and visible, 0 for the others; none if all are.
#[inline(always)]
fn weights(
    q: &Lanes,
    w: &Lanes,
    least: &Lanes,
    limit: f32,
    footprint: &Footprint<f32>,
) -> Option<Lanes> {
    let inside = inside(q, w, limit);
    let mut hit = [0_u32; LANES];
    for i in 0..LANES {
        hit[i] = u32::from(inside[i] >= least[i]);
    }
    if hit.iter().all(|&h| h == 0) {
        return None;
    }
    let mut weight = [0.0; LANES];
    for i in 0..LANES {
        // q of a fragment that counts is in [0, 16]; the others may give any number.
        let value = footprint.amplitude * exp_f32_in_range(q[i] * -0.5);
        weight[i] = if hit[i] != 0 { value } else { 0.0 };
    }
    Some(weight)
}
