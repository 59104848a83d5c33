//! What is computed.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit};
use crate::splat::SplatSettings;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, the epsilon of each layer, and culling: off by default, as the far side of a
    /// transparent object is seen.
    pub splats: SplatSettings,
    /// The most layers of a pixel: 1 to [`MAX_LAYERS`].
    pub layers: u32,
}

/// The greatest number of layers.
pub const MAX_LAYERS: u32 = 256;

impl Default for Settings {
    /// 64 layers, seen from both sides.
    fn default() -> Self {
        Self { splats: SplatSettings::BOTH_SIDES, layers: 64 }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.splats.fields(each);
        let help = "peel at most this many layers";
        each(Field::new("peel", help, Slot::Count(&mut self.layers)).range("1 to 256"));
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`SplatSettings::check`], and if the number of layers is out of range.
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        if (1..=MAX_LAYERS).contains(&self.layers) {
            Ok(())
        } else {
            Err(Error::Invalid(format!("peel: {} layers; give 1 to {MAX_LAYERS}", self.layers)))
        }
    }
}
