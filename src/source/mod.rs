//! Make scenes and complete what files lack: attributes, shapes, plants, orders of points,
//! hierarchies.
//!
//! Complete and combine models:
//!
//! - [`mod@derive`]: complete the normals, radii and colours that a file lacks.
//! - [`mod@flatten`]: turn a scene of objects into a scene of surfels.
//! - [`viridis`]: colour points by a number of each.
//! - [`hybrid`]: draw a mesh as polygons on one side of a plane and as surfels on the other.
//! - [`scatter`]: place many objects at random.
//!
//! Make surfels from a mesh:
//!
//! - [`mod@candidates`]: turn the visible surface of a mesh into points.
//! - [`sampler`]: order points so that every prefix covers the surface.
//! - [`hierarchy`]: approximate a whole scene, coarser from level to level.
//!
//! Make test scenes:
//!
//! - [`procedural`]: make shapes whose true picture is known.
//! - [`plant`]: grow a tree of triangles, with ribbons and tubes that approximate it.

pub mod candidates;
pub mod derive;
pub mod flatten;
pub mod hierarchy;
pub mod hybrid;
pub mod plant;
pub mod procedural;
pub mod sampler;
pub mod scatter;
pub mod viridis;

pub use flatten::flatten;
pub use procedural::Shape;
pub use scatter::Scatter;
