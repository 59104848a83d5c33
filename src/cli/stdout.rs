//! Prints on stdout, and records whether it worked.

use super::words;
use splatref::{Error, Result};
use std::fmt::Display;
use std::io::{self, Write};
use std::sync::OnceLock;

/// The first failure.
static FAILURE: OnceLock<io::Error> = OnceLock::new();

// Rust opens /dev/null before `main` if stdout is closed, so prints would be lost without an error.
// A constructor runs earlier and looks.
#[cfg(unix)]
ctor::declarative::ctor! {
    #[ctor(unsafe)]
    fn look_whether_it_is_closed() {
        if let Err(closed) = rustix::io::fcntl_getfd(rustix::stdio::stdout()) {
            let _ = FAILURE.set(closed.into());
        }
    }
}

/// Prints a line on stdout. A full disk, or a reader such as `head` that has gone, does not stop
/// the command, because files are still to be written. If the disk is full, the command fails at
/// its end.
pub(super) fn say(text: impl Display) {
    if let Err(error) = writeln!(io::stdout(), "{}", words::visible(&text.to_string())) {
        let _ = FAILURE.set(error);
    }
}

/// Returns the first failure to print, if any.
///
/// A reader that has gone is no failure, because it has read what it wanted: the command ends as if
/// it had read all, with the same exit code.
pub(super) fn printed() -> Result<()> {
    if let Err(error) = io::stdout().flush() {
        let _ = FAILURE.set(error);
    }
    match FAILURE.get() {
        None => Ok(()),
        Some(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Some(error) => Err(Error::Invalid(format!("standard output: {error}"))),
    }
}
