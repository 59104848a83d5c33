//! What makes a scene: derived attributes, procedural shapes, plants, samplers, and places of
//! many objects.
//!
//! - [`mod@candidates`]: what of a mesh is seen from outside, as points.
//! - [`mod@derive`]: from what a file gives to complete surfels.
//! - [`mod@flatten`]: a scene of objects as a scene of surfels.
//! - [`hierarchy`]: surfels of a whole scene, coarser from level to level.
//! - [`hybrid`]: a mesh as polygons here and surfels there.
//! - [`plant`]: a tree of triangles, and the ribbons and tubes that stand for the tree.
//! - [`procedural`]: shapes whose true picture is known.
//! - [`sampler`]: points in an order of which every prefix is spread over all of them.
//! - [`scatter`]: places of many objects.

pub mod candidates;
pub mod derive;
pub mod flatten;
pub mod hierarchy;
pub mod hybrid;
pub mod plant;
pub mod procedural;
pub mod sampler;
pub mod scatter;

pub use flatten::flatten;
pub use procedural::Shape;
pub use scatter::Scatter;
