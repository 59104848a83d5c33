//! Discs in squares of \[BJFM19, 4.2\].

mod cases;
mod exact;
mod known;
mod laws;
mod model;
mod stages;
