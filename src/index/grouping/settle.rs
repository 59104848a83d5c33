//! Decisions of which each waits for some of its neighbours.
//!
//! Surfels are coloured, or added to a group, one after the other, in an order that has nothing to
//! do with where they lie. But a decision depends on the neighbours that come before it alone. So
//! places are decided in the order of the tree, where neighbours are close together in memory, and
//! each first has those decided that it waits for: the outcome is that of the order.
//!
//! Threads share nothing but the outcomes, each of which is one value whoever finds it. A thread
//! that needs an outcome that is not there finds it itself.

use crate::frame::Exec;
use std::ops::Range;

/// Places of one job.
const JOB: usize = 1 << 12;

/// A place that is being decided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) place: usize,
    /// How many of its neighbours have been asked.
    pub(super) asked: usize,
    /// What they came to.
    pub(super) mask: u64,
}

/// Decides all of `count` places.
///
/// `step` goes on with a place; it ends with the place decided, or with a neighbour that is open
/// and that must be decided before.
pub(super) fn settle(
    count: usize,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
    step: impl Fn(&mut Open) -> Option<usize> + Sync + Send,
) {
    let job = |places: Range<usize>| {
        let mut waiting = Vec::new();
        for place in places {
            waiting.push(Open { place, asked: 0, mask: 0 });
            while let Some(last) = waiting.last_mut() {
                match step(last) {
                    Some(place) => waiting.push(Open { place, asked: 0, mask: 0 }),
                    None => drop(waiting.pop()),
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
