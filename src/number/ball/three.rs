//! The outcomes of comparisons of balls.

use crate::number::{Pixel, Truth};
use std::ops::{BitAnd, BitOr, Not};

/// Yes, no, or undecided; and the answer of the midpoints.
///
/// `&`, `|` and `!` are the operators of Kleene's logic. On the midpoints they give the result of
/// the same formula in `f64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Three {
    certainly: bool,
    middle: bool,
    possibly: bool,
}

impl Three {
    /// Whether all values say yes, the midpoints say yes, and some values say yes: each implies the
    /// next.
    #[inline(always)]
    pub(crate) fn new([certainly, middle, possibly]: [bool; 3]) -> Self {
        Self { certainly, middle, possibly }
    }

    /// The answer of the midpoints.
    #[inline(always)]
    #[must_use]
    pub fn middle(self) -> bool {
        self.middle
    }

    /// The answer that all values agree on; none if some say yes and some no.
    #[inline(always)]
    #[must_use]
    pub fn decided(self) -> Option<bool> {
        (self.certainly == self.possibly).then_some(self.certainly)
    }
}

impl From<bool> for Three {
    #[inline(always)]
    fn from(truth: bool) -> Self {
        Self::new([truth; 3])
    }
}

impl BitAnd for Three {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self {
            certainly: self.certainly & other.certainly,
            middle: self.middle & other.middle,
            possibly: self.possibly & other.possibly,
        }
    }
}

impl BitOr for Three {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self {
            certainly: self.certainly | other.certainly,
            middle: self.middle | other.middle,
            possibly: self.possibly | other.possibly,
        }
    }
}

impl Not for Three {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self { certainly: !self.possibly, middle: !self.middle, possibly: !self.certainly }
    }
}

impl Truth for Three {
    #[inline(always)]
    fn certainly(self) -> bool {
        self.certainly
    }
    #[inline(always)]
    fn possibly(self) -> bool {
        self.possibly
    }
}

/// The columns or rows that a coordinate may lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRange {
    least: u32,
    greatest: u32,
}

impl PixelRange {
    #[inline(always)]
    pub(super) fn new(least: u32, greatest: u32) -> Self {
        Self { least, greatest }
    }
}

impl Pixel for PixelRange {
    #[inline(always)]
    fn least(self) -> u32 {
        self.least
    }
    #[inline(always)]
    fn greatest(self) -> u32 {
        self.greatest
    }
}
