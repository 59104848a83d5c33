//! `splatref`: the ground truth for point-splatting renderers.

pub mod error;
pub mod frame;
pub mod io;
pub mod number;
pub mod scene;

pub use error::{Error, Result};
