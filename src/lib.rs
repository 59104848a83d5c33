//! `splatref`: the ground truth for point-splatting renderers.

pub mod composite;
pub mod error;
pub mod frame;
pub mod io;
pub mod method;
pub mod number;
pub mod scene;
pub mod shade;
pub mod splat;
pub mod verify;

pub use error::{Error, Result};
