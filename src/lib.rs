//! `splatref`: the ground truth for point-splatting renderers.

pub mod composite;
pub mod error;
pub mod frame;
pub mod method;
pub mod number;
pub mod scene;
pub mod splat;

pub use error::{Error, Result};
