//! Projection and binning: what both paths do first.

use super::Settings;
use crate::frame::{Bins, Exec, Grid};
use crate::number::Real;
use crate::scene::{Camera, Surfels};
use crate::splat::{Projector, Shared, Splat, Tally, View};
use std::ops::Range;

/// The splats of a picture in batches of ascending surfels, each with its bins.
#[derive(Debug)]
pub(super) struct Prepared<R> {
    pub(super) shared: Shared<R>,
    pub(super) epsilon: R,
    pub(super) batches: Vec<Batch<R>>,
    pub(super) tally: Tally,
}

/// The visible splats of a range of surfels.
#[derive(Debug)]
pub(super) struct Batch<R> {
    pub(super) splats: Vec<Splat<R>>,
    bins: Bins,
}

/// Projects a range of surfels and appends the visible splats.
type Project<R> = fn(&Projector<R>, &Surfels, Range<usize>, &mut Vec<Splat<R>>) -> Tally;

impl<R: Real> Prepared<R> {
    /// Projects every surfel and sorts the splats into tiles.
    pub(super) fn new(
        surfels: &Surfels,
        camera: &Camera,
        settings: &Settings,
        exec: &Exec,
        grid: &Grid,
        project: Project<R>,
    ) -> Self {
        let view = View::new(camera);
        let projector = Projector::new(view, &settings.kernel, settings.cull);
        let count = surfels.len();
        // Enough surfels that the starts of their bins, one a tile, take 4 bytes a surfel at most.
        let size = grid.len().max(16_384);
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let results = exec.ordered(ranges.collect(), |range: Range<usize>| {
            let mut splats = Vec::with_capacity(range.len());
            let tally = project(&projector, surfels, range, &mut splats);
            let bins = Bins::new(grid, splats.len(), |i| splats[i].bounds);
            (Batch { splats, bins }, tally)
        });
        let tally = results.iter().fold(Tally::default(), |sum, (_, tally)| sum.plus(tally));
        Self {
            shared: Shared::new(&view, &settings.kernel),
            epsilon: R::from_f32(settings.epsilon.resolve(surfels)),
            batches: results.into_iter().map(|(batch, _)| batch).collect(),
            tally,
        }
    }

    /// Calls `visit` for each splat that may touch a tile, in ascending surfel index.
    #[inline(always)]
    pub(super) fn for_each(&self, tile: usize, mut visit: impl FnMut(&Splat<R>)) {
        for batch in &self.batches {
            batch.bins.for_each(tile, |i| visit(&batch.splats[i as usize]));
        }
    }
}
