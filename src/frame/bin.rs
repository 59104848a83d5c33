//! Sort screen bounds into tiles, by counting sort, at the resolution that suits the bounds.

use super::{Grid, Rect};

/// The bounds that touch each tile: for each tile, indices in ascending order.
///
/// Bounds that touch at most 16 tiles are listed in each of these tiles. Larger bounds are listed
/// in cells of 2 x 2, 4 x 4 ... tiles, as small as possible so that the bounds touch at most 16
/// cells. A tile has the lists of all cells that it is in. So memory is at most 64 bytes a splat,
/// whatever the size of the splat. About twice as many tiles visit a splat as it touches (at most
/// four times in the tests, with up to 13 x 10 tiles). Many more tiles visit a splat that is far
/// longer than 16 tiles and thin.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    /// Columns of tiles.
    columns: u32,
    /// The levels that list anything, finest first.
    levels: Vec<Level>,
}

/// The most cells in which one item is listed.
const MOST: u32 = 16;
/// How many levels there can be: cells of up to 2^16 tiles a side, which no picture exceeds.
const LEVELS: usize = 17;

/// The lists of cells of 2^shift x 2^shift tiles.
#[derive(Clone, Debug)]
struct Level {
    shift: u32,
    /// Columns of cells.
    columns: u32,
    /// Where the list of each cell starts in `items`, and where the last list ends.
    starts: Vec<u32>,
    items: Vec<u32>,
}

/// The cells of 2 x 2 that a rectangle touches; the rectangle is not empty.
#[inline(always)]
fn coarser(r: &Rect) -> Rect {
    let end = |end: u32| ((end - 1) >> 1) + 1;
    Rect { x0: r.x0 >> 1, y0: r.y0 >> 1, x1: end(r.x1), y1: end(r.y1) }
}

/// The level for bounds that touch these tiles, and the cells that they touch on that level.
#[inline(always)]
fn place(tiles: Rect) -> (u32, Rect) {
    let (mut shift, mut cells) = (0, tiles);
    while (cells.x1 - cells.x0) * (cells.y1 - cells.y0) > MOST {
        cells = coarser(&cells);
        shift += 1;
    }
    (shift, cells)
}

impl Bins {
    /// Sorts `count` bounds into the tiles of a grid; each of them touches the grid's window.
    #[must_use]
    pub fn new(grid: &Grid, count: usize, bounds: impl Fn(usize) -> Rect) -> Self {
        Self::sorted(grid, count, &|first, some| {
            for (i, own) in some.iter_mut().enumerate() {
                *own = bounds(first + i);
            }
        })
    }

    /// [`Bins::new`], compiled once. `bounds` writes the bounds of as many items as it is given
    /// places for, from an item on.
    fn sorted(grid: &Grid, count: usize, bounds: &dyn Fn(usize, &mut [Rect])) -> Self {
        /// Bounds that are kept at a time: 4 kB.
        const SOME: usize = 256;
        let mut some = [Rect::default(); SOME];
        let mut levels: [Option<Level>; LEVELS] = Default::default();
        // Count first; a level is made when the first item is listed in it.
        for first in (0..count).step_by(SOME) {
            let some = &mut some[..SOME.min(count - first)];
            bounds(first, some);
            for bounds in some {
                let (shift, cells) = place(grid.touched(bounds));
                let level = levels[shift as usize].get_or_insert_with(|| Level::new(grid, shift));
                each_cell(level.columns, &cells, |cell| level.starts[cell + 2] += 1);
            }
        }
        for level in levels.iter_mut().flatten() {
            level.sum();
        }
        // Fill in ascending order.
        for first in (0..count).step_by(SOME) {
            let some = &mut some[..SOME.min(count - first)];
            bounds(first, some);
            for (i, bounds) in some.iter().enumerate() {
                let (shift, cells) = place(grid.touched(bounds));
                if let Some(level) = &mut levels[shift as usize] {
                    level.put(&cells, (first + i) as u32);
                }
            }
        }
        Self { columns: grid.columns, levels: levels.into_iter().flatten().collect() }
    }

    /// The most indices that [`Bins::for_each`] visits.
    #[must_use]
    pub fn count(&self, tile: usize) -> usize {
        self.lists(tile).map(<[u32]>::len).sum()
    }

    /// Calls `visit` for each index whose bounds may touch the tile, in ascending order.
    #[inline(always)]
    pub fn for_each(&self, tile: usize, mut visit: impl FnMut(u32)) {
        // Lists of tiles only: there is one level, and its list is in order.
        if self.is_exact() {
            return self
                .levels
                .iter()
                .for_each(|level| level.list(tile).iter().for_each(|&i| visit(i)));
        }
        let mut lists: [&[u32]; LEVELS] = [&[]; LEVELS];
        let mut left = 0;
        for list in self.lists(tile).filter(|list| !list.is_empty()) {
            lists[left] = list;
            left += 1;
        }
        // Several sorted lists are merged: take from the list that begins lowest, up to where
        // another begins.
        while left > 1 {
            let lowest =
                (1..left).fold(0, |low, k| if lists[k][0] < lists[low][0] { k } else { low });
            let others = (0..left).filter(|&k| k != lowest).map(|k| lists[k][0]);
            let until = others.fold(u32::MAX, |low, first| if first < low { first } else { low });
            while let Some((&first, rest)) = lists[lowest].split_first() {
                if first > until {
                    break;
                }
                visit(first);
                lists[lowest] = rest;
            }
            // The last list takes the place of an exhausted one.
            if lists[lowest].is_empty() {
                left -= 1;
                lists[lowest] = lists[left];
            }
        }
        lists[0].iter().for_each(|&i| visit(i));
    }

    /// Renumbers the bounds in the order in which the tiles, one after the other, first list them,
    /// and returns the old index of each. Data kept in this order lies side by side for a tile.
    ///
    /// Tiles visit the same bounds as before, in the same order, which is no longer the order of
    /// the indices. Returns none and changes nothing in two cases: nothing is listed, or the lists
    /// are not [exact](Bins::is_exact), because lists of several levels are merged by their
    /// indices.
    pub(crate) fn renumber(&mut self, count: usize) -> Option<Vec<u32>> {
        if !self.is_exact() {
            return None;
        }
        let level = self.levels.first_mut()?;
        let (mut numbers, mut old) = (vec![u32::MAX; count], vec![0; count]);
        let mut next = 0;
        for item in &mut level.items {
            let number = &mut numbers[*item as usize];
            // No branch, because the processor would predict it badly: about every sixth index is
            // listed again.
            let fresh = *number == u32::MAX;
            *number = if fresh { next } else { *number };
            old[*number as usize] = *item;
            next += u32::from(fresh);
            *item = *number;
        }
        Some(old)
    }

    /// The lists of the cells that a tile is in.
    fn lists(&self, tile: usize) -> impl Iterator<Item = &[u32]> {
        let (x, y) = (tile as u32 % self.columns, tile as u32 / self.columns);
        let cell = move |level: &Level| (y >> level.shift) * level.columns + (x >> level.shift);
        self.levels.iter().map(move |level| level.list(cell(level) as usize))
    }

    /// Whether every list belongs to one tile, so that bounds touch each tile that visits them.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.levels.iter().all(|level| level.shift == 0)
    }
}

impl Level {
    fn new(grid: &Grid, shift: u32) -> Self {
        let cells = |tiles: u32| ((tiles - 1) >> shift) + 1;
        let (columns, rows) = (cells(grid.columns), cells(grid.rows));
        // One place more at the end, and counts go two places late. After `sum` the list of a cell
        // starts one place late, and `put` moves each start to where its list ends, which is the
        // start of the next list.
        let starts = vec![0; (columns * rows) as usize + 2];
        Self { shift, columns, starts, items: Vec::new() }
    }

    /// The list of a cell.
    #[inline(always)]
    fn list(&self, cell: usize) -> &[u32] {
        &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Turns counts into starts.
    fn sum(&mut self) {
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.items = vec![0; sum as usize];
    }

    /// Appends an index to the lists of these cells.
    #[inline(always)]
    fn put(&mut self, cells: &Rect, index: u32) {
        each_cell(self.columns, cells, |cell| {
            let next = &mut self.starts[cell + 1];
            self.items[*next as usize] = index;
            *next += 1;
        });
    }
}

/// Calls `visit` for the number of each cell of a level.
#[inline(always)]
fn each_cell(columns: u32, cells: &Rect, mut visit: impl FnMut(usize)) {
    for row in cells.y0..cells.y1 {
        for column in cells.x0..cells.x1 {
            visit((row * columns + column) as usize);
        }
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
            corners in prop::collection::vec((0_u32..140, 0_u32..70, 1_u32..60, 1_u32..60), 0..80),
            tile in prop::sample::select(vec![8_u32, 16, 32, 64]),
            strips: bool,
            part: bool,
        ) {
            let (width, height) = (150, 80);
            let window = if part { Rect { x0: 13, y0: 21, x1: 97, y1: 60 } } else { Rect::of_size([width, height]) };
            let tiles_of = Exec::new(1, tile).unwrap().grid_of(window);
            let grid = if strips { tiles_of.strips() } else { tiles_of };
            let bounds: Vec<_> = corners
                .iter()
                .map(|&(x0, y0, w, h)| Rect { x0, y0, x1: width.min(x0 + w), y1: height.min(y0 + h) })
                .filter(|bounds| !bounds.intersection(&window).is_empty())
                .collect();
            let bins = Bins::new(&grid, bounds.len(), |i| bounds[i]);
            let mut met = vec![0; bounds.len()];
            for (tile, rect) in grid.rects().iter().enumerate() {
                let mut seen = Vec::new();
                bins.for_each(tile, |i| seen.push(i));
                prop_assert!(seen.is_sorted_by(|a, b| a < b), "{seen:?}");
                prop_assert_eq!(seen.len(), bins.count(tile));
                seen.iter().for_each(|i| met[*i as usize] += 1);
                for (i, b) in bounds.iter().enumerate() {
                    if !b.intersection(rect).is_empty() {
                        prop_assert!(seen.contains(&(i as u32)), "{i} not in tile {tile}");
                    }
                }
            }
            for (bounds, met) in bounds.iter().zip(met) {
                // 5 tiles a side can lie in 3 cells of 2, so 36 tiles instead of 25; 9 tiles a side
                // in 4 cells of 4.
                let touched = grid.touched(bounds).pixels();
                prop_assert!(met <= 4 * touched, "{met} tiles for {touched}");
            }
            let listed: usize = bins.levels.iter().map(|level| level.items.len()).sum();
            prop_assert!(listed <= MOST as usize * bounds.len());
        }

        #[test]
        fn new_numbers_are_those_of_the_same_bounds_as_tiles_ask_for_them(
            corners in prop::collection::vec((0_u32..140, 0_u32..70), 1..80),
            side in 1_u32..60,
            tile in prop::sample::select(vec![8_u32, 16, 32, 64]),
        ) {
            let grid = Exec::new(1, tile).unwrap().grid(200, 130);
            let bounds = |i: usize| {
                let (x0, y0) = corners[i];
                Rect { x0, y0, x1: x0 + side, y1: y0 + side }
            };
            let before = Bins::new(&grid, corners.len(), bounds);
            let mut after = before.clone();
            let Some(old) = after.renumber(corners.len()) else {
                prop_assert!(!before.is_exact());
                return Ok(());
            };
            prop_assert!(before.is_exact());
            let mut count = 0;
            for tile in 0..grid.len() {
                let (mut was, mut is) = (Vec::new(), Vec::new());
                before.for_each(tile, |i| was.push(i));
                after.for_each(tile, |i| is.push(i));
                let same: Vec<_> = is.iter().map(|&i| old[i as usize]).collect();
                prop_assert_eq!(same, was);
                for i in is {
                    prop_assert!(i <= count, "{i} after {count}");
                    count = count.max(i + 1);
                }
            }
            prop_assert_eq!(count as usize, corners.len());
        }
    }
}
