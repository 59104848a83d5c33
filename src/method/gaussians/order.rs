//! Put all splats of a picture in order, and sort them into tiles.

use super::Order;
use super::splats::{Beside, GaussianSplat, Source};
use crate::frame::{Bins, Exec, Grid, Rect};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::prepare::batch_size;
use crate::number::Exact;
use crate::number::real::ordered_f64;
use crate::splat::{Fate, Tally};
use std::ops::Range;

/// All splats of a picture in their order, with the tiles that they may touch.
#[derive(Debug)]
pub(crate) struct Splats<R> {
    pub(crate) tally: Tally,
    /// The splats of each run of items.
    batches: Vec<Batch<R>>,
    /// How many items a run has, as a power of 2.
    shift: u32,
    /// Which splat has each place: its batch times the size of a run, and its index in the batch.
    order: Vec<u32>,
    /// The runs of places, each as long as a run of items.
    runs: Vec<Run>,
}

/// A run of places.
#[derive(Debug)]
struct Run {
    /// The bounds of the splats, side by side: the splats themselves lie far apart in memory.
    bounds: Vec<Rect>,
    bins: Bins,
}

/// The splats of a run of items, in the order of their indices.
#[derive(Debug)]
struct Batch<R> {
    splats: Vec<GaussianSplat<R>>,
    /// Beside each splat, if it needs more; else nothing.
    beside: Vec<Beside<R>>,
}

impl<R: Exact> Batch<R> {
    /// The splats of a run of items, and what became of all of them.
    fn new(job: &Job<'_>, source: &Source<'_, R>, range: Range<usize>) -> (Self, Tally) {
        spend(Work::Project);
        let (mut splats, mut tally) = (Vec::with_capacity(range.len()), Tally::default());
        for i in range {
            let (splat, fate) = source.splat(i);
            tally.count(fate);
            if fate == Fate::Visible {
                splats.push(splat);
            }
        }
        if source.settings.order != Order::Steps {
            job.keep_touching(&mut splats, |splat| splat.bounds);
        }
        let beside = |splat: &GaussianSplat<R>| source.beside(splat.index as usize);
        let beside = splats.iter().map_while(beside).collect();
        (Self { splats, beside }, tally)
    }
}

impl<R: Exact> Splats<R> {
    /// The splats of a picture, for the tiles of a grid.
    pub(crate) fn new(job: &Job<'_>, grid: &Grid, source: &Source<'_, R>) -> Self {
        let (count, exec) = (source.len(), job.exec);
        let shift = batch_size(grid, count).next_power_of_two().ilog2();
        let size = 1 << shift;
        let own = source.settings.order == Order::Pixel;
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let batches = exec.ordered(ranges.collect(), |range| Batch::new(job, source, range));
        let (mut batches, tallies): (Vec<_>, Vec<_>) = batches.into_iter().unzip();
        let tally = tallies.into_iter().fold(Tally::default(), |sum, tally| sum.plus(&tally));
        if source.settings.order == Order::Steps {
            // The steps are between the least and the greatest key of the picture.
            steps(&mut batches);
            let bounds = |splat: &GaussianSplat<R>| splat.bounds;
            batches.iter_mut().for_each(|batch| job.keep_touching(&mut batch.splats, bounds));
        }
        let order = ordered(&batches, shift, own, exec);
        let mut all = Self { tally, batches, shift, order, runs: Vec::new() };
        let runs: Vec<usize> = (0..all.order.len()).step_by(size).collect();
        all.runs = exec.ordered(runs, |first| {
            let places = first..all.order.len().min(first + size);
            let bounds: Vec<Rect> = places.map(|place| all.at(place).bounds).collect();
            let bins = Bins::new(grid, bounds.len(), |i| bounds[i]);
            Run { bounds, bins }
        });
        all
    }

    /// How many splats are seen.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// The splat at a place of the order.
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
        let at = self.order[place] as usize;
        (at >> self.shift, at & ((1 << self.shift) - 1))
    }

    /// How many splats may touch the tile that most may touch.
    pub(crate) fn most_in_a_tile(&self, grid: &Grid) -> usize {
        let count = |tile| self.runs.iter().map(|run| run.bins.count(tile)).sum();
        (0..grid.len()).map(count).max().unwrap_or(0)
    }

    /// The places of the splats that may touch a rectangle in a tile, in their order.
    pub(crate) fn places(&self, tile: usize, rect: Rect) -> Vec<usize> {
        spend(Work::Gather);
        let mut places = Vec::new();
        for (run, Run { bounds, bins }) in self.runs.iter().enumerate() {
            bins.for_each(tile, |i| {
                if !bounds[i as usize].intersection(&rect).is_empty() {
                    places.push((run << self.shift) + i as usize);
                }
            });
        }
        places
    }
}

/// The splats in ascending order of their keys, ties to the lower index; in that of their indices if
/// each pixel has its `own` order.
fn ordered<R: Exact>(batches: &[Batch<R>], shift: u32, own: bool, exec: &Exec) -> Vec<u32> {
    let ranked = exec.ordered((0..batches.len()).collect(), |batch| {
        let places = (batch as u32) << shift..;
        let splats = batches[batch].splats.iter().zip(places);
        let key = |splat: &GaussianSplat<R>| if own { 0 } else { ordered_f64(splat.key.to_f64()) };
        splats.map(|(splat, place)| (key(splat), place)).collect::<Vec<_>>()
    });
    let mut ranked = ranked.concat();
    if !own {
        exec.sort(&mut ranked);
    }
    ranked.into_iter().map(|(_, place)| place).collect()
}

/// Replaces each key by its step: floor(((key - least) / (most - least)) 65535); 0 if all are equal.
fn steps<R: Exact>(batches: &mut [Batch<R>]) {
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
