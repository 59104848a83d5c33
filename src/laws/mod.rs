//! Test your compositing operators: laws that must hold, whatever draws the picture.
//!
//! Pass your operator to a function of this page. The function evaluates the operator at many
//! inputs and returns the first counterexample. The inputs depend only on the version of this crate
//! ([`crate::number::random`] and the edge cases of each law), so a backend that fails, fails
//! again. An operator is a closure in `f32` (or `f64`). If your operator runs on a GPU, evaluate
//! your shader in the closure, or write its formula a second time in Rust.
//!
//! ```
//! use splatref::laws;
//!
//! // The epsilon-z test of a shader, as it should be, and by a difference that rounds.
//! laws::epsilon(&|t: f32, nearest: f32, epsilon: f32| t <= nearest + epsilon)?;
//! let wrong = laws::epsilon(&|t: f32, nearest: f32, epsilon: f32| t - nearest <= epsilon);
//! println!("{}", wrong.unwrap_err()); // the law, the inputs, what was expected and found
//! # Ok::<(), laws::Counterexample>(())
//! ```
//!
//! The module of each function also has its laws one by one, as functions of the inputs. Use these
//! for property tests with a generator that shrinks.
//!
//! - [`mod@epsilon`]: which fragments belong to the visible surface.
//! - [`mod@sums`]: weighted accumulation and normalization.
//! - [`mod@over`], [`mod@under`]: alpha-blending from back to front, and from front to back.
//! - [`mod@bins`]: low-precision and Voronoi-enhanced depth.
//! - [`mod@groups`]: the n-ary operator over depth-images.
//! - [`mod@means`]: the average of neighbours in a pyramid.

pub mod bins;
pub mod epsilon;
pub mod groups;
mod inputs;
pub mod means;
pub mod over;
pub mod sums;
#[cfg(test)]
mod tests;
pub mod under;

pub use bins::bins;
pub use epsilon::epsilon;
pub use groups::groups;
pub use means::means;
pub use over::over;
pub use sums::sums;
pub use under::under;

use crate::number::Exact;
use std::fmt::{self, Debug};

/// Inputs at which an operator breaks a law.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counterexample {
    /// The law, in words.
    pub law: &'static str,
    /// The inputs.
    pub inputs: String,
    /// What the law asks for.
    pub expected: String,
    /// What the operator gave.
    pub found: String,
}

impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, inputs, expected, found } = self;
        write!(f, "{law}: of {inputs}: expected {expected}, found {found}")
    }
}

impl std::error::Error for Counterexample {}

/// The result of testing an operator: it keeps the law, or a counterexample.
pub type Lawful = Result<(), Counterexample>;

/// Returns a counterexample unless the law holds.
fn law(
    law: &'static str,
    holds: bool,
    inputs: &dyn Debug,
    expected: &dyn Debug,
    found: &dyn Debug,
) -> Lawful {
    if holds {
        return Ok(());
    }
    let [inputs, expected, found] = [inputs, expected, found].map(|v| format!("{v:?}"));
    Err(Counterexample { law, inputs, expected, found })
}

/// Half the spacing of the numbers in [1, 2): the relative error of one rounding.
fn unit<R: Exact>() -> f64 {
    // An addend of 2^-30 is lost next to 1 in `f32`, but not in `f64`.
    let single = R::ONE + R::from_f32(1.0 / 1_073_741_824.0) == R::ONE;
    if single { f64::from(f32::EPSILON) / 2.0 } else { f64::EPSILON / 2.0 }
}

/// Whether the numbers have the same bits.
fn same<R: Exact, const N: usize>(a: [R; N], b: [R; N]) -> bool {
    a.map(|v| v.to_f64().to_bits()) == b.map(|v| v.to_f64().to_bits())
}
