//! Choose threads and tile size. They decide how a picture is made, and cannot change one bit of
//! it.
//!
//! [`Exec::ordered`] is the one parallel loop of the crate. Each job owns what it writes, a tile or
//! a chunk that no other job touches. The results come back in the order of the jobs.

use super::{Plane, Rect};
use crate::error::{Error, Result};
use crate::number::MapInline;
use rayon::prelude::*;
use std::mem;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Threads and tile size: how a picture is computed, never what.
///
/// ```
/// use splatref::frame::Exec;
///
/// let fast = Exec::new(0, 32)?; // a thread for each core
/// let slow = Exec::sequential(); // no threads at all: the same bits
/// let squares = |exec: &Exec| exec.ordered((0..100).collect(), |i: u32| i * i);
/// assert_eq!(squares(&fast), squares(&slow), "results come in the order of the jobs");
/// # Ok::<(), splatref::Error>(())
/// ```
#[derive(Debug)]
pub struct Exec {
    tile: u32,
    pool: Option<Arc<rayon::ThreadPool>>,
    stop: Option<Arc<AtomicBool>>,
}

/// What work unwinds with that was stopped, see [`Exec::stoppable`].
#[derive(Clone, Copy, Debug)]
pub struct Stopped;

impl Exec {
    /// Starts `threads` threads, one per core if `threads` is 0; tiles have `tile` x `tile` pixels.
    ///
    /// # Errors
    /// [`Error::Usage`] if the tile is not 8, 16, 32 or 64, or if the threads cannot be started.
    pub fn new(threads: usize, tile: u32) -> Result<Self> {
        if ![8, 16, 32, 64].contains(&tile) {
            return Err(Error::Usage(format!("a tile of {tile} pixels; give 8, 16, 32 or 64")));
        }
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = if threads == 0 { cores } else { threads };
        if threads > 1024 {
            return Err(Error::Usage(format!("{threads} threads; give at most 1024")));
        }
        let pool = if threads == 1 {
            // No pool at all, so that targets without threads render too.
            None
        } else {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            Some(Arc::new(pool.map_err(|e| Error::Usage(format!("{threads} threads: {e}")))?))
        };
        Ok(Self { tile, pool, stop: None })
    }

    /// One thread, tiles of 32 pixels.
    #[must_use]
    pub fn sequential() -> Self {
        Self { tile: 32, pool: None, stop: None }
    }

    /// The same threads and tiles for work that can be stopped: once `stop` is true, the next job
    /// unwinds with [`Stopped`], and nothing is written. Catch it with [`std::panic::catch_unwind`].
    #[must_use]
    pub fn stoppable(&self, stop: Arc<AtomicBool>) -> Self {
        Self { tile: self.tile, pool: self.pool.clone(), stop: Some(stop) }
    }

    /// Unwinds with [`Stopped`] if the work was stopped. Jobs call it; long work without jobs may.
    pub fn check_stop(&self) {
        if self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            // Unlike a panic, this prints nothing.
            resume_unwind(Box::new(Stopped));
        }
    }

    /// How many threads work.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// The tiles of a picture.
    #[must_use]
    pub fn grid(&self, width: u32, height: u32) -> Grid {
        self.grid_of(Rect::of_size([width, height]))
    }

    /// The tiles of a part of a picture, see [`Grid`].
    #[must_use]
    pub fn grid_of(&self, window: Rect) -> Grid {
        Grid::new(window, [self.tile; 2])
    }

    /// Runs every job, in parallel, and returns the results in the order of the jobs.
    pub fn ordered<J: Send, T: Send>(
        &self,
        jobs: Vec<J>,
        run: impl Fn(J) -> T + Sync + Send,
    ) -> Vec<T> {
        // Two plain loops, because chains of iterators are compiled for each kind of jobs and results.
        let mut slots = Vec::with_capacity(jobs.len());
        for job in jobs {
            slots.push(Mutex::new(Slot::Job(job)));
        }
        // One thread goes through the same closure, because a second call of `run` would be compiled again.
        self.each(slots.len(), &|i| {
            let slot = || slots[i].lock().unwrap_or_else(PoisonError::into_inner);
            // A statement of its own, so that the lock is not held while the job runs.
            let job = mem::replace(&mut *slot(), Slot::Empty);
            if let Slot::Job(job) = job {
                let result = run(job);
                *slot() = Slot::Result(result);
            }
        });
        let mut results = Vec::with_capacity(slots.len());
        for slot in slots {
            // Every slot has a result here, because a job that panics makes `each` panic.
            if let Slot::Result(result) = slot.into_inner().unwrap_or_else(PoisonError::into_inner)
            {
                results.push(result);
            }
        }
        results
    }

    /// Runs `run` for each index below `count`, in parallel. `run` is not a type parameter, because a
    /// parallel loop compiled for each of the crate's loops was a fifth of the program.
    ///
    /// An idle thread cannot take over a run of indices that another thread has begun: runs are short.
    fn each(&self, count: usize, run: &(dyn Fn(usize) + Sync)) {
        /// Runs for each thread, or one for each index.
        const RUNS: usize = 64;
        let run = &|i| {
            self.check_stop();
            run(i);
        };
        match &self.pool {
            None => (0..count).for_each(run),
            Some(pool) => {
                let most = count.div_ceil(RUNS * pool.current_num_threads()).max(1);
                pool.install(|| (0..count).into_par_iter().with_max_len(most).for_each(run));
            }
        }
    }

    /// Runs two jobs, in parallel, and returns the results of both.
    pub fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.pool {
            None => (first(), second()),
            Some(pool) => pool.join(first, second),
        }
    }

    /// Does work that runs jobs many times; between the jobs no thread falls asleep.
    pub(crate) fn within<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            None => work(),
            Some(pool) => pool.install(work),
        }
    }

    /// Appends `of(i)` for each `i` below `count`, in parallel.
    pub(crate) fn extend<T: Send>(
        &self,
        to: &mut Vec<T>,
        count: usize,
        of: impl Fn(usize) -> T + Sync + Send,
    ) {
        match &self.pool {
            None => to.extend((0..count).map(of)),
            Some(pool) => pool.install(|| to.par_extend((0..count).into_par_iter().map(of))),
        }
    }

    /// Sorts values in parallel; no two values may be equal.
    pub(crate) fn sort<T: Ord + Send>(&self, values: &mut [T]) {
        match &self.pool {
            None => values.sort_unstable(),
            Some(pool) => pool.install(|| values.par_sort_unstable()),
        }
    }

    /// Runs jobs of `size` neighbouring items each, in parallel, with the index of the job's first
    /// item, and returns the results in the order of the jobs.
    pub(crate) fn chunks<T: Send, R: Send>(
        &self,
        items: impl Iterator<Item = T>,
        size: usize,
        run: impl Fn(usize, Vec<T>) -> R + Sync + Send,
    ) -> Vec<R> {
        let mut items = items.enumerate().peekable();
        let chunks = std::iter::from_fn(|| {
            let first = items.peek()?.0;
            Some((first, items.by_ref().take(size).map(|(_, item)| item).collect()))
        });
        self.ordered(chunks.collect(), |(first, chunk)| run(first, chunk))
    }
}

/// A job that waits, a job that runs, or the result of a job.
enum Slot<J, T> {
    Job(J),
    Empty,
    Result(T),
}

/// The division of a picture, or of a part of it, into tiles. The tiles of a part are those of the
/// picture that touch it, cut at its edges. Pixels are counted in the picture; planes hold the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    window: Rect,
    /// Column and row, in the picture, of the first tile.
    first: [u32; 2],
    /// Width and height of a tile in pixels, powers of two.
    pub side: [u32; 2],
    /// Tiles in a row.
    pub columns: u32,
    /// Rows of tiles.
    pub rows: u32,
}

impl Grid {
    fn new(window: Rect, side: [u32; 2]) -> Self {
        let first = [window.x0 / side[0], window.y0 / side[1]];
        let columns = window.x1.div_ceil(side[0]) - first[0];
        let rows = window.y1.div_ceil(side[1]) - first[1];
        Self { window, first, side, columns, rows }
    }

    /// The pixels that the tiles cover.
    #[must_use]
    pub fn window(&self) -> Rect {
        self.window
    }

    /// The tiles that a rectangle touches, as columns and rows of the grid, the ends exclusive. The
    /// rectangle must touch the window.
    #[inline(always)]
    pub(super) fn touched(&self, rect: &Rect) -> Rect {
        let Rect { x0, y0, x1, y1 } = rect.intersection(&self.window);
        // Tiles are powers of two wide and high; a shift is much faster than a division.
        let [across, down] = self.side.map_inline(u32::trailing_zeros);
        let ([left, top], end) = (self.first, |end: u32, shift: u32| ((end - 1) >> shift) + 1);
        Rect {
            x0: (x0 >> across) - left,
            y0: (y0 >> down) - top,
            x1: end(x1, across) - left,
            y1: end(y1, down) - top,
        }
    }

    /// The same picture in strips, the tiles of the fast paths: as high as a tile, and at least 64
    /// pixels wide. The costs per strip, and per splat in each strip that it touches, are then
    /// shared by that many pixels, however small the tiles are.
    #[must_use]
    pub fn strips(&self) -> Self {
        let [wide, high] = self.side;
        Self::new(self.window, [wide.max(STRIP), high])
    }

    /// Whether a pixel of the picture is in the window.
    #[must_use]
    pub fn holds(&self, x: u32, y: u32) -> bool {
        self.window.contains(x, y)
    }

    /// How many tiles there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Whether there is no tile.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pixels of the tile at a column and row of tiles.
    #[must_use]
    pub fn rect(&self, column: u32, row: u32) -> Rect {
        let ([wide, high], [left, top]) = (self.side, self.first);
        let (x0, y0) = ((left + column) * wide, (top + row) * high);
        Rect { x0, y0, x1: x0 + wide, y1: y0 + high }.intersection(&self.window)
    }

    /// Width and height of the window in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.window.size()
    }

    /// The tile of a pixel, and the index of the pixel in its tile, both counted row by row.
    #[must_use]
    #[inline]
    pub fn place(&self, x: u32, y: u32) -> (usize, usize) {
        let (column, row) = (x / self.side[0] - self.first[0], y / self.side[1] - self.first[1]);
        let Rect { x0, y0, x1, .. } = self.rect(column, row);
        let tile = (row * self.columns + column) as usize;
        (tile, ((y - y0) * (x1 - x0) + (x - x0)) as usize)
    }

    /// The pixels of each tile, row by row.
    #[must_use]
    pub fn rects(&self) -> Vec<Rect> {
        let tiles = (0..self.rows).flat_map(|row| (0..self.columns).map(move |c| (c, row)));
        tiles.map(|(column, row)| self.rect(column, row)).collect()
    }

    /// Assembles a plane from values by tile and by pixel in the tile, both counted row by row.
    pub fn assemble<T: Clone>(&self, fill: T, value: impl Fn(usize, usize) -> T) -> Plane<T> {
        let [width, height] = self.size();
        let mut plane = Plane::filled(width, height, fill);
        for (tile, rect) in self.rects().iter().enumerate() {
            let columns = (rect.x1 - rect.x0) as usize;
            for y in rect.y0..rect.y1 {
                let [left, top] = [rect.x0 - self.window.x0, y - self.window.y0];
                let start = top as usize * width as usize + left as usize;
                let first = (y - rect.y0) as usize * columns;
                for x in 0..columns {
                    plane.values_mut()[start + x] = value(tile, first + x);
                }
            }
        }
        plane
    }

    /// Cuts a plane into its tiles, disjoint and writable, row by row.
    pub fn cut<'a, T: Send>(&self, plane: &'a mut Plane<T>, exec: &Exec) -> Vec<TileMut<'a, T>> {
        let (width, high) = (self.size()[0].max(1) as usize, self.side[1] as usize);
        let (mut rest, mut bands) = (plane.values_mut(), Vec::new());
        for row in 0..self.rows {
            // The first row of tiles may be cut too.
            let band = rest.split_at_mut(width * self.rect(0, row).rows());
            (_, rest) = (bands.push((row, band.0)), band.1);
        }
        // A tile is many short rows, so cutting them out is enough work to run in parallel.
        let cut = exec.ordered(bands, |(row, band): (u32, &'a mut [T])| {
            let empty = |column| TileMut {
                index: (row * self.columns + column) as usize,
                rect: self.rect(column, row),
                rows: Vec::with_capacity(high),
            };
            let mut cut: Vec<_> = (0..self.columns).map(empty).collect();
            for mut row in band.chunks_mut(width) {
                for tile in &mut cut {
                    let (part, rest) = row.split_at_mut(tile.rect.columns());
                    tile.rows.push(part);
                    row = rest;
                }
            }
            cut
        });
        cut.into_iter().flatten().collect()
    }
}

/// The least width of a strip in pixels, if the picture is as wide.
const STRIP: u32 = 64;

/// The pixels of one tile of a plane, writable.
#[derive(Debug)]
pub struct TileMut<'a, T> {
    /// The tile's number, counted row by row.
    pub index: usize,
    /// The pixels of the picture that the tile covers.
    pub rect: Rect,
    rows: Vec<&'a mut [T]>,
}

impl<T> TileMut<'_, T> {
    /// The tile's rows, from the top.
    pub fn rows(&mut self) -> impl Iterator<Item = &mut [T]> {
        self.rows.iter_mut().map(|row| &mut **row)
    }

    /// The value at a column and row of the picture.
    #[inline(always)]
    pub fn at(&mut self, [x, y]: [u32; 2]) -> &mut T {
        let Rect { x0, y0, .. } = self.rect;
        &mut self.rows[(y - y0) as usize][(x - x0) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_and_strips_partition_the_picture() {
        let exec = Exec::new(3, 16).unwrap();
        for (width, height) in [(1, 1), (16, 16), (17, 33), (64, 5), (100, 1), (129, 20)] {
            let tiles = exec.grid(width, height);
            let part = Rect { x0: width / 3, y0: height / 2, x1: width, y1: height - height / 3 };
            let [parts, whole] = [part, Rect::of_size([width, height])].map(|w| exec.grid_of(w));
            assert_eq!(whole, tiles);
            for grid in [tiles, tiles.strips(), parts, parts.strips()] {
                let [wide, high] = grid.size();
                let mut plane = Plane::filled(wide, high, 0_u32);
                let written = exec.ordered(grid.cut(&mut plane, &exec), |mut tile| {
                    let Rect { x0, y0, x1, .. } = tile.rect;
                    for (y, row) in (y0..).zip(tile.rows()) {
                        for (x, value) in (x0..x1).zip(row) {
                            *value += 1 + x + width * y;
                        }
                    }
                    (tile.index, tile.rect)
                });
                let rects: Vec<_> = grid.rects().into_iter().enumerate().collect();
                assert_eq!(written, rects, "results come in the order of the jobs");
                let Rect { x0, y0, x1, y1 } = grid.window();
                let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
                let expected: Vec<_> = pixels.clone().map(|(x, y)| 1 + x + width * y).collect();
                assert_eq!(plane.values(), expected, "each pixel once: {width} x {height}");
                for (x, y) in pixels {
                    let (tile, pixel) = grid.place(x, y);
                    let (_, rect) = rects[tile];
                    assert_eq!((x, y), {
                        let columns = rect.columns();
                        (rect.x0 + (pixel % columns) as u32, rect.y0 + (pixel / columns) as u32)
                    });
                }
                let again = grid.assemble(0, |tile, pixel| {
                    let (_, rect) = rects[tile];
                    let (x, y) = (pixel % rect.columns(), pixel / rect.columns());
                    1 + rect.x0 + x as u32 + width * (rect.y0 + y as u32)
                });
                assert_eq!(again, plane);
            }
        }
    }

    #[test]
    fn work_that_is_stopped_unwinds_at_its_next_job() {
        for exec in [Exec::sequential(), Exec::new(3, 16).unwrap()] {
            let stop = Arc::new(AtomicBool::new(false));
            let stoppable = exec.stoppable(stop.clone());
            let work = || {
                stoppable.ordered((0..1000).collect(), |i: u32| {
                    stop.store(i > 10, Ordering::Relaxed);
                    i
                })
            };
            let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
            assert!(ended.unwrap_err().is::<Stopped>());
            assert_eq!(exec.ordered((0..1000).collect(), |i: u32| i).len(), 1000, "others go on");
        }
    }

    #[test]
    fn wrong_tiles_are_refused() {
        assert_eq!(Exec::new(1, 12).unwrap_err().exit_code(), 2);
    }
}
