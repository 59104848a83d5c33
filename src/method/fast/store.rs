//! From the blocks of a tile to the rows of the framebuffer.

use super::tile::{BlockGrid, PixelBlock, ROW, Tile};
use crate::frame::{FramebufferStrip, NO_ID, Rect};
use crate::number::lanes::{LANES, Lanes};
use std::ops::Range;

/// Writes a tile without splats.
pub(super) fn clear(rect: &Rect, pixels: &mut FramebufferStrip<'_, f32>) {
    let columns = columns(rect, pixels);
    for y in 0..(rect.y1 - rect.y0) as usize {
        pixels.depth.row(y)[columns.clone()].fill(f32::INFINITY);
        pixels.id.row(y)[columns.clone()].fill(NO_ID);
        pixels.weight.row(y)[columns.clone()].fill(0.0);
        for plane in [&mut pixels.normal, &mut pixels.color].into_iter().flatten() {
            plane.row(y)[columns.clone()].fill([0.0; 3]);
        }
    }
}

/// Copies the blocks of a tile into the rows of the framebuffer.
pub(super) fn store(tile: &Tile, pixels: &mut FramebufferStrip<'_, f32>) {
    let BlockGrid { rect, columns: wide } = tile.grid;
    let columns = columns(&rect, pixels);
    for y in 0..(rect.y1 - rect.y0) as usize {
        let blocks = &tile.blocks[y / ROW * wide as usize..][..wide as usize];
        let (first, columns) = (y % ROW * ROW, columns.clone());
        let to = &mut pixels.depth.row(y)[columns.clone()];
        store_row(blocks, to, |block| row(&block.nearest, first));
        let to = &mut pixels.id.row(y)[columns.clone()];
        store_row(blocks, to, |block| row(&block.id, first));
        let to = &mut pixels.weight.row(y)[columns.clone()];
        store_row(blocks, to, |block| row(&block.weight, first));
        if let Some(normal) = &mut pixels.normal {
            let to = &mut normal.row(y)[columns.clone()];
            store_row(blocks, to, |block| interleaved(&block.normal, first));
        }
        if let Some(color) = &mut pixels.color {
            let to = &mut color.row(y)[columns];
            store_row(blocks, to, |block| interleaved(&block.color, first));
        }
    }
}

/// Where the rows of a tile are in those of its strip.
fn columns(tile: &Rect, pixels: &FramebufferStrip<'_, f32>) -> Range<usize> {
    let left = pixels.strip.rect.x0;
    (tile.x0 - left) as usize..(tile.x1 - left) as usize
}

/// Copies one row of pixels, a block at a time; the last may be cut by the edge of the picture.
#[inline(always)]
fn store_row<T: Copy>(
    blocks: &[PixelBlock],
    pixels: &mut [T],
    row: impl Fn(&PixelBlock) -> [T; ROW],
) {
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
fn row<T: Copy>(lanes: &[T; LANES], first: usize) -> [T; ROW] {
    std::array::from_fn(|x| lanes[first + x])
}

/// The row of three components that starts at a lane.
#[inline(always)]
fn interleaved(components: &[Lanes; 3], first: usize) -> [[f32; 3]; ROW] {
    let [a, b, c] = components.each_ref().map(|lanes| row(lanes, first));
    std::array::from_fn(|x| [a[x], b[x], c[x]])
}
