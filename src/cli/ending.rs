//! How a command ended.

use splatref::Result;

/// How a command ended that ran to its end.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// Success.
    Good,
    /// Pictures that should be equal are not.
    Different,
    /// No verdict is possible.
    Undecidable,
}

/// The result of a command.
pub(super) type Ended = Result<Ending>;
