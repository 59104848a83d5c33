//! Open regular files, whose length is known before anything is read.

use crate::error::Error;
use crate::memory;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::Path;

/// Opens the file at `path`; returns it and its length in bytes.
///
/// # Errors
/// If it cannot be opened, or is a directory, a pipe, a device, or a pointer of Git LFS.
pub(super) fn open(path: &Path) -> io::Result<(File, u64)> {
    // Ask before opening, because opening a pipe without a writer would wait.
    if let Some(what) = no_file(path) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    if length <= LONGEST_POINTER {
        let mut text = Vec::new();
        (&mut file).take(POINTER.len() as u64).read_to_end(&mut text)?;
        if text == POINTER {
            let what = "this is a Git LFS pointer, not the file itself; run `git lfs pull`";
            return Err(io::Error::new(io::ErrorKind::InvalidData, what));
        }
        file.rewind()?;
    }
    Ok((file, length))
}

/// How a pointer of Git LFS begins; a pointer is shorter than 1024 bytes.
const POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";
const LONGEST_POINTER: u64 = 1024;

/// Reads the file at `path`: as many bytes as it has when it is opened.
///
/// # Errors
/// As [`open`], and if it cannot be read.
pub(super) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let (file, length) = open(path)?;
    rest(file, length)
}

/// How many times the length of a text its parsed TOML may take, in short tables and arrays.
const TOML_IN_MEMORY: u64 = 100;

/// Asks for the memory that a text takes when it is parsed as TOML, before it is.
///
/// # Errors
/// [`Error::Format`] if the process may not hold so much.
pub(super) fn ask_for_toml(path: &Path, text: &str) -> Result<(), Error> {
    let bytes = text.len() as u64;
    memory::try_ask(bytes.saturating_mul(TOML_IN_MEMORY), || {
        format!("parsing {bytes} bytes of TOML")
    })
    .map_err(|what| Error::format(path, what))
}

/// Describes why a text is not TOML, and in which line.
pub(super) fn no_toml(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map(|span| line(text, span.start));
    let what = error.message().trim().replace('\n', " ");
    match line {
        Some(line) => Error::format(path, format!("line {line}: {what}")),
        None => Error::format(path, what),
    }
}

/// The line of a byte of the text, counted from 1.
pub(super) fn line(text: &str, at: usize) -> usize {
    1 + text[..at].matches('\n').count()
}

/// Reads the rest of a file from its current position, at most `length` bytes, even if it grows
/// meanwhile.
///
/// # Errors
/// If the process may not hold so many bytes, or the file cannot be read.
pub(super) fn rest(file: impl Read, length: u64) -> io::Result<Vec<u8>> {
    memory::try_ask(length, || "the file".to_owned())
        .map_err(|what| io::Error::new(io::ErrorKind::OutOfMemory, what))?;
    let mut bytes = Vec::new();
    let room = usize::try_from(length).map_err(|_| io::ErrorKind::OutOfMemory)?;
    bytes.try_reserve_exact(room)?;
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Why the thing at `path` cannot be read as a file; `None` for a file or if nothing is there.
pub(super) fn no_file(path: &Path) -> Option<&'static str> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Some("this is a directory; give a file"),
        Ok(found) if !found.is_file() => Some(
            "this is a pipe or a device, but its length must be known; write it to a file first",
        ),
        _ => None,
    }
}
