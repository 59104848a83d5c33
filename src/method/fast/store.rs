//! Store the blocks of a tile in the rows of the framebuffer.

use super::tile::{BlockGrid, ROW, Tile};
use crate::frame::{FramebufferTile, NO_ID, TileMut};
use crate::method::clock::{Work, spend};
use crate::number::lanes::components;

/// Writes a tile without splats.
pub(crate) fn clear(pixels: &mut FramebufferTile<'_, f32>) {
    clear_plane(&mut pixels.depth, f32::INFINITY);
    clear_plane(&mut pixels.id, NO_ID);
    clear_plane(&mut pixels.weight, 0.0);
    for plane in [&mut pixels.normal, &mut pixels.color].into_iter().flatten() {
        clear_plane(plane, [0.0; 3]);
    }
}

/// Copies the blocks of a tile into the rows of the framebuffer.
pub(super) fn store(tile: &Tile, pixels: &mut FramebufferTile<'_, f32>) {
    let blocks = &tile.blocks;
    store_plane(blocks, &mut pixels.depth, |block, i| block.nearest[i]);
    store_plane(blocks, &mut pixels.id, |block, i| block.id[i]);
    store_plane(blocks, &mut pixels.weight, |block, i| block.weight[i]);
    if let Some(normal) = &mut pixels.normal {
        store_plane(blocks, normal, |block, i| components(&block.normal, i));
    }
    if let Some(color) = &mut pixels.color {
        store_plane(blocks, color, |block, i| components(&block.color, i));
    }
}

/// Writes one value into a tile of a plane.
#[inline(always)]
pub(crate) fn clear_plane<T: Copy>(plane: &mut TileMut<'_, T>, value: T) {
    spend(Work::Store);
    for row in plane.rows() {
        // A loop, because `fill` is compiled for a value that is not known there.
        for pixel in row {
            *pixel = value;
        }
    }
}

/// Copies the blocks of a tile into its rows of a plane; `pixel` returns the value of a lane.
#[inline(always)]
pub(crate) fn store_plane<B, T: Copy>(
    blocks: &[B],
    plane: &mut TileMut<'_, T>,
    pixel: impl Fn(&B, usize) -> T,
) {
    spend(Work::Store);
    let columns = BlockGrid::new(plane.rect).columns as usize;
    for (y, row) in plane.rows().enumerate() {
        let (blocks, first) = (&blocks[y / ROW * columns..][..columns], y % ROW * ROW);
        let (whole, rest) = row.as_chunks_mut::<ROW>();
        for (block, pixels) in blocks.iter().zip(whole.iter_mut()) {
            // Written out, because code that makes an array from a closure is not always inlined
            // into the loop.
            let at = |x| pixel(block, first + x);
            *pixels = [at(0), at(1), at(2), at(3)];
        }
        // The last block may be cut by the edge of the picture.
        if let Some(block) = blocks.get(whole.len()) {
            (0..).zip(rest).for_each(|(x, value)| *value = pixel(block, first + x));
        }
    }
}
