//! Oracle for the candidates and samplers of \[BJFM19\], written from their pages alone and exact
//! to the last bit.

mod candidates;
pub(crate) mod cases;
mod known;
mod laws;
mod orders;
mod refused;
mod stages;
