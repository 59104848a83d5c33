//! Oracle for Algorithms 2 and 3 of \[ZP06\].

pub(crate) mod cases;
mod glass;
mod known;
mod laws;
pub(crate) mod model;
mod refused;
pub(crate) mod settings;
pub(crate) mod stages;
pub(crate) mod surroundings;
mod tolerance;

pub(crate) use settings::Settings;
