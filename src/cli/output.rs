//! Where a command may write.

use splatref::io::scene_file::SceneFile;
use splatref::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Whether a file could be written at `path`, before much is computed for it: its directory must be
/// there, and the file must be none that the command reads.
pub(super) fn check(path: &Path, scene: &Path, file: &SceneFile) -> Result<()> {
    check_folder(path)?;
    check_unread(path, scene, file)
}

/// Whether the directory of a file that is to be written is there.
pub(super) fn check_folder(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.map(fs::metadata) {
        Some(Ok(found)) if !found.is_dir() => {
            Err(Error::format(path, "what should be its directory is a file"))
        }
        Some(Err(source)) => Err(Error::io(path, source)),
        _ => Ok(()),
    }
}

/// Whether a file that is to be written is not this one, which is read too.
pub(super) fn check_other(path: &Path, read: &Path) -> Result<()> {
    if overwrites(path, read) {
        let path = path.display();
        let what = format!("{path} is what is read; give another name for the output");
        return Err(Error::Usage(what));
    }
    Ok(())
}

/// Whether two files that are to be written are two.
pub(super) fn check_two(one: &Path, other: &Path) -> Result<()> {
    if place(one).is_some_and(|place_of_one| place(other) == Some(place_of_one)) {
        let (one, other) = (one.display(), other.display());
        let what = format!("{one} and {other} are one file; give two names");
        return Err(Error::Usage(what));
    }
    Ok(())
}

/// Whether a file that is to be written is none that is read.
pub(super) fn check_unread(path: &Path, scene: &Path, file: &SceneFile) -> Result<()> {
    let mut read = std::iter::once(scene).chain(file.reads());
    if read.any(|input| overwrites(path, input)) {
        let path = path.display();
        return Err(Error::Usage(format!(
            "{path} is what the scene is read from; give another name for the output"
        )));
    }
    Ok(())
}

/// Whether a file that is there would be overwritten.
fn overwrites(path: &Path, read: &Path) -> bool {
    fs::canonicalize(read).is_ok_and(|read| place(path) == Some(read))
}

/// Where a file is, or will be: its folder is there.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = || fs::canonicalize(folder.unwrap_or(Path::new("."))).ok();
    fs::canonicalize(path).ok().or_else(|| Some(folder()?.join(path.file_name()?)))
}
