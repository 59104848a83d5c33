//! What is computed.

use crate::error::Result;
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::transparent;
use crate::shade::optics::Refraction;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How the other layers are blended; its footprints, epsilon and culling are those of the
    /// nearest layer too.
    pub layers: transparent::Settings,
    /// Which fragment of a group the nearest layer keeps.
    pub nearest: DepthTest,
    /// How light is bent at the nearest layer; needs an environment to be seen.
    pub refraction: Option<Refraction>,
}

impl Default for Settings {
    /// Voronoi depth with bins as deep as epsilon; nothing is refracted.
    fn default() -> Self {
        Self {
            layers: transparent::Settings::default(),
            nearest: DepthTest::Voronoi(BinCount::Epsilon),
            refraction: None,
        }
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        self.layers.check()?;
        if let DepthTest::Voronoi(bins) = &self.nearest {
            bins.check()?;
        }
        self.refraction.as_ref().map_or(Ok(()), Refraction::check)
    }
}
