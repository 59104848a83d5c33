//! Checks where a command may write.

use splatref::io::scene_file::SceneFile;
use splatref::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Checks, before long work, that a file can be written at `path`: its directory exists, and the
/// command does not read the file.
pub(super) fn check(path: &Path, scene: &Path, file: &SceneFile) -> Result<()> {
    check_folder(path)?;
    check_unread(path, scene, file)
}

/// Checks that the directory of an output exists.
pub(super) fn check_folder(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.map(fs::metadata) {
        Some(Ok(found)) if !found.is_dir() => {
            Err(Error::format(path, "its directory is a file; give another name"))
        }
        Some(Err(source)) => Err(Error::io(path, source)),
        _ => Ok(()),
    }
}

/// Checks that an output is not this input.
pub(super) fn check_other(path: &Path, read: &Path) -> Result<()> {
    if overwrites(path, read) {
        let path = path.display();
        let what = format!("{path} is also an input; give another name for the output");
        return Err(Error::Usage(what));
    }
    Ok(())
}

/// Checks that two outputs are different files.
pub(super) fn check_two(one: &Path, other: &Path) -> Result<()> {
    if place(one).is_some_and(|place_of_one| place(other) == Some(place_of_one)) {
        let (one, other) = (one.display(), other.display());
        let what = format!("{one} and {other} are the same file; give two names");
        return Err(Error::Usage(what));
    }
    Ok(())
}

/// Checks that the scene is not read from the output file.
pub(super) fn check_unread(path: &Path, scene: &Path, file: &SceneFile) -> Result<()> {
    let mut read = std::iter::once(scene).chain(file.reads());
    let in_some_frame = place(path).is_some_and(|place| file.reads_in_some_frame(&place));
    if in_some_frame || read.any(|input| overwrites(path, input)) {
        let path = path.display();
        return Err(Error::Usage(format!(
            "{path} is part of the scene; give another name for the output"
        )));
    }
    Ok(())
}

/// Whether writing `path` would overwrite the file `read`.
fn overwrites(path: &Path, read: &Path) -> bool {
    fs::canonicalize(read).is_ok_and(|read| place(path) == Some(read))
}

/// The canonical path of a file, whether it exists or only its folder does.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = || fs::canonicalize(folder.unwrap_or(Path::new("."))).ok();
    fs::canonicalize(path).ok().or_else(|| Some(folder()?.join(path.file_name()?)))
}
