//! The laws of the compositing operators.

mod bins;
pub(crate) mod groups;
mod over;
mod sums;

use proptest::test_runner::{TestCaseError, TestCaseResult};
use splatref::laws::Lawful;

/// What a law says of a case, as a property test wants it.
pub(crate) fn lawful(found: Lawful) -> TestCaseResult {
    found.map_err(|counterexample| TestCaseError::fail(counterexample.to_string()))
}
