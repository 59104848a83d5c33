//! What a frame saw: the state that deferred splatting carries from frame to frame \[GBP04, 4.3\].
//!
//! A flag stands for m consecutive surfels of one object, the last of an object for as many as are
//! left. It is a bit: m = 64 and 2^12 objects of 2^20 surfels take 8 MiB.

use crate::error::{Error, Result};
use crate::scene::objects::Ids;

/// Which groups of m consecutive surfels of each object a frame has selected, and how many surfels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// m.
    group: u32,
    /// How many surfels each object has.
    counts: Vec<u32>,
    /// The first word of each object, and the end of the last.
    starts: Vec<usize>,
    /// A bit a group; the groups of an object begin with a word.
    words: Vec<u64>,
    /// How many surfels of each object were selected.
    selected: Vec<u32>,
}

impl Seen {
    /// Nothing, in groups of `group` surfels.
    #[must_use]
    pub fn nothing(ids: &Ids, group: u32) -> Self {
        let counts: Vec<_> = (0..ids.order().len() as u32).map(|object| ids.all(object)).collect();
        let mut starts = vec![0];
        for &count in &counts {
            let words = (count.div_ceil(group) as usize).div_ceil(64);
            starts.push(starts[starts.len() - 1] + words);
        }
        let words = vec![0; starts[starts.len() - 1]];
        let selected = vec![0; counts.len()];
        Self { group, counts, starts, words, selected }
    }

    /// The groups of these surfels, each of which is there once: what the frame that selected them
    /// saw.
    #[must_use]
    pub fn of(ids: &Ids, group: u32, selected: &[u64]) -> Self {
        let mut seen = Self::nothing(ids, group);
        for (object, surfel) in selected.iter().filter_map(|&id| ids.find(id)) {
            let (word, bit) = seen.place(object, surfel);
            seen.words[word] |= bit;
            seen.selected[object as usize] += 1;
        }
        seen
    }

    /// What was seen, as it was told: how many surfels of each object were selected, and the words. None
    /// if it cannot be so: as many words, no flag of a group that does not exist, no more surfels than
    /// there are.
    #[must_use]
    pub fn restored(ids: &Ids, group: u32, selected: Vec<u32>, words: Vec<u64>) -> Option<Self> {
        if group == 0 {
            return None;
        }
        let empty = Self::nothing(ids, group);
        let few = |(selected, count): (&u32, &u32)| selected <= count;
        let fits = words.len() == empty.words.len()
            && selected.len() == empty.counts.len()
            && selected.iter().zip(&empty.counts).all(few);
        let exist = |object: usize| {
            let groups = empty.counts[object].div_ceil(group) as usize;
            let words = &words[empty.starts[object]..empty.starts[object + 1]];
            groups.is_multiple_of(64) || words.last().is_none_or(|last| last >> (groups % 64) == 0)
        };
        let sound = fits && (0..empty.counts.len()).all(exist);
        sound.then_some(Self { words, selected, ..empty })
    }

    /// How many surfels each object has.
    #[must_use]
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// The flags: of each object, from a word of its own on, a bit a group, the lowest first.
    #[must_use]
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// m.
    #[must_use]
    pub fn group(&self) -> u32 {
        self.group
    }

    /// How many surfels of each object were selected.
    #[must_use]
    pub fn selected(&self) -> &[u32] {
        &self.selected
    }

    /// Whether the group of a surfel was seen.
    #[must_use]
    pub fn has(&self, object: u32, surfel: u32) -> bool {
        let (word, bit) = self.place(object, surfel);
        self.words[word] & bit != 0
    }

    /// The surfels of all groups that were seen, of those that have ids; ascending.
    #[must_use]
    pub fn surfels(&self, ids: &Ids) -> Vec<u64> {
        let mut all = Vec::new();
        for &object in ids.order() {
            let (first, count) = (ids.id(object, 0), ids.count(object));
            let words = &self.words[self.starts[object as usize]..self.starts[object as usize + 1]];
            for (word, &bits) in (0_u32..).zip(words) {
                let mut bits = bits;
                while bits != 0 {
                    let from = (word * 64 + bits.trailing_zeros()) * self.group;
                    let to = count.min(from.saturating_add(self.group));
                    // Nothing if the group begins beyond the last id.
                    all.extend((from..to).map(|surfel| first + u64::from(surfel)));
                    bits &= bits - 1;
                }
            }
        }
        all
    }

    /// Whether this can be what a frame of such objects saw, in such groups.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is of other objects, or of other groups.
    pub fn check(&self, ids: &Ids, group: u32) -> Result<()> {
        if self.group != group {
            let (found, wanted) = (self.group, group);
            return Err(Error::Invalid(format!(
                "the state has groups of {found} surfels, the method {wanted}: set --flags {found}"
            )));
        }
        let same = self.counts.len() == ids.order().len()
            && (0..).zip(&self.counts).all(|(object, &count)| ids.all(object) == count);
        if same { Ok(()) } else { Err(Error::Invalid("the state is of another scene".into())) }
    }

    /// The word and the bit of a surfel's group.
    fn place(&self, object: u32, surfel: u32) -> (usize, u64) {
        let group = surfel / self.group;
        (self.starts[object as usize] + (group / 64) as usize, 1 << (group % 64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_flag_is_set_if_and_only_if_its_group_was_selected(
            counts in prop::collection::vec(0..400_u32, 1..6), group in 1..130_u32,
            picks in prop::collection::vec(any::<prop::sample::Index>(), 0..40),
        ) {
            let ids = Ids::new(counts.clone(), |_| String::new()).unwrap();
            let every: Vec<u64> = (0..counts.len() as u32)
                .flat_map(|o| (0..counts[o as usize]).map(move |s| (o, s)))
                .map(|(o, s)| ids.id(o, s))
                .collect();
            let mut chosen: Vec<u64> =
                picks.iter().filter(|_| !every.is_empty()).map(|i| every[i.index(every.len())]).collect();
            chosen.sort_unstable();
            chosen.dedup();
            let seen = Seen::of(&ids, group, &chosen);
            let of_group = |id: u64| {
                let (object, surfel) = ids.find(id).unwrap();
                (object, surfel / group)
            };
            let groups: Vec<_> = chosen.iter().map(|&id| of_group(id)).collect();
            let expected: Vec<u64> =
                every.iter().copied().filter(|&id| groups.contains(&of_group(id))).collect();
            prop_assert_eq!(&seen.surfels(&ids), &expected);
            for &id in &every {
                let (object, surfel) = ids.find(id).unwrap();
                prop_assert_eq!(seen.has(object, surfel), expected.contains(&id));
            }
            prop_assert_eq!(seen.selected().iter().sum::<u32>() as usize, chosen.len());
            prop_assert!(seen.check(&ids, group).is_ok());
            prop_assert!(seen.check(&ids, group + 1).is_err());
            let mut others = counts;
            others.push(3);
            prop_assert!(seen.check(&Ids::new(others, |_| String::new()).unwrap(), group).is_err());
        }
    }

    #[test]
    fn flags_take_the_memory_of_the_paper() {
        let ids = Ids::new(vec![(1 << 20) - 1; 1 << 12], |_| String::new()).unwrap();
        let seen = Seen::nothing(&ids, 64);
        assert_eq!(seen.words.len() * 8, 8 << 20);
    }
}
