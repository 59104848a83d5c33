//! Test your compositing operators: laws that must hold, whatever draws the picture.
//!
//! Pass your operator to a function of this page. The function evaluates the operator at many
//! inputs and returns the first counterexample, shrunk to the simplest inputs that it finds. The
//! inputs depend only on the version of this crate ([`crate::number::random`] and the edge cases of
//! each law), so a backend that fails, fails again. An operator is a closure in `f32` (or `f64`). If
//! your operator runs on a GPU, evaluate your shader in the closure, or write its formula a second
//! time in Rust.
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
//! # Leave out the laws that your operator need not keep
//!
//! Every law has a [`Kind`]. An operator that breaks an [algebraic](Kind::Algebraic) law draws
//! another picture. An operator that breaks only [exact](Kind::Exact) laws, or laws at
//! [odd](Kind::Odd) inputs, may be right: [`Counterexample::picture`] says what you lose. The
//! function `of_kinds` in the module of each operator tests only the kinds that you name:
//!
//! ```
//! use splatref::composite::over::Blend;
//! use splatref::laws::{Kind, over};
//!
//! // Blending as b + a (c - b): one multiplication less, but an opaque layer is a rounding off.
//! let mix = |a: f32, below: f32, c: f32| below + a * (c - below);
//! let blend = |below: Blend<f32>, alpha, color: [f32; 3]| Blend {
//!     color: std::array::from_fn(|i| mix(alpha, below.color[i], color[i])),
//!     alpha: mix(alpha, below.alpha, 1.0),
//! };
//! over::of_kinds(&[Kind::Algebraic, Kind::Odd], &blend)?;
//! let lost = over::over(&blend).unwrap_err();
//! assert_eq!((lost.kind, lost.law), (Kind::Exact, "an opaque layer hides what is below"));
//! # Ok::<(), splatref::laws::Counterexample>(())
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
mod search;
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

/// What a law asks of an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The operator computes the right quantity, up to rounding, and decides as defined except
    /// within a rounding of a limit. An operator that breaks such a law is wrong.
    Algebraic,
    /// The result is right to the bit, at ordinary inputs. An operator may round in another way and
    /// be right all the same.
    Exact,
    /// Inputs that few pictures have: infinities, -0, numbers below the normal ones, and the
    /// largest numbers.
    Odd,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Algebraic, Self::Exact, Self::Odd];

    /// The kind in one word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Algebraic => "algebraic",
            Self::Exact => "exact",
            Self::Odd => "odd inputs",
        }
    }
}

/// A law.
#[derive(Clone, Copy, Debug)]
struct Law {
    words: &'static str,
    kind: Kind,
    /// What in a picture stands on the law.
    picture: &'static str,
}

impl Law {
    const fn algebraic(words: &'static str, picture: &'static str) -> Self {
        Self { words, kind: Kind::Algebraic, picture }
    }

    const fn exact(words: &'static str, picture: &'static str) -> Self {
        Self { words, kind: Kind::Exact, picture }
    }

    const fn odd(words: &'static str, picture: &'static str) -> Self {
        Self { words, kind: Kind::Odd, picture }
    }
}

/// Inputs at which an operator breaks a law.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counterexample {
    /// The law, in words.
    pub law: &'static str,
    /// The kind of the law; [`Kind::Odd`] if only odd inputs break it.
    pub kind: Kind,
    /// What in a picture stands on the law.
    pub picture: &'static str,
    /// The inputs.
    pub inputs: String,
    /// What the law asks for.
    pub expected: String,
    /// What the operator gave.
    pub found: String,
}

impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, kind, picture, inputs, expected, found } = self;
        let kind = kind.name();
        write!(f, "{law} ({kind}: {picture}): of {inputs}: expected {expected}, found {found}")
    }
}

impl std::error::Error for Counterexample {}

/// The result of testing an operator: it keeps the law, or a counterexample.
pub type Lawful = Result<(), Counterexample>;

/// Returns a counterexample unless the law holds.
fn law(
    law: &Law,
    holds: bool,
    inputs: &dyn Debug,
    expected: &dyn Debug,
    found: &dyn Debug,
) -> Lawful {
    if holds {
        return Ok(());
    }
    let [inputs, expected, found] = [inputs, expected, found].map(|v| format!("{v:?}"));
    let Law { words, kind, picture } = *law;
    Err(Counterexample { law: words, kind, picture, inputs, expected, found })
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
