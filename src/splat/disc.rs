//! A surfel as the projection takes it.

use crate::number::{Real, Vector3};

/// A surfel in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc<R> {
    /// Centre.
    pub position: Vector3<R>,
    /// Unit normal.
    pub normal: Vector3<R>,
    /// Radius; with tangents they count instead.
    pub radius: R,
    /// Half axes of an elliptical surfel.
    pub tangents: Option<[Vector3<R>; 2]>,
}

impl<R: Real> Disc<R> {
    /// The radius of a sphere that holds it: r, or sqrt(U . U + V . V) of an ellipse, whose half
    /// axes need not be perpendicular.
    #[inline(always)]
    pub(super) fn reach(&self) -> R {
        match self.tangents {
            None => self.radius,
            Some([u, v]) => (u.dot(u) + v.dot(v)).sqrt(),
        }
    }
}
