//! Deferred splatting.

mod cases;
mod ids;
mod known;
mod laws;
mod model;
mod place;
mod stages;
mod tolerance;
