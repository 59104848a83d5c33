//! From attributes to light: deferred shading, pixel by pixel.
//!
//! - [`phong`]: the Phong reflection model.

pub mod phong;
