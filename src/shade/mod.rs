//! From attributes to light: deferred shading, pixel by pixel.
//!
//! - [`optics`]: reflection and refraction of an environment.
//! - [`phong`]: the Phong reflection model.

pub mod optics;
pub mod phong;
