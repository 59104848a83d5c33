//! Remember what a frame saw: the state that deferred splatting carries from frame to frame
//! \[GBP04, 4.3\].
//!
//! A flag stands for m consecutive surfels of one object; the last flag of an object stands for as
//! many as are left. A flag is one bit: m = 64 and 2^12 objects of 2^20 surfels take 8 MiB. Flags
//! beyond the last set flag of an object take no memory, because in objects that are far away or
//! not seen they would be most of the flags.

use crate::error::{Error, Result};
use crate::scene::objects::Ids;
use std::ops::Range;

/// Which groups of m consecutive surfels of each object a frame has selected, and how many surfels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// m: the number of surfels of a flag.
    group: u32,
    /// How many surfels each object has.
    counts: Vec<u32>,
    /// The index of the first word of each object, and the end of the last.
    starts: Vec<usize>,
    /// One bit for each group. The groups of an object begin with a new word, and its last word is
    /// not 0.
    words: Vec<u64>,
    /// How many surfels of each object were selected.
    selected: Vec<u32>,
}

impl Seen {
    /// Starts with nothing seen, in groups of `group` surfels.
    #[must_use]
    pub fn nothing(ids: &Ids, group: u32) -> Self {
        let counts: Vec<_> = (0..ids.order().len() as u32).map(|object| ids.all(object)).collect();
        let (starts, selected) = (vec![0; counts.len() + 1], vec![0; counts.len()]);
        Self { group, counts, starts, words: Vec::new(), selected }
    }

    /// What the frame that selected these surfels saw; the ids must ascend, each once.
    #[must_use]
    pub fn from_selected(ids: &Ids, group: u32, selected: &[u64]) -> Self {
        let mut seen = Self::nothing(ids, group);
        let mut lengths = vec![0; seen.counts.len()];
        for (object, run) in ids.runs(selected) {
            let last = (run[run.len() - 1] - ids.id(object, 0)) as u32;
            lengths[object as usize] = (last / group / 64) as usize + 1;
            seen.selected[object as usize] = run.len() as u32;
        }
        seen.allocate(&lengths);
        for (object, run) in ids.runs(selected) {
            let (start, first) = (seen.starts[object as usize], ids.id(object, 0));
            for id in run {
                let flag = (id - first) as u32 / group;
                seen.words[start + (flag / 64) as usize] |= 1 << (flag % 64);
            }
        }
        seen
    }

    /// Restores a saved state: how many surfels of each object were selected, how many words of
    /// flags each object has, and the words. Returns none if the state is impossible: a flag of a
    /// group that does not exist, a word of 0 at the end, or more surfels than there are.
    #[must_use]
    pub fn restored(
        ids: &Ids,
        group: u32,
        selected: Vec<u32>,
        lengths: &[usize],
        words: Vec<u64>,
    ) -> Option<Self> {
        if group == 0 {
            return None;
        }
        let mut seen = Self::nothing(ids, group);
        let few = |(selected, count): (&u32, &u32)| selected <= count;
        if lengths.len() != seen.counts.len()
            || selected.len() != seen.counts.len()
            || !selected.iter().zip(&seen.counts).all(few)
            || lengths.iter().try_fold(0_usize, |sum, &n| sum.checked_add(n)) != Some(words.len())
        {
            return None;
        }
        seen.allocate(lengths);
        let exist = |object: usize| {
            let groups = seen.counts[object].div_ceil(group) as usize;
            let words = &words[seen.starts[object]..seen.starts[object + 1]];
            let Some(last) = words.last() else { return true };
            let used = words.len() * 64 - last.leading_zeros() as usize;
            *last != 0 && used <= groups
        };
        let sound = (0..seen.counts.len()).all(exist);
        sound.then_some(Self { words, selected, ..seen })
    }

    /// Makes room for this many words for each object, with no flag set.
    fn allocate(&mut self, lengths: &[usize]) {
        for (object, length) in lengths.iter().enumerate() {
            self.starts[object + 1] = self.starts[object] + length;
        }
        self.words = vec![0; self.starts[lengths.len()]];
    }

    /// How many surfels each object has, with and without ids, because a flag counts all surfels of
    /// an object.
    #[must_use]
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// The flags of an object, one bit for each group, the lowest first, up to the last word that
    /// is not 0.
    #[must_use]
    pub fn words(&self, object: u32) -> &[u64] {
        &self.words[self.starts[object as usize]..self.starts[object as usize + 1]]
    }

    /// m: the number of surfels of a flag.
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
        let flag = surfel / self.group;
        let word = self.words(object).get((flag / 64) as usize);
        word.is_some_and(|word| word >> (flag % 64) & 1 != 0)
    }

    /// The surfels of all groups that were seen, as far as they have ids. In ascending ids, it
    /// gives objects and ranges of their surfels; no range ends where the next begins.
    #[must_use]
    pub fn ranges(&self, ids: &Ids) -> Vec<(u32, Range<u32>)> {
        let mut all: Vec<(u32, Range<u32>)> = Vec::new();
        for &object in ids.order() {
            let (count, begin) = (ids.count(object), all.len());
            for (word, &bits) in (0_u32..).zip(self.words(object)) {
                let mut bits = bits;
                while bits != 0 {
                    let from = (word * 64 + bits.trailing_zeros()) * self.group;
                    let to = count.min(from.saturating_add(self.group));
                    bits &= bits - 1;
                    match all[begin..].last_mut() {
                        // These surfels have no ids in this view.
                        _ if from >= to => {}
                        Some((_, last)) if last.end == from => last.end = to,
                        _ => all.push((object, from..to)),
                    }
                }
            }
        }
        all
    }

    /// The ids of the surfels of all groups that were seen, ascending.
    #[must_use]
    pub fn surfels(&self, ids: &Ids) -> Vec<u64> {
        let ranges = self.ranges(ids).into_iter();
        ranges.flat_map(|(object, range)| range.map(move |i| ids.id(object, i))).collect()
    }

    /// Checks that this can be what a frame of these objects saw, in groups of this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the state belongs to other objects, or has other groups.
    pub fn check(&self, ids: &Ids, group: u32) -> Result<()> {
        if self.group != group {
            let (found, wanted) = (self.group, group);
            return Err(Error::Invalid(format!(
                "the state was kept with --flags {found}, but the method has {wanted}; set --flags \
                 {found}"
            )));
        }
        let same = self.counts.len() == ids.order().len()
            && (0..).zip(&self.counts).all(|(object, &count)| ids.all(object) == count);
        if same {
            Ok(())
        } else {
            Err(Error::Invalid(
                "the state belongs to another scene; give the scene that it was made with".into(),
            ))
        }
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
            let seen = Seen::from_selected(&ids, group, &chosen);
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
        // The last surfel of each object is selected.
        let ids = Ids::new(vec![(1 << 20) - 1; 1 << 12], |_| String::new()).unwrap();
        let last: Vec<u64> = (0..1 << 12).map(|object| ids.id(object, (1 << 20) - 2)).collect();
        let seen = Seen::from_selected(&ids, 64, &last);
        assert_eq!(seen.words.len() * 8, 8 << 20);
        // The first surfel of each object is selected: one word for each.
        let first: Vec<u64> = (0..1 << 12).map(|object| ids.id(object, 0)).collect();
        assert_eq!(Seen::from_selected(&ids, 64, &first).words.len(), 1 << 12);
        assert_eq!(Seen::nothing(&ids, 64).words.len(), 0);
    }
}
