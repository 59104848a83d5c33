//! Read an array from an NPY file of `NumPy` as a plane of a picture, and write arrays.
//!
//! Format: [NEP 1](https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html),
//! versions 1.0 to 3.0.

mod array;
#[cfg(test)]
mod tests;
mod write;

pub use write::{Values, write};

use super::guard::guarded;
use super::{Reason, input};
use crate::error::{Error, Result};
use crate::frame::Image;
use crate::memory;
use array::Array;
use std::io::{Read, Take};
use std::path::Path;

/// A header is a line of some hundred bytes; `NumPy` itself rejects longer ones by default.
const LONGEST_HEADER: u64 = 10_000;

/// Reads the array of the NPY file at `path` as the plane called `name`.
///
/// The shape of the array decides the channels:
///
/// - (h, w) or (h, w, 1): the channel `name`.
/// - (h, w, 3): the channels `name.X`, `name.Y` and `name.Z`.
/// - (h, w, 3) with a name that is `RGB` or ends in `.RGB`: a colour. `RGB` gives the channels `R`,
///   `G` and `B` of the picture itself, `attributes.RGB` gives `attributes.R` and so on.
/// - (1, h, w) or (3, h, w): the same with the channel first, as tensors are. `Decided:` a last side
///   of 1 or 3 wins, so that (3, h, 3) is a picture of 3 rows.
/// - Any of these behind one more side of 1, a batch of one picture.
///
/// Rows go down from the top. The array may be in C or in Fortran order, and of either byte order:
///
/// | type | value |
/// |---|---|
/// | `float16`, `float32` | its bits; `float16` is widened exactly |
/// | `float64` | `Decided:` rounded once to `f32`, as this crate stores its own `f64` pictures |
/// | `bool`, `uint8`, `uint16`, `uint32`, `uint64` | an index |
/// | `int8`, `int16`, `int32`, `int64` | an index; -1 is [`crate::frame::NO_ID`] |
///
/// A number that is no index of 32 bits is refused: below -1, or above 2^32 - 1. `Decided:` except
/// for `int32`, which is read by its bits.
///
/// Memory holds the array as it is in the file, and the planes. The reader compares the header with
/// the length of the file before it allocates anything of that size.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it is no NPY file, has another
/// type or shape, is empty, holds no index, or its length does not match its shape.
pub fn read(path: &Path, name: &str) -> Result<Image> {
    read_stored(path, name).map(|(image, _)| image)
}

/// [`read`], and whether the array holds `float16`.
pub(in crate::io) fn read_stored(path: &Path, name: &str) -> Result<(Image, bool)> {
    guarded(|| decode(path, name)).map_err(|what| Error::format(path, what))?
}

fn decode(path: &Path, name: &str) -> Result<(Image, bool)> {
    let (file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    // The length is taken once, so that nothing more is read if the file grows meanwhile.
    let mut file = file.take(length);
    let array = header(&mut file).map_err(|what| Error::format(path, what))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|source| Error::io(path, source))?;
    if bytes.len() as u64 != array.bytes() {
        return Err(Error::format(path, "the file became shorter while it was read"));
    }
    let image = array.image(&bytes, name).map_err(|what| Error::format(path, what))?;
    Ok((image, array.is_half()))
}

/// The array in these bytes of a file, as [`read_stored`].
pub(in crate::io) fn parse(bytes: &[u8], name: &str) -> Reason<(Image, bool)> {
    let mut file = bytes.take(bytes.len() as u64);
    let array = header(&mut file)?;
    let image = array.image(file.into_inner(), name)?;
    Ok((image, array.is_half()))
}

/// Reads the header, checks that exactly its array follows, and asks for the memory of the array and
/// its planes.
fn header(file: &mut Take<impl Read>) -> Reason<Array> {
    let array = Array::parse(&header_text(file)?)?;
    array.fits(file.limit())?;
    let planes = u64::from(array.width) * u64::from(array.height) * 3 * 4;
    let held = array.bytes().saturating_add(planes);
    memory::try_ask(held, || format!("an array of {} x {}", array.height, array.width))?;
    Ok(array)
}

/// Reads the dictionary at the start of a file; the array follows.
fn header_text(file: &mut Take<impl Read>) -> Reason<String> {
    let early =
        |_| "byte 0: not an NPY file, or truncated; write it again with numpy.save".to_owned();
    let mut start = [0; 8];
    file.read_exact(&mut start).map_err(early)?;
    if start[..6] != *b"\x93NUMPY" {
        return Err("byte 0: not an NPY file; give one that numpy.save wrote".into());
    }
    let length = match start[6] {
        1 => {
            let mut length = [0; 2];
            file.read_exact(&mut length).map_err(early)?;
            u64::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            file.read_exact(&mut length).map_err(early)?;
            u64::from(u32::from_le_bytes(length))
        }
        other => return Err(format!("byte 6: NPY version {other}; versions 1 to 3 are read")),
    };
    if length > LONGEST_HEADER.min(file.limit()) {
        return Err(format!("byte 8: a header of {length} bytes; write it again with numpy.save"));
    }
    let mut text = vec![0; length as usize];
    file.read_exact(&mut text).map_err(early)?;
    String::from_utf8(text).map_err(|_| "header: not text; write it again with numpy.save".into())
}
