//! Lights and the material that answers them.

use glam::Vec3;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Light from infinitely far away.
    Directional {
        /// World-space direction *towards* the light; any length but 0.
        towards: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
    /// A directional light that moves with the camera, its direction given in view space.
    Headlight {
        /// View-space direction *towards* the light; any length but 0.
        towards: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
    /// Light from a point, without attenuation.
    Point {
        /// World-space position.
        position: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
}

/// The Phong reflection model: ambient + diffuse (n . l) + specular (r . v)^shininess.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Weight of the surface colour where no light arrives, in [0, 1].
    pub ambient: f32,
    /// Weight of the surface colour times n . l, in [0, 1].
    pub diffuse: f32,
    /// Weight of the light's colour times (r . v)^shininess, in [0, 1].
    pub specular: f32,
    /// Exponent of the highlight, at least 0.
    pub shininess: f32,
    /// Linear RGB of a surface whose surfels have no colour of their own.
    pub color: Vec3,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            ambient: 0.125,
            diffuse: 0.75,
            specular: 0.25,
            shininess: 32.0,
            color: Vec3::new(0.75, 0.75, 0.75),
        }
    }
}
