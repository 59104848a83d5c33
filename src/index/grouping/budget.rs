//! Limit how many neighbours are looked at, and the memory that they take.

use super::disc_tree::{DISCS, DiscTree, NearBlocks};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::lanes::vectorized;
use crate::progress::Progress;
use crate::scene::Surfels;
use std::sync::atomic::{AtomicU64, Ordering};

/// The most pairs of near surfels that are looked at.
///
/// In practice the number of colours and the average degree are much the same (Table 1 of the
/// paper). So an average of twice as many neighbours as there can be groups is more than any good
/// scene needs. The limit bounds memory and time where a million surfels stand at one place.
#[derive(Debug)]
pub(super) struct Budget {
    surfels: usize,
    factor: f64,
    /// Ordered pairs: each pair counts twice.
    spent: AtomicU64,
}

impl Budget {
    /// The budget for this many surfels that are near by this factor.
    pub(super) fn new(surfels: usize, factor: f64) -> Self {
        Self { surfels, factor, spent: AtomicU64::new(0) }
    }

    /// Spends from the budget. Whether there is an error in the end does not depend on the order of
    /// the calls.
    ///
    /// # Errors
    /// [`Error::Invalid`] if more is spent than there is.
    pub(super) fn spend(&self, pairs: u64) -> Result<()> {
        let before = self.spent.fetch_add(pairs, Ordering::Relaxed);
        if before.saturating_add(pairs) <= 2 * most(self.surfels) {
            Ok(())
        } else {
            Err(self.overrun())
        }
    }

    /// Calls [`Budget::spend`] once there are many pairs and resets their count, so that threads
    /// need not synchronize for each surfel.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    #[inline(always)]
    pub(super) fn spend_many(&self, pairs: &mut u64) -> Result<()> {
        if *pairs < 4096 { Ok(()) } else { self.spend(std::mem::take(pairs)) }
    }

    /// Checks that the pairs of a part can be counted in 32 bits.
    ///
    /// # Errors
    /// As [`Budget::spend`]; a part has at most 2^32 - 1 pairs.
    pub(super) fn fits(&self, pairs: usize) -> Result<()> {
        if u32::try_from(pairs).is_ok() { Ok(()) } else { Err(self.overrun()) }
    }

    fn overrun(&self) -> Error {
        Error::Invalid(format!(
            "more than {} pairs of {} surfels overlap at c = {}, over 64 a surfel; give a lower c \
             or smaller radii",
            most(self.surfels),
            self.surfels,
            self.factor
        ))
    }
}

/// The most pairs for this many surfels.
fn most(surfels: usize) -> u64 {
    64 * surfels as u64 + (1 << 20)
}

/// Bytes of a surfel in the tree, and bytes that are kept for each surfel beside its neighbours.
const OF_A_SURFEL: [u64; 2] = [128, 144];
/// Bytes of a neighbour: in the graph of all overlaps, in the graph of a smaller c, and the grade
/// of its edge.
const OF_A_NEIGHBOUR: u64 = 4 + 4 + 1;
/// Neighbours are counted for one block in this many.
const COUNTED: usize = 64;

impl DiscTree {
    /// Makes the tree of all surfels, for groups by neighbours that are near by a factor.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the process may not hold the memory.
    pub(super) fn of_all(
        surfels: &Surfels,
        factor: f64,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let count = surfels.len();
        ask_for_surfels(count)?;
        progress("sorting surfels", 0, 1);
        let tree = Self::new(surfels, 0..count as u32, exec);
        ask_for_neighbours(&tree, factor)?;
        Ok(tree)
    }
}

/// Asks for the memory of this many surfels, without their neighbours.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
fn ask_for_surfels(count: usize) -> Result<()> {
    let bytes = count as u64 * OF_A_SURFEL.iter().sum::<u64>();
    memory::ask(bytes, || format!("groups of {count} surfels"))
}

/// Asks for the memory of the neighbours that are near by a factor; the tree exists already.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
fn ask_for_neighbours(tree: &DiscTree, factor: f64) -> Result<()> {
    let count = tree.surfel.len();
    let neighbours = about_so_many(tree, factor);
    let bytes = count as u64 * OF_A_SURFEL[1] + neighbours * OF_A_NEIGHBOUR;
    memory::ask(bytes, || format!("groups of {count} surfels with about {neighbours} neighbours"))
}

/// Reserves room for this many surfels that are added to groups. Where few neighbours are near here
/// and many there, each surfel may be added to dozens of groups.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
pub(super) fn room_for_added(count: u64) -> Result<Vec<(u32, u8)>> {
    let bytes = count * size_of::<(u32, u8)>() as u64;
    memory::ask(bytes, || format!("groups to which {count} surfels are added"))?;
    Ok(Vec::with_capacity(count as usize))
}

vectorized!(
    /// Estimates the number of neighbours, at most the number allowed: it counts the neighbours of
    /// one block in [`COUNTED`].
    fn about_so_many(tree: &DiscTree, factor: f64) -> u64 {
        let n = tree.surfel.len();
        let blocks = (0..n).step_by(COUNTED * DISCS).map(|first| first..n.min(first + DISCS));
        let places = blocks.clone().map(|block| block.len()).sum::<usize>().max(1);
        let (each_for, most) = (n.div_ceil(places).max(1) as u64, 2 * most(n));
        // A million surfels at one place have a million squared, so counting stops at the limit.
        let enough = most / each_for;
        let (mut room, mut seen) = (NearBlocks::default(), 0);
        for place in blocks.flatten() {
            tree.near(place, factor, &mut room, |_, so_many| {
                seen += so_many as u64;
                seen < enough
            });
            if seen >= enough {
                return most;
            }
        }
        seen * each_for
    }
);
