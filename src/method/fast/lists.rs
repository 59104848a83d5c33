//! List the splats of each block of a tile. Some passes finish a block before the next one, so that
//! everything they keep of its pixels stays in the nearest cache.

use super::fragments::each_place;
use super::tile::{BlockGrid, Record};
use crate::splat::Shared;

/// The splats that may touch each block of a tile.
pub(crate) struct BlockLists {
    /// The lists, block by block.
    splats: Vec<u32>,
    /// The end of each block's list.
    ends: Vec<u32>,
}

impl BlockLists {
    /// Lists the splats of a tile, in their order.
    pub(crate) fn new<A>(splats: &[Record<A>], grid: &BlockGrid, shared: &Shared<f32>) -> Self {
        if shared.ray_cast {
            Self::of::<true, A>(splats, grid, shared.limit)
        } else {
            Self::of::<false, A>(splats, grid, shared.limit)
        }
    }

    fn of<const RAY_CAST: bool, A>(splats: &[Record<A>], grid: &BlockGrid, limit: f32) -> Self {
        // The places of the splats, one after the other: a tile has at most 16 x 16 blocks.
        let mut places: Vec<u8> = Vec::with_capacity(4 * splats.len());
        let mut place_ends = Vec::with_capacity(splats.len());
        let mut counts = vec![0_u32; grid.len()];
        for splat in splats {
            each_place::<RAY_CAST, A>(splat, grid, limit, |block, _| {
                counts[block] += 1;
                places.push(block as u8);
            });
            place_ends.push(places.len());
        }
        let mut sum = 0;
        for count in &mut counts {
            (*count, sum) = (sum, sum + *count);
        }
        let (mut next, mut listed) = (counts, vec![0; sum as usize]);
        let mut start = 0;
        for (index, end) in (0..).zip(place_ends) {
            for &block in &places[start..end] {
                let next = &mut next[usize::from(block)];
                listed[*next as usize] = index;
                *next += 1;
            }
            start = end;
        }
        // The end of a block's list is the start of the next block's list.
        Self { splats: listed, ends: next }
    }

    /// Each block: its place in the tile, and its splats.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (usize, &[u32])> {
        self.ends.iter().enumerate().map(|(block, &end)| {
            let start = if block == 0 { 0 } else { self.ends[block - 1] };
            (block, &self.splats[start as usize..end as usize])
        })
    }
}
