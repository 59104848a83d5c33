//! What discs that overlap cover of each other, all radii as they are.

use super::disc_tree::DiscTree;
use super::graph::Graph;
use super::parts::Parts;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use std::ops::Range;

/// Discs, and which of them overlap.
pub(super) struct Overlaps<'a> {
    pub(super) tree: &'a DiscTree,
    pub(super) graph: &'a Graph,
    pub(super) exec: &'a Exec,
}

impl Overlaps<'_> {
    /// For each set and place i, the samples that those discs j cover for which `by(i, j, lower)` has bit 0
    /// set, bit 1 and so on; `lower` tells whether the surfel at j has the lower index.
    pub(super) fn covered<const SETS: usize>(
        &self,
        by: impl Fn(usize, usize, bool) -> u32 + Sync + Send,
        progress: &dyn Fn(u64, u64),
    ) -> Parts<[Vec<u64>; SETS]> {
        let job = |places| Ok(covered_by_neighbours(self.tree, self.graph, places, &by));
        Parts::of(self.tree, self.exec, progress, job).expect("nothing fails")
    }
}

vectorized!(
    /// [`Overlaps::covered`] for some places.
    fn covered_by_neighbours<const SETS: usize, B: Fn(usize, usize, bool) -> u32>(
        tree: &DiscTree,
        graph: &Graph,
        places: Range<usize>,
        by: &B,
    ) -> [Vec<u64>; SETS] {
        // Side by side, as who asks for one set does not ask for the others.
        let mut covered = [(); SETS].map(|()| Vec::with_capacity(places.len()));
        for i in places {
            let (mut masks, row) = ([0; SETS], graph.of(i));
            for from in (0..row.all.len()).step_by(64) {
                let mut chosen = 0_u64;
                row.visit_64(from, |number, j, lower| {
                    chosen |= u64::from(by(i, j, lower) != 0) << number;
                });
                if chosen == 0 {
                    continue;
                }
                let samples = tree.samples(i);
                while chosen != 0 {
                    let at = from + chosen.trailing_zeros() as usize;
                    chosen &= chosen - 1;
                    let j = row.all[at] as usize;
                    let mask = samples.covered_by(&tree.discs[j]);
                    let sets = by(i, j, at < row.lower);
                    for (set, all) in masks.iter_mut().enumerate() {
                        *all |= if sets >> set & 1 == 1 { mask } else { 0 };
                    }
                }
            }
            for (covered, mask) in covered.iter_mut().zip(masks) {
                covered.push(mask);
            }
        }
        covered
    }
);
