//! Candidates and samplers of \[BJFM19\], from their pages alone, to the last bit.

mod candidates;
pub(crate) mod cases;
mod known;
mod laws;
mod orders;
mod refused;
mod stages;
