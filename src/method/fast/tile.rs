//! Hold the data of a fast path: records of splats, and the blocks of a tile.

use super::fragments::touches;
use crate::frame::{NO_ID, Rect};
use crate::method::clock::{Work, spend};
use crate::method::fragment::facing;
use crate::method::prepare::Prepared;
use crate::number::lanes::{LANES, Lanes};
use crate::splat::{Footprint, Splat};
use glam::Vec3;

/// Side of a block in pixels.
pub(crate) const SIDE: u32 = 4;
/// Pixels of a row of a block.
pub(crate) const ROW: usize = SIDE as usize;
const _: () = assert!(ROW * ROW == LANES, "a lane is a pixel of a block");

/// The pixels of a block, row by row.
#[derive(Clone)]
#[repr(align(64))]
pub(crate) struct PixelBlock {
    /// Nearness of the nearest fragment.
    pub(crate) nearest: Lanes,
    /// Surfel of that fragment.
    pub(crate) id: [u32; LANES],
    /// The least nearness that passes the epsilon-z test.
    pub(crate) least: Lanes,
    pub(crate) weight: Lanes,
    pub(crate) normal: [Lanes; 3],
    pub(crate) color: [Lanes; 3],
}

/// A splat with its attributes, so that a tile finds everything in one place: 80 bytes with the
/// attributes of a surface.
#[derive(Clone, Copy)]
pub(crate) struct Record<A = Surface> {
    pub(crate) footprint: Footprint<f32>,
    pub(crate) surfel: u32,
    /// First and last column, first and last row.
    pub(crate) bounds: [u16; 4],
    pub(crate) attributes: A,
}

/// The attributes that are averaged if splats are a surface.
#[derive(Clone, Copy)]
pub(crate) struct Surface {
    /// The normal of the side that is seen.
    pub(crate) normal: [f32; 3],
    pub(crate) color: [f32; 3],
}

impl Surface {
    #[inline(always)]
    pub(crate) fn new(splat: &Splat<f32>, normals: &[Vec3], colors: Option<&[Vec3]>) -> Self {
        let i = splat.surfel as usize;
        Self {
            normal: facing(normals[i].to_array(), splat.back),
            color: colors.map_or([0.0; 3], |c| c[i].to_array()),
        }
    }
}

impl<A> Record<A> {
    #[inline(always)]
    pub(crate) fn new(splat: &Splat<f32>, attributes: A) -> Self {
        let Rect { x0, y0, x1, y1 } = splat.bounds;
        Self {
            footprint: splat.footprint,
            surfel: splat.surfel,
            // Pictures have at most 65,536 pixels a side, so the last pixel fits.
            bounds: [x0 as u16, (x1 - 1) as u16, y0 as u16, (y1 - 1) as u16],
            attributes,
        }
    }

    #[inline(always)]
    pub(crate) fn bounds(&self) -> Rect {
        let [x0, x1, y0, y1] = self.bounds;
        let (x0, y0) = (u32::from(x0), u32::from(y0));
        Rect { x0, y0, x1: u32::from(x1) + 1, y1: u32::from(y1) + 1 }
    }

    /// The blocks of a tile that the splat may touch: columns and rows, the ends exclusive.
    #[inline(always)]
    pub(crate) fn blocks(&self, tile: &Rect) -> Rect {
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

/// The positions of a tile's blocks.
#[derive(Clone, Copy)]
pub(crate) struct BlockGrid {
    /// The pixels of the tile.
    pub(crate) rect: Rect,
    /// Blocks in a row.
    pub(crate) columns: u32,
}

impl BlockGrid {
    /// The blocks of these pixels.
    pub(crate) fn new(rect: Rect) -> Self {
        Self { rect, columns: (rect.x1 - rect.x0).div_ceil(SIDE) }
    }

    /// How many blocks there are.
    pub(crate) fn len(&self) -> usize {
        (self.columns * (self.rect.y1 - self.rect.y0).div_ceil(SIDE)) as usize
    }

    /// Column and row of the first pixel of a block.
    #[inline(always)]
    pub(crate) fn corner(&self, block: usize) -> (u32, u32) {
        let (column, row) = (block as u32 % self.columns, block as u32 / self.columns);
        (self.rect.x0 + column * SIDE, self.rect.y0 + row * SIDE)
    }
}

/// The memory of one tile.
pub(crate) struct Tile {
    pub(crate) splats: Vec<Record>,
    pub(crate) blocks: Vec<PixelBlock>,
    pub(crate) grid: BlockGrid,
    /// Whether normals are wanted.
    pub(crate) normal: bool,
    /// Whether colours are wanted.
    pub(crate) color: bool,
}

impl Tile {
    /// Memory that tiles use one after the other; normals and colours exist if they are wanted.
    pub(crate) fn new([normal, color]: [bool; 2]) -> Self {
        let grid = BlockGrid::new(Rect::default());
        Self { splats: Vec::new(), blocks: Vec::new(), grid, normal, color }
    }

    /// Starts a tile of these pixels: its splats, and its empty blocks; no blocks if there are no
    /// splats.
    pub(crate) fn gather(&mut self, prepared: &Prepared<f32, Record>, index: usize, rect: Rect) {
        prepared.gather_f32(index, &rect, &mut self.splats);
        self.empty(rect, prepared.shared.empty());
    }

    /// Starts a tile of these pixels for its present splats: its empty blocks, of this nearness.
    pub(crate) fn empty(&mut self, rect: Rect, nearness: f32) {
        self.grid = BlockGrid::new(rect);
        let count = if self.splats.is_empty() { 0 } else { self.grid.len() };
        let zero = [0.0; LANES];
        let empty = PixelBlock {
            nearest: [nearness; LANES],
            id: [NO_ID; LANES],
            least: zero,
            weight: zero,
            normal: [zero; 3],
            color: [zero; 3],
        };
        self.blocks.clear();
        self.blocks.resize(count, empty);
    }
}

impl<A: Copy + Send> Prepared<f32, Record<A>> {
    /// Gathers the splats that may touch a tile of these pixels, in the order of the items;
    /// replaces the previous content of `gathered`.
    pub(crate) fn gather_f32(&self, tile: usize, rect: &Rect, gathered: &mut Vec<Record<A>>) {
        spend(Work::Gather);
        self.gather(tile, |splat| touches(splat, rect, &self.shared), gathered);
    }
}
