//! Laws of the operators.

mod bins;
pub(crate) mod groups;
mod over;
mod sums;
