//! Oracle for Algorithm 1 of \[ZP06\].

pub(crate) mod identity;
mod laws;
pub(crate) mod model;
pub(crate) mod range;
mod stages;
mod tolerance;
