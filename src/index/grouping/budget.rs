//! How much of the neighbourhood is looked at, and the memory that it takes.

use super::disc_tree::{DISCS, DiscTree, NearBlocks};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::lanes::vectorized;
use crate::progress::Progress;
use crate::scene::Surfels;
use std::sync::atomic::{AtomicU64, Ordering};

/// How many pairs of near surfels are looked at, at most.
///
/// Colours and average degree are much the same in practice (Table 1 of the paper), so that twice
/// as many neighbours on the average as there can be groups is more than any good scene needs. The
/// bound is for memory and time where a million surfels stand at one place.
#[derive(Debug)]
pub(super) struct Budget {
    surfels: usize,
    factor: f64,
    /// Ordered pairs: each pair counts twice.
    spent: AtomicU64,
}

impl Budget {
    /// For so many surfels, near by this factor.
    pub(super) fn new(surfels: usize, factor: f64) -> Self {
        Self { surfels, factor, spent: AtomicU64::new(0) }
    }

    /// Takes from the budget. Whether there is an error in the end does not depend on who asks
    /// when.
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

    /// [`Budget::spend`] once there are many pairs, which then are none: threads need not meet for
    /// each surfel.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    #[inline(always)]
    pub(super) fn spend_many(&self, pairs: &mut u64) -> Result<()> {
        if *pairs < 4096 { Ok(()) } else { self.spend(std::mem::take(pairs)) }
    }

    /// Whether those of a part can be counted.
    ///
    /// # Errors
    /// As [`Budget::spend`], of which a part has at most 2^32 - 1.
    pub(super) fn fits(&self, pairs: usize) -> Result<()> {
        if u32::try_from(pairs).is_ok() { Ok(()) } else { Err(self.overrun()) }
    }

    fn overrun(&self) -> Error {
        Error::Invalid(format!(
            "more than {} pairs of {} surfels overlap at c = {}, over 64 a surfel: give a lower \
             c or smaller radii",
            most(self.surfels),
            self.surfels,
            self.factor
        ))
    }
}

/// The most pairs of so many surfels.
fn most(surfels: usize) -> u64 {
    64 * surfels as u64 + (1 << 20)
}

/// Bytes of a surfel in the tree, and of what is known of each beside its neighbours.
const OF_A_SURFEL: [u64; 2] = [128, 144];
/// Bytes of a neighbour: in the graph of all, in that of a smaller c, and the grade of its edge.
const OF_A_NEIGHBOUR: u64 = 4 + 4 + 1;
/// The neighbours are counted of one block in so many.
const COUNTED: usize = 64;

impl DiscTree {
    /// Of all surfels, for groups of them by neighbours that are near by a factor.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the process may not hold what it takes.
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

/// Asks for what so many surfels take, their neighbours aside.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
fn ask_for_surfels(count: usize) -> Result<()> {
    let bytes = count as u64 * OF_A_SURFEL.iter().sum::<u64>();
    memory::ask(bytes, || format!("groups of {count} surfels"))
}

/// Asks for what the neighbours take that are near by a factor, where the tree is there already.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
fn ask_for_neighbours(tree: &DiscTree, factor: f64) -> Result<()> {
    let count = tree.surfel.len();
    let neighbours = about_so_many(tree, factor);
    let bytes = count as u64 * OF_A_SURFEL[1] + neighbours * OF_A_NEIGHBOUR;
    memory::ask(bytes, || format!("groups of {count} surfels with about {neighbours} neighbours"))
}

/// Room for so many surfels that are added to groups: of few neighbours here and many there, each may be
/// added to dozens.
///
/// # Errors
/// [`Error::Invalid`] if the process may not hold as much.
pub(super) fn room_for_added(count: u64) -> Result<Vec<(u32, u8)>> {
    let bytes = count * size_of::<(u32, u8)>() as u64;
    memory::ask(bytes, || format!("groups to which {count} surfels are added"))?;
    Ok(Vec::with_capacity(count as usize))
}

vectorized!(
    /// About how many neighbours there are, and no more than there may be: those at one block in
    /// [`COUNTED`] are counted.
    fn about_so_many(tree: &DiscTree, factor: f64) -> u64 {
        let n = tree.surfel.len();
        let blocks = (0..n).step_by(COUNTED * DISCS).map(|first| first..n.min(first + DISCS));
        let places = blocks.clone().map(|block| block.len()).sum::<usize>().max(1);
        let (each_for, most) = (n.div_ceil(places).max(1) as u64, 2 * most(n));
        // A million surfels at one place have a million squared.
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
