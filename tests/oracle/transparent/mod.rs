//! Algorithms 2 and 3 of \[ZP06\].

pub(crate) mod cases;
pub(crate) mod glass;
pub(crate) mod known;
pub(crate) mod laws;
pub(crate) mod model;
pub(crate) mod refused;
pub(crate) mod stages;
pub(crate) mod surroundings;
pub(crate) mod tolerance;
