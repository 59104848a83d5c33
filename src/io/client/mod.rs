//! Give `splatref verify` the planes of another renderer: files of planes, and a TOML file that says
//! how each file stores its numbers.
//!
//! One EXR with the crate's channel names and types needs no TOML file. [`read`] takes the EXR as
//! it is, and its `HALF` channels as [`Storage::Half`]. For any other files, write one TOML file
//! and put it beside them. Every key has a default, but there must be at least one plane. This
//! example uses everything:
//!
//! ```toml
#![doc = include_str!("example.toml")]
//! ```
//!
//! # Keys of the whole file
//!
//! | key | values, the default first | meaning |
//! |---|---|---|
//! | `file` | a path | an EXR whose channels are planes by the crate's names; a plane without its own `file` is looked for in this EXR |
//! | `profile` | `"gpu"`, `"precise"`, `"ieee"` | the precision that the client's arithmetic promises, [`Client::rounding`] |
//! | `accumulator` | `"f32"`, `"f16"` | how the client stores sums between two additions, [`Client::accumulator`] |
//! | `ties` | `"lowest"`, `"last"`, `"any"` | which of several equally near fragments wins, [`Client::ties`] |
//! | `origin` | `"top-left"`, `"bottom-left"` | whether rows run down or up, in all files; only the order of rows changes, not row numbers stored in a plane, nor vectors |
//! | `records` | a path | the projected splats, one for each drawn surfel, in any order, as `splatref project` writes them: of 96 bytes ([`SplatRecord`](crate::splat::record::SplatRecord)) for [`Client::records`], or of 128 ([`GaussianRecord`](crate::method::gaussians::record::GaussianRecord)) for [`Client::gaussian_records`] |
//! | `size` | \[width, height\] | size of raw files; by default the size of the other planes, or of the camera's picture |
//! | `[depth]` | `meaning`, `near`, `far` | defaults for every plane of depths |
//! | `[depth-test]` | `format`, `meaning`, `near`, `far` | the depths that the client's depth test compares, if they are not those of the planes, [`Client::depth_test`]; see below |
//! | `[planes.NAME]` | the table below; a path alone is its `file` | a plane by its name in [`crate::method::planes`]; the picture is `RGB`. Quote a name that has a dot: `[planes."visibility.Z"]`. A colour may be called `resolved` or `"resolved.RGB"` |
//!
//! Paths are relative to the TOML file. The reader refuses unknown keys, and keys that mean nothing
//! to the plane they are given for. All planes must have one size.
//!
//! # Keys of one plane
//!
//! | key | values, the default first | meaning |
//! |---|---|---|
//! | `file` | the `file` of the whole TOML file | `.exr`, `.npy`, `.npz`, `.png`, `.raw` or `.bin` |
//! | `channel` | the crate's names | a channel of an EXR or a PNG, or three: `["r", "g", "b"]`; two for octahedral vectors. One name stands for all of a colour or a vector: `"ViewLayer.Combined"` for `ViewLayer.Combined.R` and so on. A PNG has `R`, `G`, `B` and `A`; a grey PNG needs no `channel` for a plane of one number a pixel. The array of an NPZ; the plane's name if absent |
//! | `format` | see below | raw files: how the numbers are stored; other files: the format that the numbers passed through |
//! | `offset`, `row_stride`, `pixel_stride` | 0, tight, tight | raw files: bytes before the first pixel, from row to row, from pixel to pixel |
//! | `empty` | see below | depths and indices: the number of an empty pixel, as it is stored (rounded to a number that the file can hold); `nan` is any NaN |
//! | `id_base` | 0 | indices: the number of the first surfel |
//! | `premultiplied` | `false`, `true` | colours: whether they are multiplied by the plane `A` of their layer (`A` of the picture, `blended.A` of `blended`), which must be there; the reader divides linear light by it, and leaves the colour alone where it is 0 |
//! | `encoding` | `"linear"` (PNG: `"srgb"`), `"srgb"` | colours, see [`crate::number::srgb`] |
//! | | `"octahedral"` | `normal` and `projection.normal`: unit vectors in two numbers, see below |
//! | `range` | \[0, 1\] | unorm and `rgb10a2`: the numbers that 0 and 1 stand for; `[-1, 1]` for the components of normals. Depths must be t |
//! | `meaning`, `near`, `far` | from `[depth]` | depths, see below |
//!
//! A raw file is little-endian and holds one number a pixel, or three next to each other, row by
//! row. Without `offset` and strides the file must be exactly as long as its pixels; with one of
//! them, at least as long. See [`crate::io::npy`] and [`crate::io::npz`] for the arrays that are read, [`crate::io::exr`]
//! for the EXR files, and `io::png` (with the feature `cli`) for PNG.
//!
//! # Formats, and how far each lets a number be off
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
//! If you give no `format`, the file decides:
//!
//! - EXR: `FLOAT`, `HALF` and `UINT` are `f32`, `f16` and `u32`.
//! - NPY: floats are `f32`, or `f16` if they are stored so; integers `u32`, -1 as all bits set.
//! - PNG: `unorm8` or `unorm16`; for indices and counts, its codes.
//! - Raw: `f32`, for indices `u32`, for counts `u8`.
//!
//! If an integer type stores other numbers than indices and counts, say which format they passed
//! through: `unorm8`, `unorm16`, `unorm24`. A format that the file cannot hold is refused. Indices
//! and counts may be whole floats, below 2^24 in `f32` and 2^11 in `f16`. A number that its format
//! could not hold, such as a colour beyond 1 in unorm, is judged as it is stored.
//!
//! # Depths
//!
//! These rules apply to `Z` and to every name that ends in `.Z`, if the plane has one number a
//! pixel. With near n and far f:
//!
//! | `meaning` | stored is v | `empty` | may lie off by, in v |
//! |---|---|---|---|
//! | `"t"` | t | +inf | as the format |
//! | `"1/t"` | 1 / t | 0 | a step; 2^-10 v in `f16`, at least 2^-24; 2^-21 v in `f32` |
//! | `"near/t"` | n / t | 0 | the same |
//! | `"z-buffer"` | f (t - n) / (t (f - n)) | 1 | a step; 2^-10 in `f16`, 2^-23 in `f32` |
//! | `"reversed-z"` | 1 - (the number of `"z-buffer"`) | 0 | a step; in floats as `1/t`, for v + n / (f - n) |
//! | `"linear"` | (t - n) / (f - n) | 1 | a step; as `f16`; in `f32` 2^-23 of the greater of n and f, in t |
//!
//! t is the crate's depth: along the view direction, in world units. `"1/t"` in `f32` allows for
//! the division, to the precision that shading languages promise. `far` may be `inf`, except for
//! `"linear"`. A depth buffer under an orthographic camera is `"linear"` too; there n may lie
//! behind f. A surface at the far end that has the number of an empty pixel counts as empty.
//!
//! [`DepthConvention`] writes such files, with the TOML file that says how to read them.
//!
//! # Depth tests
//!
//! A renderer may test depths in a depth buffer and store them in a color target. Describe the depth
//! buffer in `[depth-test]`: its `format` (`f32`, the default, `f16` or unorm) and the `meaning` of
//! its numbers, with `near` and `far` if the meaning needs them. The planes of depths keep a
//! description of their own.
//!
//! The test may take two fragments for equally near if their numbers are at most two steps apart.
//! A step is that of the table above, and 2^-21 more for computing the number from t in `f32`. The
//! same holds for the limit of visible depths and for the end of a peeled layer. Voronoi-enhanced
//! depths are bins, and no format changes which bin is nearer.
//!
//! # Normals
//!
//! A normal is three components from -1 to 1. With `encoding = "octahedral"` it is the two numbers
//! u and v of `oct` from Cigolle et al., "A Survey of Efficient Representations for Independent
//! Unit Vectors", JCGT 3(2), 2014, in any format but the packed ones:
//!
//! ```text
//!   w         = 1 - |u| - |v|
//!   (x, y)    = (u, v), or ((1 - |v|) sign u, (1 - |u|) sign v) where w < 0, with sign 0 = 1
//!   normal    = (x, y, w) / |(x, y, w)|
//! ```
//!
//! The normal is in the space of its plane; for the plane `normal` this is world space. For unorm
//! the default `range` is [-1, 1]. Without a `channel`, u and v are `X` and `Y` of an EXR, `R` and
//! `G` of a PNG; an NPY is not read.
//!
//! How far a component may be off follows from r, the sum of what the format may lose of u and v
//! and 2^-20 for the encoding. With d = sqrt(6) r and l = |(x, y, w)|, a component may lie off by
//! 2 d / (2 l - d), and by 2^-19 more because the encoding forgets the length: about 3 to 4 r in all.
//!
//! The null vector has no code. Therefore the plane `Z` beside the normals must be there
//! (`projection.Z` for `projection.normal`), and where that is +inf the vector is not read. Numbers
//! beyond the square are NaN.
//!
//! # Indices
//!
//! If you give no `empty`, it is `0xFFFF_FFFF` (-1 as `i32`), or `id_base - 1` if there is an
//! `id_base` above 0. All other numbers must be whole, and at least the base.
//!
//! # Colours
//!
//! The reader decodes `"srgb"` to linear light, together with what storing may have lost:
//!
//! - integer codes: a step;
//! - `f16`: 2^-10 v, at least 2^-18;
//! - `f32`: 2^-18 v, at least 2^-18, because shading languages compute the power inexactly.

mod arrays;
mod convert;
mod depth;
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

pub use arrays::Array;
pub use depth::{DepthConvention, DepthFile};

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::{extension, input};
use crate::method::Stage;
use crate::verdict::client::Client;
#[cfg(doc)]
use crate::verdict::client::Storage;
use parse::{PlaneKeys, Sidecar};
use std::path::{Path, PathBuf};

/// A description of a client's planes. Only the description itself has been read, no plane yet.
#[derive(Clone, Debug)]
pub struct Description {
    path: PathBuf,
    sidecar: Sidecar,
}

impl Description {
    /// Opens the file at `path`: an `.exr` that holds the planes, or a `.toml` as above.
    ///
    /// # Errors
    /// [`Error::Usage`] if the file is of another kind. [`Error::Io`] if a TOML file cannot be
    /// read, [`Error::Format`] if it has an unknown key, a value of the wrong type, or an
    /// impossible value.
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

    /// Takes planes from channels of other names: pairs of a plane, `RGB` for the picture, and its
    /// channel, as in the key `channel`. They replace what the TOML file says of this plane.
    #[must_use]
    pub fn with_channels(mut self, channels: &[(String, String)]) -> Self {
        for (plane, channel) in channels {
            let planes = &mut self.sidecar.planes;
            let at = planes.iter().position(|(name, _)| name == plane).unwrap_or(planes.len());
            if at == planes.len() {
                planes.push((plane.clone(), PlaneKeys::default()));
            }
            planes[at].1.channel = Some(vec![channel.clone()]);
        }
        self
    }

    /// The files that hold planes or records.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.sidecar.files()
    }

    /// Reads the planes of these stages; `size` is the size of the camera's picture.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be read. [`Error::Format`] if a file is malformed, if the
    /// description does not fit the files, or if no plane belongs to these stages.
    pub fn client(&self, stages: &[Stage], size: [u32; 2], exec: &Exec) -> Result<Client> {
        gather::client(&self.path, &self.sidecar, stages, size, exec)
    }
}

/// Reads the planes of these stages from the file at `path`: [`Description::open`], then
/// [`Description::client`].
///
/// # Errors
/// The errors of these two.
pub fn read(path: &Path, stages: &[Stage], size: [u32; 2], exec: &Exec) -> Result<Client> {
    Description::open(path)?.client(stages, size, exec)
}
