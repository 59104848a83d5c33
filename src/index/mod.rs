//! What is built once from a scene and asked for every view.
//!
//! - [`grouping`]: groups of surfels that do not overlap, so that a group shares one depth-image.
//! - [`order`]: surfels from back to front.

pub mod grouping;
pub mod order;
pub(crate) mod point_tree;
