//! What comparisons and integer parts of numbers are.

use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

/// The outcome of a comparison.
///
/// A number that is exact answers with a `bool`. A number that stands for all values in an interval
/// has a third answer, "undecided", where some of these values say yes and others no: `&`, `|` and
/// `!` are then the operators of Kleene's logic. Only a `bool` can steer an `if`. A value that
/// depends on any other truth goes through [`Real::select`](super::Real::select); a decision about
/// a fragment or a cell is handed to the caller.
pub trait Truth:
    Copy
    + Debug
    + PartialEq
    + From<bool>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Not<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Whether every value says yes.
    fn certainly(self) -> bool;
    /// Whether some value says yes.
    fn possibly(self) -> bool;
}

impl Truth for bool {
    #[inline(always)]
    fn certainly(self) -> bool {
        self
    }
    #[inline(always)]
    fn possibly(self) -> bool {
        self
    }
}

/// The integer part of a coordinate: one column or row, or the least and the greatest that the
/// coordinate may lie in.
pub trait Pixel: Copy + Debug + Send + Sync + 'static {
    /// The least.
    fn least(self) -> u32;
    /// The greatest.
    fn greatest(self) -> u32;
}

impl Pixel for u32 {
    #[inline(always)]
    fn least(self) -> u32 {
        self
    }
    #[inline(always)]
    fn greatest(self) -> u32 {
        self
    }
}
