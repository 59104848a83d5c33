//! Oracle for the 2+1-pass method.

pub(crate) mod cases;
mod known;
mod laws;
mod margin;
pub(crate) mod model;
pub(crate) mod splat;
pub(crate) mod stages;
mod tolerance;
