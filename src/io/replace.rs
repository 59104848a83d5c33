//! Output files that are whole or not there: written beside their place, then renamed into it.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file so that nobody ever sees half of it.
///
/// The bytes go to `.NAME.partial-PID` in the same directory, which is renamed to `path` when
/// `write` has succeeded and removed in every other case, a panic included. A file that was at
/// `path` stays as it was until then.
///
/// # Errors
/// [`Error::Io`] on `path` if it names no file, or something that is not a regular file, if its
/// directory does not exist or cannot be written to, or if `write` fails.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    replace(path, write).map_err(|source| Error::io(path, source))
}

fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let refuse = |what| Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    let Some(name) = path.file_name() else {
        return refuse("this names no file; give the name of the file to write");
    };
    // A rename would put a file in the place of a device such as /dev/null.
    if fs::metadata(path).is_ok_and(|at| !at.is_file()) {
        return refuse("this is there and is no regular file; give another name");
    }
    let mut partial = std::ffi::OsString::from(".");
    partial.push(name);
    // WASI has no process ids, and std panics when asked for one.
    let process = if cfg!(target_family = "wasm") { 0 } else { std::process::id() };
    partial.push(format!(".partial-{process}"));
    let partial = Partial(path.with_file_name(partial));

    let mut out = BufWriter::new(File::create(&partial.0)?);
    write(&mut out)?;
    out.flush()?;
    drop(out);
    fs::rename(&partial.0, path)
}

/// The file beside, removed when this goes; after the rename nothing is left to remove.
struct Partial(PathBuf);

impl Drop for Partial {
    fn drop(&mut self) {
        // There is nobody to tell, and the error that led here is the one that matters.
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a directory holds.
    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_and_nothing_else_stays() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.ply");
        fs::write(&path, "old").unwrap();
        write_atomically(&path, |out| {
            assert_eq!(fs::read_to_string(&path).unwrap(), "old", "untouched while writing");
            out.write_all(b"new")
        })
        .unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(directory.path()), ["a.ply"]);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_no_partial_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.ply");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("disk on fire"))
        })
        .unwrap_err();
        assert_eq!(error.to_string(), format!("{}: disk on fire", path.display()));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(directory.path()), ["a.ply"]);
    }

    #[test]
    fn places_that_no_file_can_take_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let refused = |path: &Path| write_atomically(path, |_| Ok(())).unwrap_err().to_string();
        assert!(refused(directory.path()).contains("no regular file"));
        assert!(refused(&directory.path().join("..")).contains("names no file"));
        let missing = directory.path().join("missing/a.ply");
        assert!(refused(&missing).starts_with(&missing.display().to_string()));
        assert!(names(directory.path()).is_empty());
    }
}
