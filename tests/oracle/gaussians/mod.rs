//! Oracle for Gaussian splats, from the rustdoc alone.

mod blend;
mod bounds;
mod cases;
mod closed_forms;
mod harmonics;
mod laws;
mod model;
mod shape;
mod stages;
mod tolerance;
