//! What is rendered: surfels, camera, lights, and procedural scenes whose true picture is known.
//!
//! - [`bounds`]: what bounds a scene.
//! - [`cloud`]: points as a file holds them, nothing derived, nothing checked.
//! - [`surfels`]: the checked structure of arrays that every method takes.
//! - [`camera`]: perspective and orthographic cameras.
//! - [`mod@derive`]: from what a file gives to complete surfels.
//! - [`environment`]: the light that surrounds a scene.
//! - [`group`]: groups of surfels that do not overlap.
//! - [`hash`]: the identity of a scene.
//! - [`hybrid`]: a mesh as polygons here and surfels there.
//! - [`indexed`]: triangles, ribbons and tubes.
//! - [`light`]: lights and the Phong material.
//! - [`merge`]: several models as one.
//! - [`order`]: surfels from back to front, for every view.
//! - [`plant`]: a tree of triangles, and the ribbons and tubes that stand for it.
//! - [`procedural`]: shapes whose true picture is known.
//! - [`transform`]: moving, turning and scaling a model.

pub mod bounds;
pub mod camera;
pub mod cloud;
pub mod derive;
pub mod environment;
pub mod group;
pub mod hash;
pub mod hybrid;
pub mod indexed;
pub mod light;
pub mod merge;
pub mod order;
pub mod plant;
pub mod procedural;
pub mod surfels;
pub mod transform;
mod tree;

pub use camera::{Camera, Lens, Pose, Projection};
pub use cloud::Cloud;
pub use environment::Environment;
pub use indexed::{Counts, Polylines, Primitives, Triangles, Vertices};
pub use light::{Light, Phong};
pub use procedural::Shape;
pub use surfels::{Dropped, Surfels};
pub use transform::Similarity;

/// A picture to be made: surfels, what lights them, and what lies behind them.
///
/// The camera is not part of it: one scene has many pictures.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the scene is called in reports: a file name or a procedural shape.
    pub name: String,
    /// The surfels, in the order that every sum and every tie follows.
    pub surfels: Surfels,
    /// What there is beside them.
    pub primitives: Primitives,
    /// The lights; with none the resolved colour is shown unlit.
    pub lights: Vec<Light>,
    /// How the surface answers the lights.
    pub material: Phong,
    /// What surrounds the surfels; black if absent.
    pub environment: Option<Environment>,
}
