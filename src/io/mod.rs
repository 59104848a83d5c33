//! Files: pictures in and out. Only this module, `cli` and `main` know of them.
//!
//! - [`exr`]: every plane of a frame, exactly; reading guards against lying files.
//! - [`png`]: an 8-bit preview.
//! - [`replace`]: the one way a file is written: beside, then renamed.

pub mod exr;
pub mod png;
pub mod replace;
