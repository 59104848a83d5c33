//! Read 3D Gaussians from the files of the programs that train and store them.
//!
//! | file | what it holds | what the reader does |
//! |---|---|---|
//! | `.ply` of the original program, of gsplat and of their kin | log scales, logit opacities, quaternions w x y z of any length, coefficients channel by channel | see [the properties](#the-properties-of-a-ply) |
//!
//! [`read`] activates the numbers. [`crate::scene::Gaussians::new`] checks them, and counts what cannot be
//! drawn.
//!
//! # The properties of a PLY
//!
//! A PLY holds Gaussians if its element `vertex` has `scale_0` and `rot_0`, or `f_dc_0`. The
//! properties may come in any order, as `float` or `double`, in ascii or in binary.
//!
//! | properties | become |
//! |---|---|
//! | `x y z` | positions; if they are `double`, less an offset, as those of [points](crate::io::ply) |
//! | `scale_0 scale_1 scale_2` | scales: `exp` of each number |
//! | `rot_0 rot_1 rot_2 rot_3` | rotations: w, x, y, z |
//! | `opacity` | opacities: `1 / (1 + exp(-x))` |
//! | `f_dc_0 f_dc_1 f_dc_2` | red, green and blue of the first coefficient |
//! | `f_rest_0` ... | the other coefficients: all of red, then all of green, then all of blue. 0, 9, 24 or 45 properties give degree 0, 1, 2 or 3 |
//!
//! - Without `scale_2`, the Gaussians are discs: the third scale is 0.
//! - `exp` is the correctly rounded `f32` if the file's number is one; otherwise it is computed in f64 and
//!   rounded once. Opacities are computed in f64, operation by operation as written, and rounded once.
//! - All colours are encoded as [sRGB](crate::scene::gaussians::Encoding::Srgb), because the programs train
//!   them on photographs.
//! - Normals and all other properties are skipped. So are other elements.
//! - A compressed PLY, with `packed_position` and its like, is refused by name.

mod activation;

use crate::error::Result;
use crate::io::ply;
use crate::scene::GaussianArrays;
use glam::DVec3;
use std::path::Path;

pub(in crate::io) use activation::{opacity, scale};

/// What a file holds: activated numbers, which nobody has checked yet.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianFile {
    /// The Gaussians, for [`crate::scene::Gaussians::new`].
    pub arrays: GaussianArrays,
    /// What the reader subtracted from the positions of the file, because `f32` would merge places
    /// that are far from 0.
    pub offset: DVec3,
    /// How the file stores its numbers, in words.
    pub convention: String,
    /// What the reader doubts about the file, and what mends it: one line each, without the name of
    /// the file.
    pub warnings: Vec<String>,
}

/// Whether a file holds 3D Gaussians, by its name and its header. False if it cannot be read.
#[must_use]
pub fn holds(path: &Path) -> bool {
    ply::holds_gaussians(path)
}

/// Reads a file.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read. [`crate::Error::Format`] if it holds no Gaussians,
/// is truncated or differs from its header, or lacks a number that Gaussians need.
pub fn read(path: &Path) -> Result<GaussianFile> {
    ply::read_gaussians(path)
}
