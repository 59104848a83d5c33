//! Sort the splats of a picture into tiles, and put those of a tile in order.

use super::Order;
use super::splats::{Beside, GaussianSplat, Source};
use crate::frame::{Bins, Grid, Rect};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::prepare::batch_size;
use crate::number::Exact;
use crate::number::lanes::vectorized_avx2;
use crate::number::real::ordered_f64;
use crate::splat::{Fate, Tally};
use std::ops::Range;

/// All splats of a picture, with the tiles that they may touch. Each tile puts its own in order: it has few,
/// and they are near each other in memory.
#[derive(Debug)]
pub(crate) struct Splats<R> {
    pub(crate) tally: Tally,
    /// The splats of each run of items.
    batches: Vec<Batch<R>>,
    /// How many places a batch has, as a power of 2: a place is that of a batch and an index in it.
    shift: u32,
    /// Whether each pixel has an order of its own.
    own: bool,
}

/// The splats of a run of items, in the order of their indices.
#[derive(Debug)]
struct Batch<R> {
    splats: Vec<GaussianSplat<R>>,
    /// Beside each splat, if it needs more; else nothing.
    beside: Vec<Beside<R>>,
    bins: Bins,
}

impl<R: Exact> Batch<R> {
    /// Leaves out what the window does not show, and sorts the rest into tiles.
    fn in_tiles(mut self, job: &Job<'_>, grid: &Grid, source: &Source<'_, R>) -> Self {
        let Self { splats, beside, bins } = &mut self;
        job.keep_touching(splats, |splat| splat.bounds);
        let found = |splat: &GaussianSplat<R>| source.beside(splat.index as usize);
        *beside = splats.iter().map_while(found).collect();
        *bins = Bins::new(grid, splats.len(), |i| splats[i].bounds);
        self
    }
}

vectorized_avx2!(
    /// The splats of a run of items, and what became of all of them.
    fn projected<R: Exact>(
        source: &Source<'_, R>,
        range: Range<usize>,
    ) -> (Vec<GaussianSplat<R>>, Tally) {
        let source = *source;
        let (mut splats, mut tally) = (Vec::with_capacity(range.len()), Tally::default());
        for i in range {
            let (splat, fate) = source.splat(i);
            tally.count(fate);
            if fate == Fate::Visible {
                splats.push(splat);
            }
        }
        // Coefficients are far apart in memory. A short loop waits for those of several splats at once, and
        // most splats of a capture are out of sight and need none.
        for splat in &mut splats {
            let i = splat.index as usize;
            splat.color = source.look(i, source.position(i)).1;
        }
        (splats, tally)
    }
);

impl<R: Exact> Splats<R> {
    /// The splats of a picture, for the tiles of a grid.
    pub(crate) fn new(job: &Job<'_>, grid: &Grid, source: &Source<'_, R>) -> Self {
        let (count, exec) = (source.len(), job.exec);
        let shift = batch_size(grid, count).next_power_of_two().ilog2();
        let size = 1 << shift;
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let steps = source.settings.order == Order::Steps;
        let (mut batches, tallies): (Vec<_>, Vec<_>) = exec
            .ordered(ranges.collect(), |range| {
                spend(Work::Project);
                let (splats, tally) = projected(source, range);
                let batch = Batch { splats, beside: Vec::new(), bins: Bins::default() };
                (if steps { batch } else { batch.in_tiles(job, grid, source) }, tally)
            })
            .into_iter()
            .unzip();
        let tally = tallies.into_iter().fold(Tally::default(), |sum, tally| sum.plus(&tally));
        if steps {
            // The steps are between the least and the greatest key of the picture.
            set_steps(&mut batches);
            batches = exec.ordered(batches, |batch| batch.in_tiles(job, grid, source));
        }
        Self { tally, batches, shift, own: source.settings.order == Order::Pixel }
    }

    /// The splat at a place.
    #[inline(always)]
    pub(crate) fn at(&self, place: usize) -> &GaussianSplat<R> {
        let (batch, i) = self.split(place);
        &self.batches[batch].splats[i]
    }

    /// What its fragments need beside it, if anything.
    #[inline(always)]
    pub(crate) fn beside(&self, place: usize) -> Option<&Beside<R>> {
        let (batch, i) = self.split(place);
        self.batches[batch].beside.get(i)
    }

    #[inline(always)]
    fn split(&self, place: usize) -> (usize, usize) {
        (place >> self.shift, place & ((1 << self.shift) - 1))
    }

    /// How many splats may touch the tile that most may touch.
    pub(crate) fn most_in_a_tile(&self, grid: &Grid) -> usize {
        let count = |tile| self.batches.iter().map(|batch| batch.bins.count(tile)).sum();
        (0..grid.len()).map(count).max().unwrap_or(0)
    }

    /// The places of the splats that may touch a rectangle in a tile, in their order.
    pub(crate) fn places(&self, tile: usize, rect: Rect) -> Vec<usize> {
        spend(Work::Gather);
        let mut found = Vec::new();
        for (batch, first) in self.batches.iter().zip((0_u32..).step_by(1 << self.shift)) {
            batch.bins.for_each(tile, |i| {
                let splat = &batch.splats[i as usize];
                if !splat.bounds.intersection(&rect).is_empty() {
                    found.push((self.rank(splat), first + i));
                }
            });
        }
        in_order(found)
    }

    /// The places of all splats, in their order.
    pub(crate) fn all_places(&self) -> Vec<usize> {
        let firsts = (0_u32..).step_by(1 << self.shift);
        let ranked = self.batches.iter().zip(firsts).flat_map(|(batch, first)| {
            batch.splats.iter().zip(first..).map(|(splat, place)| (self.rank(splat), place))
        });
        in_order(ranked.collect())
    }

    /// What the order compares; the same for all if each pixel has an order of its own.
    #[inline(always)]
    fn rank(&self, splat: &GaussianSplat<R>) -> i64 {
        if self.own { 0 } else { ordered_f64(splat.key.to_f64()) }
    }
}

/// Places by ascending rank, ties to the lower place and so to the lower index.
fn in_order(mut ranked: Vec<(i64, u32)>) -> Vec<usize> {
    ranked.sort_unstable();
    ranked.into_iter().map(|(_, place)| place as usize).collect()
}

/// Replaces each key by its step: floor(((key - least) / (most - least)) 65535); 0 if all are equal.
fn set_steps<R: Exact>(batches: &mut [Batch<R>]) {
    let keys = || batches.iter().flat_map(|batch| &batch.splats).map(|splat| splat.key);
    let least = keys().reduce(|a, b| a.at_most(b));
    let most = keys().reduce(|a, b| a.at_least(b));
    let (Some(least), Some(most)) = (least, most) else { return };
    let range = most - least;
    for splat in batches.iter_mut().flat_map(|batch| &mut batch.splats) {
        let share = (splat.key - least) / range;
        let step = (share * R::from_f32(65_535.0)).floor();
        splat.key = if range > R::ZERO { step } else { R::ZERO };
    }
}
