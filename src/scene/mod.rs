//! Describe a scene: surfels and primitives, objects, cameras, lights and an environment.
//!
//! - [`bounds`]: the box and the sphere around a scene.
//! - [`cloud`]: points as a file holds them, nothing derived, nothing checked.
//! - [`objects`]: geometries that many objects share, and the motion of the objects.
//! - [`surfels`]: the checked structure of arrays that every method takes.
//! - [`boxes`]: boxes around neighbouring surfels.
//! - [`camera`]: perspective and orthographic cameras.
//! - [`coordinates`]: where points are in a texture.
//! - `degenerate`: which points cannot be surfels.
//! - [`environment`]: the light that surrounds a scene.
//! - [`excerpt`]: some surfels of a larger scene.
//! - [`gaussians`]: 3D Gaussians, which one method draws.
//! - [`groups`]: which surfels share a depth-image.
//! - [`hash`]: the identity of a scene.
//! - [`indexed`]: triangles, ribbons and tubes.
//! - [`light`]: lights and the Phong material.
//! - [`merge`]: join several models.
//! - [`mipmap`]: prefiltered colours of surfels.
//! - [`sides`]: how large surfels are drawn as point primitives.
//! - [`surface`]: opaque geometry that splats are mixed with.
//! - [`texture`]: textures, and their mean colours over ellipses.
//! - [`transform`]: move, turn and scale a model.

pub mod bounds;
pub mod boxes;
pub mod camera;
pub mod cloud;
pub mod coordinates;
mod degenerate;
pub mod environment;
pub mod excerpt;
pub mod gaussians;
pub mod groups;
pub mod hash;
pub mod indexed;
pub mod light;
pub mod merge;
pub mod mipmap;
pub mod objects;
pub mod sides;
mod slerp;
pub mod surface;
pub mod surfels;
pub mod texture;
pub mod transform;

pub use bounds::Sphere;
pub use boxes::Boxes;
pub use camera::{Camera, CameraMotion, Convention, Intrinsics, Lens, Pose, PoseMatrix};
pub use camera::{Projection, Stereo, Turntable};
pub use cloud::{Cloud, Property};
pub use coordinates::Coordinates;
pub use degenerate::Dropped;
pub use environment::Environment;
pub use excerpt::Excerpt;
pub use gaussians::{GaussianArrays, Gaussians};
pub use groups::Groups;
pub(crate) use groups::MAX_GROUPS;
pub use indexed::{Counts, Polylines, Primitives, Triangles, Vertices};
pub use light::{Light, Phong};
pub use mipmap::Mipmap;
pub use objects::{Geometry, Motion, Object, Objects};
pub use sides::Sides;
pub use surface::Surface;
pub use surfels::Surfels;
pub use texture::{Paint, Texture};
pub use transform::Similarity;

/// Everything that a picture shows: surfels, the lights on them, and what lies behind them.
///
/// The camera is not part of the scene, because one scene has many pictures.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name of the scene in reports: a file name or a procedural shape.
    pub name: String,
    /// The surfels, in the order that every sum and every tie follows.
    pub surfels: Surfels,
    /// Triangles, ribbons and tubes beside the surfels.
    pub primitives: Primitives,
    /// What was subtracted from every coordinate of the files: surfels, primitives, point lights and
    /// the camera are relative to this place.
    pub offset: glam::DVec3,
    /// The lights; without any, the resolved colour is shown unlit.
    pub lights: Vec<Light>,
    /// How the surface reflects the lights.
    pub material: Phong,
    /// The environment around the surfels; black if absent.
    pub environment: Option<Environment>,
    /// The objects, if the scene is made of objects. Surfels and primitives then belong to the
    /// objects in their places, or there are none until [`crate::source::flatten()`] puts them
    /// there.
    pub objects: Option<Objects>,
    /// 3D Gaussians, which the method `gaussians` draws; a scene that has any has nothing else.
    pub gaussians: Option<Gaussians>,
    /// How large surfels are drawn as point primitives, if the view chose sizes.
    pub sides: Option<Sides>,
    /// The opaque geometry of one view, which the method `gaussians` mixes with its splats by depth.
    pub surface: Option<Surface>,
    /// Which surfels of a larger scene these are, if they are not all.
    pub excerpt: Option<Excerpt>,
}

impl Scene {
    /// Makes a scene of surfels under one headlight, with the default material and no environment.
    #[must_use]
    pub fn lit(name: &str, surfels: Surfels) -> Self {
        Self { lights: vec![Light::DEFAULT], ..Self::unlit(name, surfels) }
    }

    /// How many surfels the scene has, those that were not loaded included.
    #[must_use]
    pub fn surfel_count(&self) -> u64 {
        self.excerpt.as_ref().map_or(self.surfels.len() as u64, Excerpt::total)
    }

    /// Makes a scene of 3D Gaussians, which have no lights.
    #[must_use]
    pub fn of_gaussians(name: &str, gaussians: Gaussians) -> Self {
        Self { gaussians: Some(gaussians), ..Self::unlit(name, Surfels::none()) }
    }

    /// Makes a scene of surfels that show their own colours.
    #[must_use]
    pub fn unlit(name: &str, surfels: Surfels) -> Self {
        Self {
            name: name.to_owned(),
            surfels,
            primitives: Primitives::default(),
            lights: Vec::new(),
            material: Phong::default(),
            offset: glam::DVec3::ZERO,
            environment: None,
            objects: None,
            gaussians: None,
            sides: None,
            surface: None,
            excerpt: None,
        }
    }
}
