//! Helpers that all oracles share.

pub(crate) mod case;
pub(crate) mod check;
pub(crate) mod condition;
pub(crate) mod dice;
pub(crate) mod draw;
pub(crate) mod eye;
pub(crate) mod goldens;
pub(crate) mod number;
mod pieces;
pub(crate) mod planes;
pub(crate) mod projection;
pub(crate) mod scene;
pub(crate) mod shade;
pub(crate) mod tolerance;
