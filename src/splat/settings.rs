//! What every method that draws splats can set.

use super::Kernel;
use crate::error::{Error, Result};
use crate::scene::{Scene, Surfels};

/// Footprints, the visible band and culling; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatSettings {
    /// Reconstruction kernel and low-pass filter.
    pub kernel: Kernel,
    /// Depth of the band that belongs to the visible surface.
    pub epsilon: Epsilon,
    /// Whether surfels seen from behind are dropped. On by default: at the silhouette of a closed
    /// surface, discs of its far side stick out.
    pub cull: bool,
}

impl SplatSettings {
    /// The default, seen from both sides: the far side of a transparent object is seen.
    pub const BOTH_SIDES: Self =
        Self { kernel: Kernel::DEFAULT, epsilon: Epsilon::MedianRadii(1.0), cull: false };

    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the kernel is out of range, or epsilon is negative or NaN.
    pub fn check(&self) -> Result<()> {
        self.kernel.check()?;
        let (Epsilon::World(value) | Epsilon::MedianRadii(value)) = self.epsilon;
        if value >= 0.0 {
            Ok(())
        } else {
            Err(Error::Invalid(format!("epsilon: {value}; give a number >= 0")))
        }
    }

    /// What the settings come to in a scene: names and values as TOML.
    #[must_use]
    pub fn resolved(&self, scene: &Scene) -> Vec<(&'static str, String)> {
        vec![("epsilon_in_world_units", format!("{:?}", self.epsilon.resolve(&scene.surfels)))]
    }
}

impl Default for SplatSettings {
    fn default() -> Self {
        Self { cull: true, ..Self::BOTH_SIDES }
    }
}

/// A depth, in one of two units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Epsilon {
    /// World units.
    World(f32),
    /// Multiples of the median radius of the scene's surfels.
    MedianRadii(f32),
}

impl Default for Epsilon {
    /// One median radius.
    fn default() -> Self {
        Self::MedianRadii(1.0)
    }
}

impl Epsilon {
    /// The depth in world units; the product with the median is rounded once.
    #[must_use]
    pub fn resolve(&self, surfels: &Surfels) -> f32 {
        match *self {
            Self::World(depth) => depth,
            Self::MedianRadii(count) => count * surfels.median_radius(),
        }
    }
}
