//! Transparent surfels: back-to-front blending within groups, averaged \[ZP06, Algorithm 2\].
//!
//! A surfel has its own opacity alpha; where a scene has none it is 1. Opaque and transparent
//! surfels mix freely. Back faces are layers too: [`Settings::default`] does not cull.
//!
//! # Algorithm 2
//!
//! 1. **Order.** The surfels from back to front, see [`crate::index::order`]. A surfel is drawn
//!    once in each of its groups, its radius (or tangents) times the scale of the group, see
//!    [`Groups`]; the order of a surfel's groups does not matter.
//! 2. **Shading.** `Decided:` (blended fragments cannot be shaded later) each surfel is shaded
//!    once, by [`crate::shade::phong`] at its centre with the normal of the side that is seen.
//! 3. **Geometry pass.** For each fragment that is inside (q <= k^2; the kernel's weight plays no
//!    part, section 3.3), with its bin of low-precision depth (eq. 6, [`crate::composite::bins`]):
//!    it passes if `bin < bin of the pixel`, at first +inf. Then the pixel takes its bin, and
//!    blends ([`crate::composite::over`]) its shaded colour by alpha; alpha is added to the pixel's
//!    sum of opacities (section 5.2.3), and one to its count of layers. `Departs:` an opaque
//!    fragment sets that sum to 0 and marks the pixel as hiding what is behind: eq. 11 is made for
//!    one opacity everywhere.
//! 4. **Compositing pass.** The average of the images, see [`Holes`]: colour, opacity, sum of
//!    opacities, hidden part; each is a sum in the order of the groups, divided once by their
//!    count.
//!
//! An environment is behind everything: colour + (1 - A) env(ray of the pixel), and A becomes 1.
//! Without one colours are over black, that is, multiplied by A.
//!
//! # What it gets wrong
//!
//! - Two fragments of one layer and one group that fall on either side of a bin's edge are blended
//!   as two layers: darker arcs, the more of them the more bins there are.
//! - Two layers in one bin are one layer: the one that is drawn first, the farther, is seen.
//! - A group that does not cover a layer leaves holes in it, see [`crate::index::grouping`] for the
//!   extensions that close them, and [`Holes`].
//! - Overlapping surfels are ordered by their centres, see [`crate::index::order`].
//!
//! The truth that it is held against is [`super::peeling`].
//!
//! [`Groups`]: crate::scene::Groups

pub(super) mod blend;
pub(super) mod picture;

use crate::error::Result;
use crate::frame::Frame;
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::single_pass::BinCount;
use crate::method::{Picture, Stage};
use crate::number::Real;
use crate::scene::{Camera, Scene};
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

/// K = 4, which \[ZP06, section 6.2\] finds sufficient; groups are extended by adding surfels.
pub(crate) const GROUPING: Grouping = Grouping {
    rules: Rules { overlap: 1.0, opposite: true, coplanar: None },
    count: Some(4),
    extension: Extension::Add { most: 0.5 },
};

impl Algorithm for Settings {
    const NAME: &'static str = "transparent";
    const SUMMARY: &'static str =
        "layers alpha-blended within groups, averaged [ZP06, Algorithm 2]";
    const STAGES: &'static [Stage] = &[];
    const GROUPING: Option<Grouping> = Some(GROUPING);
    const BACK_TO_FRONT: bool = true;
    type Memory = ();

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Real>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn stage<R: Real>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let _ = (job, from);
        Err(crate::method::stage::unknown(stage))
    }

    fn explain<R: Real>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<String> {
        let _ = (job, pixel);
        Err(crate::Error::Usage("there is no replay of this method".into()))
    }

    fn resolved(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        let mut resolved = self.splats.resolved(scene);
        resolved.extend(self.bins.resolved(&self.splats, scene, camera));
        resolved
    }
}
