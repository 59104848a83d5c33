//! Lights, and the material that reflects them.

use crate::error::{Error, Result};
use glam::Vec3;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Light from infinitely far away.
    Directional {
        /// World-space direction *towards* the light; any length but 0.
        towards: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
    /// A directional light that moves with the camera, its direction given in view space.
    Headlight {
        /// View-space direction *towards* the light; any length but 0.
        towards: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
    /// Light from a point, without attenuation.
    Point {
        /// World-space position.
        position: Vec3,
        /// Linear RGB radiance scale.
        color: Vec3,
    },
}

/// The largest component of a light's, a surface's or an environment's colour, so that no sum of
/// products of colours leaves `f32`.
pub const MAX_RADIANCE: f32 = 65_536.0;

/// Whether every component of a colour is in [0, [`MAX_RADIANCE`]].
pub(crate) fn is_color(color: Vec3) -> bool {
    color.to_array().iter().all(|v| (0.0..=MAX_RADIANCE).contains(v))
}

impl Light {
    /// The headlight of pictures that name no light: white, from the upper left, along (-1/2,
    /// 3/4, 1) in view space.
    pub const DEFAULT: Self =
        Self::Headlight { towards: Vec3::new(-0.5, 0.75, 1.0), color: Vec3::ONE };

    /// Checks that the light can be used for shading.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a number is not finite, if the square of a direction's length is not a
    /// normal `f32`, or if a colour is not in [0, [`MAX_RADIANCE`]]. (A direction with such a
    /// length has lost its digits.)
    pub fn check(&self) -> Result<()> {
        let color = match *self {
            Self::Directional { towards, color } | Self::Headlight { towards, color } => {
                if !towards.length_squared().is_normal() {
                    let what = "light: towards must be a finite vector whose length is neither 0 \
                                nor infinite";
                    return Err(Error::Invalid(what.into()));
                }
                color
            }
            Self::Point { position, color } => {
                if !position.is_finite() {
                    return Err(Error::Invalid("light: position must be finite numbers".into()));
                }
                color
            }
        };
        if is_color(color) {
            Ok(())
        } else {
            let what = format!("light: color must be three numbers in [0, {MAX_RADIANCE}]");
            Err(Error::Invalid(what))
        }
    }
}

/// The Phong reflection model: ambient + diffuse (n . l) + specular (r . v)^shininess.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Weight of the surface colour where no light arrives, in [0, 1].
    pub ambient: f32,
    /// Weight of the surface colour times n . l, in [0, 1].
    pub diffuse: f32,
    /// Weight of the light's colour times (r . v)^shininess, in [0, 1].
    pub specular: f32,
    /// Exponent of the highlight, at least 0.
    pub shininess: f32,
    /// Linear RGB of a surface whose surfels have no colour of their own.
    pub color: Vec3,
}

/// Ambient 1/8, diffuse 3/4, specular 1/4, shininess 32, and a surface of (3/4, 3/4, 3/4).
impl Default for Phong {
    fn default() -> Self {
        Self {
            ambient: 0.125,
            diffuse: 0.75,
            specular: 0.25,
            shininess: 32.0,
            color: Vec3::new(0.75, 0.75, 0.75),
        }
    }
}

impl Phong {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a weight or a component of the colour is not in [0, 1], or if the
    /// shininess is not in [0, 65536].
    pub fn check(&self) -> Result<()> {
        let [r, g, b] = self.color.to_array();
        let numbers = [
            ("ambient", self.ambient, 1.0),
            ("diffuse", self.diffuse, 1.0),
            ("specular", self.specular, 1.0),
            ("shininess", self.shininess, 65_536.0),
            ("color", r, 1.0),
            ("color", g, 1.0),
            ("color", b, 1.0),
        ];
        for (what, value, most) in numbers {
            if !(0.0..=most).contains(&value) {
                let what = format!("material: {what} {value}; give a number in [0, {most}]");
                return Err(Error::Invalid(what));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert!(Light::DEFAULT.check().is_ok() && Phong::default().check().is_ok());
        for towards in [Vec3::ZERO, Vec3::splat(1e-30), Vec3::splat(1e30), Vec3::NAN] {
            assert!(Light::Headlight { towards, color: Vec3::ONE }.check().is_err(), "{towards}");
        }
        for color in [-Vec3::X, Vec3::NAN, Vec3::splat(1e6)] {
            assert!(Light::Point { position: Vec3::ZERO, color }.check().is_err(), "{color}");
            assert!(Phong { color, ..Phong::default() }.check().is_err(), "{color}");
        }
        let position = Vec3::splat(f32::INFINITY);
        assert!(Light::Point { position, color: Vec3::ONE }.check().is_err());
        assert!(Phong { shininess: -1.0, ..Phong::default() }.check().is_err());
    }
}
