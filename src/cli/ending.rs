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
    /// A picture is right, but unlike that of any right renderer that was tried.
    Unlike,
}

/// The result of a command.
pub(super) type Ended = Result<Ending>;
