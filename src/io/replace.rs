//! Output files that are whole or not there: written beside their place, then renamed into it.

use crate::error::{Error, Result};
use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{NamedTempFile, TempPath};

/// Writes a file so that nobody ever sees half of it: [`Pending::write`], then [`Pending::put`].
///
/// # Errors
/// As these.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    Pending::write(path, write)?.put()
}

/// A file that is written, beside its place. It is removed unless it is put there.
#[derive(Debug)]
pub struct Pending {
    partial: Partial,
    /// As the caller named the place.
    path: PathBuf,
    /// The place itself, where no symbolic link leads on.
    place: PathBuf,
}

impl Pending {
    /// Writes the bytes that are to be at `path` to a file of another name in the same directory.
    ///
    /// Nobody else can have that file: it is created exclusively, under a random name that does not
    /// grow with the name of `path`. It is removed if `write` fails or panics, and by
    /// [`remove_partial_files`]. A file at `path` stays as it is; its permissions are those of the
    /// file that will replace it. Where `path` is a symbolic link, the file that it leads to is
    /// replaced.
    ///
    /// # Errors
    /// [`Error::Io`] on `path` if it names no file, or something that is not a regular file, or a
    /// file that may only be read, if its directory does not exist or cannot be written to, or if
    /// `write` fails.
    pub fn write(
        path: &Path,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<Self> {
        Self::try_write(path, write).map_err(|source| Error::io(path, source))
    }

    fn try_write(
        path: &Path,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> io::Result<Self> {
        let refuse = |what| Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        let place = place(path)?;
        let Some(folder) = place.parent().filter(|_| place.file_name().is_some()) else {
            return refuse("this names no file; give the name of the file to write");
        };
        let replaced = fs::metadata(&place).ok();
        // A rename would put a file in the place of a device such as /dev/null.
        if replaced.as_ref().is_some_and(|at| !at.is_file()) {
            return refuse("this is there and is no regular file; give another name");
        }
        // WASI has no permissions; there every file counts as one that may only be read.
        let permissions = replaced.map(|at| at.permissions()).filter(|_| cfg!(any(unix, windows)));
        if permissions.as_ref().is_some_and(Permissions::readonly) {
            return refuse("this is there and may only be read; give another name");
        }
        let (partial, file) = Partial::new(folder)?;
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()?;
        if let Some(permissions) = permissions {
            fs::set_permissions(partial.path(), permissions)?;
        }
        Ok(Self { partial, path: path.to_owned(), place })
    }

    /// Puts the file in its place, where it replaces the one that is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be renamed.
    pub fn put(self) -> Result<()> {
        self.partial.put(&self.place).map_err(|source| Error::io(&self.path, source))
    }
}

/// Where a file is to be: at `path`, or where symbolic links lead from there.
fn place(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    // As many as Linux follows.
    for _ in 0..40 {
        if !fs::symlink_metadata(&place).is_ok_and(|at| at.is_symlink()) {
            if place.parent().is_some_and(|folder| folder.as_os_str().is_empty()) {
                place = Path::new(".").join(place);
            }
            return Ok(place);
        }
        let target = fs::read_link(&place)?;
        place = place.with_file_name(target);
    }
    Err(io::Error::other("a circle of symbolic links"))
}

/// The partial files of this process. Files are created, renamed and removed while this is held.
static PARTIAL_FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn partial_files() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths is whole whoever panicked.
    PARTIAL_FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the partial files of this process, for a program that is about to end early, such as in
/// answer to a signal. As long as the returned guard is held, no other partial file is made, and
/// none is put in its place.
#[must_use = "others may write again when it goes"]
pub fn remove_partial_files() -> impl Sized {
    let mut files = partial_files();
    for path in files.drain(..) {
        // There is nobody to tell.
        let _ = fs::remove_file(path);
    }
    files
}

/// A file beside its place.
#[derive(Debug)]
struct Partial(Option<TempPath>);

impl Partial {
    fn new(folder: &Path) -> io::Result<(Self, File)> {
        let mut files = partial_files();
        let mut builder = tempfile::Builder::new();
        builder.prefix(".splatref-").suffix(".partial").rand_bytes(12);
        if let Some(permissions) = of_new_files() {
            builder.permissions(permissions);
        }
        let (file, path) = builder.tempfile_in(folder).map(NamedTempFile::into_parts)?;
        files.push(path.to_path_buf());
        Ok((Self(Some(path)), file))
    }

    fn path(&self) -> &Path {
        self.0.as_deref().unwrap_or_else(|| Path::new(""))
    }

    fn put(mut self, place: &Path) -> io::Result<()> {
        let mut files = partial_files();
        let Some(path) = self.0.take() else { return Ok(()) };
        files.retain(|file| file != &*path);
        path.persist(place).map_err(|failed| failed.error)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if let Some(path) = self.0.take() {
            partial_files().retain(|file| file != &*path);
            // The path is removed as it goes.
        }
    }
}

/// What a new file may, before the process takes its mask from it: a temporary one would be its
/// owner's alone.
fn of_new_files() -> Option<Permissions> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        Some(Permissions::from_mode(0o666))
    }
    #[cfg(not(unix))]
    None
}

#[cfg(test)]
mod tests;
