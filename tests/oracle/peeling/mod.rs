//! Oracle for depth peeling.

mod model;
mod stages;
mod tolerance;
