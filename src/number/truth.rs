//! The outcome of a comparison, and the integer part of a number.

use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

/// The outcome of a comparison.
///
/// An exact number answers with a `bool`. A number that stands for all values in an interval has a
/// third answer, "undecided", where some of these values say yes and others no. Then `&`, `|` and
/// `!` are the operators of Kleene's logic. Only a `bool` can steer an `if`. A value that depends
/// on any other truth goes through [`Real::select`](super::Real::select); a decision about a
/// fragment or a cell goes to the caller.
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

/// The integer part of a coordinate: one column or row, or the least and the greatest column or row
/// that the coordinate may lie in.
pub trait Pixel: Copy + Debug + Send + Sync + 'static {
    /// The least column or row.
    fn least(self) -> u32;
    /// The greatest column or row.
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
