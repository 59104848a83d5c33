//! The camera in the numbers of the arithmetic.

use crate::number::{MapInline, Real, Vector3};
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
    /// Converts the numbers of a camera.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let m = camera.view_from_world;
        let row = |i: usize| m.row(i).to_array().map_inline(R::from_f32);
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
        let [x, y, z] = &self.rows;
        Vector3::new(turned(x, world), turned(y, world), turned(z, world))
    }

    /// The world-space direction of the ray of pixel (x, y); its length is any but 0.
    ///
    /// ```text
    ///   d = (((x + 1/2) - cx)/fx, -(((y + 1/2) - cy)/fy), -1)   orthographic: (0, 0, -1)
    ///   each component of the ray: (m0 d.x + m1 d.y) + m2 d.z   down a column of the view matrix
    /// ```
    ///
    /// This works because the inverse of a rotation is its transpose.
    #[inline(always)]
    pub fn ray(&self, x: u32, y: u32) -> Vector3<R> {
        let (px, py) = if self.perspective {
            (
                (R::from_f32(x as f32 + 0.5) - self.cx) / self.fx,
                -((R::from_f32(y as f32 + 0.5) - self.cy) / self.fy),
            )
        } else {
            (R::ZERO, R::ZERO)
        };
        let m = &self.rows;
        let column = |i: usize| (m[0][i] * px + m[1][i] * py) - m[2][i];
        Vector3::new(column(0), column(1), column(2))
    }

    /// The nearness of a depth: 1/t, or -t under an orthographic camera.
    #[inline(always)]
    pub fn nearness(&self, depth: R) -> R {
        R::select(self.perspective.into(), R::ONE / depth, -depth)
    }
}

/// A component of a direction. It is not a closure, because a closure would not be inlined where
/// numbers are balls.
#[inline(always)]
fn turned<R: Real>(row: &[R; 4], world: Vector3<R>) -> R {
    (row[0] * world.x + row[1] * world.y) + row[2] * world.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Lens, Pose};
    use glam::{DMat4, DVec3, DVec4};

    const POSE: Pose = Pose {
        eye: DVec3::new(3.0, -1.0, 2.0),
        target: DVec3::new(0.5, 0.25, -4.0),
        up: DVec3::new(0.25, 1.0, 0.125),
    };

    /// The point seen at a depth, by the inverse of the whole projection.
    fn unproject(camera: &Camera, x: u32, y: u32, t: f64) -> DVec3 {
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let scale = if camera.projection == Projection::Perspective { t } else { 1.0 };
        let column = (px - f64::from(camera.cx)) / f64::from(camera.fx) * scale;
        let row = (f64::from(camera.cy) - py) / f64::from(camera.fy) * scale;
        let world: DMat4 = camera.view_from_world.as_dmat4().inverse();
        (world * DVec4::new(column, row, -t, 1.0)).truncate()
    }

    #[test]
    fn the_ray_of_a_pixel_points_from_its_near_points_to_its_far_ones() {
        for lens in [Lens::FieldOfView(50.0), Lens::Orthographic(3.0)] {
            let camera = Camera::new(17, 9, POSE, lens).unwrap();
            for (x, y) in [(0, 0), (16, 8), (8, 4), (3, 7)] {
                let truth = unproject(&camera, x, y, 5.0) - unproject(&camera, x, y, 1.0);
                let ray = View::<f64>::new(&camera).ray(x, y);
                let ray = DVec3::new(ray.x, ray.y, ray.z).normalize();
                // The matrix is rounded to f32, so its transpose is its inverse to 2^-23 or so.
                assert!((ray - truth.normalize()).length() < 1e-6, "{ray} {truth}");
                let single = View::<f32>::new(&camera).ray(x, y).normalized();
                let single = DVec3::new(single.x.into(), single.y.into(), single.z.into());
                assert!((ray - single).length() < 1e-6, "{ray} {single}");
            }
        }
    }
}
