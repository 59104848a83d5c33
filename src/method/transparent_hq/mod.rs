//! Transparency behind a nearest layer in high quality, with reflection and refraction \[ZP06,
//! Algorithm 3\].
//!
//! 1. **Nearest layer.** The geometry and the compositing pass of [`mod@super::single_pass`], with
//!    opacity as one more weighted attribute. `Decided:` each surfel in its own group alone and
//!    with its own radius: a surfel that an extension added elsewhere would count twice in a
//!    weighted sum. Deferred shading gives `C_F`, the average opacity is alpha. The stencil is 1
//!    where the layer is.
//! 2. **Other layers.** Algorithm 2 without the fragments of the nearest layer and what is before
//!    it: those with t <= Z + epsilon, Z the depth of pass 1. Where pass 1 left nothing, Z is +inf
//!    and all are dropped: enlarged surfels do not stick out of the silhouette. Its average is
//!    `C_O`.
//! 3. **Compositing.** I = alpha `C_F` + (1 - alpha) `C_O`, and so for the opacity, with 1 for
//!    `C_F`.
//!
//! With [`Settings::refraction`] and an environment, that sum is the one of
//! [`crate::shade::optics`]. The environment is otherwise as in [`mod@super::transparent`].
//!
//! # What it gets wrong
//!
//! All that [`mod@super::transparent`] does, and: a surfel that its group enlarges can be drawn
//! behind itself, where the nearest layer clamps its depth to its own radius (see
//! [`mod@crate::splat::project`]) and epsilon < (scale - 1) r, and, as depths of another radius
//! round otherwise, anywhere with an epsilon of 0.

mod nearest;
mod picture;

use crate::error::Result;
use crate::frame::Frame;
use crate::index::grouping::Grouping;
use crate::method::algorithm::{Algorithm, Job};
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::{Picture, Stage, transparent};
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::setting::{Field, Fields, Slot, Visit};
use crate::shade::optics::{BendingLayers, Refraction};
use crate::splat::SplatSettings;

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

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.layers.fields(each);
        each(self.nearest.field());
        if let DepthTest::Voronoi(bins) = &mut self.nearest {
            *bins = self.layers.bins;
        }
        let mut ratio = self.refraction.map(|refraction| refraction.ratio);
        let mut layers =
            self.refraction.map_or(BendingLayers::Multiple, |refraction| refraction.layers);
        let help = "ratios of refraction for red, green and blue, the index outside over the index \
                    inside: 0.6667 from air to glass";
        each(Field::new("refraction", help, Slot::Ratios(&mut ratio)).range("above 0 to 4"));
        let bends = Field::new("bends", "how many layers bend light", Slot::Word(&mut layers));
        each(if ratio.is_some() { bends } else { bends.idle("without a `refraction`") });
        self.refraction = ratio.map(|ratio| Refraction { ratio, layers });
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

impl Algorithm for Settings {
    const NAME: &'static str = "transparent-hq";
    const SUMMARY: &'static str = "layers behind a smoothly interpolated nearest one; reflection, \
         refraction, dispersion [ZP06, Algorithm 3]";
    const STAGES: &'static [Stage] = &[];
    const GROUPING: Option<Grouping> = Some(transparent::GROUPING);
    const BACK_TO_FRONT: bool = true;
    type Memory = ();

    fn splats(&self) -> Option<&SplatSettings> {
        Some(&self.layers.splats)
    }

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn stage<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let _ = (job, from);
        Err(crate::method::stage::unknown(stage))
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<String> {
        let _ = (job, pixel);
        Err(crate::Error::Usage("there is no replay of this method".into()))
    }

    fn resolved(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        self.layers.resolved(scene, camera)
    }
}
