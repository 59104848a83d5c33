//! A study of a scene: measures its candidates against the truth, and times them by turns.
//!
//! 1. [`Setup::load`] loads the scenes of the [candidates](crate::study::sweep), and the truth.
//! 2. [`measure`] takes the errors of one candidate after the other.
//! 3. [`time::turn`] takes times, round by round.
//!
//! A [`Study`] holds the results so far. The errors depend only on the scene, the camera and the
//! settings; times do not.

mod bench;
pub mod cameras;
mod loss;
pub mod measure;
mod record;
mod setup;
pub mod time;
pub mod truths;

pub use bench::{Bench, LeftOut, Visit};
pub use loss::Loss;
pub use record::{Measured, Record, Study, Subject};
pub use setup::Setup;
