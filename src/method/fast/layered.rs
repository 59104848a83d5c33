//! Pictures of transparent layers: the planes that they have, and the blocks of a tile.

use super::store::{interleaved, row, store_row};
use super::tile::{BlockGrid, ROW};
use crate::frame::{Exec, Grid, NO_ID, Plane, Pool, Rect, TileMut};
use crate::number::lanes::{LANES, Lanes};

/// What the layers of the pixels of a block come to.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(in crate::method) struct LayeredBlock {
    /// Over black.
    pub(in crate::method) color: [Lanes; 3],
    pub(in crate::method) alpha: Lanes,
    /// Depth of the nearest fragment; +inf where there is none.
    pub(in crate::method) depth: Lanes,
    /// Its surfel; [`NO_ID`] where there is none.
    pub(in crate::method) id: [u32; LANES],
    /// How many layers.
    pub(in crate::method) layers: Lanes,
}

impl LayeredBlock {
    /// Nothing is seen.
    pub(in crate::method) const EMPTY: Self = Self {
        color: [[0.0; LANES]; 3],
        alpha: [0.0; LANES],
        depth: [f32::INFINITY; LANES],
        id: [NO_ID; LANES],
        layers: [0.0; LANES],
    };
}

/// The planes of a picture, before its environment.
pub(in crate::method) struct LayeredPlanes<L> {
    pub(in crate::method) color: Plane<[f32; 3]>,
    pub(in crate::method) alpha: Plane<f32>,
    pub(in crate::method) depth: Plane<f32>,
    pub(in crate::method) id: Plane<u32>,
    pub(in crate::method) layers: Plane<L>,
}

/// One tile of them, writable.
pub(in crate::method) struct LayeredTile<'a, L> {
    /// The pixels.
    pub(in crate::method) rect: Rect,
    color: TileMut<'a, [f32; 3]>,
    alpha: TileMut<'a, f32>,
    depth: TileMut<'a, f32>,
    id: TileMut<'a, u32>,
    layers: TileMut<'a, L>,
}

impl<L: Send> LayeredPlanes<L> {
    /// Planes in memory that is used again: the values are any.
    pub(in crate::method) fn new(size: [u32; 2], layers: Plane<L>, pool: &mut Pool) -> Self {
        Self {
            color: pool.triple(size),
            alpha: pool.scalar(size),
            depth: pool.scalar(size),
            id: pool.index(size),
            layers,
        }
    }

    /// The tiles, row by row.
    pub(in crate::method) fn tiles(&mut self, grid: &Grid, exec: &Exec) -> Vec<LayeredTile<'_, L>> {
        let color = tiles(&mut self.color, grid, exec).into_iter();
        let alpha = tiles(&mut self.alpha, grid, exec).into_iter();
        let depth = tiles(&mut self.depth, grid, exec).into_iter();
        let id = tiles(&mut self.id, grid, exec).into_iter();
        let layers = tiles(&mut self.layers, grid, exec).into_iter();
        let planes = grid.rects().into_iter().zip(color).zip(alpha).zip(depth).zip(id).zip(layers);
        planes
            .map(|(((((rect, color), alpha), depth), id), layers)| LayeredTile {
                rect,
                color,
                alpha,
                depth,
                id,
                layers,
            })
            .collect()
    }
}

/// The tiles of a plane, row by row.
pub(in crate::method) fn tiles<'a, T: Send>(
    plane: &'a mut Plane<T>,
    grid: &Grid,
    exec: &Exec,
) -> Vec<TileMut<'a, T>> {
    // A tile is many short rows: cutting them out is work enough to be shared.
    let bands = exec.ordered(grid.bands(plane).collect(), |band| grid.split(band));
    bands.into_iter().flatten().collect()
}

impl<L: Copy> LayeredTile<'_, L> {
    /// Writes a tile without splats.
    pub(in crate::method) fn clear(&mut self, none: L) {
        let rect = self.rect;
        clear_plane(rect, &mut self.color, [0.0; 3]);
        clear_plane(rect, &mut self.alpha, 0.0);
        clear_plane(rect, &mut self.depth, f32::INFINITY);
        clear_plane(rect, &mut self.id, NO_ID);
        clear_plane(rect, &mut self.layers, none);
    }

    /// Copies the blocks of a tile into its rows.
    pub(in crate::method) fn store(&mut self, blocks: &[LayeredBlock], layers: impl Fn(f32) -> L) {
        let rect = self.rect;
        store_plane(rect, blocks, &mut self.color, |block, i| interleaved(&block.color, i));
        store_plane(rect, blocks, &mut self.alpha, |block, i| row(&block.alpha, i));
        store_plane(rect, blocks, &mut self.depth, |block, i| row(&block.depth, i));
        store_plane(rect, blocks, &mut self.id, |block, i| row(&block.id, i));
        store_plane(rect, blocks, &mut self.layers, |block, i| row(&block.layers, i).map(&layers));
    }
}

/// Writes one value into a tile of a plane.
pub(in crate::method) fn clear_plane<T: Copy>(rect: Rect, plane: &mut TileMut<'_, T>, value: T) {
    (0..(rect.y1 - rect.y0) as usize).for_each(|y| plane.row(y).fill(value));
}

/// Copies the blocks of a tile into its rows of a plane; `part` gives the pixels of a block from a
/// lane on.
pub(in crate::method) fn store_plane<B, T: Copy>(
    rect: Rect,
    blocks: &[B],
    plane: &mut TileMut<'_, T>,
    part: impl Fn(&B, usize) -> [T; ROW],
) {
    let columns = BlockGrid::new(rect).columns as usize;
    for y in 0..(rect.y1 - rect.y0) as usize {
        let blocks = &blocks[y / ROW * columns..][..columns];
        store_row(blocks, plane.row(y), |block| part(block, y % ROW * ROW));
    }
}
