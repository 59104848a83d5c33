//! What overlapping discs cover of each other, with all radii as they are.

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
    /// For each set and each place i, finds what the discs j of the set cover. Disc j belongs to
    /// set 0 if bit 0 of `by(i, j, lower)` is set, to set 1 if bit 1 is set, and so on; `lower`
    /// tells whether the surfel at j has the lower index. For the first `COUNTED` sets the result
    /// is how many samples they leave open. For the next `TOLD` sets the result is which samples
    /// they cover.
    pub(super) fn covered<const COUNTED: usize, const TOLD: usize>(
        &self,
        by: impl Fn(usize, usize, bool) -> u32 + Sync + Send,
        progress: &dyn Fn(u64, u64),
    ) -> Covered<COUNTED, TOLD> {
        let job = |places| Ok(covered_by_neighbours(self.tree, self.graph, places, &by));
        Covered(Parts::compute(self.tree, self.exec, progress, job).expect("nothing fails"))
    }
}

/// What is covered of each place.
pub(super) struct Covered<const COUNTED: usize, const TOLD: usize>(Parts<Sets<COUNTED, TOLD>>);

/// What is covered of the places of a part. Sets are stored separately, because a caller that reads
/// one set does not read the others.
struct Sets<const COUNTED: usize, const TOLD: usize> {
    open: Vec<[u8; COUNTED]>,
    covered: [Vec<u64>; TOLD],
}

impl<const COUNTED: usize, const TOLD: usize> Covered<COUNTED, TOLD> {
    /// How many samples of a place each counted set leaves open.
    #[inline(always)]
    pub(super) fn open(&self, place: usize) -> [u8; COUNTED] {
        let (part, place) = self.0.with(place);
        part.open[place]
    }

    /// The samples of a place that a told set covers.
    #[inline(always)]
    pub(super) fn told(&self, set: usize, place: usize) -> u64 {
        let (part, place) = self.0.with(place);
        part.covered[set][place]
    }
}

vectorized!(
    /// [`Overlaps::covered`] for some places.
    fn covered_by_neighbours<
        const COUNTED: usize,
        const TOLD: usize,
        B: Fn(usize, usize, bool) -> u32,
    >(
        tree: &DiscTree,
        graph: &Graph,
        places: Range<usize>,
        by: &B,
    ) -> Sets<COUNTED, TOLD> {
        let mut open = Vec::with_capacity(places.len());
        let mut covered = [(); TOLD].map(|()| Vec::with_capacity(places.len()));
        for i in places {
            let (mut counted, mut told, row) = ([0_u64; COUNTED], [0; TOLD], graph.row(i));
            for from in (0..row.all.len()).step_by(64) {
                let mut chosen = 0_u64;
                row.visit_64(from, |number, j, lower| {
                    chosen |= u64::from(by(i, j, lower) != 0) << number;
                });
                // Most places have no neighbour in any set, and need no samples.
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
                    let of = |set: usize| if sets >> set & 1 == 1 { mask } else { 0 };
                    counted.iter_mut().enumerate().for_each(|(set, all)| *all |= of(set));
                    told.iter_mut().enumerate().for_each(|(set, all)| *all |= of(COUNTED + set));
                }
            }
            // Not `map_inline`: there may be no set.
            open.push(counted.map(|mask| mask.count_zeros() as u8));
            for (covered, mask) in covered.iter_mut().zip(told) {
                covered.push(mask);
            }
        }
        Sets { open, covered }
    }
);
