//! Write output files that are complete or absent: write beside the final place, then rename.

use crate::error::{Error, Result};
use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{NamedTempFile, TempPath};

/// Writes a file so that no reader ever sees half of it: [`Pending::write`], then [`Pending::put`].
///
/// # Errors
/// The errors of these two.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    Pending::write(path, write)?.put()
}

/// Bytes that are written at once: some lines of an EXR, which come one by one.
const BUFFER: usize = 256 << 10;

/// A complete file that waits beside its place. It is removed unless [`Pending::put`] is called.
#[derive(Debug)]
pub struct Pending {
    partial: Partial,
    /// The place as the caller named it.
    path: PathBuf,
    /// The place itself, after following symbolic links.
    place: PathBuf,
}

impl Pending {
    /// Writes the bytes for `path` to a file of another name in the same directory.
    ///
    /// No other process can have that file, because it is created exclusively, under a random name.
    /// The name does not grow with the name of `path`. The file is removed if `write` fails or
    /// panics, and by [`remove_partial_files`]. If the process is killed, it stays until a process
    /// writes its first file to the same directory. A file that is already at `path` stays as it is;
    /// the new file gets its permissions. If `path` is a symbolic link, the file behind the link is
    /// replaced.
    ///
    /// # Errors
    /// [`Error::Io`] on `path` if it names no file, something that is not a regular file, or a
    /// read-only file; if its directory does not exist or cannot be written to; or if `write`
    /// fails.
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
            return refuse("not a file name; give the name of the file to write");
        };
        let replaced = fs::metadata(&place).ok();
        // A rename would replace a device such as /dev/null by a file.
        if replaced.as_ref().is_some_and(|at| !at.is_file()) {
            return refuse("exists, but is not a regular file; give another name");
        }
        // WASI has no permissions and reports every file as read-only.
        let permissions = replaced.map(|at| at.permissions()).filter(|_| cfg!(any(unix, windows)));
        if permissions.as_ref().is_some_and(Permissions::readonly) {
            return refuse("exists, but is read-only; give another name");
        }
        let (partial, file) = Partial::new(folder)?;
        let mut out = BufWriter::with_capacity(BUFFER, file);
        write(&mut out)?;
        out.flush()?;
        if let Some(permissions) = permissions {
            fs::set_permissions(partial.path(), permissions)?;
        }
        Ok(Self { partial, path: path.to_owned(), place })
    }

    /// Puts the file in its place, and replaces a file that is already there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be renamed.
    pub fn put(self) -> Result<()> {
        self.partial.put(&self.place).map_err(|source| Error::io(&self.path, source))
    }
}

/// The final place of a file: `path`, or where symbolic links lead from there.
fn place(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    // Linux follows as many links.
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

/// Removes the partial files of processes that are gone, such as one that SIGKILL ended.
///
/// A process holds a lock on its partial files while they exist, and the system releases the lock
/// when the process ends, in whatever way. So only files without a lock are removed. Where files
/// cannot be locked, nothing is removed. Errors are ignored: the files are in nobody's way.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let partial = |name: &str| {
        let random = name.strip_prefix(PREFIX).and_then(|name| name.strip_suffix(SUFFIX));
        random.is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    };
    for entry in entries.flatten() {
        if !entry.file_name().to_str().is_some_and(partial)
            || !entry.file_type().is_ok_and(|kind| kind.is_file())
        {
            continue;
        }
        let path = entry.path();
        // Locked until the end of the loop's body, so that its writer notices if it is just made.
        if let Ok(file) = File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(&path);
        }
    }
}

/// The name of a partial file: the prefix, letters and digits, the suffix.
const PREFIX: &str = ".splatref-";
const SUFFIX: &str = ".partial";
const RANDOM: usize = 12;

/// The folders that this process has looked at for abandoned files.
static LOOKED_AT: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The partial files of this process, and the folders that it made for them. Hold the lock to create,
/// rename or remove a file.
static PARTIAL_FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn partial_files() -> MutexGuard<'static, Vec<PathBuf>> {
    // The list of paths is valid even after a panic.
    PARTIAL_FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the partial files of this process, and folders that it made for them and that are empty. Call
/// it when the program is about to end early, for example after a signal. While the returned guard is
/// held, no other partial file is created, and none is put in its place.
#[must_use = "others may write again when it goes"]
pub fn remove_partial_files() -> impl Sized {
    let mut files = partial_files();
    // A folder was made before its files.
    for path in files.drain(..).rev() {
        // Ignore the error, because the program is about to end.
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir(&path));
    }
    files
}

/// A folder for files to be written. If it was made here, it goes with this guard, and by
/// [`remove_partial_files`], unless something is in it.
#[derive(Debug)]
pub(crate) struct NewFolder(Option<PathBuf>);

impl NewFolder {
    /// Makes the folder, unless it is there.
    pub(crate) fn make(path: &Path) -> Result<Self> {
        let mut files = partial_files();
        match fs::create_dir(path) {
            Ok(()) => {
                files.push(path.to_owned());
                Ok(Self(Some(path.to_owned())))
            }
            Err(_) if path.is_dir() => Ok(Self(None)),
            Err(error) => Err(Error::io(path, error)),
        }
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if let Some(path) = self.0.take() {
            partial_files().retain(|other| *other != path);
            // Fails if it is not empty.
            let _ = fs::remove_dir(path);
        }
    }
}

/// A file beside its final place, removed on drop. The open file keeps its lock.
#[derive(Debug)]
struct Partial(Option<(TempPath, Option<File>)>);

impl Partial {
    fn new(folder: &Path) -> io::Result<(Self, File)> {
        {
            let mut known = LOOKED_AT.lock().unwrap_or_else(PoisonError::into_inner);
            if !known.iter().any(|other| other == folder) {
                known.push(folder.to_owned());
                remove_abandoned(folder);
            }
        }
        let mut files = partial_files();
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
        if let Some(permissions) = of_new_files() {
            builder.permissions(permissions);
        }
        loop {
            let (file, path) = builder.tempfile_in(folder).map(NamedTempFile::into_parts)?;
            // Where files cannot be locked, no other process removes this one either.
            let _ = file.lock();
            // Another process may have removed it before it was locked; then make another.
            if path.exists() {
                files.push(path.to_path_buf());
                let lock = match file.try_clone() {
                    // WASI opens no file twice, and locks none.
                    Err(error) if error.kind() == io::ErrorKind::Unsupported => None,
                    lock => Some(lock?),
                };
                return Ok((Self(Some((path, lock))), file));
            }
        }
    }

    fn path(&self) -> &Path {
        self.0.as_ref().map_or_else(|| Path::new(""), |(path, _)| path)
    }

    fn put(mut self, place: &Path) -> io::Result<()> {
        let mut files = partial_files();
        let Some((path, _lock)) = self.0.take() else { return Ok(()) };
        files.retain(|file| file != &*path);
        path.persist(place).map_err(|failed| failed.error)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if let Some((path, _lock)) = self.0.take() {
            partial_files().retain(|file| file != &*path);
            // Dropping the path removes the file.
        }
    }
}

/// The permissions of a new file, before the mask of the process applies. Without them a temporary
/// file would be readable by its owner only.
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
