//! A study of a scene: its candidates measured against the truth, and timed by turns.
//!
//! 1. [`Bench::load`] loads what the [candidates](crate::study::sweep) draw.
//! 2. [`measure`] takes the errors of one candidate after the other.
//! 3. [`time::turn`] takes times, round by round.
//!
//! What is known so far is a [`Study`]. The errors are a function of the scene, the camera and the
//! settings; times are not.

mod bench;
pub mod cameras;
mod loss;
pub mod measure;
mod record;
pub mod time;
pub mod truths;

pub use bench::{Bench, LeftOut, Visit};
pub use loss::Loss;
pub use record::{Measured, Record, Study, Subject};
