//! The algebra of fragments, as plain functions with laws.
//!
//! - [`epsilon`]: which fragments belong to the visible surface.
//! - [`sum`]: weighted accumulation and normalization.

pub mod epsilon;
pub mod sum;
