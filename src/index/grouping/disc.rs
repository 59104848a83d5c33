//! A disc in space, and the dot product of this module.

use crate::scene::Sphere;
use glam::{DVec3, Vec3};

/// A disc in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpaceDisc {
    pub(super) center: Vec3,
    /// A unit vector.
    pub(super) normal: Vec3,
    pub(super) radius: f64,
}

impl SpaceDisc {
    /// Whether two discs are near by a factor, see the [module](super).
    #[inline(always)]
    pub(super) fn is_near(&self, other: &Self, factor: f64) -> bool {
        are_near(self.sphere(), other.sphere(), factor)
    }

    /// The sphere around it.
    #[inline(always)]
    pub(super) fn sphere(&self) -> Sphere {
        Sphere { center: self.center.as_dvec3(), radius: self.radius }
    }

    /// The cosine between the normals.
    #[inline(always)]
    pub(super) fn cosine(&self, other: &Self) -> f64 {
        dot(self.normal.as_dvec3(), other.normal.as_dvec3())
    }
}

/// Whether two discs, by their spheres, are near by a factor, see the [module](super).
#[inline(always)]
pub(super) fn are_near(a: Sphere, b: Sphere, factor: f64) -> bool {
    let (d, reach) = (a.center - b.center, factor * (a.radius + b.radius));
    dot(d, d) < reach * reach
}

/// `(x x' + y y') + z z'`.
#[inline(always)]
pub(super) fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}
