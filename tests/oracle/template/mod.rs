//! Oracle for the reconstruction with templates of \[MOC08\].

pub(crate) mod cases;
mod cover;
mod known;
mod laws;
mod mirror;
mod model;
mod stages;
mod tolerance;
