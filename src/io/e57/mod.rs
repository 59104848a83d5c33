//! Read scans from E57 files, with the feature `cli`.
//!
//! | record of a scan | becomes | details |
//! |---|---|---|
//! | `cartesianX`, `cartesianY`, `cartesianZ` | positions | in f64, turned and moved by the scan's `pose`; then as the `double` coordinates of a [`PLY`](super::ply), less an offset and rounded to `f32` once |
//! | `sphericalRange`, `sphericalAzimuth`, `sphericalElevation` | positions | of a scan without cartesian coordinates, see below |
//! | `colorRed`, `colorGreen`, `colorBlue` | colours | from the scan's colour limits, else the range of their type, to [0, 1]; **sRGB**, decoded in `f64` and rounded once |
//! | `intensity` | the property `intensity` | as it is stored, scaled; NaN where it is invalid |
//!
//! The scans of a file are joined in their order. With the range r, the azimuth a and the elevation e
//! of a point, and with the quaternion (w, v) and the translation t of the pose, in f64:
//!
//! ```text
//!   p = (r cos e cos a, r cos e sin a, r sin e)
//!   c = v x p + w p                   each product of vectors by components, in the order written
//!   position = (p + 2 (v x c)) + t
//! ```
//!
//! - The reader leaves out points whose coordinates are invalid or only a direction, and says how
//!   many.
//! - `Decided:` if only some points have a colour, the others are grey, (3/4, 3/4, 3/4).
//! - Every page of the file has a checksum, so a flipped bit is an error.
//!
//! The reader skips images, indices, returns and times. The crate e57 reads the file. Its memory
//! grows with the file: a value takes 24 bytes, and a damaged file may hold a value in each bit.

mod points;
mod scan;
#[cfg(test)]
mod tests;

use super::guard::guarded;
use super::ply::ReadOptions;
use super::{Reason, input};
use crate::error::{Error, Result};
use crate::scene::Cloud;
use std::path::Path;

/// Reads a file. Of the options, only `keep_place` applies.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes, options).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if the bytes are no E57, are damaged, or have no points with coordinates.
pub fn parse(bytes: &[u8], options: &ReadOptions) -> Reason<Cloud> {
    guarded(|| points::read(bytes, options)).flatten()
}
