//! Read the pose of a camera from a 4 x 4 matrix, in the convention of another program.
//!
//! A matrix is given by rows and multiplies column vectors. Its last row is (0, 0, 0, 1), so three
//! rows are enough. World to camera takes a point of the world to the axes of the camera; camera to
//! world is its inverse, and its last column is the place of the camera. A convention says where
//! the axes of the camera point:
//!
//! ```text
//!   opencv            +x right   +y down   +z forward       COLMAP too
//!   opengl, blender   +x right   +y up     -z forward       nerfstudio and instant-ngp too
//! ```
//!
//! The world is never turned. Blender's world has +z up, and the matrix is in this world.
//!
//! # From a matrix to the view matrix
//!
//! In f64, each operation rounded. Let W be world to camera, with the rows W0, W1 and W2.
//! [`super::Camera::view_from_world`] has the rows
//!
//! ```text
//!   opengl, blender   W0     W1     W2
//!   opencv            W0    -W1    -W2
//! ```
//!
//! and then (0, 0, 0, 1). 0 is added to each element, which turns a -0 into +0. The elements are
//! rounded to `f32` once. Nothing is made orthonormal: the numbers are used as they are given.
//!
//! Camera to world, with the elements Lij and the last column t, is inverted first. The inverse has
//! the elements Rij and the last column u:
//!
//! ```text
//!   c00 = L11 L22 - L12 L21     c01 = L12 L20 - L10 L22     c02 = L10 L21 - L11 L20
//!   c10 = L02 L21 - L01 L22     c11 = L00 L22 - L02 L20     c12 = L01 L20 - L00 L21
//!   c20 = L01 L12 - L02 L11     c21 = L02 L10 - L00 L12     c22 = L00 L11 - L01 L10
//!   D   = (L00 c00 + L01 c01) + L02 c02
//!   Rij = cji / D               ui = -((Ri0 t0 + Ri1 t1) + Ri2 t2)
//! ```
//!
//! # What is refused
//!
//! [`TOLERANCE`] bounds every |element| of L L^T - I, where L is the upper left 3 x 3 block. A
//! matrix that is farther off is refused: as a scale, if L L^T is a multiple of I within the
//! tolerance, else as not orthonormal. A matrix with a determinant below 0 is refused as mirrored.
//! The last row may be off by [`TOLERANCE`], and then counts as (0, 0, 0, 1).

use crate::number::MapInline;
use crate::setting::{Word, Words};
use glam::{DMat4, DVec4};

/// How far L L^T of a pose may be from the unit matrix, see the [module](self).
pub const TOLERANCE: f64 = 5e-4;

/// Whose numbers these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// +x right, +y down, +z forward.
    OpenCv,
    /// +x right, +y up, -z forward; clip space has +y up and depths from -1 to 1.
    OpenGl,
    /// As OpenGL.
    Blender,
    /// Only a clip space: +y down, depths from 0 to 1.
    Vulkan,
    /// Only a clip space: +y up, depths from 0 to 1.
    Direct3d,
}

impl Words for Convention {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("opencv", Self::OpenCv),
        ("opengl", Self::OpenGl),
        ("blender", Self::Blender),
        ("vulkan", Self::Vulkan),
        ("d3d", Self::Direct3d),
    ];
}

impl Convention {
    /// The convention with this name.
    ///
    /// # Errors
    /// One line that lists the names.
    pub fn by_name(name: &str) -> Result<Self, String> {
        let words = || Self::OpenCv.words().join(", ");
        Self::named(name).ok_or_else(|| format!("no convention `{name}`; give one of {}", words()))
    }
}

/// A matrix, and which way it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoseMatrix {
    /// From the world to the axes of the camera.
    WorldToCamera(DMat4),
    /// From the axes of the camera to the world.
    CameraToWorld(DMat4),
}

impl PoseMatrix {
    /// The view matrix, in f64, see the [module](self).
    ///
    /// # Errors
    /// What is wrong with the matrix, and the cure.
    pub fn view(self, convention: Convention) -> Result<DMat4, String> {
        let world_to_camera = self.world_to_camera()?;
        check_handed(&world_to_camera)?;
        match convention {
            Convention::OpenGl | Convention::Blender => Ok(signed(world_to_camera, [1.0; 3])),
            Convention::OpenCv => Ok(signed(world_to_camera, [1.0, -1.0, -1.0])),
            Convention::Vulkan | Convention::Direct3d => {
                Err("the convention of a pose is opencv, \
                 opengl or blender; vulkan and d3d need a projection matrix"
                    .into())
            }
        }
    }

    /// The matrix from world to camera, checked; it may be mirrored.
    pub(super) fn world_to_camera(self) -> Result<DMat4, String> {
        let (Self::WorldToCamera(matrix) | Self::CameraToWorld(matrix)) = self;
        check(&matrix)?;
        Ok(match self {
            Self::WorldToCamera(matrix) => matrix,
            Self::CameraToWorld(matrix) => inverse(&matrix),
        })
    }
}

/// Checks a matrix that already is [`super::Camera::view_from_world`]; its numbers are used as they
/// are, a -0 too.
///
/// # Errors
/// As [`PoseMatrix::view`].
pub fn check_view(view: &DMat4) -> Result<(), String> {
    check(view)?;
    check_handed(view)
}

fn check_handed(matrix: &DMat4) -> Result<(), String> {
    if matrix.determinant() < 0.0 {
        return Err("the pose is mirrored: its determinant is negative; give a right-handed one \
                    (check the convention, and negate one axis)"
            .into());
    }
    Ok(())
}

/// Checks that a matrix is rigid; it may be mirrored.
pub(super) fn check(matrix: &DMat4) -> Result<(), String> {
    if !matrix.is_finite() {
        return Err("the pose has a number that is not finite".into());
    }
    let rows = [0, 1, 2].map(|i| matrix.row(i));
    let off = |row: DVec4, unit: DVec4| (row - unit).abs().max_element();
    if !(off(matrix.row(3), DVec4::W) <= TOLERANCE) {
        let last = matrix.row(3).to_array();
        // By columns, the translation is in the last row.
        return Err(if off(matrix.col(3), DVec4::W) <= TOLERANCE {
            "the pose is by columns: the last row has the translation; transpose the matrix".into()
        } else {
            format!("the last row of the pose is {last:?}; it must be 0, 0, 0, 1")
        });
    }
    let products = rows.map(|a| rows.map(|b| a.truncate().dot(b.truncate())));
    let farthest = |scale: f64| {
        let mut most: f64 = 0.0;
        for (i, row) in products.iter().enumerate() {
            for (j, product) in row.iter().enumerate() {
                let off = (product / scale - f64::from(i == j)).abs();
                // A NaN counts as far.
                if !(off <= most) {
                    most = off;
                }
            }
        }
        most
    };
    let off = farthest(1.0);
    if off <= TOLERANCE {
        return Ok(());
    }
    let square = (products[0][0] + products[1][1] + products[2][2]) / 3.0;
    Err(if square > 0.0 && farthest(square) <= TOLERANCE {
        let scale = square.sqrt();
        format!(
            "the pose has a scale of {scale:.6}; divide its first three columns by it, and scale \
             the model instead"
        )
    } else {
        format!(
            "the rotation of the pose is not orthonormal: a product of its rows is {off:.3e} off, \
             and {TOLERANCE:e} is allowed; give more digits, or a rotation without scale and shear"
        )
    })
}

/// The matrix with each of its first three rows times a sign, and 0 added.
pub(super) fn signed(matrix: DMat4, signs: [f64; 3]) -> DMat4 {
    let [x, y, z] = signs;
    let rows = [(0, x), (1, y), (2, z)];
    let [x, y, z] = rows.map_inline(|(i, sign)| matrix.row(i) * sign + DVec4::ZERO);
    DMat4::from_cols(x, y, z, DVec4::W).transpose()
}

/// The inverse of a rigid matrix, see the [module](self).
fn inverse(matrix: &DMat4) -> DMat4 {
    let [l0, l1, l2] = [0, 1, 2].map(|i| matrix.row(i).to_array());
    let minor = |a: [f64; 4], b: [f64; 4], i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    let c = [
        [minor(l1, l2, 1, 2), minor(l1, l2, 2, 0), minor(l1, l2, 0, 1)],
        [minor(l2, l0, 1, 2), minor(l2, l0, 2, 0), minor(l2, l0, 0, 1)],
        [minor(l0, l1, 1, 2), minor(l0, l1, 2, 0), minor(l0, l1, 0, 1)],
    ];
    let d = (l0[0] * c[0][0] + l0[1] * c[0][1]) + l0[2] * c[0][2];
    let t = [l0[3], l1[3], l2[3]];
    let row = |i: usize| {
        let r = [0, 1, 2].map(|j| c[j][i] / d);
        DVec4::new(r[0], r[1], r[2], -((r[0] * t[0] + r[1] * t[1]) + r[2] * t[2]))
    };
    DMat4::from_cols(row(0), row(1), row(2), DVec4::W).transpose()
}

#[cfg(test)]
pub(super) mod tests;
