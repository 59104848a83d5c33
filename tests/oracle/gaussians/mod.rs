//! Oracle for Gaussian splats, from the rustdoc alone.

mod blend;
mod bounds;
mod cases;
mod closed_forms;
pub(crate) mod discs;
mod harmonics;
mod laws;
mod model;
mod shape;
mod stages;
mod tolerance;
