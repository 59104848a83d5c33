//! The one error of the crate, raised only at the door: files, scenes and settings.
//!
//! Inside the pipeline nothing fails: a degenerate surfel is dropped and counted.

use std::path::{Path, PathBuf};

/// What went wrong, where, and what to do; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The operating system refused to read or write a file.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason given by the system.
        source: std::io::Error,
    },
    /// A file is not what its format promises.
    #[error("{}: {what}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where (element, line or byte), what, and what to do.
        what: String,
    },
    /// A scene, camera or setting that no picture can be made of.
    #[error("{0}")]
    Invalid(String),
    /// The program was called wrongly.
    #[error("{0}")]
    Usage(String),
}

/// A result with the crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::Io`] on `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// An [`Error::Format`] of `path`.
    pub fn format(path: &Path, what: impl Into<String>) -> Self {
        Self::Format { path: path.to_owned(), what: what.into() }
    }

    /// The exit code of the program: 2 for wrong usage, 1 for the rest.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Io { .. } | Self::Format { .. } | Self::Invalid(_) => 1,
        }
    }
}
