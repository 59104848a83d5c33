//! From the blocks of a tile to the rows of the framebuffer.

use super::tile::{BlockGrid, ROW, Tile};
use crate::frame::{FramebufferStrip, NO_ID, Rect, StripMut};
use crate::number::lanes::{LANES, Lanes};

/// Writes a tile without splats.
pub(in crate::method) fn clear(rect: &Rect, pixels: &mut FramebufferStrip<'_, f32>) {
    clear_plane(rect, &mut pixels.depth, f32::INFINITY);
    clear_plane(rect, &mut pixels.id, NO_ID);
    clear_plane(rect, &mut pixels.weight, 0.0);
    for plane in [&mut pixels.normal, &mut pixels.color].into_iter().flatten() {
        clear_plane(rect, plane, [0.0; 3]);
    }
}

/// Copies the blocks of a tile into the rows of the framebuffer.
pub(super) fn store(tile: &Tile, pixels: &mut FramebufferStrip<'_, f32>) {
    let (rect, blocks) = (&tile.grid.rect, &tile.blocks);
    store_plane(rect, blocks, &mut pixels.depth, |block, i| row(&block.nearest, i));
    store_plane(rect, blocks, &mut pixels.id, |block, i| row(&block.id, i));
    store_plane(rect, blocks, &mut pixels.weight, |block, i| row(&block.weight, i));
    if let Some(normal) = &mut pixels.normal {
        store_plane(rect, blocks, normal, |block, i| interleaved(&block.normal, i));
    }
    if let Some(color) = &mut pixels.color {
        store_plane(rect, blocks, color, |block, i| interleaved(&block.color, i));
    }
}

/// Writes one value into a tile of a plane.
pub(in crate::method) fn clear_plane<T: Copy>(rect: &Rect, plane: &mut StripMut<'_, T>, value: T) {
    (0..rect.rows()).for_each(|y| plane.row(rect, y).fill(value));
}

/// Copies the blocks of a tile into its rows of a plane; `part` gives the pixels of a block from a
/// lane on.
#[inline(always)]
pub(in crate::method) fn store_plane<B, T: Copy>(
    rect: &Rect,
    blocks: &[B],
    plane: &mut StripMut<'_, T>,
    part: impl Fn(&B, usize) -> [T; ROW],
) {
    let columns = BlockGrid::new(*rect).columns as usize;
    for y in 0..rect.rows() {
        let blocks = &blocks[y / ROW * columns..][..columns];
        store_row(blocks, plane.row(rect, y), |block| part(block, y % ROW * ROW));
    }
}

/// Copies one row of pixels, a block at a time; the last may be cut by the edge of the picture.
#[inline(always)]
fn store_row<B, T: Copy>(blocks: &[B], pixels: &mut [T], row: impl Fn(&B) -> [T; ROW]) {
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
