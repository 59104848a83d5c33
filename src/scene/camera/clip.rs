//! Read a camera from a projection matrix and the view matrix beside it, and write such a matrix.
//!
//! Both are given by rows and multiply column vectors: clip = P V world. A [`Convention`] says what
//! the graphics interface makes of clip space:
//!
//! ```text
//!   opengl   +y up     depth z / w from -1 to 1
//!   vulkan   +y down   depth z / w from 0 to 1
//!   d3d      +y up     depth z / w from 0 to 1      Direct3D, Metal, WebGPU
//! ```
//!
//! With Pij divided by |P32|, W and H the size, and s the sign of P32 (s = -1: the camera looks
//! along -z of V; s = 1: along +z), a perspective matrix has
//!
//! ```text
//!   fx = (W / 2) |P00|     cx = (W / 2) (1 + s P02)
//!   fy = (H / 2) |P11|     cy = (H / 2) (1 + q (s P12))       q = 1 for vulkan, else -1
//!   planes (P23 / (b - s P22)) for the bounds b of the depth
//! ```
//!
//! An orthographic matrix, with Pij divided by P33, has
//!
//! ```text
//!   fx = (W / 2) |P00|     cx = (W / 2) (1 + P03)
//!   fy = (H / 2) |P11|     cy = (H / 2) (1 + q P13)
//!   planes s ((b - P23) / P22) for the bounds b
//!   s = -1 if the sum of both (b - P23) / P22 is <= 0, else 1
//! ```
//!
//! The near plane is the lesser plane, and the far plane the other one. A plane of a perspective
//! matrix that is not a finite number > 0 counts as infinite. So reversed and infinite matrices are
//! read like the others. Everything is computed in f64 and rounded to `f32` once.
//!
//! The rows of the view matrix are V0 sx, V1 sy and V2 sz, with 0 added:
//!
//! ```text
//!   sx = the sign of P00     sy = q (-1) times the sign of P11     sz = -s
//! ```
//!
//! A perspective matrix with |P23| = 1 and |P32| other than 1 is refused as transposed, each within
//! 1e-6.
//!
//! # Flipped rows
//!
//! If sx sy sz times the determinant of V is negative, the two matrices mirror the world. A renderer
//! that flips y, because it reads its picture from the bottom or has a viewport of negative height,
//! writes such matrices: sx = 1, s = -1, and V is not mirrored. Then sy becomes -sy, and cy becomes
//! H - cy. Any other mirror is refused, because it belongs to a left-handed world.

use super::convention::{Convention, PoseMatrix, signed};
use super::{Camera, Intrinsics, Projection};
use glam::{DMat4, DVec4};

/// What the two matrices say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipCamera {
    /// Focal lengths and principal point.
    pub intrinsics: Intrinsics,
    /// The view matrix, in f64.
    pub view: DMat4,
    /// The near plane.
    pub near: f64,
    /// The far plane; infinite if there is none.
    pub far: f64,
}

/// How large an element that must be 0 may be, relative to the largest of its row.
const NOISE: f64 = 1e-6;

const LEFT_HANDED: &str = "the projection matrix and the pose mirror the picture, so the world is \
                           left-handed; negate z of all points and normals, and the third column \
                           of world to camera";

/// Reads both matrices for a picture of this size, see the [module](self).
///
/// # Errors
/// What is wrong with a matrix, and the cure.
pub fn from_clip(
    matrix: &DMat4,
    convention: Convention,
    size: [u32; 2],
    pose: PoseMatrix,
) -> Result<ClipCamera, String> {
    let (q, bounds) = match convention {
        Convention::OpenGl => (-1.0, [-1.0, 1.0]),
        Convention::Direct3d => (-1.0, [0.0, 1.0]),
        Convention::Vulkan => (1.0, [0.0, 1.0]),
        Convention::OpenCv | Convention::Blender => {
            let what = "the convention of a projection matrix is opengl, vulkan or d3d";
            return Err(what.into());
        }
    };
    let view = pose.world_to_camera()?;
    let mut lens = Numbers::new(matrix)?;
    let [low, high] = lens.planes(bounds)?;
    if lens.projection == Projection::Perspective && !(low.is_finite() && low > 0.0) {
        let what = "the projection matrix has no near plane in front of the camera; check its \
                    third row, and the convention";
        return Err(what.into());
    }
    let half = size.map(|side| f64::from(side) / 2.0);
    let [sx, sign_y] = lens.scale.map(|v| if v < 0.0 { -1.0 } else { 1.0 });
    let (mut sy, sz) = (-q * sign_y, -lens.s);
    let mut c = [half[0] * (1.0 + lens.offset[0]), half[1] * (1.0 + q * lens.offset[1])];
    let handed = view.determinant();
    if sx * sy * sz * handed < 0.0 {
        if !(sx > 0.0 && lens.s < 0.0 && handed > 0.0) {
            return Err(LEFT_HANDED.into());
        }
        (sy, c[1]) = (-sy, f64::from(size[1]) - c[1]);
    }
    let f = [half[0] * lens.scale[0].abs(), half[1] * lens.scale[1].abs()];
    let intrinsics = Intrinsics { size, projection: lens.projection, f, c };
    Ok(ClipCamera { intrinsics, view: signed(view, [sx, sy, sz]), near: low, far: high })
}

/// The projection matrix of a camera for [`Camera::view_from_world`], with the far plane at the depth
/// `far`, in f64. With n the near plane and f the far plane:
///
/// ```text
///   perspective    2 fx / W    0           1 - 2 cx / W    0            orthographic   2 fx / W    0           0    2 cx / W - 1
///                  0           2 fy / H    2 cy / H - 1    0                           0           2 fy / H    0    1 - 2 cy / H
///                  0           0           a               b                           0           0           c    d
///                  0           0           -1              0                           0           0           0    1
///
///   depth 0 to 1   a = f / (n - f)          b = n f / (n - f)      c = 1 / (n - f)    d = n / (n - f)
///   depth -1 to 1  a = (f + n) / (n - f)    b = 2 n f / (n - f)    c = 2 / (n - f)    d = (f + n) / (n - f)
/// ```
///
/// The second row is negated for Vulkan.
///
/// # Errors
/// If the convention has no clip space, or if the far plane is not behind the near plane.
pub fn to_clip(camera: &Camera, convention: Convention, far: f64) -> Result<DMat4, String> {
    let (up, whole) = match convention {
        Convention::OpenGl => (1.0, true),
        Convention::Direct3d => (1.0, false),
        Convention::Vulkan => (-1.0, false),
        Convention::OpenCv | Convention::Blender => {
            let what = "the convention of a projection matrix is opengl, vulkan or d3d";
            return Err(what.into());
        }
    };
    let [near, fx, fy, cx, cy] =
        [camera.near, camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    if !(far > near && far.is_finite()) {
        return Err(format!("the far plane {far} is not behind the near plane {near}"));
    }
    let [w, h] = camera.size().map(f64::from);
    let (x, y) = (2.0 * cx / w - 1.0, up * (1.0 - 2.0 * cy / h));
    let span = near - far;
    let rows = match camera.projection {
        Projection::Perspective => {
            let (a, b) = match whole {
                true => ((far + near) / span, 2.0 * near * far / span),
                false => (far / span, near * far / span),
            };
            [[-x, 0.0], [-y, 0.0], [a, b], [-1.0, 0.0]]
        }
        Projection::Orthographic => {
            let (a, b) = match whole {
                true => (2.0 / span, (far + near) / span),
                false => (1.0 / span, near / span),
            };
            [[0.0, x], [0.0, y], [a, b], [0.0, 1.0]]
        }
    };
    let diagonal = [2.0 * fx / w, up * 2.0 * fy / h];
    let row = |i: usize| {
        let [z, last] = rows[i];
        let of = |column: usize| if i == column { diagonal[i] } else { 0.0 };
        // Adding 0 turns -0 into 0.
        DVec4::new(of(0), of(1), z, last) + DVec4::ZERO
    };
    Ok(DMat4::from_cols(row(0), row(1), row(2), row(3)).transpose())
}

/// The numbers of a projection matrix.
struct Numbers {
    projection: Projection,
    /// P00 and P11.
    scale: [f64; 2],
    /// What moves the middle of clip space.
    offset: [f64; 2],
    /// P22 and P23.
    depth: [f64; 2],
    /// The sign of z in front of the camera.
    s: f64,
}

impl Numbers {
    fn new(matrix: &DMat4) -> Result<Self, String> {
        if !matrix.is_finite() {
            return Err("the projection matrix has a number that is not finite".into());
        }
        let is_w = |row: DVec4| {
            let others = if row.z.abs() > row.w.abs() {
                [row.x, row.y, row.w]
            } else {
                [row.x, row.y, row.z]
            };
            let most = row.abs().max_element();
            most > 0.0 && others.iter().all(|v| v.abs() <= NOISE * most)
        };
        let last = matrix.row(3);
        let is_one = |v: f64| (v.abs() - 1.0).abs() <= NOISE;
        let by_columns = "the projection matrix is by columns, or for row vectors; transpose it";
        if !is_w(last) {
            return Err(if is_w(matrix.col(3)) {
                by_columns.into()
            } else {
                "the last row of the projection matrix must be 0, 0, -1, 0 or 0, 0, 1, 0, or 0, 0, 0, 1 \
                 for an orthographic one; give the view matrix apart, as a pose"
                    .into()
            });
        }
        let perspective = last.z.abs() > last.w.abs();
        // A transposed perspective matrix has the same zeros, but its 1 is at the other place.
        if perspective && !is_one(last.z) && is_one(matrix.row(2).w) {
            return Err(by_columns.into());
        }
        let by = if perspective { last.z.abs() } else { last.w };
        if by < 0.0 {
            return Err("the projection matrix is negative; negate it".into());
        }
        let [x, y, z] = [0, 1, 2].map(|i| matrix.row(i) / by);
        // The element that moves the middle, and the elements that must be 0.
        let ((offset_x, zero_x), (offset_y, zero_y)) = match perspective {
            true => ((x.z, [x.y, x.w]), (y.z, [y.x, y.w])),
            false => ((x.w, [x.y, x.z]), (y.w, [y.x, y.z])),
        };
        for (scale, zeros) in [(x.x, zero_x), (y.y, zero_y), (z.abs().max_element(), [z.x, z.y])] {
            if !(zeros.iter().all(|v| v.abs() <= NOISE * scale.abs()) && scale != 0.0) {
                let what = "the projection matrix has skew, a turn or a shift of the eye; put turns \
                            and shifts into the pose, and leave skew out";
                return Err(what.into());
            }
        }
        let (projection, sign) = match perspective {
            true => (Projection::Perspective, if last.z < 0.0 { -1.0 } else { 1.0 }),
            false => (Projection::Orthographic, 1.0),
        };
        let (offset, depth) = ([offset_x * sign, offset_y * sign], [z.z, z.w]);
        Ok(Self { projection, scale: [x.x, y.y], offset, depth, s: sign })
    }

    /// The planes in ascending depth. This finds the sign of z of an orthographic matrix, because
    /// the planes are in front of the camera, or most of what is between them.
    fn planes(&mut self, bounds: [f64; 2]) -> Result<[f64; 2], String> {
        let [a, b] = self.depth;
        let planes = match self.projection {
            Projection::Perspective => bounds.map(|bound| {
                let plane = b / (bound - self.s * a);
                if plane.is_finite() && plane > 0.0 { plane } else { f64::INFINITY }
            }),
            Projection::Orthographic => {
                let [first, second] = bounds.map(|bound| (bound - b) / a);
                self.s = if first + second <= 0.0 { -1.0 } else { 1.0 };
                [self.s * first, self.s * second]
            }
        };
        if !planes.iter().any(|plane| plane.is_finite()) {
            let what = "the projection matrix has no depth: no plane is near; check its third row, \
                        and the convention";
            return Err(what.into());
        }
        let [x, y] = planes;
        Ok(if x < y { [x, y] } else { [y, x] })
    }
}

#[cfg(test)]
mod tests;
