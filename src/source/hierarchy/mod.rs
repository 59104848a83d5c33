//! Hierarchies of surfel approximations \[BJFM19, 3.4\]: a whole scene, coarser from level to level.
//!
//! - [`mod@approximate`]: the surfels of a node.
//! - [`mod@octree`]: the tree, where "no such structure is available".
//! - [`flaws`]: what is wrong with a mesh.
//! - [`parts`]: the triangles of the nodes.

pub mod approximate;
pub mod flaws;
pub mod octree;
pub mod parts;

pub use approximate::{MOST, Sampler, Settings, Traversal, approximate};
pub use flaws::Flaws;
pub use octree::{Octree, octree};
pub use parts::{Numbers, Part};

/// Triangles of a node that is divided no further. The paper's example is "each subtree that consists of more than 10k
/// triangles".
pub const BOUND: u64 = 10_000;
