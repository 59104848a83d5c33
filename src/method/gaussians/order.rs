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
    /// Leaves out what the window does not show, gives the rest their colours and sorts them into tiles.
    fn new(
        job: &Job<'_>,
        grid: &Grid,
        source: &Source<'_, R>,
        mut splats: Vec<GaussianSplat<R>>,
    ) -> Self {
        job.keep_touching(&mut splats, |splat| splat.bounds);
        color(source, &mut splats);
        let beside = |splat: &GaussianSplat<R>| source.beside(splat.index as usize);
        let beside = splats.iter().map_while(beside).collect();
        let bins = Bins::new(grid, splats.len(), |i| splats[i].bounds);
        Self { splats, beside, bins }
    }
}

vectorized_avx2!(
    /// The splats of a run of items without their colours, and what became of all items.
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
        (splats, tally)
    }
);

vectorized_avx2!(
    /// Finds the colours. Coefficients are far apart in memory, and this short loop waits for those of
    /// several splats at once.
    fn color<R: Exact>(source: &Source<'_, R>, splats: &mut [GaussianSplat<R>]) {
        let source = *source;
        for splat in splats {
            let i = splat.index as usize;
            splat.color = source.look(i, source.position(i)).1;
        }
    }
);

impl<R: Exact> Splats<R> {
    /// The splats of a picture, for the tiles of a grid.
    pub(crate) fn new(job: &Job<'_>, grid: &Grid, source: &Source<'_, R>) -> Self {
        let (count, exec) = (source.len(), job.exec);
        let shift = batch_size(grid, count).next_power_of_two().ilog2();
        let size = 1 << shift;
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let ranges = ranges.collect();
        let project = |range| {
            spend(Work::Project);
            projected(source, range)
        };
        let batch = |splats| Batch::new(job, grid, source, splats);
        let (batches, tallies): (Vec<_>, Vec<_>) = if source.settings.order == Order::Steps {
            let projected = exec.ordered(ranges, project).into_iter();
            let (mut all, tallies): (Vec<_>, Vec<_>) = projected.unzip();
            // The steps are between the least and the greatest key of the picture.
            set_steps(&mut all);
            (exec.ordered(all, batch), tallies)
        } else {
            let both = |range| {
                let (splats, tally) = project(range);
                (batch(splats), tally)
            };
            exec.ordered(ranges, both).into_iter().unzip()
        };
        let tally = tallies.into_iter().fold(Tally::default(), |sum, tally| sum.plus(&tally));
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
        let most = self.batches.iter().map(|batch| batch.bins.count(tile)).sum();
        let mut found = Vec::with_capacity(most);
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
fn set_steps<R: Exact>(batches: &mut [Vec<GaussianSplat<R>>]) {
    let keys = || batches.iter().flatten().map(|splat| splat.key);
    let least = keys().reduce(|a, b| a.at_most(b));
    let most = keys().reduce(|a, b| a.at_least(b));
    let (Some(least), Some(most)) = (least, most) else { return };
    let range = most - least;
    for splat in batches.iter_mut().flatten() {
        let share = (splat.key - least) / range;
        let step = (share * R::from_f32(65_535.0)).floor();
        splat.key = if range > R::ZERO { step } else { R::ZERO };
    }
}
