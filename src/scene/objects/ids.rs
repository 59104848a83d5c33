//! Put an object's index and a surfel's index into one id \[GBP04, 4.2\].
//!
//! An id has 32 bits, or 40 where 32 do not suffice. The lowest n bits are the surfel's index in
//! its object, and the others are the object's number. [`Split`] says how many bits each gets. A
//! scene takes the first of these splits that fits:
//!
//! ```text
//!   Even      n = 20: at most 4096 objects of at most 2^20 surfels
//!   Two       the highest bit is the scheme: 0, then 11 and 20 bits, for objects of more than 2^17
//!             surfels, at most 2048; 1, then 14 and 17 bits, for the others, at most 16384
//!   Single(n) the least n with which the largest object fits, for at most 2^(32 - n) objects
//!   Stencil(n) 8 bits more, those of the stencil buffer, above the 32; n = 20 as in Even, else the least n
//!             as in Single; for n < 32 no object has a number whose lowest 32 - n bits all are 1: at most
//!             2^(40 - n) - 2^8 objects of at most 2^n surfels
//! ```
//!
//! Objects are numbered from 0 in the order of the scene; in `Two` the objects of each scheme are
//! numbered separately. In `Stencil(n)` object o has the number o + floor(o / (2^(32 - n) - 1)), in
//! `Stencil(32)` o. `Single` takes the least n with which the largest object fits, or does not fit.
//!
//! [`NO_ID`] is never a surfel, and never the lowest 32 bits of one: a split in which a surfel
//! would have them does not fit. (`Decided:` \[GBP04\] calls it the most improbable indicator; a
//! scene in which it does occur takes the next split.) Planes of ids hold the lowest 32 bits; the
//! stages of [`deferred`](crate::method::deferred) leave the highest 8 of wider ids in planes
//! beside them. A plane of wide ids without the highest bits is not judged, because two surfels of
//! one picture may show the same number there.
//!
//! Where surfels are counted, they are counted in the order of their ids. This applies to the text
//! of an explanation or of a verdict by a method that draws all surfels one by one. It also applies
//! to a verdict on wide ids, and to planes of ids by a method that draws primitives beside surfels,
//! [`blue`](crate::method::blue), if the view draws at least one primitive: there the count
//! continues with the primitives after the surfels. In a view that draws no primitive, the planes of
//! `blue` hold ids.
//!
//! [`deferred`](crate::method::deferred) never counts: its planes hold ids, whether the scene has
//! primitives or not, and a pixel that shows a polygon holds [`NO_ID`].
//!
//! In an object with [levels of detail](super::detail) only the surfels that a view looks at have
//! ids, so the split may change from frame to frame. \[GBP04, 4.2\] has its two schemes for the
//! forest because most trees are far away.
//!
//! The order of every sum and of every tie in a scene of objects is the order of the ids: `Even`,
//! `Single` and `Stencil` keep the order of the scene, `Two` puts the large objects first.

use crate::error::{Error, Result};
use crate::frame::NO_ID;

/// How the bits of an id are divided, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// 12 bits of the object, 20 of the surfel.
    Even,
    /// 11 and 20 bits, or 14 and 17, after one bit that says which.
    Two,
    /// This many bits of the surfel, 0 to 32; the others are the object's.
    Single(u32),
    /// This many bits of the surfel, 0 to 32, of 40 in all; the others are the object's.
    Stencil(u32),
}

/// Bits of a surfel's index in a large object, and in a small one of [`Split::Two`].
const LARGE: u32 = 20;
const SMALL: u32 = 17;
/// Bits of the number of an object in [`Split::Two`], large and small.
const LARGE_OBJECTS: u32 = 11;
const SMALL_OBJECTS: u32 = 14;
/// Bits of ids that include the stencil buffer's bits.
const WIDE: u32 = 40;
/// The scheme bit of [`Split::Two`].
const SCHEME: u64 = 1 << 31;

/// The ids of the surfels of some objects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ids {
    split: Split,
    /// How many surfels of each object have ids.
    counts: Vec<u32>,
    /// How many surfels each object has.
    all: Vec<u32>,
    /// The id of the first surfel of each object.
    first: Vec<u64>,
    /// The objects in the order of their ids.
    order: Vec<u32>,
    /// How many surfels come before each object, in that order.
    before: Vec<u64>,
}

impl Ids {
    /// Makes the ids of objects with these numbers of surfels, by the first split that fits.
    ///
    /// # Errors
    /// [`Error::Invalid`] if none fits; with the limit, and the `name` of the object that breaks
    /// it.
    pub fn new(counts: Vec<u32>, name: impl Fn(usize) -> String) -> Result<Self> {
        Self::first(counts.clone(), counts, name)
    }

    /// Makes the ids of the first surfels of each object: the ones that a [view](super::detail)
    /// looks at. `counts` are their numbers, and `all` are the numbers of all surfels.
    ///
    /// # Errors
    /// As [`Ids::new`].
    pub fn first(counts: Vec<u32>, all: Vec<u32>, name: impl Fn(usize) -> String) -> Result<Self> {
        let most = counts.iter().copied().max().unwrap_or(0);
        let bits = bits_for(u64::from(most));
        let [single, wide] = [Split::Single(bits), Split::Stencil(bits)];
        let splits = [Split::Even, Split::Two, single, Split::Stencil(LARGE), wide];
        let fits = splits.into_iter().find_map(|split| Self::with_split(split, &counts));
        fits.map(|fits| Self { all, ..fits }).ok_or_else(|| {
            let objects = counts.len();
            // Either one object has too many surfels for its bits, or there are too many objects.
            let large = counts.iter().position(|&count| count == most && count > 1 << LARGE);
            let what = match large {
                Some(object) => format!(
                    "{} has {most} surfels, but ids of {objects} objects leave room for {} in \
                     each; split it",
                    name(object),
                    1_u64 << (WIDE - bits_for(objects as u64 + (1 << 8)))
                ),
                None => {
                    let room = (1_u64 << (WIDE - bits)) - (1 << 8);
                    let first = name(room as usize);
                    let than = format!("the {room} that ids have room for");
                    format!("{objects} objects are too many: {first} exceeds {than}")
                }
            };
            Error::Invalid(what)
        })
    }

    /// Makes the ids with a chosen split; none if it does not fit.
    #[must_use]
    pub fn with_split(split: Split, counts: &[u32]) -> Option<Self> {
        let numbers = |bits: u32| 0..1_u64 << bits;
        let (mut objects, mut small) = match split {
            Split::Even => (numbers(32 - LARGE), numbers(0)),
            Split::Two => (numbers(LARGE_OBJECTS), numbers(SMALL_OBJECTS)),
            Split::Single(bits) => (numbers(32_u32.checked_sub(bits)?), numbers(0)),
            Split::Stencil(bits) if bits <= 32 => (numbers(WIDE - bits), numbers(0)),
            Split::Stencil(_) => return None,
        };
        let mut first = Vec::with_capacity(counts.len());
        for &count in counts {
            let count = u64::from(count);
            let (start, room) = match split {
                Split::Two if count <= 1 << SMALL => {
                    (SCHEME | small.next()? << SMALL, 1_u64 << SMALL)
                }
                Split::Even | Split::Two => (objects.next()? << LARGE, 1 << LARGE),
                Split::Single(bits) => (objects.next()? << bits, 1 << bits),
                Split::Stencil(bits) => {
                    let last = (1 << (32 - bits)) - 1;
                    // A number whose lowest bits are all 1 could give a surfel the lowest 32 bits
                    // of `NO_ID`.
                    let number = objects.find(|number| bits == 32 || number & last != last);
                    (number? << bits, 1 << bits)
                }
            };
            if count > room || (start..start + count).contains(&u64::from(NO_ID)) {
                return None;
            }
            first.push(start);
        }
        let mut order: Vec<_> = (0..counts.len() as u32).collect();
        order.sort_by_key(|&object| first[object as usize]);
        let mut sum = 0;
        let before = order.iter().map(|&object| {
            sum += u64::from(counts[object as usize]);
            sum - u64::from(counts[object as usize])
        });
        let (before, counts) = (before.collect(), counts.to_vec());
        Some(Self { split, before, all: counts.clone(), counts, first, order })
    }

    /// The same surfels with another split; none if they do not fit.
    #[must_use]
    pub fn split_as(&self, split: Split) -> Option<Self> {
        Some(Self { all: self.all.clone(), ..Self::with_split(split, &self.counts)? })
    }

    /// The ids of no objects.
    #[must_use]
    pub fn none() -> Self {
        Self {
            split: Split::Even,
            counts: Vec::new(),
            all: Vec::new(),
            first: Vec::new(),
            order: Vec::new(),
            before: Vec::new(),
        }
    }

    /// How the bits are divided.
    #[must_use]
    pub fn split(&self) -> Split {
        self.split
    }

    /// The objects in the order of their ids.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Whether ids have more than 32 bits.
    #[must_use]
    pub fn is_wide(&self) -> bool {
        matches!(self.split, Split::Stencil(_))
    }

    /// How many surfels an object has, with and without ids.
    #[must_use]
    pub fn all(&self, object: u32) -> u32 {
        self.all[object as usize]
    }

    /// How many of an object's first surfels have ids.
    #[must_use]
    pub fn count(&self, object: u32) -> u32 {
        self.counts[object as usize]
    }

    /// How many ids there are.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().map(|&count| u64::from(count)).sum()
    }

    /// The id of a surfel of an object.
    #[must_use]
    pub fn id(&self, object: u32, surfel: u32) -> u64 {
        self.first[object as usize] + u64::from(surfel)
    }

    /// The id that has this many lower ids; none if there are not enough ids.
    #[must_use]
    pub fn nth(&self, rank: u64) -> Option<u64> {
        let after = self.before.partition_point(|&before| before <= rank);
        // Several objects may have this rank as their start; all but the last of them have no
        // surfels.
        let (&object, before) = (self.order.get(after.checked_sub(1)?)?, self.before[after - 1]);
        let surfel = rank - before;
        (surfel < u64::from(self.count(object))).then(|| self.first[object as usize] + surfel)
    }

    /// How many ids are lower than an id; none if the id belongs to no surfel.
    #[must_use]
    pub fn rank(&self, id: u64) -> Option<u64> {
        let (object, surfel) = self.find(id)?;
        let first = self.first[object as usize];
        let place = self.order.partition_point(|&other| self.first[other as usize] < first);
        Some(self.before[place] + u64::from(surfel))
    }

    /// The object and the surfel of an id; none if the id belongs to no surfel.
    #[must_use]
    pub fn find(&self, id: u64) -> Option<(u32, u32)> {
        let after = self.order.partition_point(|&object| self.first[object as usize] <= id);
        let object = self.order[after.checked_sub(1)?];
        let surfel = id - self.first[object as usize];
        (surfel < u64::from(self.count(object))).then_some((object, surfel as u32))
    }

    /// Splits ascending ids object by object: each object with the ids of its surfels. Ids that
    /// belong to no surfel are left out.
    pub fn runs<'a>(&'a self, ids: &'a [u64]) -> impl Iterator<Item = (u32, &'a [u64])> {
        let mut rest = ids;
        std::iter::from_fn(move || {
            loop {
                let &id = rest.first()?;
                let Some((object, _)) = self.find(id) else {
                    rest = &rest[1..];
                    continue;
                };
                let end = self.id(object, self.count(object));
                let (run, others) = rest.split_at(rest.partition_point(|&id| id < end));
                rest = others;
                return Some((object, run));
            }
        })
    }
}

/// How many bits hold the numbers below a count.
fn bits_for(count: u64) -> u32 {
    count.saturating_sub(1).checked_ilog2().map_or(0, |bit| bit + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The split of the ids, not the ids: nobody wants to read a million of them.
    fn split_of(counts: &[u32]) -> Result<Split> {
        Ids::new(counts.to_vec(), |object| format!("o{object}")).map(|ids| ids.split())
    }

    #[test]
    fn the_first_split_that_fits_is_taken() {
        let split = |counts: &[u32]| split_of(counts).unwrap();
        assert_eq!(split(&[1]), Split::Even);
        assert_eq!(split(&[1 << 20; 4095]), Split::Even);
        // The last surfel of the last object would be 0xFFFF_FFFF.
        assert_eq!(split(&[1 << 20; 4096]), Split::Stencil(20));
        let mut full = vec![1 << 20; 4096];
        full[4095] -= 1;
        assert_eq!(split(&full), Split::Even);
        // The paper's forest: 2048 large objects, 16384 small ones.
        let forest = |large: usize, small: usize| {
            let mut counts = vec![(1 << 20) - 1; large];
            counts.extend(vec![(1 << 17) - 1; small]);
            counts
        };
        assert_eq!(split(&forest(2048, 16384)), Split::Two);
        assert_eq!(split(&forest(2049, 16384)), Split::Stencil(20));
        assert_eq!(split(&[300; 100_000]), Split::Single(9));
        assert_eq!(split(&[u32::MAX - 1]), Split::Single(32));
        assert_eq!(split(&[750_000; 6800]), Split::Stencil(20));
        assert_eq!(split(&[1_100_000; 6800]), Split::Stencil(21));
    }

    #[test]
    fn what_fits_no_split_names_the_object_and_the_limit() {
        let words = |counts: &[u32]| split_of(counts).unwrap_err().to_string();
        let mut counts = vec![7; 5000];
        counts[4321] = (1 << 27) + 1;
        let what = "o4321 has 134217729 surfels, but ids of 5000 objects leave room for 134217728 in each; split it";
        assert_eq!(words(&counts), what);
        let many = vec![1 << 20; (1 << 20) - 255];
        let what =
            "1048321 objects are too many: o1048320 exceeds the 1048320 that ids have room for";
        assert_eq!(words(&many), what);
    }

    #[test]
    fn the_bits_are_those_of_the_paper() {
        let large = (1 << 17) + 1;
        let two = Ids::with_split(Split::Two, &[5, large, 7, large]).unwrap();
        assert_eq!(two.order(), [1, 3, 0, 2], "large objects first");
        assert_eq!(two.id(1, 9), 9);
        assert_eq!(two.id(3, 9), 1 << 20 | 9);
        assert_eq!(two.id(0, 4), 1 << 31 | 4);
        assert_eq!(two.id(2, 6), 1 << 31 | 1 << 17 | 6);
        let even = Ids::with_split(Split::Even, &[5, 6]).unwrap();
        assert_eq!(even.id(1, 3), 1 << 20 | 3);
        let stencil = Ids::with_split(Split::Stencil(20), &vec![1; 4098]).unwrap();
        // No object has the number 4095.
        assert_eq!(stencil.id(4094, 0), 4094 << 20);
        assert_eq!(stencil.id(4095, 0), 1 << 32, "the stencil has the high bits");
    }

    proptest! {
        #[test]
        fn ids_go_there_and_back(
            counts in prop::collection::vec(
                prop_oneof![0..4_u32, 131_070..131_075_u32, 1_048_570..1_048_577_u32], 1..9),
            at in any::<prop::sample::Index>(), which in any::<prop::sample::Index>(),
        ) {
            let most = *counts.iter().max().unwrap();
            let single = Split::Single(bits_for(u64::from(most)));
            let wide = Split::Stencil(bits_for(u64::from(most)));
            for split in [Split::Even, Split::Two, single, Split::Stencil(20), wide] {
                let Some(ids) = Ids::with_split(split, &counts) else { continue };
                let object = at.index(counts.len());
                prop_assert_eq!(ids.total(), counts.iter().map(|&c| u64::from(c)).sum::<u64>());
                if counts[object] > 0 {
                    let surfel = which.index(counts[object] as usize) as u32;
                    let id = ids.id(object as u32, surfel);
                    prop_assert_eq!(ids.find(id), Some((object as u32, surfel)));
                    prop_assert!(id as u32 != NO_ID, "{split:?}");
                    prop_assert!(ids.is_wide() || id < 1 << 32);
                }
                let total = ids.total();
                let rank = (total > 0).then(|| which.index(total as usize) as u64);
                if let Some(rank) = rank {
                    let id = ids.nth(rank).unwrap();
                    prop_assert_eq!(ids.rank(id), Some(rank));
                    prop_assert!(rank == 0 || ids.nth(rank - 1).unwrap() < id);
                }
                prop_assert_eq!(ids.nth(total), None);
                // In runs, all ids are there once, object by object, and ids of no surfel are not.
                let mut some: Vec<u64> = (0..total.min(9)).filter_map(|rank| ids.nth(rank)).collect();
                some.extend([u64::MAX - 1, u64::MAX]);
                let runs = ids.runs(&some);
                let runs = runs.flat_map(|(object, run)| run.iter().map(move |&id| (object, id)));
                let found = some.iter().filter_map(|&id| ids.find(id).map(|(object, _)| (object, id)));
                prop_assert!(runs.eq(found));
                // The id after the last one of an object belongs to no surfel, or is the first of
                // the next object.
                let end = ids.id(object as u32, counts[object]);
                prop_assert!(ids.find(end).is_none_or(|(_, surfel)| surfel == 0));
                prop_assert_eq!(ids.find(u64::from(NO_ID)), None);
            }
        }
    }
}
