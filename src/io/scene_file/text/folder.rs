//! Paths as a scene file calls them.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf, absolute};

/// The folder that a file is written to.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn containing(path: &Path) -> Result<Self> {
        let whole = absolute(path).map_err(|source| Error::io(path, source))?;
        Ok(Self(whole.parent().unwrap_or(&whole).to_owned()))
    }

    /// How the file calls another: by what follows the folder if it lies within, else by the whole path.
    pub(super) fn path(&self, other: &Path) -> PathBuf {
        let whole = absolute(other).unwrap_or_else(|_| other.to_owned());
        whole.strip_prefix(&self.0).map(Path::to_owned).unwrap_or(whole)
    }
}
