//! Paths as a scene file calls them.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf, absolute};

/// The folder that the file is written to.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn containing(path: &Path) -> Result<Self> {
        let whole = absolute(path).map_err(|source| Error::io(path, source))?;
        Ok(Self(whole.parent().unwrap_or(&whole).to_owned()))
    }

    /// The path of another file in the text: relative if it lies in the folder or below, else
    /// absolute.
    pub(super) fn path(&self, other: &Path) -> PathBuf {
        let whole = absolute(other).unwrap_or_else(|_| other.to_owned());
        whole.strip_prefix(&self.0).map(Path::to_owned).unwrap_or(whole)
    }
}
