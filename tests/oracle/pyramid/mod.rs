//! Oracle for the pull-push pyramid of \[MKC08\].

mod cases;
mod known;
mod laws;
mod model;
mod rays;
mod stages;
mod tolerance;
