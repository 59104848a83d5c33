//! Oracle for discs in screen squares \[BJFM19, 4.2\].

mod cases;
mod exact;
mod known;
mod laws;
mod model;
mod stages;
