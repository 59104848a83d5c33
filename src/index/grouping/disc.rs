//! A disc in space, and the dot product of this room.

use glam::DVec3;

/// A disc in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpaceDisc {
    /// Which surfel it is of.
    pub(super) surfel: u32,
    pub(super) center: DVec3,
    /// Of length 1.
    pub(super) normal: DVec3,
    pub(super) radius: f64,
}

/// `(x x' + y y') + z z'`.
pub(super) fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}
