//! Laws of the operators.

pub(crate) mod bins;
pub(crate) mod groups;
pub(crate) mod over;
