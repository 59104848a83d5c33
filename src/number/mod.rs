//! Numbers: one formula, several arithmetics.
//!
//! Every formula of a splat or a fragment is written once, generic over [`Real`]. With `f32` it is
//! the executable specification, the bits that a GPU gets from the same IEEE operations in the same
//! order; with `f64` it is the truth of the same problem.
//!
//! - [`real`]: the trait, its comparisons, and the numbers with two outcomes, [`Exact`].
//! - [`ball`]: a number with a radius, whose comparisons have three outcomes.
//! - [`truth`]: what comparisons and integer parts of numbers are.
//! - [`vector`]: two- and three-component vectors whose order of operations is written out.
//! - [`lanes`]: values side by side, and kernels for every width of vectors.
//! - [`elementary`]: the only home of exp, pow, sin ... in the crate.
//! - [`random`]: random values as functions of a seed and an index.
//! - [`srgb`]: the transfer function between stored colours and linear light.

pub mod ball;
pub mod elementary;
pub mod lanes;
pub mod random;
pub mod real;
pub mod srgb;
pub mod truth;
pub mod vector;

pub use ball::Ball;
pub use real::{Exact, Real};
pub use truth::{Pixel, Truth};
pub use vector::{Vector2, Vector3};
