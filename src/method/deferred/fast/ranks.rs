//! Rank surfels among all that passes 1 and 3 draw, in the order of their ids.

use super::super::visibility::NONE;
use crate::number::MapInline;

/// Stands for a polygon in the place of a rank; higher than the rank of any surfel.
pub(super) const POLYGON: u32 = crate::frame::NO_ID - 1;

/// Two ascending lists of ids without a common id, as one list.
pub(super) struct Ranks<'a> {
    flagged: &'a [u64],
    fresh: &'a [u64],
    /// How many flagged ids are less than each fresh id, and the rank of each fresh id.
    before: Sparse,
    of_fresh: Sparse,
}

impl<'a> Ranks<'a> {
    pub(super) fn new(flagged: &'a [u64], fresh: &'a [u64]) -> Self {
        let mut before = 0;
        let less = fresh.iter().map(|id| {
            before += flagged[before..].partition_point(|other| other < id);
            before as u32
        });
        let before: Vec<u32> = less.collect();
        let ranks = (0..).zip(&before).map(|(i, before)| i + before).collect();
        let most = flagged.len() + fresh.len();
        Self {
            flagged,
            fresh,
            before: Sparse::new(before, most),
            of_fresh: Sparse::new(ranks, most),
        }
    }

    /// The rank of a surfel of pass 1.
    pub(super) fn of_flagged(&self, index: u32) -> u32 {
        index + self.before.less(index + 1) as u32
    }

    /// The rank of a surfel of pass 3.
    pub(super) fn of_fresh(&self, index: u32) -> u32 {
        self.of_fresh.values[index as usize]
    }

    /// The id of a rank.
    #[inline]
    pub(super) fn id(&self, rank: u32) -> u64 {
        let before = self.of_fresh.less(rank);
        let id = match self.of_fresh.values.get(before) {
            Some(found) if *found == rank => self.fresh.get(before),
            _ => self.flagged.get(rank as usize - before),
        };
        id.map_or(NONE, |&id| id)
    }
}

/// Ascending numbers, few in the range that is queried.
struct Sparse {
    values: Vec<u32>,
    /// How many numbers are less than each multiple of [`STEP`].
    steps: Vec<u32>,
}

const STEP: usize = 256;

impl Sparse {
    /// Stores numbers of at most `most`.
    fn new(values: Vec<u32>, most: usize) -> Self {
        let mut less = 0;
        let steps = (0..=most / STEP + 2).map(|step| {
            let limit = step * STEP;
            while values.get(less).is_some_and(|&value| (value as usize) < limit) {
                less += 1;
            }
            less as u32
        });
        Self { steps: steps.collect(), values }
    }

    /// How many numbers are less than `value`.
    fn less(&self, value: u32) -> usize {
        let step = value as usize / STEP;
        let [from, to] = [self.steps[step], self.steps[step + 1]].map_inline(|less| less as usize);
        from + self.values[from..to].partition_point(|&other| other < value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ranks_are_places_in_the_merged_list(
            all in prop::collection::btree_set(0..5000_u64, 0..1200), dense in 1..40_u64,
        ) {
            let (fresh, flagged): (Vec<u64>, Vec<u64>) = all.iter().partition(|&&id| id % dense == 0);
            let ranks = Ranks::new(&flagged, &fresh);
            for (rank, id) in (0..).zip(all) {
                prop_assert_eq!(ranks.id(rank), id);
                let own = match flagged.binary_search(&id) {
                    Ok(index) => ranks.of_flagged(index as u32),
                    Err(_) => ranks.of_fresh(fresh.binary_search(&id).unwrap() as u32),
                };
                prop_assert_eq!(own, rank);
            }
        }
    }
}
