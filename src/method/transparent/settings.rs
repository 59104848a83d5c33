//! The settings of the method.

use crate::composite::bins::DepthBins;
use crate::error::Result;
use crate::method::Job;
use crate::method::single_pass::BinCount;
use crate::number::Real;
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::SplatSettings;

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, epsilon, culling.
    pub splats: SplatSettings,
    /// The bins of the low-precision depth.
    pub bins: BinCount,
    /// Where the bins of each group begin.
    pub bin_edges: BinEdges,
    /// What a group without a fragment at a pixel contributes to the average.
    pub holes: Holes,
}

/// Where the depth bins of each group begin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BinEdges {
    /// `Decided:` the bins of group k of K are moved towards the eye by k/K of a bin.
    #[default]
    Staggered,
    /// At the nearest depth in all groups, as in \[ZP06, eq. 6\].
    Common,
}

/// What a group without a fragment at a pixel contributes to the average.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Holes {
    /// `Decided:` nothing: the average is over the other groups.
    #[default]
    Skipped,
    /// The background, as in averaging all images to the letter \[ZP06, Algorithm 2\].
    Background,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            splats: SplatSettings::BOTH_SIDES,
            bins: BinCount::default(),
            bin_edges: BinEdges::default(),
            holes: Holes::default(),
        }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.splats.fields(each);
        self.bins.field(each);
        let help =
            "start each group's depth bins at an offset of its own, or all at the same depth";
        each(Field::new("bin_edges", help, Slot::Word(&mut self.bin_edges)));
        let help = "choose what a group without fragments adds to the average: nothing, or the \
                    background";
        each(Field::new("holes", help, Slot::Word(&mut self.holes)));
    }
}

impl Words for BinEdges {
    const WORDS: &'static [(&'static str, Self)] =
        &[("staggered", Self::Staggered), ("common", Self::Common)];
}

impl Words for Holes {
    const WORDS: &'static [(&'static str, Self)] =
        &[("skipped", Self::Skipped), ("background", Self::Background)];
}

impl Settings {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a number is not.
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        self.bins.check()
    }

    /// The bins of each group of a picture.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`BinCount::resolve`].
    pub(crate) fn bins<R: Real>(&self, job: &Job<'_>, groups: usize) -> Result<Vec<DepthBins<R>>> {
        let surfels = &job.scene.surfels;
        let epsilon = self.splats.epsilon.resolve(surfels);
        let bins = DepthBins::new(&self.bins.resolve(surfels, job.camera, epsilon)?);
        Ok((0..groups)
            .map(|group| match self.bin_edges {
                // Group 0 is not moved, so that its bins need no sum that would be rounded.
                BinEdges::Staggered if group > 0 => bins.moved(group as f32 / groups as f32),
                _ => bins,
            })
            .collect())
    }
}
