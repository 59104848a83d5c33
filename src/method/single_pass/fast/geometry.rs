//! The geometry pass over one tile, compiled for every vector width.

use super::images::{Image, Images, NONE};
use crate::composite::bins::DepthBins;
use crate::method::fast::lanes::{columns, fragments, inside};
use crate::method::fast::tile::{LANES, SIDE, Tile};
use crate::splat::Shared;
use multiversion::multiversion;

impl Images {
    /// Draws every splat into the image of its group; the plain depth test if there are no bins.
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

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn geometry<const RAY_CAST: bool, const VORONOI: bool>(
    images: &mut Images,
    tile: &Tile,
    shared: &Shared<f32>,
    bins: Option<&DepthBins<f32>>,
) {
    let Images { order, ends, slots, images } = images;
    let (shared, rect) = (*shared, tile.rect);
    let empty = Image {
        nearness: [shared.empty(); LANES],
        q: [0.0; LANES],
        splat: [NONE; LANES],
        z: [f32::INFINITY; LANES],
    };
    let mut start = 0;
    for (slots, &end) in slots.chunks_mut(tile.blocks.len()).zip(ends.iter()) {
        for &index in &order[start..end] {
            let splat = &tile.splats[index as usize];
            let footprint = splat.footprint;
            let blocks = splat.blocks(&rect);
            for row in blocks.y0..blocks.y1 {
                let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
                for column in first..last {
                    let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                    let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                    let inside = inside(&q, &w, shared.limit);
                    let slot = &mut slots[(row * tile.columns + column) as usize];
                    if *slot == NONE {
                        *slot = images.len() as u32;
                        images.push(empty);
                    }
                    let image = &mut images[*slot as usize];
                    let before = *image;
                    let mut wins = [0_u32; LANES];
                    if VORONOI && let Some(bins) = bins {
                        let mut z = [0.0; LANES];
                        for i in 0..LANES {
                            // NaN, which fails, outside.
                            z[i] = bins.voronoi(shared.depth(inside[i]), (q[i] / shared.limit).sqrt());
                        }
                        for i in 0..LANES {
                            wins[i] = u32::from(z[i] < before.z[i]).wrapping_neg();
                            image.z[i] = if z[i] < before.z[i] { z[i] } else { before.z[i] };
                        }
                    } else {
                        for i in 0..LANES {
                            wins[i] = u32::from(inside[i] > before.nearness[i]).wrapping_neg();
                        }
                    }
                    let mut after = before;
                    for i in 0..LANES {
                        after.nearness[i] = if wins[i] != 0 { inside[i] } else { before.nearness[i] };
                        after.q[i] = if wins[i] != 0 { q[i] } else { before.q[i] };
                    }
                    for i in 0..LANES {
                        after.splat[i] = (index & wins[i]) | (before.splat[i] & !wins[i]);
                    }
                    (image.nearness, image.q, image.splat) = (after.nearness, after.q, after.splat);
                }
            }
        }
        start = end;
    }
}
