//! How much of the neighbourhood is looked at.

use crate::error::{Error, Result};
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
        if before.saturating_add(pairs) <= 2 * self.most() { Ok(()) } else { Err(self.overrun()) }
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

    fn most(&self) -> u64 {
        64 * self.surfels as u64 + (1 << 20)
    }

    fn overrun(&self) -> Error {
        Error::Invalid(format!(
            "more than {} pairs of {} surfels overlap at c = {}, over 64 a surfel: give a lower \
             c or smaller radii",
            self.most(),
            self.surfels,
            self.factor
        ))
    }
}
