//! From the blocks of a tile to the rows of the framebuffer.

use super::tile::{ROW, Tile};
use crate::frame::{FramebufferTile, NO_ID};
use crate::number::lanes::{LANES, Lanes};

/// Writes a tile without splats.
pub(super) fn clear(tile: &mut FramebufferTile<'_, f32>) {
    for y in 0..(tile.rect.y1 - tile.rect.y0) as usize {
        tile.depth.row(y).fill(f32::INFINITY);
        tile.id.row(y).fill(NO_ID);
        tile.weight.row(y).fill(0.0);
        for plane in [&mut tile.normal, &mut tile.color].into_iter().flatten() {
            plane.row(y).fill([0.0; 3]);
        }
    }
}

/// Copies the blocks into the rows of the framebuffer.
pub(super) fn store(tile: &Tile, pixels: &mut FramebufferTile<'_, f32>) {
    let columns = tile.grid.columns as usize;
    for y in 0..(pixels.rect.y1 - pixels.rect.y0) as usize {
        let blocks = &tile.blocks[y / ROW * columns..][..columns];
        let first = y % ROW * ROW;
        store_row(blocks, pixels.depth.row(y), |block| row(&block.nearest, first));
        store_row(blocks, pixels.id.row(y), |block| row(&block.id, first));
        store_row(blocks, pixels.weight.row(y), |block| row(&block.weight, first));
        if let Some(normal) = &mut pixels.normal {
            store_row(blocks, normal.row(y), |block| interleaved(&block.normal, first));
        }
        if let Some(color) = &mut pixels.color {
            store_row(blocks, color.row(y), |block| interleaved(&block.color, first));
        }
    }
}

/// Copies one row of pixels, a block at a time; the last may be cut by the edge of the picture.
#[inline(always)]
pub(super) fn store_row<B, T: Copy>(blocks: &[B], pixels: &mut [T], row: impl Fn(&B) -> [T; ROW]) {
    let (whole, rest) = pixels.as_chunks_mut::<ROW>();
    for (block, pixels) in blocks.iter().zip(whole.iter_mut()) {
        *pixels = row(block);
    }
    if let Some(block) = blocks.get(whole.len()) {
        rest.copy_from_slice(&row(block)[..rest.len()]);
    }
}

/// The row of a block that starts at a lane.
#[inline(always)]
pub(in crate::method) fn row<T: Copy>(lanes: &[T; LANES], first: usize) -> [T; ROW] {
    std::array::from_fn(|x| lanes[first + x])
}

/// The row of three components that starts at a lane.
#[inline(always)]
pub(in crate::method) fn interleaved(components: &[Lanes; 3], first: usize) -> [[f32; 3]; ROW] {
    let [a, b, c] = components.each_ref().map(|lanes| row(lanes, first));
    std::array::from_fn(|x| [a[x], b[x], c[x]])
}
