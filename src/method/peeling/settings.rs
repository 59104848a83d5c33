//! The settings of the method.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit};
use crate::splat::SplatSettings;

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, the epsilon of each layer, and culling. Culling is off by default, because you
    /// see the far side of a transparent object.
    pub splats: SplatSettings,
    /// The maximum number of layers of a pixel: 1 to [`MAX_LAYERS`].
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
    /// Checks that the numbers are in range.
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
