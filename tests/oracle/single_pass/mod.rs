//! Algorithm 1 of \[ZP06\].

pub(crate) mod identity;
pub(crate) mod laws;
pub(crate) mod model;
pub(crate) mod range;
pub(crate) mod stages;
