//! What a fast path works with: records of splats, and the blocks of a tile.

use super::fragments::touches;
use crate::frame::{FramebufferStrip, NO_ID, Rect};
use crate::method::fragment::facing;
use crate::method::prepare::Prepared;
use crate::number::lanes::{LANES, Lanes};
use crate::splat::{Footprint, Splat};
use glam::Vec3;

/// Side of a block in pixels.
pub(in crate::method) const SIDE: u32 = 4;
/// Pixels of a row of a block.
pub(in crate::method) const ROW: usize = SIDE as usize;
const _: () = assert!(ROW * ROW == LANES, "a lane is a pixel of a block");

/// The pixels of a block, row by row.
#[derive(Clone)]
#[repr(align(64))]
pub(in crate::method) struct PixelBlock {
    /// Nearness of the nearest fragment.
    pub(in crate::method) nearest: Lanes,
    /// Its surfel.
    pub(in crate::method) id: [u32; LANES],
    /// The least nearness that passes the epsilon-z test.
    pub(in crate::method) least: Lanes,
    pub(in crate::method) weight: Lanes,
    pub(in crate::method) normal: [Lanes; 3],
    pub(in crate::method) color: [Lanes; 3],
}

/// A splat with its attributes: 80 bytes, so that a tile finds all it needs in one place.
#[derive(Clone, Copy)]
pub(in crate::method) struct Record {
    pub(in crate::method) footprint: Footprint<f32>,
    pub(in crate::method) surfel: u32,
    /// First and last column, first and last row.
    pub(in crate::method) bounds: [u16; 4],
    /// The normal of the side that is seen.
    pub(in crate::method) normal: [f32; 3],
    pub(in crate::method) color: [f32; 3],
}

impl Record {
    #[inline(always)]
    pub(in crate::method) fn new(
        splat: &Splat<f32>,
        normals: &[Vec3],
        colors: Option<&[Vec3]>,
    ) -> Self {
        let Rect { x0, y0, x1, y1 } = splat.bounds;
        let i = splat.surfel as usize;
        Self {
            footprint: splat.footprint,
            surfel: splat.surfel,
            // Pictures have at most 65,536 pixels a side, so the last pixel fits.
            bounds: [x0, x1 - 1, y0, y1 - 1].map(|pixel| pixel as u16),
            normal: facing(normals[i].to_array(), splat.back),
            color: colors.map_or([0.0; 3], |c| c[i].to_array()),
        }
    }

    pub(in crate::method) fn bounds(&self) -> Rect {
        let [x0, x1, y0, y1] = self.bounds.map(u32::from);
        Rect { x0, y0, x1: x1 + 1, y1: y1 + 1 }
    }

    /// The blocks of a tile that it may touch: columns and rows, the ends exclusive.
    #[inline(always)]
    pub(in crate::method) fn blocks(&self, tile: &Rect) -> Rect {
        let inside = self.bounds().intersection(tile);
        if inside.is_empty() {
            return Rect::default();
        }
        Rect {
            x0: (inside.x0 - tile.x0) / SIDE,
            y0: (inside.y0 - tile.y0) / SIDE,
            x1: (inside.x1 - tile.x0).div_ceil(SIDE),
            y1: (inside.y1 - tile.y0).div_ceil(SIDE),
        }
    }
}

/// Where the blocks of a tile are.
#[derive(Clone, Copy)]
pub(in crate::method) struct BlockGrid {
    /// The pixels of the tile.
    pub(in crate::method) rect: Rect,
    /// Blocks in a row.
    pub(in crate::method) columns: u32,
}

/// What one tile works with.
pub(in crate::method) struct Tile {
    pub(in crate::method) splats: Vec<Record>,
    pub(in crate::method) blocks: Vec<PixelBlock>,
    pub(in crate::method) grid: BlockGrid,
    /// Whether normals are wanted.
    pub(in crate::method) normal: bool,
    /// Whether colours are wanted.
    pub(in crate::method) color: bool,
}

impl Tile {
    /// The memory that the tiles of a strip use one after the other.
    pub(in crate::method) fn new(pixels: &FramebufferStrip<'_, f32>) -> Self {
        Self {
            splats: Vec::new(),
            blocks: Vec::new(),
            grid: BlockGrid { rect: Rect::default(), columns: 0 },
            normal: pixels.normal.is_some(),
            color: pixels.color.is_some(),
        }
    }

    /// Becomes a tile: its splats, and its empty blocks; no blocks if there are no splats.
    pub(in crate::method) fn gather(
        &mut self,
        prepared: &Prepared<f32, Record>,
        index: usize,
        rect: Rect,
    ) {
        let shared = &prepared.shared;
        prepared.gather(index, |splat| touches(splat, &rect, shared), &mut self.splats);
        let columns = (rect.x1 - rect.x0).div_ceil(SIDE);
        let rows = (rect.y1 - rect.y0).div_ceil(SIDE);
        let count = if self.splats.is_empty() { 0 } else { columns * rows };
        let zero = [0.0; LANES];
        let empty = PixelBlock {
            nearest: [prepared.shared.empty(); LANES],
            id: [NO_ID; LANES],
            least: zero,
            weight: zero,
            normal: [zero; 3],
            color: [zero; 3],
        };
        self.blocks.clear();
        self.blocks.resize(count as usize, empty);
        self.grid = BlockGrid { rect, columns };
    }
}
