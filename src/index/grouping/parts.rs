//! Results of parallel jobs over the places of a tree. The results stay in the parts that each job
//! produced, because copying them together would be work for one thread.

use super::disc_tree::{DISCS, DiscTree};
use crate::error::Result;
use crate::frame::Exec;
use std::ops::Range;

/// How many blocks a part has.
const BLOCKS: usize = 64;
/// How many places a part has.
const PLACES: usize = BLOCKS * DISCS;

/// One value for each part of a tree.
#[derive(Clone, Debug)]
pub(super) struct Parts<T>(Vec<T>);

impl<T> Default for Parts<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Send> Parts<T> {
    /// Runs a job for the places of each part, in parallel.
    ///
    /// `progress` receives how many places are done, and how many there are.
    pub(super) fn of(
        tree: &DiscTree,
        exec: &Exec,
        progress: &dyn Fn(u64, u64),
        job: impl Fn(Range<usize>) -> Result<T> + Sync + Send,
    ) -> Result<Self> {
        Self::in_place_of(Self::default(), tree, exec, progress, |places, _| job(places))
    }

    /// [`Parts::of`], reusing memory: each job gets its own part of `before`.
    pub(super) fn in_place_of(
        before: Self,
        tree: &DiscTree,
        exec: &Exec,
        progress: &dyn Fn(u64, u64),
        job: impl Fn(Range<usize>, Option<T>) -> Result<T> + Sync + Send,
    ) -> Result<Self> {
        const BATCH: usize = 256 * PLACES;
        let places = tree.surfel.len();
        let (mut before, mut parts) =
            (before.0.into_iter(), Vec::with_capacity(places.div_ceil(PLACES)));
        for batch in (0..places).step_by(BATCH) {
            progress(batch as u64, places as u64);
            let starts = (batch..places.min(batch + BATCH)).step_by(PLACES);
            let range = |start| (start..places.min(start + PLACES), before.next());
            let jobs = starts.map(range).collect();
            for part in exec.ordered(jobs, |(places, before)| job(places, before)) {
                parts.push(part?);
            }
        }
        progress(places as u64, places as u64);
        Ok(Self(parts))
    }
}

impl<T> Parts<T> {
    /// The part that contains a place, and the index of the place in that part.
    #[inline(always)]
    pub(super) fn with(&self, place: usize) -> (&T, usize) {
        (&self.0[place / PLACES], place % PLACES)
    }
}

impl<T: Copy> Parts<Vec<T>> {
    /// The value of a place.
    #[inline(always)]
    pub(super) fn at(&self, place: usize) -> T {
        let (part, place) = self.with(place);
        part[place]
    }
}
