//! Read arrays from an NPZ file, the ZIP archive that `numpy.savez` and `savez_compressed` write.
//!
//! Each array is an NPY file in the archive, stored or deflated. The reader is our own, because the
//! crates that read ZIP bring ten times its code. It reads the directory at the end of the file,
//! with its extensions for large files, and checks sizes and checksums. It reads no archive of
//! several files and no encrypted one.

use super::{Reason, input, npy};
use crate::error::{Error, Result};
use crate::frame::Image;
use crate::memory;
use miniz_oxide::inflate;
use std::path::Path;

/// Deflate expands one byte to at most this many.
const MOST_EXPANSION: u64 = 1032;
const DAMAGED: &str = "the archive is damaged or truncated; write it again with numpy.savez";

/// Reads the array called `name` as the plane `plane`, and whether it holds `float16`; see
/// [`npy::read`].
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it is no archive, if it has no
/// such array, or as [`npy::read`].
pub(in crate::io) fn read_stored(path: &Path, name: &str, plane: &str) -> Result<(Image, bool)> {
    with_bytes(path, |bytes| {
        let entries = entries(bytes)?;
        let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        let missing =
            || format!("no array `{}`; there are {}", name.escape_debug(), names.join(", "));
        let entry = entries.iter().find(|entry| entry.name == name).ok_or_else(missing)?;
        entry.array(bytes, plane)
    })
}

/// Reads every array as planes under the array's own name.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it is no archive, if an array is
/// no plane ([`npy::read`]), or if arrays differ in size.
pub fn read(path: &Path) -> Result<Image> {
    with_bytes(path, |bytes| {
        let mut all: Option<Image> = None;
        for entry in entries(bytes)? {
            let (image, _) = entry.array(bytes, &entry.name)?;
            let Some(all) = &mut all else {
                all = Some(image);
                continue;
            };
            if (image.width, image.height) != (all.width, all.height) {
                let name = entry.name.escape_debug();
                return Err(format!("the array `{name}` has another size than the one before it"));
            }
            all.channels.extend(image.channels);
        }
        let mut all = all.ok_or("the archive has no array")?;
        all.channels.sort_by(|a, b| a.0.cmp(&b.0));
        match all.channels.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(format!("two arrays give the plane `{}`; rename one", pair[0].0)),
            None => Ok(all),
        }
    })
}

fn with_bytes<T>(path: &Path, read: impl FnOnce(&[u8]) -> Reason<T>) -> Result<T> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    read(&bytes).map_err(|what| Error::format(path, what))
}

/// An array in the archive.
struct Entry {
    /// The name of its file without `.npy`.
    name: String,
    method: u16,
    encrypted: bool,
    crc: u32,
    /// Bytes in the archive, and of the array's file.
    packed: u64,
    size: u64,
    /// Where the entry's own header is.
    at: u64,
}

/// The directory of the archive.
fn entries(bytes: &[u8]) -> Reason<Vec<Entry>> {
    if !bytes.starts_with(b"PK") {
        return Err("byte 0: not an NPZ archive; give one that numpy.savez wrote".into());
    }
    // The last record has 22 bytes and a comment of at most 65535.
    let from = bytes.len().saturating_sub(22 + 65535);
    let end = bytes[from..].windows(4).rposition(|four| four == b"PK\x05\x06");
    let end = from + end.ok_or(DAMAGED)?;
    if bytes.len() < end + 22 + number(bytes, end + 20, 2)? as usize {
        return Err(DAMAGED.into());
    }
    let (mut count, mut at) = (number(bytes, end + 10, 2)?, number(bytes, end + 16, 4)?);
    // A large archive has another record, which a locator before the last record points at.
    if let Some(locator) = end.checked_sub(20).filter(|&at| bytes[at..].starts_with(b"PK\x06\x07"))
    {
        let large = place(number(bytes, locator + 8, 8)?)?;
        (count, at) = (number(bytes, large + 32, 8)?, number(bytes, large + 48, 8)?);
    }
    let mut at = place(at)?;
    let mut found = Vec::new();
    for _ in 0..count {
        if !bytes.get(at..).unwrap_or_default().starts_with(b"PK\x01\x02") {
            return Err(DAMAGED.into());
        }
        let length = |offset| number(bytes, at + offset, 2).map(|length| length as usize);
        let (name, extra, comment) = (length(28)?, length(30)?, length(32)?);
        let start = at + 46;
        let text = bytes.get(start..start + name).ok_or(DAMAGED)?;
        let text = String::from_utf8_lossy(text);
        let mut entry = Entry {
            name: text.strip_suffix(".npy").unwrap_or(&text).to_owned(),
            method: number(bytes, at + 10, 2)? as u16,
            encrypted: number(bytes, at + 8, 2)? & 1 != 0,
            crc: number(bytes, at + 16, 4)? as u32,
            packed: number(bytes, at + 20, 4)?,
            size: number(bytes, at + 24, 4)?,
            at: number(bytes, at + 42, 4)?,
        };
        entry.large(bytes.get(start + name..start + name + extra).ok_or(DAMAGED)?)?;
        // A folder is no array.
        if text.ends_with(".npy") {
            found.push(entry);
        }
        at = start + name + extra + comment;
    }
    Ok(found)
}

impl Entry {
    /// Replaces numbers that do not fit 32 bits by those of the extension for large files.
    fn large(&mut self, mut extra: &[u8]) -> Reason<()> {
        while !extra.is_empty() {
            let (kind, length) = (number(extra, 0, 2)?, number(extra, 2, 2)? as usize);
            let body = extra.get(4..4 + length).ok_or(DAMAGED)?;
            if kind == 1 {
                let mut next = 0;
                for value in [&mut self.size, &mut self.packed, &mut self.at] {
                    if *value == u64::from(u32::MAX) {
                        *value = number(body, next, 8)?;
                        next += 8;
                    }
                }
            }
            extra = &extra[4 + length..];
        }
        Ok(())
    }

    /// Unpacks the array.
    fn array(&self, bytes: &[u8], plane: &str) -> Reason<(Image, bool)> {
        let named = |what: String| format!("{}.npy: {what}", self.name.escape_debug());
        let unpacked = self.unpacked(bytes).map_err(named)?;
        npy::parse(&unpacked, plane).map_err(named)
    }

    fn unpacked(&self, bytes: &[u8]) -> Reason<Vec<u8>> {
        if self.encrypted {
            return Err("it is encrypted; write the archive without a password".into());
        }
        let at = place(self.at)?;
        let start = at as u64 + 30 + number(bytes, at + 26, 2)? + number(bytes, at + 28, 2)?;
        let start = place(start)?;
        let end = start.checked_add(place(self.packed)?).ok_or(DAMAGED)?;
        let packed = bytes.get(start..end).ok_or(DAMAGED)?;
        if self.size > self.packed.saturating_mul(MOST_EXPANSION) {
            return Err(DAMAGED.into());
        }
        memory::try_ask(self.size, || "an array of the archive".into())?;
        let unpacked = match self.method {
            0 => packed.to_vec(),
            8 => inflate::decompress_to_vec_with_limit(packed, place(self.size)?)
                .map_err(|_| DAMAGED)?,
            other => {
                return Err(format!(
                    "it is packed by method {other}; write it with numpy.savez_compressed"
                ));
            }
        };
        if unpacked.len() as u64 != self.size || crc32fast::hash(&unpacked) != self.crc {
            return Err(DAMAGED.into());
        }
        Ok(unpacked)
    }
}

/// A little-endian number of some bytes.
fn number(bytes: &[u8], at: usize, size: usize) -> Reason<u64> {
    let found = at.checked_add(size).and_then(|end| bytes.get(at..end)).ok_or(DAMAGED)?;
    Ok(found.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
}

/// A place in memory.
fn place(at: u64) -> Reason<usize> {
    usize::try_from(at).ok().filter(|&at| at < usize::MAX / 2).ok_or_else(|| DAMAGED.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::image::Values;
    use std::fs;
    use tempfile::TempDir;

    fn npy(numbers: [f32; 2]) -> Vec<u8> {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }";
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    /// An archive as numpy writes it: local headers have sizes of 64 bits.
    fn archive(arrays: &[(&str, Vec<u8>)], deflated: bool) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for (name, array) in arrays {
            let at = bytes.len() as u32;
            let packed = match deflated {
                true => miniz_oxide::deflate::compress_to_vec(array, 6),
                false => array.clone(),
            };
            let method = if deflated { 8_u16 } else { 0 };
            let common = |sizes: [u32; 2]| {
                let mut common = [45, 0, 0, 0].to_vec();
                common.extend(method.to_le_bytes());
                common.extend([0; 4]);
                common.extend(crc32fast::hash(array).to_le_bytes());
                common.extend(sizes.iter().flat_map(|size| size.to_le_bytes()));
                common.extend((name.len() as u16).to_le_bytes());
                common
            };
            bytes.extend(b"PK\x03\x04");
            bytes.extend(common([u32::MAX; 2]));
            bytes.extend(20_u16.to_le_bytes());
            bytes.extend(name.as_bytes());
            bytes.extend([1, 0, 16, 0]);
            bytes.extend((array.len() as u64).to_le_bytes());
            bytes.extend((packed.len() as u64).to_le_bytes());
            bytes.extend(&packed);
            directory.extend(b"PK\x01\x02\x2d\0");
            directory.extend(common([packed.len() as u32, array.len() as u32]));
            directory.extend([0; 12]);
            directory.extend(at.to_le_bytes());
            directory.extend(name.as_bytes());
        }
        let at = bytes.len() as u32;
        bytes.extend(&directory);
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        bytes.extend([arrays.len() as u16; 2].iter().flat_map(|count| count.to_le_bytes()));
        bytes.extend((directory.len() as u32).to_le_bytes());
        bytes.extend(at.to_le_bytes());
        bytes.extend([0, 0]);
        bytes
    }

    fn file(bytes: &[u8]) -> (TempDir, std::path::PathBuf) {
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.npz");
        fs::write(&path, bytes).unwrap();
        (at, path)
    }

    #[test]
    fn arrays_are_read_stored_and_deflated() {
        for deflated in [false, true] {
            let arrays = [("Z.npy", npy([1.0, 2.5])), ("A.npy", npy([0.0, 1.0]))];
            let (_at, path) = file(&archive(&arrays, deflated));
            let image = read(&path).unwrap();
            assert_eq!(image.channel("Z"), Some(&Values::Float(vec![1.0, 2.5])));
            assert!(image.channels.is_sorted_by(|a, b| a.0 < b.0));
            let (one, is_half) = read_stored(&path, "A", "v").unwrap();
            assert_eq!((one.channel("v"), is_half), (Some(&Values::Float(vec![0.0, 1.0])), false));
            let error = read_stored(&path, "B", "v").unwrap_err().to_string();
            assert!(error.contains("no array `B`; there are Z, A"), "{error}");
        }
    }

    #[test]
    fn the_checksum_is_the_one_of_zip() {
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
    }

    /// Whatever byte is changed or missing, the reader says it in one line.
    #[test]
    fn damaged_archives_are_refused() {
        let whole = archive(&[("Z.npy", npy([1.0, 2.5]))], true);
        for length in 0..whole.len() {
            let (_at, path) = file(&whole[..length]);
            let error = read(&path).unwrap_err().to_string();
            assert!(error.contains("a.npz: ") && error.lines().count() == 1, "{length}: {error}");
        }
        let data = 30 + "Z.npy".len() + 20;
        for (at, byte) in [(data + 5, 0x55), (whole.len() - 22 + 16, 0xff)] {
            let mut damaged = whole.clone();
            damaged[at] ^= byte;
            let (_at, path) = file(&damaged);
            assert!(read(&path).unwrap_err().to_string().contains("damaged"));
        }
        let (_at, path) = file(b"not at all");
        assert!(read(&path).unwrap_err().to_string().contains("not an NPZ archive"));
    }
}
