//! The splats of each block of a tile: for passes that finish a block before the next one, so that
//! all they keep of its pixels stays in the nearest cache.

use super::fragments::each_place;
use super::tile::{BlockGrid, Record};
use crate::splat::Shared;

/// The splats that may touch each block of a tile.
pub(in crate::method) struct BlockLists {
    /// Block by block.
    splats: Vec<u32>,
    /// Where the list of each block ends.
    ends: Vec<u32>,
}

impl BlockLists {
    /// Lists splats of a tile, in this order.
    pub(in crate::method) fn new<A>(
        splats: &[Record<A>],
        order: impl Iterator<Item = u32> + Clone,
        grid: &BlockGrid,
        shared: &Shared<f32>,
    ) -> Self {
        if shared.ray_cast {
            Self::of::<true, A>(splats, order, grid, shared.limit)
        } else {
            Self::of::<false, A>(splats, order, grid, shared.limit)
        }
    }

    fn of<const RAY_CAST: bool, A>(
        splats: &[Record<A>],
        order: impl Iterator<Item = u32> + Clone,
        grid: &BlockGrid,
        limit: f32,
    ) -> Self {
        let mut counts = vec![0_u32; grid.len()];
        for splat in order.clone() {
            let splat = &splats[splat as usize];
            each_place::<RAY_CAST, A>(splat, grid, limit, |block, _| counts[block] += 1);
        }
        let mut sum = 0;
        for count in &mut counts {
            (*count, sum) = (sum, sum + *count);
        }
        let (mut next, mut listed) = (counts, vec![0; sum as usize]);
        for index in order {
            let splat = &splats[index as usize];
            each_place::<RAY_CAST, A>(splat, grid, limit, |block, _| {
                listed[next[block] as usize] = index;
                next[block] += 1;
            });
        }
        // What follows the last of a block is the first of the next.
        Self { splats: listed, ends: next }
    }

    /// Each block: its place in the tile, and its splats.
    pub(in crate::method) fn blocks(&self) -> impl Iterator<Item = (usize, &[u32])> {
        self.ends.iter().enumerate().map(|(block, &end)| {
            let start = if block == 0 { 0 } else { self.ends[block - 1] };
            (block, &self.splats[start as usize..end as usize])
        })
    }
}
