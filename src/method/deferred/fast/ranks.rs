//! Rank surfels among all that passes 1 and 3 draw, in the order of their ids, and say which of them
//! pass 4 draws.

use super::super::visibility::NONE;
use crate::method::clock::{Work, spend};

/// Stands for a polygon in the place of a rank; higher than the rank of any surfel.
pub(super) const POLYGON: u32 = crate::frame::NO_ID - 1;

/// What passes 1 and 3 draw, as one list in ascending ids. The rank of a surfel is its place in the
/// list.
pub(super) struct Ranks {
    ids: Vec<u64>,
    of_flagged: Vec<u32>,
    of_fresh: Vec<u32>,
    /// Whether pass 4 draws each surfel of pass 1.
    kept: Vec<bool>,
}

/// Whether pass 4 draws each surfel of pass 1, and the ids of pass 4 that pass 1 did not draw. All lists
/// of ids ascend.
pub(super) fn compared(flagged: &[u64], selected: &[u64]) -> (Vec<bool>, Vec<u64>) {
    spend(Work::Difference);
    let (mut kept, mut fresh) = (vec![false; flagged.len()], Vec::new());
    let mut at = 0;
    for &id in selected {
        while at < flagged.len() && flagged[at] < id {
            at += 1;
        }
        if flagged.get(at) == Some(&id) {
            kept[at] = true;
        } else {
            fresh.push(id);
        }
    }
    (kept, fresh)
}

impl Ranks {
    /// Merges the ids of passes 1 and 3, which have none in common and ascend.
    pub(super) fn new(flagged: &[u64], kept: Vec<bool>, fresh: &[u64]) -> Self {
        spend(Work::Rank);
        let most = flagged.len() + fresh.len();
        let mut ids = Vec::with_capacity(most);
        let mut of_flagged = Vec::with_capacity(flagged.len());
        let mut of_fresh = Vec::with_capacity(fresh.len());
        let mut rest = flagged;
        for &id in fresh {
            let before = rest.iter().take_while(|&&other| other < id).count();
            let (run, others) = rest.split_at(before);
            rest = others;
            of_flagged.extend(ids.len() as u32..(ids.len() + run.len()) as u32);
            ids.extend_from_slice(run);
            of_fresh.push(ids.len() as u32);
            ids.push(id);
        }
        of_flagged.extend(ids.len() as u32..most as u32);
        ids.extend_from_slice(rest);
        Self { ids, of_flagged, of_fresh, kept }
    }

    /// How many surfels of pass 1 pass 4 draws.
    pub(super) fn kept(&self) -> u64 {
        self.kept.iter().filter(|kept| **kept).count() as u64
    }

    /// The rank of a surfel of pass 1.
    pub(super) fn of_flagged(&self, index: u32) -> u32 {
        self.of_flagged[index as usize]
    }

    /// The rank of a surfel of pass 3.
    pub(super) fn of_fresh(&self, index: u32) -> u32 {
        self.of_fresh[index as usize]
    }

    /// Whether pass 4 draws a surfel of pass 1.
    pub(super) fn keeps(&self, index: u32) -> bool {
        self.kept[index as usize]
    }

    /// The id of a rank.
    #[inline]
    pub(super) fn id(&self, rank: u32) -> u64 {
        self.ids.get(rank as usize).map_or(NONE, |&id| id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ranks_are_places_in_the_merged_list(
            all in prop::collection::btree_set(0..5000_u64, 0..1200), dense in 1..40_u64, kept in 1..9_u64,
        ) {
            let (fresh, flagged): (Vec<u64>, Vec<u64>) = all.iter().partition(|&&id| id % dense == 0);
            // Pass 4 draws what pass 3 draws, and some of what pass 1 draws.
            let draws = |id: &&u64| id.is_multiple_of(dense) || id.is_multiple_of(kept);
            let selected: Vec<u64> = all.iter().filter(draws).copied().collect();
            let (keeps, new) = compared(&flagged, &selected);
            prop_assert_eq!(&new, &fresh);
            let ranks = Ranks::new(&flagged, keeps, &fresh);
            for (rank, id) in (0..).zip(&all) {
                prop_assert_eq!(ranks.id(rank), *id);
                let own = match flagged.binary_search(id) {
                    Ok(index) => {
                        prop_assert_eq!(ranks.keeps(index as u32), selected.contains(id));
                        ranks.of_flagged(index as u32)
                    }
                    Err(_) => ranks.of_fresh(fresh.binary_search(id).unwrap() as u32),
                };
                prop_assert_eq!(own, rank);
            }
        }
    }
}
