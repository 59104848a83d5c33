//! Approximate a whole scene by surfels, coarser from level to level \[BJFM19, 3.4\].
//!
//! [`crate::io::hierarchy`] stores such a hierarchy in a folder.
//!
//! - [`mod@approximate`]: choose the surfels of a node.
//! - [`mod@octree`]: build the tree, because "no such structure is available".
//! - [`parts`]: divide triangles among the nodes.
//! - [`flaws`]: count flaws of a mesh.

pub mod approximate;
pub mod flaws;
pub mod octree;
pub mod parts;

pub use approximate::{MOST, Sampler, Settings, Traversal, approximate};
pub use flaws::Flaws;
pub use octree::{Octree, octree};
pub use parts::{Numbers, Part};

/// A node with at most so many triangles is not divided. The paper's example is "each subtree that
/// consists of more than 10k triangles".
pub const BOUND: u64 = 10_000;
