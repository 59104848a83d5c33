//! Ids by the table of splits: the first id of each object, and everything else by search.

use crate::oracle::kit::dice::Dice;
use splatref::frame::NO_ID;
use splatref::scene::objects::{Ids, Split};

/// Where the ids of each object begin.
pub(crate) struct Numbers {
    pub(crate) split: Split,
    first: Vec<u64>,
    counts: Vec<u32>,
}

impl Numbers {
    /// By the first split that fits.
    pub(crate) fn new(counts: &[u32]) -> Option<Self> {
        let largest = counts.iter().copied().max().unwrap_or(0);
        let bits = (0..=32).find(|n| u64::from(largest) <= 1 << n)?;
        let wide = [Split::Stencil(20), Split::Stencil(bits)];
        let splits = [Split::Even, Split::Two, Split::Single(bits), wide[0], wide[1]];
        splits.into_iter().find_map(|split| Self::from_split(split, counts))
    }

    /// By a split, if it fits.
    pub(crate) fn from_split(split: Split, counts: &[u32]) -> Option<Self> {
        let mut first = Vec::new();
        let [mut large, mut small] = [0_u64; 2];
        for (object, &count) in (0_u64..).zip(counts) {
            let count = u64::from(count);
            let [number, room, bits] = match split {
                Split::Even => [object, 4096, 20],
                Split::Two if count > 1 << 17 => {
                    large += 1;
                    [large - 1, 2048, 20]
                }
                Split::Two => {
                    small += 1;
                    [small - 1, 16384, 17]
                }
                Split::Single(n) => [object, 1 << (32 - n), n.into()],
                Split::Stencil(32) => [object, 1 << 8, 32],
                // The numbers whose lowest 32 - n bits are 1 are left out.
                Split::Stencil(n) => {
                    [object + object / ((1 << (32 - n)) - 1), 1 << (40 - n), n.into()]
                }
            };
            if number >= room || count > 1 << bits {
                return None;
            }
            let scheme = u64::from(split == Split::Two && count <= 1 << 17) << 31;
            first.push(scheme | number << bits);
            // The last of a full object is the only one that may be the id of none.
            let last = (scheme | number << bits) + count.saturating_sub(1);
            if count > 0 && last & 0xFFFF_FFFF == u64::from(NO_ID) {
                return None;
            }
        }
        Some(Self { split, first, counts: counts.to_vec() })
    }

    pub(crate) fn id(&self, object: usize, surfel: u32) -> u64 {
        self.first[object] + u64::from(surfel)
    }

    /// Object and surfel of an id.
    pub(crate) fn find(&self, id: u64) -> Option<(usize, u32)> {
        let holds =
            |(first, count): (&u64, &u32)| (*first..first + u64::from(*count)).contains(&id);
        let object = self.first.iter().zip(&self.counts).position(holds)?;
        Some((object, (id - self.first[object]) as u32))
    }

    /// All surfels, ascending in their ids: object and surfel.
    pub(crate) fn every(&self) -> Vec<(usize, u32)> {
        let of = |o: usize| (0..self.counts[o]).map(move |s| (o, s));
        let mut all: Vec<_> = (0..self.counts.len()).flat_map(of).collect();
        all.sort_by_key(|&(o, s)| self.id(o, s));
        all
    }
}

fn name(object: usize) -> String {
    format!("object {object}")
}

/// The first and the last surfel, and some between.
fn some(dice: &mut Dice, count: u32) -> Vec<u32> {
    let mut all = vec![0, count - 1];
    all.extend((0..3).map(|_| dice.below(count as usize) as u32));
    all
}

/// Holds the crate's ids to the table.
fn compare(dice: &mut Dice, model: &Numbers, ids: &Ids) {
    let counts = &model.counts;
    assert_eq!(ids.split(), model.split, "{counts:?}");
    assert_eq!(ids.total(), counts.iter().map(|&n| u64::from(n)).sum::<u64>());
    assert_eq!(ids.is_wide(), matches!(model.split, Split::Stencil(_)));
    let mut order: Vec<u32> = (0..counts.len() as u32).collect();
    order.sort_by_key(|&o| model.first[o as usize]);
    assert_eq!(ids.order(), order, "{:?}", model.split);
    let few: Vec<_> = (0..20).map(|_| dice.below(counts.len())).collect();
    let chosen = few.into_iter().chain([0, counts.len() - 1]);
    for o in chosen.filter(|&o| counts[o] > 0) {
        assert_eq!(ids.count(o as u32), counts[o]);
        for s in some(dice, counts[o]) {
            let id = model.id(o, s);
            assert_eq!(ids.id(o as u32, s), id, "{o}, {s} in {:?}", model.split);
            assert_eq!(ids.find(id), Some((o as u32, s)), "{id:#x} in {:?}", model.split);
            assert_ne!(id as u32, NO_ID);
        }
        let beyond = model.id(o, 0) + u64::from(counts[o]);
        let found = ids.find(beyond).map(|(o, s)| (o as usize, s));
        assert_eq!(found, model.find(beyond), "beyond object {o} in {:?}", model.split);
    }
    assert_eq!(ids.find(NO_ID.into()), None);
}

/// Counts at the limits of a split, which one more surfel or object would leave.
fn counts(dice: &mut Dice) -> Vec<u32> {
    let limits = [1 << 20, 1 << 17, 1 << 13, 1 << 5, 1];
    let objects = [1, 3, 2047, 2049, 4095, 4096, 4097, 16384, 16385, 20000][dice.below(10)];
    let most = limits[dice.below(5)] + [0, 0, 1][dice.below(3)];
    let rare = [0, 1, 100][dice.below(3)];
    let count = |i: usize| match dice.below(4) {
        0 => most,
        1 => [0, 1][dice.below(2)],
        _ if i < rare => (1 << 17) + 1,
        _ => 1 + dice.below(most as usize) as u32,
    };
    (0..objects).map(count).collect()
}

#[test]
fn deferred_ids_are_those_of_the_table() {
    let (mut dice, mut used) = (Dice(41), std::collections::BTreeMap::new());
    for _ in 0..150 {
        let counts = counts(&mut dice);
        let (model, ids) = (Numbers::new(&counts), Ids::new(counts.clone(), name));
        assert_eq!(model.is_some(), ids.is_ok(), "{} objects: {ids:?}", counts.len());
        let split = model.as_ref().map(|model| format!("{:?}", model.split));
        *used.entry(split.unwrap_or_default()).or_insert(0) += 1;
        if let (Some(model), Ok(ids)) = (model, ids) {
            compare(&mut dice, &model, &ids);
        }
        let wide = [Split::Stencil(20), Split::Stencil(14), Split::Stencil(31)];
        let narrow = [Split::Even, Split::Two, Split::Single(17), Split::Single(12)];
        for split in narrow.into_iter().chain(wide) {
            let (model, ids) =
                (Numbers::from_split(split, &counts), Ids::with_split(split, &counts));
            assert_eq!(model.is_some(), ids.is_some(), "{split:?}");
            if let (Some(model), Some(ids)) = (model, ids) {
                compare(&mut dice, &model, &ids);
            }
        }
    }
    println!("{used:?}");
    for split in ["Even", "Two", "Stencil(20)"] {
        assert!(used.get(split).is_some_and(|n| *n > 3), "{split}: {used:?}");
    }
    assert!(used.keys().filter(|s| s.starts_with("Single")).count() >= 2, "{used:?}");
}

#[test]
fn deferred_the_id_of_none_takes_the_next_split() {
    let full = 1_u32 << 20;
    let split = |counts: Vec<u32>| Ids::new(counts, name).map(|ids| ids.split()).ok();
    let last = |count| [vec![1; 4095], vec![count]].concat();
    // 0xFFF in the upper bits and 0xFFFFF in the lower.
    assert_eq!(split(last(full - 1)), Some(Split::Even));
    assert_eq!(split(last(full)), Some(Split::Two));
    // In `Two` the last of 16384 full small objects would have it.
    let small = |last| [vec![full, 1 << 17], vec![1; 16382], vec![last]].concat();
    assert_eq!(split(small((1 << 17) - 1)), Some(Split::Two));
    assert_eq!(split(small(1 << 17)), Some(Split::Stencil(20)));
    // In `Single(19)` that of the last of 2^13, which are too large to be small and too many.
    let large = |last| [vec![1 << 19; 8191], vec![last]].concat();
    assert_eq!(split(large((1 << 19) - 1)), Some(Split::Single(19)));
    assert_eq!(split(large(1 << 19)), Some(Split::Stencil(20)));
    // Beyond all of them.
    assert_eq!(split(vec![u32::MAX - 1]), Some(Split::Single(32)));
    assert_eq!(split(vec![(1 << 31) + 1; 2]), Some(Split::Stencil(32)));
    assert_eq!(split(vec![(1 << 31) + 1; 257]), None);
    assert_eq!(split(vec![full; (1 << 20) - (1 << 8)]), Some(Split::Stencil(20)));
    assert_eq!(split(vec![full; (1 << 20) - (1 << 8) + 1]), None);
}
