//! Depth peeling.

mod model;
mod stages;
mod tolerance;
