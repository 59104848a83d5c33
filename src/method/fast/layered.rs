//! Hold pictures of transparent layers: their planes, and the blocks of a tile.

use super::store::{clear_plane, store_plane};
use crate::frame::{Exec, Grid, NO_ID, Plane, Pool, TileMut};
use crate::number::lanes::{LANES, Lanes, components};

/// The blended layers of a block's pixels.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct LayeredBlock {
    /// The colour over black.
    pub(crate) color: [Lanes; 3],
    pub(crate) alpha: Lanes,
    /// Depth of the nearest fragment; +inf where there is none.
    pub(crate) depth: Lanes,
    /// Surfel of that fragment; [`NO_ID`] where there is none.
    pub(crate) id: [u32; LANES],
    /// The count of layers.
    pub(crate) layers: Lanes,
}

impl LayeredBlock {
    /// Nothing is seen.
    pub(crate) const EMPTY: Self = Self {
        color: [[0.0; LANES]; 3],
        alpha: [0.0; LANES],
        depth: [f32::INFINITY; LANES],
        id: [NO_ID; LANES],
        layers: [0.0; LANES],
    };
}

/// The planes of a picture, before its environment.
pub(crate) struct LayeredPlanes<L> {
    pub(crate) color: Plane<[f32; 3]>,
    pub(crate) alpha: Plane<f32>,
    pub(crate) depth: Plane<f32>,
    pub(crate) id: Plane<u32>,
    pub(crate) layers: Plane<L>,
}

/// One tile of the planes, writable.
pub(crate) struct LayeredTile<'a, L> {
    color: TileMut<'a, [f32; 3]>,
    alpha: TileMut<'a, f32>,
    pub(crate) depth: TileMut<'a, f32>,
    id: TileMut<'a, u32>,
    layers: TileMut<'a, L>,
}

impl<L: Send> LayeredPlanes<L> {
    /// Planes in memory that is used again; their values are arbitrary.
    pub(crate) fn new(size: [u32; 2], layers: Plane<L>, pool: &mut Pool) -> Self {
        Self {
            color: pool.triple(size),
            alpha: pool.scalar(size),
            depth: pool.scalar(size),
            id: pool.index(size),
            layers,
        }
    }

    /// The tiles, row by row.
    pub(crate) fn cut(&mut self, grid: &Grid, exec: &Exec) -> Vec<LayeredTile<'_, L>> {
        let color = grid.cut(&mut self.color, exec).into_iter();
        let alpha = grid.cut(&mut self.alpha, exec);
        let depth = grid.cut(&mut self.depth, exec);
        let id = grid.cut(&mut self.id, exec);
        let layers = grid.cut(&mut self.layers, exec);
        let planes = color.zip(alpha).zip(depth).zip(id).zip(layers);
        planes
            .map(|((((color, alpha), depth), id), layers)| LayeredTile {
                color,
                alpha,
                depth,
                id,
                layers,
            })
            .collect()
    }
}

impl<L: Copy> LayeredTile<'_, L> {
    /// Writes a tile without splats.
    pub(crate) fn clear(&mut self, none: L) {
        clear_plane(&mut self.color, [0.0; 3]);
        clear_plane(&mut self.alpha, 0.0);
        clear_plane(&mut self.depth, f32::INFINITY);
        clear_plane(&mut self.id, NO_ID);
        clear_plane(&mut self.layers, none);
    }

    /// Copies the blocks of a tile into its rows.
    pub(crate) fn store(&mut self, blocks: &[LayeredBlock], layers: impl Fn(f32) -> L) {
        store_plane(blocks, &mut self.color, |block, i| components(&block.color, i));
        store_plane(blocks, &mut self.alpha, |block, i| block.alpha[i]);
        store_plane(blocks, &mut self.depth, |block, i| block.depth[i]);
        store_plane(blocks, &mut self.id, |block, i| block.id[i]);
        store_plane(blocks, &mut self.layers, |block, i| layers(block.layers[i]));
    }
}
