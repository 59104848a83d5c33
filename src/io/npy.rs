//! Read an array from an NPY file of `NumPy` as a plane of a picture.
//!
//! Format: [NEP 1](https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html),
//! versions 1.0 to 3.0.

use super::guard::guarded;
use super::{Reason, input};
use crate::error::{Error, Result};
use crate::frame::Image;
use crate::frame::image::Values;
use crate::memory;
use std::fs::File;
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
///
/// Rows go down from the top, in C order. Types, all little-endian:
///
/// | type | value |
/// |---|---|
/// | `float32` | its bits |
/// | `float64` | `Decided:` rounded once to `f32`, as this crate stores its own `f64` pictures |
/// | `uint8`, `uint16`, `uint32` | an index |
/// | `int32` | an index by its bits, so that -1 is [`crate::frame::NO_ID`] |
///
/// Memory holds the array as it is in the file, and the planes. The reader compares the header with
/// the length of the file before it allocates anything of that size.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it is no NPY file, has another
/// type, order (Fortran) or shape, is empty, or its length does not match its shape.
pub fn read(path: &Path, name: &str) -> Result<Image> {
    guarded(|| decode(path, name)).map_err(|what| Error::format(path, what))?
}

fn decode(path: &Path, name: &str) -> Result<Image> {
    let (file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    // The length is taken once, so that nothing more is read if the file grows meanwhile.
    let mut file = file.take(length);
    let text = header_text(&mut file).map_err(|what| Error::format(path, what))?;
    let array = Array::parse(&text)
        .and_then(|array| array.fits(file.limit()).map(|()| array))
        .map_err(|what| Error::format(path, what))?;
    let held = array.bytes() + 4 * u64::from(array.width) * u64::from(array.height) * 3;
    memory::try_ask(held, || format!("an array of {} x {}", array.height, array.width))
        .map_err(|what| Error::format(path, what))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|source| Error::io(path, source))?;
    if bytes.len() as u64 != array.bytes() {
        return Err(Error::format(path, "the file became shorter while it was read"));
    }
    Ok(array.image(&bytes, name))
}

/// Reads the dictionary at the start of a file; the array follows.
fn header_text(file: &mut Take<File>) -> Reason<String> {
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

/// The types of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dtype {
    F32,
    F64,
    U8,
    U16,
    /// Also `int32`, by its bits.
    U32,
}

/// The contents of a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Array {
    element: Dtype,
    height: u32,
    width: u32,
    /// Numbers a pixel: 1 or 3.
    components: usize,
}

impl Array {
    /// Parses the dictionary: `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }`, with
    /// the keys in any order.
    fn parse(text: &str) -> Reason<Self> {
        let dictionary = text.trim().strip_prefix('{').and_then(|t| t.strip_suffix('}'));
        let dictionary = dictionary.ok_or("header: not a dictionary; write it with numpy.save")?;
        let descr = value(dictionary, "descr")?;
        let element = match descr.trim_matches(['\'', '"']) {
            "<f4" => Dtype::F32,
            "<f8" => Dtype::F64,
            "|u1" => Dtype::U8,
            "<u2" => Dtype::U16,
            "<u4" | "<i4" => Dtype::U32,
            other => {
                return Err(format!(
                    "header: elements `{other}`; save as float32, float64, uint8, uint16, uint32 or \
                     int32, little-endian"
                ));
            }
        };
        match value(dictionary, "fortran_order")? {
            "False" => {}
            _ => return Err("header: Fortran order; save numpy.ascontiguousarray(a)".into()),
        }
        let shape = value(dictionary, "shape")?;
        let sides = shape.trim_matches(['(', ')']).split(',').map(str::trim);
        let sides: Option<Vec<u32>> =
            sides.filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect();
        let (height, width, components) = match sides.as_deref() {
            Some(&[h, w] | &[h, w, 1]) if h > 0 && w > 0 => (h, w, 1),
            Some(&[h, w, 3]) if h > 0 && w > 0 => (h, w, 3),
            _ => {
                return Err(format!(
                    "header: the shape {shape}; save (height, width), (height, width, 1) or (height, \
                     width, 3), with at least one pixel"
                ));
            }
        };
        Ok(Self { element, height, width, components })
    }

    /// How many bytes the array has.
    fn bytes(&self) -> u64 {
        let size = match self.element {
            Dtype::F32 | Dtype::U32 => 4,
            Dtype::F64 => 8,
            Dtype::U8 => 1,
            Dtype::U16 => 2,
        };
        let pixels = u64::from(self.height) * u64::from(self.width);
        pixels.saturating_mul(size * self.components as u64)
    }

    /// Checks that exactly as many bytes follow.
    fn fits(&self, rest: u64) -> Reason<()> {
        let (Self { width, height, .. }, bytes) = (self, self.bytes());
        if bytes == rest {
            return Ok(());
        }
        Err(format!(
            "header: declares {width} x {height} pixels in {bytes} bytes, but {rest} follow; write \
             it again"
        ))
    }

    /// Converts the bytes, which have the right length, to planes.
    fn image(&self, bytes: &[u8], name: &str) -> Image {
        let names = self.names(name);
        let each = |component: usize| {
            let floats = |all: Vec<f32>| Values::Float(self.strided(&all, component));
            let indices = |all: Vec<u32>| Values::Index(self.strided(&all, component));
            match self.element {
                Dtype::F32 => floats(elements(bytes, f32::from_le_bytes)),
                Dtype::F64 => floats(elements(bytes, |b| f64::from_le_bytes(b) as f32)),
                Dtype::U8 => indices(elements(bytes, |[b]| u32::from(b))),
                Dtype::U16 => indices(elements(bytes, |b| u32::from(u16::from_le_bytes(b)))),
                Dtype::U32 => indices(elements(bytes, u32::from_le_bytes)),
            }
        };
        let channels = names.into_iter().enumerate().map(|(i, name)| (name, each(i)));
        let mut channels: Vec<(String, Values)> = channels.collect();
        channels.sort_by(|a, b| a.0.cmp(&b.0));
        Image { width: self.width, height: self.height, channels, text: None }
    }

    /// One component of each pixel.
    fn strided<T: Copy>(&self, all: &[T], component: usize) -> Vec<T> {
        all.iter().skip(component).step_by(self.components).copied().collect()
    }

    /// The names of the channels.
    fn names(&self, name: &str) -> Vec<String> {
        if self.components == 1 {
            return vec![name.to_owned()];
        }
        match (name, name.strip_suffix(".RGB")) {
            ("RGB", _) => ["R", "G", "B"].map(str::to_owned).to_vec(),
            (_, Some(layer)) => ["R", "G", "B"].map(|c| format!("{layer}.{c}")).to_vec(),
            _ => ["X", "Y", "Z"].map(|c| format!("{name}.{c}")).to_vec(),
        }
    }
}

/// The elements of an array.
fn elements<T, const N: usize>(bytes: &[u8], of: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|&element| of(element)).collect()
}

/// The text of a value in a dictionary that nests only parentheses.
fn value<'a>(dictionary: &'a str, key: &str) -> Reason<&'a str> {
    let quoted = [format!("'{key}'"), format!("\"{key}\"")];
    let start = quoted.iter().find_map(|quoted| {
        dictionary.find(quoted.as_str()).map(|at| &dictionary[at + quoted.len()..])
    });
    let missing = || format!("header: no `{key}`; write it with numpy.save");
    let text = start.and_then(|rest| rest.trim_start().strip_prefix(':')).ok_or_else(missing)?;
    let text = text.trim_start();
    let end =
        if text.starts_with('(') { text.find(')').map(|end| end + 1) } else { text.find(',') };
    Ok(text[..end.unwrap_or(text.len())].trim())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use tempfile::TempDir;

    /// A file of version 1.0, as numpy.save writes it.
    fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        with_header(&text, data)
    }

    fn with_header(text: &str, data: &[u8]) -> Vec<u8> {
        let padded = format!("{text}{}\n", " ".repeat((64 - (text.len() + 11) % 64) % 64));
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((padded.len() as u16).to_le_bytes());
        bytes.extend(padded.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read_bytes(bytes: &[u8], name: &str) -> Result<Image> {
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.npy");
        fs::write(&path, bytes).unwrap();
        read(&path, name)
    }

    fn le<T: Copy, const N: usize>(values: &[T], bytes: fn(T) -> [u8; N]) -> Vec<u8> {
        values.iter().flat_map(|&v| bytes(v)).collect()
    }

    #[test]
    fn floats_and_indices_of_every_type_are_read() {
        let floats = [1.0, -0.0, f32::INFINITY, f32::NAN, 1e-45, 3.5];
        let image = read_bytes(&npy("<f4", "(2, 3)", &le(&floats, f32::to_le_bytes)), "Z").unwrap();
        assert_eq!((image.width, image.height, image.channels.len()), (3, 2, 1));
        let Some(Values::Float(found)) = image.channel("Z") else { panic!("no floats") };
        assert_eq!(found.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), floats.map(f32::to_bits));

        let doubles = [0.1, 1e300, 16_777_217.0];
        let image = read_bytes(&npy("<f8", "(1, 3, 1)", &le(&doubles, f64::to_le_bytes)), "Z");
        let rounded = vec![0.1, f32::INFINITY, 16_777_216.0];
        assert_eq!(image.unwrap().channel("Z"), Some(&Values::Float(rounded)));

        let bytes = npy("|u1", "(1, 2)", &[7, 255]);
        let known = Values::Index(vec![7, 255]);
        assert_eq!(read_bytes(&bytes, "count").unwrap().channel("count"), Some(&known));
        let bytes = npy("<u2", "(1, 2)", &le(&[7_u16, 65_535], u16::to_le_bytes));
        let known = Values::Index(vec![7, 65_535]);
        assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
        let known = Values::Index(vec![7, crate::frame::NO_ID]);
        let bytes = npy("<u4", "(1, 2)", &le(&[7, u32::MAX], u32::to_le_bytes));
        assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
        let bytes = npy("<i4", "(1, 2)", &le(&[7, -1], i32::to_le_bytes));
        assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
    }

    #[test]
    fn three_components_are_a_vector_or_a_color() {
        let numbers: Vec<f32> = (0..6).map(|i| i as f32).collect();
        let bytes = npy("<f4", "(1, 2, 3)", &le(&numbers, f32::to_le_bytes));
        for (name, names) in [
            ("normal", ["normal.X", "normal.Y", "normal.Z"]),
            ("RGB", ["R", "G", "B"]),
            ("attributes.RGB", ["attributes.R", "attributes.G", "attributes.B"]),
        ] {
            let image = read_bytes(&bytes, name).unwrap();
            for (i, name) in names.iter().enumerate() {
                let known = Values::Float(vec![i as f32, i as f32 + 3.0]);
                assert_eq!(image.channel(name), Some(&known), "{name}");
            }
            assert!(image.channels.is_sorted_by(|a, b| a.0 < b.0), "{name}");
        }
    }

    #[test]
    fn later_versions_and_other_spellings_are_read() {
        let text = "{\"shape\":(1,2,), \"fortran_order\":False, \"descr\":\"|u1\"}";
        let mut bytes = b"\x93NUMPY\x02\0".to_vec();
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend([3, 4]);
        assert_eq!(read_bytes(&bytes, "a").unwrap().channel("a"), Some(&Values::Index(vec![3, 4])));
    }

    #[test]
    fn what_is_no_plane_is_refused_in_one_line() {
        let data = [0; 24];
        let fortran = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }";
        let mut long = b"\x93NUMPY\x02\0".to_vec();
        long.extend(u32::MAX.to_le_bytes());
        let mut binary = npy("<f4", "(2, 3)", &data);
        binary[12] = 0xFF;
        for (bytes, why) in [
            (b"".to_vec(), "not an NPY file, or truncated"),
            (b"\x93NUMP".to_vec(), "not an NPY file, or truncated"),
            (b"PK\x03\x04 an archive of arrays".to_vec(), "not an NPY file; give one"),
            (b"\x93NUMPY\x09\0\0\0".to_vec(), "version 9"),
            (b"\x93NUMPY\x01\0\x10\0{".to_vec(), "a header of 16 bytes"),
            (long, "a header of 4294967295 bytes"),
            (binary, "not text"),
            (with_header("[]", &data), "not a dictionary"),
            (with_header("{'descr': '<f4', 'fortran_order': False}", &data), "no `shape`"),
            (with_header(fortran, &data), "Fortran order"),
            (npy(">f4", "(2, 3)", &data), "elements `>f4`"),
            (npy("<f2", "(2, 3)", &data), "elements `<f2`"),
            (npy("<i8", "(1, 3)", &data), "elements `<i8`"),
            (npy("|O", "(1, 3)", &data), "elements `|O`"),
            (npy("<f4", "(6,)", &data), "the shape (6,)"),
            (npy("<f4", "()", &data), "the shape ()"),
            (npy("<f4", "(1, 3, 2)", &data), "the shape (1, 3, 2)"),
            (npy("<f4", "(0, 3)", b""), "at least one pixel"),
            (npy("<f4", "(-2, -3)", &data), "the shape (-2, -3)"),
            (npy("<f4", "(2, 3)", &data[1..]), "24 bytes, but 23 follow"),
            (npy("<f4", "(2, 2)", &data), "16 bytes, but 24 follow"),
            // A few bytes that ask for more than any memory.
            (npy("<f8", "(4294967295, 4294967295, 3)", b""), "but 0 follow"),
            (npy("<f4", "(4294967296, 1)", b""), "the shape (4294967296, 1)"),
            (npy("<f4", "(60000, 60000)", &data), "14400000000 bytes, but 24 follow"),
        ] {
            let error = read_bytes(&bytes, "a").unwrap_err();
            let line = error.to_string();
            assert!(matches!(error, Error::Format { .. }) && line.contains("a.npy: "), "{line}");
            assert!(line.contains(why) && line.lines().count() == 1, "{why}: {line}");
        }
        assert!(matches!(read(Path::new("no such.npy"), "a"), Err(Error::Io { .. })));
    }
}
