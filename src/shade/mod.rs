//! Shade pixels: from attributes to light.
//!
//! - [`harmonics`]: colours that depend on the direction.
//! - [`optics`]: reflection and refraction of an environment.
//! - [`phong`]: the Phong reflection model.

pub mod harmonics;
pub mod optics;
pub mod phong;
