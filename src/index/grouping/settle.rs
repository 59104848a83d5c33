//! Decisions of which each waits for some of its neighbours.
//!
//! Surfels are coloured, or added to a group, one after the other, in an order that has nothing to
//! do with where they lie. But a decision depends on the neighbours that come before it alone. So
//! places are decided in the order of the tree, where neighbours are close together in memory, and
//! each first has those decided that it waits for: the outcome is that of the order.
//!
//! Threads share nothing but the outcomes, each of which is one value whoever finds it. A thread
//! that needs an outcome that is not there finds it itself.

use super::graph::Row;
use crate::frame::Exec;
use std::ops::Range;

/// Places of one job.
const JOB: usize = 1 << 12;

/// A place that is being decided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) place: usize,
    /// How many of its neighbours have been asked, 64 at a time.
    pub(super) asked: usize,
    /// Which of the last 64 it waits for: none is asked twice but for these.
    pub(super) waits: u64,
    /// Which of the last 64 are decided, if who decides has yet to look at them.
    pub(super) decided: u64,
    /// What all came to.
    pub(super) mask: u64,
}

impl Open {
    const fn new(place: usize) -> Self {
        Self { place, asked: 0, waits: 0, decided: 0, mask: 0 }
    }

    /// The first of some of the last 64 neighbours.
    #[inline(always)]
    pub(super) fn first_of(&self, some: u64, row: &Row<'_>) -> Option<usize> {
        (some != 0).then(|| row.all[self.asked - 64 + some.trailing_zeros() as usize] as usize)
    }
}

/// Decides all of `count` places, as often as there are `questions`, which have nothing to do with each
/// other.
///
/// `step` goes on with a place and a question; it ends with the place decided, or with a neighbour that
/// is open and that must be decided before.
pub(super) fn settle(
    count: usize,
    questions: usize,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
    step: impl Fn(usize, &mut Open) -> Option<usize> + Sync + Send,
) {
    let job = |places: Range<usize>| {
        let mut waiting = Vec::new();
        // All questions of these places before other places: their rows are at hand.
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
