//! The 2+1-pass method: a renderer in f64 without tiles, bins or bounds.

pub(crate) mod cases;
pub(crate) mod known;
pub(crate) mod laws;
pub(crate) mod model;
pub(crate) mod splat;
pub(crate) mod stages;
