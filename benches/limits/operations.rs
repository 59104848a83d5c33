//! The operations of a stage, by what they cost.

use crate::counted::{Op, count};

/// How often each kind of operation was done.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Operations {
    /// Additions, subtractions, multiplications, comparisons, choices, floors.
    pub(crate) short: f64,
    /// Divisions and square roots.
    pub(crate) long: f64,
    /// exp and pow.
    pub(crate) exp: f64,
}

impl Operations {
    /// What some work does, and its result.
    pub(crate) fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        let (result, counts) = count(work);
        let sum = |kinds: &[Op]| kinds.iter().map(|kind| counts[*kind as usize] as f64).sum();
        let own = Self {
            short: sum(&[Op::Add, Op::Mul, Op::Compare, Op::Other]),
            long: sum(&[Op::Div, Op::Sqrt]),
            exp: sum(&[Op::Exp, Op::Pow]),
        };
        (result, own)
    }

    /// This, less what another did.
    pub(crate) fn without(self, other: Self) -> Self {
        // Work that a stage does not repeat would leave less than nothing.
        let less = |a: f64, b: f64| if a > b { a - b } else { 0.0 };
        Self {
            short: less(self.short, other.short),
            long: less(self.long, other.long),
            exp: less(self.exp, other.exp),
        }
    }

    /// Both.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            short: self.short + other.short,
            long: self.long + other.long,
            exp: self.exp + other.exp,
        }
    }

    /// So many times this.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { short: self.short * factor, long: self.long * factor, exp: self.exp * factor }
    }
}
