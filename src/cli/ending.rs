//! How a command ended.

use splatref::Result;
use splatref::verdict::Outcome;

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

impl From<Outcome> for Ending {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Right => Self::Good,
            Outcome::Wrong => Self::Different,
            Outcome::Undecidable => Self::Undecidable,
            Outcome::Unlike => Self::Unlike,
        }
    }
}

impl Ending {
    /// The same, but "unlike" is wrong if `strict`.
    pub(super) fn or_strict(self, strict: bool) -> Self {
        if strict && self == Self::Unlike { Self::Different } else { self }
    }
}

/// The result of a command.
pub(super) type Ended = Result<Ending>;
