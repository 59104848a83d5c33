//! What discs that overlap cover of each other, all radii as they are.

use super::disc_tree::DiscTree;
use super::graph::Graph;
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
    /// Whether the surfel at a place j is lower than that at i.
    #[inline(always)]
    pub(super) fn lower(&self, i: usize, j: usize) -> bool {
        self.tree.surfel[j] < self.tree.surfel[i]
    }

    /// For each place i, the samples that those discs j cover for which `by(i, j)` has bit 0 set,
    /// bit 1 and so on.
    pub(super) fn covered<const SETS: usize>(
        &self,
        by: impl Fn(usize, usize) -> u32 + Sync + Send,
        progress: &dyn Fn(u64, u64),
    ) -> Vec<[u64; SETS]> {
        let mut covered = Vec::with_capacity(self.tree.surfel.len());
        let job = |blocks| Ok(covered_by_neighbours(self.tree, self.graph, blocks, &by));
        let take = |part: Vec<_>| covered.extend(part);
        self.tree.parts(self.exec, progress, job, take).expect("nothing fails");
        covered
    }
}

vectorized!(
    /// [`Overlaps::covered`] for the places of some blocks.
    fn covered_by_neighbours<const SETS: usize, B: Fn(usize, usize) -> u32>(
        tree: &DiscTree,
        graph: &Graph,
        blocks: Range<usize>,
        by: &B,
    ) -> Vec<[u64; SETS]> {
        let mut covered = Vec::with_capacity(tree.places(blocks.end - 1).end);
        for i in tree.places(blocks.start).start..tree.places(blocks.end - 1).end {
            let (mut masks, mut samples) = ([0; SETS], None);
            // The sets that do not cover all yet.
            let mut open = (1 << SETS) - 1;
            for &j in graph.of(i) {
                let sets = by(i, j as usize) & open;
                if sets == 0 {
                    continue;
                }
                let samples = samples.get_or_insert_with(|| tree.samples(i));
                let mask = samples.covered_by(&tree.discs[j as usize]);
                let mut left = sets;
                while left != 0 {
                    let set = left.trailing_zeros();
                    let all: &mut u64 = &mut masks[set as usize];
                    *all |= mask;
                    open &= !(u32::from(*all == u64::MAX) << set);
                    left &= left - 1;
                }
                if open == 0 {
                    break;
                }
            }
            covered.push(masks);
        }
        covered
    }
);
