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

impl Ranks {
    /// Merges the ids of passes 1 and 3, which have none in common. `selected` are the ids of pass
    /// 4. All three ascend.
    pub(super) fn new(flagged: &[u64], fresh: &[u64], selected: &[u64]) -> Self {
        spend(Work::Rank);
        let most = flagged.len() + fresh.len();
        let mut ranks = Self {
            ids: Vec::with_capacity(most),
            of_flagged: Vec::with_capacity(flagged.len()),
            of_fresh: Vec::with_capacity(fresh.len()),
            kept: Vec::with_capacity(flagged.len()),
        };
        let (mut fresh, mut selected) = (fresh.iter().peekable(), selected.iter().peekable());
        for &id in flagged {
            while let Some(&before) = fresh.next_if(|&&other| other < id) {
                ranks.of_fresh.push(ranks.ids.len() as u32);
                ranks.ids.push(before);
            }
            while selected.next_if(|&&other| other < id).is_some() {}
            ranks.kept.push(selected.peek() == Some(&&id));
            ranks.of_flagged.push(ranks.ids.len() as u32);
            ranks.ids.push(id);
        }
        for &id in fresh {
            ranks.of_fresh.push(ranks.ids.len() as u32);
            ranks.ids.push(id);
        }
        ranks
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
            let ranks = Ranks::new(&flagged, &fresh, &selected);
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
