//! The camera in the numbers of the arithmetic.

use crate::number::{Real, Vector3};
use crate::scene::{Camera, Projection};

/// A [`Camera`] over [`Real`]: the same `f32` inputs, exactly.
#[derive(Clone, Copy, Debug)]
pub struct View<R> {
    /// The first three rows of the view matrix.
    pub rows: [[R; 4]; 3],
    /// Whether the camera is perspective; else orthographic.
    pub perspective: bool,
    /// Horizontal scale.
    pub fx: R,
    /// Vertical scale.
    pub fy: R,
    /// Column of the principal point.
    pub cx: R,
    /// Row of the principal point.
    pub cy: R,
    /// Depth of the near plane.
    pub near: R,
    /// Width of the picture in pixels.
    pub width: R,
    /// Height of the picture in pixels.
    pub height: R,
}

impl<R: Real> View<R> {
    /// The numbers of a camera.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let m = camera.view_from_world;
        let row = |i: usize| m.row(i).to_array().map(R::from_f32);
        Self {
            rows: [row(0), row(1), row(2)],
            perspective: camera.projection == Projection::Perspective,
            fx: R::from_f32(camera.fx),
            fy: R::from_f32(camera.fy),
            cx: R::from_f32(camera.cx),
            cy: R::from_f32(camera.cy),
            near: R::from_f32(camera.near),
            width: R::from_f32(camera.width as f32),
            height: R::from_f32(camera.height as f32),
        }
    }

    /// A point in view space: each component `((m0 x + m1 y) + m2 z) + m3`.
    #[inline(always)]
    pub fn point(&self, world: Vector3<R>) -> Vector3<R> {
        let r = self.direction(world);
        Vector3::new(r.x + self.rows[0][3], r.y + self.rows[1][3], r.z + self.rows[2][3])
    }

    /// A direction in view space: each component `(m0 x + m1 y) + m2 z`.
    #[inline(always)]
    pub fn direction(&self, world: Vector3<R>) -> Vector3<R> {
        let row = |m: &[R; 4]| (m[0] * world.x + m[1] * world.y) + m[2] * world.z;
        Vector3::new(row(&self.rows[0]), row(&self.rows[1]), row(&self.rows[2]))
    }

    /// The nearness of a depth: 1/t, or -t under an orthographic camera.
    #[inline(always)]
    pub fn nearness(&self, depth: R) -> R {
        if self.perspective { R::ONE / depth } else { -depth }
    }
}
