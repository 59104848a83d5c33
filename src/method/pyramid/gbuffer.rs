//! What the picture is shaded from: the planes that the definition and the fast path both leave.

use crate::frame::{Plane, Pool};
use crate::method::projection::Has;
use crate::scene::{Camera, Scene};

/// What is seen, pixel by pixel; vectors in world space.
pub(super) struct GBuffer<R> {
    /// See [`crate::method::projection::Kind`].
    pub(super) kind: Plane<u8>,
    /// 1 where something is seen, else 0.
    pub(super) alpha: Plane<R>,
    /// Depth t; +inf where nothing is seen.
    pub(super) depth: Plane<R>,
    /// Unit normals, if there is light or they were asked for.
    pub(super) normal: Option<Plane<[R; 3]>>,
    /// Unit tangents of tubes, the null vector elsewhere; if the scene has tubes.
    pub(super) tangent: Option<Plane<[R; 3]>>,
    /// Colours, if `colored`; else anything.
    pub(super) color: Plane<[R; 3]>,
    /// Whether the scene has colours.
    pub(super) colored: bool,
}

impl GBuffer<f32> {
    /// What a scene needs, in memory that is used again: the values are any.
    pub(super) fn new(scene: &Scene, camera: &Camera, pool: &mut Pool) -> Self {
        let (size, has) = ([camera.width, camera.height], Has::of(scene));
        Self {
            kind: pool.count(size),
            alpha: pool.scalar(size),
            depth: pool.scalar(size),
            normal: (!scene.lights.is_empty()).then(|| pool.triple(size)),
            tangent: has.tangent.then(|| pool.triple(size)),
            color: pool.triple(size),
            colored: has.color,
        }
    }
}
