//! What is given: surfels and primitives, cameras, lights, and what surrounds them.
//!
//! - [`bounds`]: what bounds a scene.
//! - [`cloud`]: points as a file holds them, nothing derived, nothing checked.
//! - [`objects`]: geometries that many objects share, and their motion.
//! - [`surfels`]: the checked structure of arrays that every method takes.
//! - [`boxes`]: what bounds neighbouring surfels.
//! - [`camera`]: perspective and orthographic cameras.
//! - [`coordinates`]: where points are in a texture.
//! - `degenerate`: which points can be no surfels.
//! - [`environment`]: the light that surrounds a scene.
//! - [`groups`]: which surfels share a depth-image.
//! - [`hash`]: the identity of a scene.
//! - [`indexed`]: triangles, ribbons and tubes.
//! - [`light`]: lights and the Phong material.
//! - [`merge`]: several models as one.
//! - [`mipmap`]: prefiltered colours of surfels.
//! - [`sides`]: how large surfels are drawn as point primitives.
//! - [`texture`]: textures, and means of them.
//! - [`transform`]: moving, turning and scaling a model.

pub mod bounds;
pub mod boxes;
pub mod camera;
pub mod cloud;
pub mod coordinates;
mod degenerate;
pub mod environment;
pub mod groups;
pub mod hash;
pub mod indexed;
pub mod light;
pub mod merge;
pub mod mipmap;
pub mod objects;
pub mod sides;
mod slerp;
pub mod surfels;
pub mod texture;
pub mod transform;

pub use boxes::Boxes;
pub use camera::{Camera, CameraMotion, Lens, Pose, Projection};
pub use cloud::{Cloud, Property};
pub use coordinates::Coordinates;
pub use degenerate::Dropped;
pub use environment::Environment;
pub use groups::Groups;
pub(crate) use groups::MAX_GROUPS;
pub use indexed::{Counts, Polylines, Primitives, Triangles, Vertices};
pub use light::{Light, Phong};
pub use mipmap::Mipmap;
pub use objects::{Geometry, Motion, Object, Objects};
pub use sides::Sides;
pub use surfels::Surfels;
pub use texture::{Paint, Texture};
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
    /// What the scene is made of, if it is made of objects. Surfels and primitives are then those of
    /// the objects in their places, or none until [`crate::source::flatten()`] puts them there.
    pub objects: Option<Objects>,
    /// How large surfels are drawn as point primitives, if somebody chose that for the view.
    pub sides: Option<Sides>,
}

impl Scene {
    /// Surfels under one headlight, of the default material, before nothing.
    #[must_use]
    pub fn lit(name: &str, surfels: Surfels) -> Self {
        Self { lights: vec![Light::DEFAULT], ..Self::unlit(name, surfels) }
    }

    /// Surfels that show their own colours.
    #[must_use]
    pub fn unlit(name: &str, surfels: Surfels) -> Self {
        Self {
            name: name.to_owned(),
            surfels,
            primitives: Primitives::default(),
            lights: Vec::new(),
            material: Phong::default(),
            environment: None,
            objects: None,
            sides: None,
        }
    }
}
