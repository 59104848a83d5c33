//! From screen bounds to tiles, by counting sort.

use super::{Grid, Rect};

/// Which tiles a batch of bounds touches: for each tile a list of indices, in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    /// Where the list of each tile starts in `items`, and where the last ends.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Bounds that touch more tiles than [`WIDE`]: every tile looks through them, so that memory
    /// stays within 4 [`WIDE`] bytes a splat whatever its size.
    wide: Vec<u32>,
}

/// The most tiles a splat is listed in.
const WIDE: u32 = 6;

/// Columns and rows of tiles that bounds touch, the ends exclusive.
#[inline(always)]
fn tiles(grid: &Grid, r: &Rect) -> Rect {
    // Tiles are a power of two wide; a shift is much faster than a division.
    let shift = grid.tile.trailing_zeros();
    let end = |pixel: u32| ((pixel - 1) >> shift) + 1;
    Rect { x0: r.x0 >> shift, y0: r.y0 >> shift, x1: end(r.x1), y1: end(r.y1) }
}

impl Bins {
    /// Sorts `count` bounds, none of them empty, into the tiles of a grid.
    #[must_use]
    pub fn new(grid: &Grid, count: usize, bounds: impl Fn(usize) -> Rect) -> Self {
        let mut bins = Self { starts: vec![0; grid.len() + 1], ..Self::default() };
        let is_wide = |r: &Rect| (r.x1 - r.x0) * (r.y1 - r.y0) > WIDE;
        let list = |column: u32, row: u32| (row * grid.columns + column) as usize;

        // Count, one place late, so that the sums become starts.
        for i in 0..count {
            let r = tiles(grid, &bounds(i));
            if is_wide(&r) {
                bins.wide.push(i as u32);
                continue;
            }
            for row in r.y0..r.y1 {
                for column in r.x0..r.x1 {
                    bins.starts[list(column, row) + 1] += 1;
                }
            }
        }
        for tile in 1..bins.starts.len() {
            bins.starts[tile] += bins.starts[tile - 1];
        }
        // Fill, in ascending order.
        bins.items = vec![0; bins.starts[grid.len()] as usize];
        let mut next = bins.starts.clone();
        for i in 0..count {
            let r = tiles(grid, &bounds(i));
            if is_wide(&r) {
                continue;
            }
            for row in r.y0..r.y1 {
                for column in r.x0..r.x1 {
                    let place = &mut next[list(column, row)];
                    bins.items[*place as usize] = i as u32;
                    *place += 1;
                }
            }
        }
        bins
    }

    /// How many indices [`Bins::for_each`] visits.
    #[must_use]
    pub fn count(&self, tile: usize) -> usize {
        (self.starts[tile + 1] - self.starts[tile]) as usize + self.wide.len()
    }

    /// Calls `visit` for each index whose bounds may touch the tile, in ascending order.
    #[inline(always)]
    pub fn for_each(&self, tile: usize, mut visit: impl FnMut(u32)) {
        let items = &self.items[self.starts[tile] as usize..self.starts[tile + 1] as usize];
        if self.wide.is_empty() {
            return items.iter().for_each(|&i| visit(i));
        }
        let mut wide = self.wide.iter().peekable();
        for &item in items {
            while let Some(&i) = wide.next_if(|&&i| i < item) {
                visit(i);
            }
            visit(item);
        }
        wide.for_each(|&i| visit(i));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_tile_sees_its_bounds_in_ascending_order(
            corners in prop::collection::vec((0_u32..90, 0_u32..70, 1_u32..60, 1_u32..60), 0..80),
            tile in prop::sample::select(vec![8_u32, 16, 32, 64]),
        ) {
            let (width, height) = (100, 80);
            let grid = Exec::new(1, tile).unwrap().grid(width, height);
            let bounds: Vec<_> = corners
                .iter()
                .map(|&(x0, y0, w, h)| Rect { x0, y0, x1: width.min(x0 + w), y1: height.min(y0 + h) })
                .collect();
            let bins = Bins::new(&grid, bounds.len(), |i| bounds[i]);
            for (tile, rect) in grid.rects().iter().enumerate() {
                let mut seen = Vec::new();
                bins.for_each(tile, |i| seen.push(i));
                prop_assert!(seen.is_sorted_by(|a, b| a < b), "{seen:?}");
                for (i, b) in bounds.iter().enumerate() {
                    if !b.intersection(rect).is_empty() {
                        prop_assert!(seen.contains(&(i as u32)), "{i} not in tile {tile}");
                    }
                }
            }
        }
    }
}
