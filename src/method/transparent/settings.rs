//! What is computed.

use crate::error::Result;
use crate::method::single_pass::BinCount;
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::SplatSettings;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, epsilon, culling.
    pub splats: SplatSettings,
    /// The bins of the low-precision depth.
    pub bins: BinCount,
    /// What a group that has nothing at a pixel gives to the average.
    pub holes: Holes,
}

/// What a group that has no fragment at a pixel gives to the average.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Holes {
    /// `Decided:` nothing: the average is over the other groups.
    #[default]
    Skipped,
    /// The background, as averaging all images does to the letter \[ZP06, Algorithm 2\].
    Background,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            splats: SplatSettings::BOTH_SIDES,
            bins: BinCount::default(),
            holes: Holes::default(),
        }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.splats.fields(each);
        self.bins.field(each);
        let help =
            "what a group without fragments gives to the average: nothing, or the background";
        each(Field::new("holes", help, Slot::Word(&mut self.holes)));
    }
}

impl Words for Holes {
    const WORDS: &'static [(&'static str, Self)] =
        &[("skipped", Self::Skipped), ("background", Self::Background)];
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        self.bins.check()
    }
}
