//! Reconstruction with templates of \[MOC08\].

mod cases;
mod cover;
mod known;
mod laws;
mod mirror;
mod model;
mod stages;
mod tolerance;
