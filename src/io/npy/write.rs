//! Write arrays as NPY files.

use crate::error::Result;
use crate::io::replace::write_atomically;
use std::io::Write;
use std::path::Path;

/// The values of an array, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values<'a> {
    /// `float32`.
    Floats(&'a [f32]),
    /// `uint32`.
    Wholes(&'a [u32]),
}

/// The header with its length and the magic bytes ends at a multiple of this.
const ALIGNED: usize = 64;

/// Writes an array of `columns` numbers a row as little-endian NPY of version 1.0, in C order: the
/// shape is (rows, columns), or (rows,) if `columns` is 1.
///
/// # Errors
/// [`crate::Error::Io`] as [`write_atomically`].
///
/// # Panics
/// If the values do not fill their last row.
pub fn write(path: &Path, values: Values<'_>, columns: usize) -> Result<()> {
    let (kind, count) = match values {
        Values::Floats(values) => ("<f4", values.len()),
        Values::Wholes(values) => ("<u4", values.len()),
    };
    assert!(count.is_multiple_of(columns), "{count} values in rows of {columns}");
    let shape = match columns {
        1 => format!("({count},)"),
        _ => format!("({}, {columns})", count / columns),
    };
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // Ten bytes stand before the text, and a line end after it.
    let length = (text.len() + 11).next_multiple_of(ALIGNED) - 10;
    write_atomically(path, |file| {
        file.write_all(b"\x93NUMPY\x01\x00")?;
        file.write_all(&(length as u16).to_le_bytes())?;
        writeln!(file, "{text:<width$}", width = length - 1)?;
        match values {
            Values::Floats(values) => {
                values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
            }
            Values::Wholes(values) => {
                values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::image::Values as Channel;
    use crate::io::npy;

    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        write(&path, Values::Floats(&[1.0, -2.5, 0.1, 4.0, f32::INFINITY, 6.0]), 3).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!((bytes.len(), bytes[127]), (128 + 24, b'\n'));
        let image = npy::read(&path, "a").unwrap();
        assert_eq!((image.width, image.height), (3, 2));
        let Some(Channel::Float(values)) = image.channel("a") else { panic!("no floats") };
        assert_eq!(values[..], [1.0, -2.5, 0.1, 4.0, f32::INFINITY, 6.0]);
        write(&path, Values::Wholes(&[7, u32::MAX, 9]), 1).unwrap();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        assert!(text.contains("'<u4'") && text.contains("(3,)"), "{text}");
    }
}
