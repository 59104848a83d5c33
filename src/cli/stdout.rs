//! What a command prints, and whether it arrived.

use super::words;
use splatref::{Error, Result};
use std::fmt::Display;
use std::io::{self, Write};
use std::sync::OnceLock;

/// The first failure.
static FAILURE: OnceLock<io::Error> = OnceLock::new();

// Before `main` Rust opens /dev/null in the place of a closed stdout: what is printed would be lost and
// nothing would fail. A constructor looks earlier.
#[cfg(unix)]
ctor::declarative::ctor! {
    #[ctor(unsafe)]
    fn look_whether_it_is_closed() {
        if let Err(closed) = rustix::io::fcntl_getfd(rustix::stdio::stdout()) {
            let _ = FAILURE.set(closed.into());
        }
    }
}

/// A line on stdout. A full disk or a reader that has gone, such as `head`, is no reason to stop:
/// files are still to be written. It is a failure in the end.
pub(super) fn say(text: impl Display) {
    if let Err(error) = writeln!(io::stdout(), "{}", words::visible(&text.to_string())) {
        let _ = FAILURE.set(error);
    }
}

/// What is printed has arrived, or why not.
pub(super) fn printed() -> Result<()> {
    if let Err(error) = io::stdout().flush() {
        let _ = FAILURE.set(error);
    }
    match FAILURE.get() {
        None => Ok(()),
        Some(error) => Err(Error::Invalid(format!("standard output: {error}"))),
    }
}
