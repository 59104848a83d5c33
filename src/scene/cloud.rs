//! Points as a file holds them: nothing derived, nothing checked but the lengths of the arrays.

use super::group::Groups;
use glam::Vec3;

/// Points, with whatever else their file gave.
///
/// Every array that is there has the length of `position`. Values are unchecked: NaN, zero normals
/// and negative radii are dropped and counted when [`super::Surfels`] are made of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions in world units.
    pub position: Vec<Vec3>,
    /// Normals of any length.
    pub normal: Option<Vec<Vec3>>,
    /// Radii in world units.
    pub radius: Option<Vec<f32>>,
    /// Linear RGB; 8- and 16-bit colours of files are sRGB and have been decoded.
    pub color: Option<Vec<Vec3>>,
    /// Opacity in [0, 1].
    pub opacity: Option<Vec<f32>>,
    /// Half axes of elliptical surfels, in world units.
    pub tangents: Option<Vec<[Vec3; 2]>>,
    /// Groups of the points.
    pub groups: Option<Groups>,
    /// Triangles as indices into `position`; polygons of files have been cut into fans.
    pub triangles: Vec<[u32; 3]>,
}
