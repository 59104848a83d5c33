//! The settings of the method.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit};
use crate::splat::SplatSettings;

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, epsilon and culling of all passes.
    pub splats: SplatSettings,
    /// m: how many consecutive surfels of an object share a flag \[GBP04, 4.3\]. In [1, 4096].
    /// `Departs:` the default is 1. \[GBP04\] has 64, so that flags take at most 8 MB. Larger groups
    /// make pass 1 draw more surfels, and leave gaps along outlines, see `docs/gbp04.md`.
    pub flags: u32,
    /// Whether pass 3 runs: it draws the surfels that the last frame did not see into the depth
    /// before EWA splatting.
    pub second: bool,
    /// Pass 1 leaves out an object if the last frame selected some of its surfels, but at most this
    /// share of the surfels that the high level leaves now \[GBP04, 7\]. In [0, 1]; 0 leaves none
    /// out. A number such as 0.1 is rounded to `f32` first, and the comparison widens the `f32` to
    /// f64.
    pub share: f32,
}

/// The maximum number of surfels that share a flag.
const MOST: u32 = 4096;

impl Default for Settings {
    /// A flag for each surfel, and pass 3.
    fn default() -> Self {
        Self { splats: SplatSettings::default(), flags: 1, second: true, share: 0.0 }
    }
}

impl Settings {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`SplatSettings::check`], or if m or the share is out of range.
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        if !(1..=MOST).contains(&self.flags) {
            return Err(Error::Invalid(format!("flags: {} surfels; give 1 to {MOST}", self.flags)));
        }
        if !(0.0..=1.0).contains(&self.share) {
            return Err(Error::Invalid(format!("share: {}; give 0 to 1", self.share)));
        }
        Ok(())
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        let Self { splats, flags, second, share } = self;
        splats.fields(each);
        let help = "share one visibility flag among this many consecutive surfels of an object (m)";
        each(Field::new("flags", help, Slot::Count(flags)).unit("surfels").range("1 to 4096"));
        let help = "repeat visibility splatting with the surfels that the last frame did not see";
        each(Field::new("second", help, Slot::Switch(second)));
        let help = "leave an object out of the first visibility pass if the last frame selected \
                    some of its surfels, but at most this fraction";
        each(Field::new("share", help, Slot::Number(share)).range("0 to 1"));
    }
}
