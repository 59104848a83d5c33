//! How a command ended.

use splatref::Result;

/// How a command ended that did its work.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// As it should be.
    Good,
    /// Pictures that should be equal are not.
    Different,
    /// Nothing can be said.
    Undecidable,
}

/// How a command ended.
pub(super) type Ended = Result<Ending>;
