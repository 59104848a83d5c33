//! What threads find out about the places of a tree, left in the parts in which they find it: to
//! copy it together would be work for one of them.

use super::disc_tree::{DISCS, DiscTree};
use crate::error::Result;
use crate::frame::Exec;
use std::ops::Range;

/// Blocks of a part.
const BLOCKS: usize = 64;
/// Places of a part.
const PLACES: usize = BLOCKS * DISCS;

/// Something for each part of a tree.
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
    /// `progress` gets how many places are done, and of how many.
    pub(super) fn compute(
        tree: &DiscTree,
        exec: &Exec,
        progress: &dyn Fn(u64, u64),
        job: impl Fn(Range<usize>) -> Result<T> + Sync + Send,
    ) -> Result<Self> {
        Self::in_place_of(Self::default(), tree, exec, progress, |places, _| job(places))
    }

    /// [`Parts::compute`], in the memory of those of before, of which each job gets its own.
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
    /// The part that a place is in, and which one the place is of that part.
    #[inline(always)]
    pub(super) fn with(&self, place: usize) -> (&T, usize) {
        (&self.0[place / PLACES], place % PLACES)
    }
}

impl<T: Copy> Parts<Vec<T>> {
    /// What there is of a place.
    #[inline(always)]
    pub(super) fn at(&self, place: usize) -> T {
        let (part, place) = self.with(place);
        part[place]
    }
}
