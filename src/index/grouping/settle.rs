//! Make decisions in parallel where each decision waits for some of its neighbours.
//!
//! Surfels are coloured, or added to a group, one after the other, in an order that is unrelated to
//! their positions. But a decision depends only on the neighbours that come before it. So places
//! are decided in the order of the tree, where neighbours are close together in memory. Each place
//! first decides the places that it waits for, so the outcome is the outcome of the original order.
//!
//! Threads share nothing but the outcomes. An outcome has one value, whichever thread finds it. A
//! thread that needs a missing outcome finds it itself.

use super::graph::Row;
use crate::frame::Exec;
use std::ops::Range;

/// How many places one job has.
const JOB: usize = 1 << 12;

/// A place that is being decided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) place: usize,
    /// How many of its neighbours have been looked at, 64 at a time.
    pub(super) asked: usize,
    /// Which of the last 64 neighbours it waits for; only these are looked at again.
    pub(super) waits: u64,
    /// Which of the last 64 neighbours are decided and still have to be evaluated.
    pub(super) decided: u64,
    /// What all neighbours so far add up to.
    pub(super) mask: u64,
}

impl Open {
    const fn new(place: usize) -> Self {
        Self { place, asked: 0, waits: 0, decided: 0, mask: 0 }
    }

    /// The first of the marked ones among the last 64 neighbours.
    #[inline(always)]
    pub(super) fn first_of(&self, some: u64, row: &Row<'_>) -> Option<usize> {
        (some != 0).then(|| row.all[self.asked - 64 + some.trailing_zeros() as usize] as usize)
    }
}

/// Decides all of `count` places, once for each of the `questions`, which are independent of each
/// other.
///
/// `step` continues with a place and a question. It returns none when the place is decided, or else
/// an undecided neighbour that must be decided first.
pub(super) fn settle(
    count: usize,
    questions: usize,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
    step: impl Fn(usize, &mut Open) -> Option<usize> + Sync + Send,
) {
    let job = |places: Range<usize>| {
        let mut waiting = Vec::new();
        // All questions of these places come before other places, because their rows are in the
        // cache.
        for question in 0..questions {
            for place in places.clone() {
                waiting.push(Open::new(place));
                while let Some(last) = waiting.last_mut() {
                    match step(question, last) {
                        Some(place) => waiting.push(Open::new(place)),
                        None => drop(waiting.pop()),
                    }
                }
            }
        }
    };
    let batch = 64 * JOB;
    for first in (0..count).step_by(batch) {
        progress(first as u64, count as u64);
        let starts = (first..count.min(first + batch)).step_by(JOB);
        exec.ordered(starts.map(|start| start..count.min(start + JOB)).collect(), job);
    }
    progress(count as u64, count as u64);
}
