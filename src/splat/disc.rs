//! A surfel in the form that the projection takes.

use crate::number::{Real, Vector3};

/// A surfel in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc<R> {
    /// Centre.
    pub position: Vector3<R>,
    /// Unit normal.
    pub normal: Vector3<R>,
    /// Radius; ignored if there are tangents.
    pub radius: R,
    /// Half axes of an elliptical surfel.
    pub tangents: Option<[Vector3<R>; 2]>,
}

impl<R: Real> Disc<R> {
    /// The radius of a sphere that contains the surfel: r, or sqrt(U . U + V . V) for an ellipse,
    /// whose half axes need not be perpendicular.
    #[inline(always)]
    pub(crate) fn reach(&self) -> R {
        match self.tangents {
            None => self.radius,
            Some([u, v]) => (u.dot(u) + v.dot(v)).sqrt(),
        }
    }
}
