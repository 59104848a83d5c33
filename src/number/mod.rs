//! Evaluate one formula in several arithmetics.
//!
//! Every formula of a splat or a fragment is written once, generic over [`Real`]:
//!
//! - In `f32` it is the executable specification: the bits that a GPU gets from the same IEEE
//!   operations in the same order.
//! - In `f64` it is the truth of the same problem.
//! - In [`Ball`] it tells how far an honest `f32` result may lie from that truth.
//!
//! What is where:
//!
//! - [`real`]: the trait, its comparisons, and [`Exact`], the numbers whose comparisons have two
//!   outcomes.
//! - [`ball`]: a number with a radius, whose comparisons have three outcomes.
//! - [`truth`]: the outcome of a comparison, and the integer part of a number.
//! - [`vector`]: two- and three-component vectors whose order of operations is written out.
//! - [`lanes`]: values side by side, and kernels compiled for every vector width.
//! - [`elementary`]: the only home of exp, pow, sin ... in the crate.
//! - [`random`]: random values as functions of a seed and an index.
//! - [`srgb`]: convert between stored colours and linear light.

pub mod ball;
pub mod elementary;
pub mod lanes;
mod map_inline;
pub mod random;
pub mod real;
pub mod srgb;
pub mod truth;
pub mod vector;

pub use ball::Ball;
pub(crate) use map_inline::MapInline;
pub use real::{Exact, Real};
pub use truth::{Pixel, Truth};
pub use vector::{Vector2, Vector3};
