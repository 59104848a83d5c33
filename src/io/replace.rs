//! Writing a file beside its place and renaming it, so that nothing half-written is ever found.

use crate::{Error, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Replaces the file at `path` by what `write` writes.
///
/// It goes to `.NAME.partial-PID` in the same directory and is renamed when complete.
///
/// # Errors
/// [`Error::Io`] if the directory or the file refuses; the partial file is removed then, and a file
/// that was at `path` stays as it was.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    let Some(name) = path.file_name() else {
        return Err(Error::io(path, io::Error::from(io::ErrorKind::InvalidFilename)));
    };
    let mut partial_name = std::ffi::OsString::from(".");
    partial_name.push(name);
    partial_name.push(format!(".partial-{}", std::process::id()));
    let partial = path.with_file_name(partial_name);
    let written = File::create(&partial).and_then(|file| {
        let mut file = BufWriter::new(file);
        write(&mut file)?;
        file.flush()?;
        drop(file);
        fs::rename(&partial, path)
    });
    written.map_err(|source| {
        // The first failure is the one to report; the partial file may not even exist.
        let _ = fs::remove_file(&partial);
        Error::io(path, source)
    })
}
