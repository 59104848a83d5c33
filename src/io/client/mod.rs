//! What the author of another renderer hands to `splatref verify`: planes in files, and a TOML file
//! that says how to read them.
//!
//! One EXR with the crate's channel names and types needs no TOML file: [`read`] takes it as it is, the
//! channels that are `HALF` as [`Storage::Half`]. Anything else is one TOML file beside the files of
//! planes, in which every key has a default; but there must be a plane. An example of everything:
//!
//! ```toml
#![doc = include_str!("example.toml")]
//! ```
//!
//! # The file itself
//!
//! | key | values, the default first | what |
//! |---|---|---|
//! | `file` | a path | an EXR whose channels are planes by the crate's names; a plane without a `file` of its own is looked for in it |
//! | `profile` | `"gpu"`, `"ieee"` | what is promised of operations, [`Client::rounding`] |
//! | `accumulator` | `"f32"`, `"f16"` | how sums are stored between two additions, [`Client::accumulator`] |
//! | `ties` | `"lowest"`, `"last"`, `"any"` | which of equally near fragments is the nearest one, [`Client::ties`] |
//! | `origin` | `"top-left"`, `"bottom-left"` | whether rows run down or up, in all files; nothing else is turned over: not the rows that a plane holds as numbers, nor vectors |
//! | `records` | a path | the projected splats, [`Client::records`]: records of 96 bytes as `splatref project` writes them ([`SplatRecord`](crate::splat::record::SplatRecord)), one a surfel that is drawn, in any order |
//! | `size` | \[width, height\] | of raw files; without it they have that of the other planes, or that of the camera |
//! | `[depth]` | `meaning`, `near`, `far` | of every plane of depths that does not say otherwise |
//! | `[planes.NAME]` | the table below; a path alone is its `file` | a plane by its name in [`crate::method::planes`]; the picture is `RGB`. A name that has a dot is quoted: `[planes."visibility.Z"]`. A colour may be called `resolved` or `"resolved.RGB"` |
//!
//! Paths are relative to the TOML file. Keys that are not here are refused, and so are keys that mean
//! nothing to a plane. All planes must have one size.
//!
//! # A plane
//!
//! | key | values, the default first | what |
//! |---|---|---|
//! | `file` | that of all planes | `.exr`, `.npy`, `.png`, `.raw` or `.bin` |
//! | `channel` | the crate's names | a channel of an EXR or a PNG, or three: `["r", "g", "b"]`; two of octahedral vectors. A PNG has `R`, `G`, `B` and `A`; one number a pixel is taken from a grey one without asking |
//! | `format` | see below | how the numbers are stored in a raw file; in others, what they passed through |
//! | `offset`, `row_stride`, `pixel_stride` | 0, tight, tight | bytes in a raw file before the first pixel, from row to row, from pixel to pixel |
//! | `empty` | see below | of depths and indices: the number of an empty pixel, as it is stored (rounded to what the file can hold); `nan` is any NaN |
//! | `id_base` | 0 | of indices: the number of the first surfel |
//! | `premultiplied` | `false`, `true` | of colours: multiplied by the plane `A` of their layer (`A` of the picture, `blended.A` of `blended`), which must be there; linear light is divided by it, and left alone where it is 0 |
//! | `encoding` | `"linear"` (of a PNG `"srgb"`), `"srgb"` | of colours, see [`crate::number::srgb`] |
//! | | `"octahedral"` | of `normal` and `projection.normal`: unit vectors in two numbers, see below |
//! | `range` | \[0, 1\] | of unorm and `rgb10a2`: which numbers 0 and 1 mean; `[-1, 1]` of the components of normals. Depths must be t |
//! | `meaning`, `near`, `far` | those of `[depth]` | of depths |
//!
//! A raw file is little-endian and holds one number a pixel, or three next to each other, row by row.
//! Without `offset` and strides it must be just as long as its pixels; with one of them, long enough.
//! [`crate::io::npy`] says which arrays are read, [`crate::io::exr`] which EXR; `io::png` how PNG is, with
//! the feature `cli`.
//!
//! # Formats
//!
//! | format | number | may lie off by |
//! |---|---|---|
//! | `f32` | itself | nothing: it is what was computed |
//! | `f16` | itself | 2^-10 of itself, at least 2^-24 |
//! | `unorm8`, `unorm16`, `unorm24` | code / (2^n - 1); `unorm24` is the low bits of 32 | a step |
//! | `snorm8`, `snorm16` | code / (2^(n-1) - 1), at least -1 | a step |
//! | `rgb10a2` | three of code / 1023 in 32 bits, the first in the low ones; the upper two bits are not read | a step |
//! | `rg11b10` | three floats without a sign in 32 bits, of 11, 11 and 10, the first in the low ones; 5 are the exponent | 2^-5 of itself, at least 2^-19 |
//! | `u8`, `u16`, `u32`, `i32` | itself; indices and counts only | nothing |
//!
//! The default is what the file has: `FLOAT`, `HALF` and `UINT` of an EXR are `f32`, `f16` and `u32`;
//! floats of an NPY are `f32`, integers `u32`, -1 as all bits set; a PNG has `unorm8` or `unorm16`, and
//! its codes where indices or counts are wanted. A raw file has `f32`, of indices `u32`, of counts `u8`.
//! Numbers in an integer type must say what they passed through: `unorm8`, `unorm16`, `unorm24`. A format
//! that the file cannot hold is refused. Indices and counts may be floats that are whole, below 2^24 in
//! `f32` and 2^11 in `f16`. A number that its format could not hold, a colour beyond 1 in unorm, is judged
//! as it is stored.
//!
//! # Depths
//!
//! `Z` and all that ends in `.Z`, of one number a pixel. With near n and far f:
//!
//! | `meaning` | stored is v | `empty` | may lie off by, in v |
//! |---|---|---|---|
//! | `"t"` | t | +inf | as the format |
//! | `"1/t"` | 1 / t | 0 | a step; 2^-10 v in `f16`, at least 2^-24; 2^-21 v in `f32` |
//! | `"near/t"` | n / t | 0 | the same |
//! | `"z-buffer"` | f (t - n) / (t (f - n)) | 1 | a step; 2^-10 in `f16`, 2^-23 in `f32` |
//! | `"reversed-z"` | 1 less that | 0 | a step; in floats as `1/t`, of v + n / (f - n) |
//! | `"linear"` | (t - n) / (f - n) | 1 | a step; as `f16`; in `f32` 2^-23 of the greater of n and f, in t |
//!
//! t is that of the crate: along the view direction, in world units. `"1/t"` in `f32` allows for the
//! division, as exact as shading languages promise it. `far` may be `inf`, but not of `"linear"`, which
//! is also what a depth buffer holds under an orthographic camera, and where n may lie behind f. A
//! surface at the far end that has the number of an empty pixel is taken for one.
//!
//! # Normals
//!
//! Three components from -1 to 1, or with `encoding = "octahedral"` the two numbers u and v of the
//! `oct` of Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
//! 3(2), 2014, in any format but the packed ones:
//!
//! ```text
//!   w         = 1 - |u| - |v|
//!   (x, y)    = (u, v), or ((1 - |v|) sign u, (1 - |u|) sign v) where w < 0, with sign 0 = 1
//!   normal    = (x, y, w) / |(x, y, w)|
//! ```
//!
//! in the space of the plane, which is that of the world of `normal`. Of unorm the `range` is [-1, 1] if
//! none is given. They are `X` and `Y` of an EXR, `R` and `G` of a PNG, if no `channel` is given; an NPY
//! is not read. With r, what the format may lose of u and v and 2^-20 for the encoding, d = sqrt(6) r and
//! l = |(x, y, w)|, a component may lie off by 2 d / (2 l - d), and 2^-19 for the length that is
//! forgotten: about 3 to 4 r. The null vector has no code. So the plane `Z` beside it must be there
//! (`projection.Z` of `projection.normal`), and where that is +inf the vector is not read. Numbers beyond
//! the square are NaN.
//!
//! # Indices
//!
//! `empty` is `0xFFFF_FFFF` if absent (-1 as `i32`), and `id_base - 1` if there is an `id_base` above 0.
//! Other numbers must be whole and not below the base.
//!
//! # Colours
//!
//! `"srgb"` is decoded to linear light, and so is what storing may have lost: a step; 2^-10 v in `f16`;
//! 2^-18 v in `f32`, for the power of a shading language; in floats at least 2^-18.

mod convert;
mod files;
mod format;
mod gather;
mod keys;
mod numbers;
mod octahedral;
mod parse;
mod raw;
mod records;
mod straight;
#[cfg(test)]
mod tests;
mod wanted;

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::{extension, input};
use crate::method::Stage;
use crate::verdict::client::Client;
#[cfg(doc)]
use crate::verdict::client::Storage;
use parse::Sidecar;
use std::path::{Path, PathBuf};

/// What a file says of a client's planes; nothing but this file is read yet.
#[derive(Clone, Debug)]
pub struct Description {
    path: PathBuf,
    sidecar: Sidecar,
}

impl Description {
    /// The file at `path`: an `.exr`, which is the planes, or a `.toml` as above.
    ///
    /// # Errors
    /// [`Error::Usage`] if the file is of another kind. [`Error::Io`] if a TOML file cannot be read,
    /// [`Error::Format`] if it has an unknown key, a value of the wrong type or what cannot be.
    pub fn open(path: &Path) -> Result<Self> {
        let sidecar = match extension(path).as_deref() {
            Some("exr") => Sidecar::of_picture(path),
            Some("toml") => {
                let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
                let text = String::from_utf8(bytes)
                    .map_err(|_| Error::format(path, "not text; TOML is UTF-8"))?;
                Sidecar::parse(&text, path)?
            }
            _ => {
                let what = "give an .exr, or a .toml that says how to read other files";
                return Err(Error::Usage(format!("{}: {what}", path.display())));
            }
        };
        Ok(Self { path: path.to_owned(), sidecar })
    }

    /// The files that hold planes or records.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.sidecar.files()
    }

    /// Reads the planes of these stages; `size` is that of the camera's picture.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be read. [`Error::Format`] if one is not what it should be, if
    /// what is said does not fit the files, and if there is no plane of these stages.
    pub fn client(&self, stages: &[Stage], size: [u32; 2], exec: &Exec) -> Result<Client> {
        gather::client(&self.path, &self.sidecar, stages, size, exec)
    }
}

/// Reads the planes of these stages that the file at `path` has or describes: [`Description::open`],
/// then [`Description::client`].
///
/// # Errors
/// As these.
pub fn read(path: &Path, stages: &[Stage], size: [u32; 2], exec: &Exec) -> Result<Client> {
    Description::open(path)?.client(stages, size, exec)
}
