//! Project the surfels and bin the splats into tiles: the first step of every method.

use super::algorithm::Job;
use super::clock::{Work, spend};
use crate::frame::{Bins, Grid, Rect};
use crate::number::{Exact, Real};
use crate::splat::SplatSettings;
use crate::splat::{Projector, Shared, Splat, Tally, View, batch};
use std::ops::Range;

/// The visible splats of a picture, as records `S`, in batches of ascending items with their bins.
/// Within a batch the splats stand in the order of the bins' numbers.
///
/// An item is drawn as one splat: a surfel, or a surfel in one of its groups.
#[derive(Debug)]
pub(crate) struct Prepared<R, S> {
    pub(crate) shared: Shared<R>,
    pub(crate) epsilon: R,
    pub(crate) tally: Tally,
    batches: Vec<(Vec<S>, Bins)>,
}

impl<R: Real, S: Send> Prepared<R, S> {
    /// Projects `count` items and sorts the splats into tiles.
    ///
    /// `project` makes the records of a range of items; `bounds` returns the pixels of a record.
    pub(crate) fn new(
        job: &Job<'_>,
        grid: &Grid,
        settings: &SplatSettings,
        count: usize,
        project: impl Fn(&Projector<R>, Range<usize>, &mut Vec<S>) -> Tally + Sync + Send,
        bounds: impl Fn(&S) -> Rect + Sync + Send,
    ) -> Self
    where
        S: Copy,
    {
        let size = batch_size(grid, count);
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let projected = |projector: &Projector<R>, range: Range<usize>, splats: &mut Vec<S>| {
            splats.reserve_exact(range.len());
            project(projector, range, splats)
        };
        // Copied side by side for a tile: with a million splats, fetching each from elsewhere took
        // a fifth of a frame.
        let side_by_side = |splats: Vec<S>, bins: &mut Bins| match bins.renumber(splats.len()) {
            Some(order) => order.iter().map(|&i| splats[i as usize]).collect(),
            None => splats,
        };
        Self::arranged(job, grid, settings, ranges.collect(), projected, bounds, side_by_side)
    }

    /// Projects the items of some batches and sorts the splats into tiles. The order of the items
    /// is the order of the batches; the items of one batch are near each other. `project` and
    /// `bounds` are as in [`Prepared::new`].
    pub(crate) fn of_batches<B: Send>(
        job: &Job<'_>,
        grid: &Grid,
        settings: &SplatSettings,
        batches: Vec<B>,
        project: impl Fn(&Projector<R>, B, &mut Vec<S>) -> Tally + Sync + Send,
        bounds: impl Fn(&S) -> Rect + Sync + Send,
    ) -> Self {
        Self::arranged(job, grid, settings, batches, project, bounds, |splats, _| splats)
    }

    /// [`Prepared::of_batches`], with the splats of a batch in the order in which `arrange` puts
    /// them for its bins.
    fn arranged<B: Send>(
        job: &Job<'_>,
        grid: &Grid,
        settings: &SplatSettings,
        batches: Vec<B>,
        project: impl Fn(&Projector<R>, B, &mut Vec<S>) -> Tally + Sync + Send,
        bounds: impl Fn(&S) -> Rect + Sync + Send,
        arrange: impl Fn(Vec<S>, &mut Bins) -> Vec<S> + Sync + Send,
    ) -> Self {
        let view = View::new(job.camera);
        let projector = Projector::new(view, &settings.kernel, settings.cull);
        let results = job.exec.ordered(batches, |batch| {
            spend(Work::Project);
            let mut splats = Vec::new();
            let tally = project(&projector, batch, &mut splats);
            job.keep_touching(&mut splats, &bounds);
            let mut bins = Bins::new(grid, splats.len(), |i| bounds(&splats[i]));
            ((arrange(splats, &mut bins), bins), tally)
        });
        let tally = results.iter().fold(Tally::default(), |sum, (_, tally)| sum.plus(tally));
        Self {
            shared: Shared::new(&view, &settings.kernel),
            epsilon: R::from_f32(settings.epsilon.resolve(&job.scene.surfels)),
            tally,
            batches: results.into_iter().map(|(batch, _)| batch).collect(),
        }
    }

    /// An upper bound on how many splats [`Prepared::for_each`] visits.
    fn count(&self, tile: usize) -> usize {
        self.batches.iter().map(|(_, bins)| bins.count(tile)).sum()
    }

    /// Calls `visit` for each splat that may touch a tile, in the order of the items.
    #[inline(always)]
    pub(crate) fn for_each(&self, tile: usize, mut visit: impl FnMut(&S)) {
        for (splats, bins) in &self.batches {
            bins.for_each(tile, |i| visit(&splats[i as usize]));
        }
    }

    /// All records, batch by batch.
    pub(crate) fn records(&self) -> impl Iterator<Item = &S> {
        self.batches.iter().flat_map(|(splats, _)| splats)
    }

    /// Gathers the splats that touch a tile, in the order of the items; replaces the previous
    /// content of `gathered`. `touches` says whether a splat near the tile may touch the tile.
    #[inline(always)]
    pub(crate) fn gather(&self, tile: usize, touches: impl Fn(&S) -> bool, gathered: &mut Vec<S>)
    where
        S: Copy,
    {
        gathered.clear();
        gathered.reserve(self.count(tile));
        for (splats, bins) in &self.batches {
            // Exact bins hold only splats that touch the tile.
            let exact = bins.is_exact();
            bins.for_each(tile, |i| {
                let splat = &splats[i as usize];
                if exact || touches(splat) {
                    gathered.push(*splat);
                }
            });
        }
    }
}

/// How many of the `count` items go into one batch.
pub(crate) fn batch_size(grid: &Grid, count: usize) -> usize {
    // At most 8192 surfels, which fit the cache, and many batches, so that threads end together. At
    // least two items for each tile, so that the starts of the bins take about 2 bytes an item. If
    // there are so many tiles that this would put everything into one batch, four batches.
    (count / 64).min(8192).max(2 * grid.len()).min(count.div_ceil(4).max(1))
}

impl<R: Exact> Prepared<R, Splat<R>> {
    /// Every surfel as its splat, in ascending index.
    pub(crate) fn splats(job: &Job<'_>, settings: &SplatSettings) -> Self {
        let surfels = &job.scene.surfels;
        Self::new(
            job,
            &job.grid(),
            settings,
            surfels.len(),
            |projector, range, splats| {
                batch::splats(projector, surfels, range, |splat| splats.push(splat))
            },
            |splat| splat.bounds,
        )
    }
}
