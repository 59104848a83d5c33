//! Read and write 3D Gaussians: the files of the programs that train, store and show them.
//!
//! | file | what it holds | what the reader does |
//! |---|---|---|
//! | `.ply` of the original program, of gsplat and of their kin | log scales, logit opacities, quaternions w x y z of any length, coefficients channel by channel | activates them, see [the properties](#the-properties-of-a-ply) |
//! | `.gltf`, `.glb` with [`KHR_gaussian_splatting`] | scales, opacities in \[0, 1\], quaternions x y z w, coefficients one by one | applies the transforms of nodes, see [below](#gltf); needs the feature `cli` |
//! | `.splat` | rows of 32 bytes: position and scale as floats, red, green, blue and opacity as bytes, a quaternion w x y z as bytes b that mean (b - 128) / 128 | a colour byte c becomes the coefficient (c / 255 - 1/2) / 0.2820947917738781, in f64, rounded once |
//! | `.spz`, versions 1 to 3 | a gzip stream: fixed-point positions; logarithms of scales, opacities, colours and coefficients of a byte each; quaternions without one part | decodes them, see [below](#spz); needs the feature `cli` |
//!
//! [`KHR_gaussian_splatting`]: https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_gaussian_splatting
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
//! - Without `scale_2`, the Gaussians are discs: the third scale is 0. `Decided:` the file chooses no
//!   setting. The reader says in [`GaussianFile::convention`] that the preset `2dgs` draws them as the
//!   program does that trains them; the others draw flat ellipsoids.
//! - `exp` is the correctly rounded `f32` if the file's number is one; otherwise it is computed in f64 and
//!   rounded once. Opacities are computed in f64, operation by operation as written, and rounded once.
//! - All colours are encoded as [sRGB](crate::scene::gaussians::Encoding::Srgb), because the programs train
//!   them on photographs.
//! - Normals and all other properties are skipped. So are other elements.
//! - A compressed PLY, with `packed_position` and its like, is refused by name.
//!
//! # glTF
//!
//! - The reader joins all primitives that have the extension, in the order of the nodes, depth first.
//!   A node may turn, move and scale them by positive factors. If the factors differ, other ellipsoids
//!   result. The coefficients are turned by the node's rotation. Shear and mirrors are refused.
//! - Attributes may be floats, or the integers that the extension allows, with strides and sparse
//!   accessors. An integer is decoded in f64 and rounded once. Buffers may be in the GLB, in the text as base64, or in
//!   files beside it.
//! - `Decided:` if a scale is negative, all scales that are floats are logarithms, as in the release
//!   candidate of the extension until 2026. The final text has linear scales, which are never negative.
//! - `colorSpace` is the [encoding](crate::scene::gaussians::Encoding). `COLOR_0` and materials are skipped.
//! - The reader warns about a kernel, a projection or a sorting method other than the extension's own, and
//!   about primitives without the extension. It refuses other required extensions by name: compression.
//!
//! The reader is our own, on `serde_json` and `base64`, which the program has anyway: the extension needs
//! accessors and nodes alone, and no crate that was found reads it.
//!
//! # SPZ
//!
//! [SPZ](https://github.com/nianticlabs/spz) holds one array after the other, which stand for these
//! numbers. Each is computed in f64 and rounded once; `exp` is that of a PLY.
//!
//! | bytes | become |
//! |---|---|
//! | positions: 3 integers of 24 bits | the integers, divided by 2^places; the header has the places |
//! | opacities: a byte b | b / 255 |
//! | colours: 3 bytes | the first coefficient, (b / 255 - 1/2) / 0.15 |
//! | scales: 3 bytes | exp(b / 16 - 10) |
//! | rotations, versions 1 and 2: 3 bytes | x, y and z: b / 127.5 - 1; w makes the length 1, and is 0 if they are longer |
//! | rotations, version 3: 32 bits | the index of the greatest part in 2 bits, and from x to w the others, each as a sign and 9 bits b: b / 511 sqrt(1/2); the greatest part makes the length 1 |
//! | the other coefficients: bytes, colour by colour of each coefficient | (b - 128) / 128 |
//!
//! - Version 1 was never released; its positions are half floats.
//! - `Decided:` the axes are kept as for all other files, nothing is turned. SPZ has x to the right, y up
//!   and z towards the viewer, as the cameras of this crate have. The PLY of a capture often has y down.
//! - A flag says that the Gaussians were trained with antialiasing: they are right with
//!   [compensated](crate::splat::gaussian::Compensation) opacities. The reader says so in
//!   [`GaussianFile::convention`], and changes no setting.
//! - Extensions of vendors are skipped with a warning. Degree 4 and versions from 4 on are refused.

#[cfg(feature = "cli")]
mod gltf;
mod splat;
#[cfg(feature = "cli")]
mod spz;
#[cfg(feature = "cli")]
mod write_ply;

#[cfg(feature = "cli")]
use super::replace::write_atomically;
use super::{extension, ply};
use crate::error::{Error, Result};
#[cfg(feature = "cli")]
use crate::scene::{Gaussians, gaussians::Encoding};
#[cfg(feature = "cli")]
use glam::DVec3;
use std::path::Path;

pub use super::activation::GaussianFile;

/// The kinds of files, by their extension.
enum Kind {
    Gltf,
    Splat,
    Spz,
    /// A PLY, or anything else, which only its header tells.
    Other,
}

fn kind(path: &Path) -> Kind {
    match extension(path).as_deref() {
        Some("gltf" | "glb") => Kind::Gltf,
        Some("splat") => Kind::Splat,
        Some("spz") => Kind::Spz,
        _ => Kind::Other,
    }
}

/// Whether a file holds 3D Gaussians, by its name and its header. False if it cannot be read.
#[must_use]
pub fn holds(path: &Path) -> bool {
    match kind(path) {
        Kind::Gltf | Kind::Splat | Kind::Spz => true,
        Kind::Other => ply::holds_gaussians(path),
    }
}

/// Reads a file by its extension; without a known one, as a PLY.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it holds no Gaussians, is truncated
/// or differs from its header, or lacks a number that Gaussians need.
pub fn read(path: &Path) -> Result<GaussianFile> {
    match kind(path) {
        #[cfg(feature = "cli")]
        Kind::Gltf => gltf::read(path),
        #[cfg(not(feature = "cli"))]
        Kind::Gltf => {
            Err(Error::format(path, "glTF is read with the feature `cli` of this crate only"))
        }
        Kind::Splat => splat::read(path),
        #[cfg(feature = "cli")]
        Kind::Spz => spz::read(path),
        #[cfg(not(feature = "cli"))]
        Kind::Spz => {
            Err(Error::format(path, "SPZ is read with the feature `cli` of this crate only"))
        }
        Kind::Other => ply::read_gaussians(path),
    }
}

/// Checks that [`write()`] writes files of this name.
///
/// # Errors
/// [`Error::Usage`] if not.
#[cfg(feature = "cli")]
pub fn check_name(path: &Path) -> Result<()> {
    if matches!(extension(path).as_deref(), Some("ply" | "glb")) {
        return Ok(());
    }
    let path = path.display();
    let what = format!("{path}: Gaussians are written as .ply or .glb; give such a name");
    Err(Error::Usage(what))
}

/// Writes Gaussians, as they are less `offset`, to a `.ply` or a `.glb`. Needs the feature `cli`.
///
/// A GLB gives the same Gaussians back, bit for bit. A PLY holds logarithms and logits: of those that
/// `f32` has, the writer takes one that gives the same number back, or else the nearest.
///
/// # Errors
/// As [`check_name`]. [`Error::Format`] if a PLY would hold linear colours,
/// which it cannot say, or a GLB 4 GiB. [`Error::Io`] as [`write_atomically`].
#[cfg(feature = "cli")]
pub fn write(path: &Path, gaussians: &Gaussians, offset: DVec3) -> Result<()> {
    check_name(path)?;
    if extension(path).as_deref() == Some("glb") {
        let write = gltf::write(gaussians, offset).map_err(|what| Error::format(path, what))?;
        return write_atomically(path, |out| write(out));
    }
    if gaussians.encoding() == Encoding::Linear {
        let what = "the colours are linear, but colours of a PLY are sRGB; give a .glb";
        return Err(Error::format(path, what));
    }
    write_atomically(path, |out| write_ply::write(gaussians, offset, out))
}
