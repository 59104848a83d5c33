//! Depth peeling.

pub(crate) mod stages;
