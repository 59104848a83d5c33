//! Shade pixels: from attributes to light, pixel by pixel (deferred shading).
//!
//! - [`optics`]: reflection and refraction of an environment.
//! - [`phong`]: the Phong reflection model.

pub mod optics;
pub mod phong;
