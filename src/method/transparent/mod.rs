//! Transparent surfels: back-to-front blending within groups, averaged \[ZP06, Algorithms 2 and
//! 3\].
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
//! # Algorithm 3
//!
//! 1. **Nearest layer.** The geometry and the compositing pass of [`super::single_pass`], with
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
//! [`crate::shade::optics`]. An environment is behind everything: colour + (1 - A) env(ray of the
//! pixel), and A becomes 1. Without one colours are over black, that is, multiplied by A.
//!
//! # What it gets wrong
//!
//! - Two fragments of one layer and one group that fall on either side of a bin's edge are blended
//!   as two layers: darker arcs, the more of them the more bins there are.
//! - Two layers in one bin are one layer: the one that is drawn first, the farther, is seen.
//! - A group that does not cover a layer leaves holes in it, see [`crate::index::grouping`] for the
//!   extensions that close them, and [`Holes`].
//! - Overlapping surfels are ordered by their centres, see [`crate::index::order`].
//! - Algorithm 3 can draw a surfel that its group enlarges behind itself: where the nearest layer
//!   clamps its depth to its own radius (see [`mod@crate::splat::project`]) and epsilon < (scale -
//!   1) r, and, as depths of another radius round otherwise, anywhere with an epsilon of 0.
//!
//! The truth that it is held against is [`super::peeling`].
//!
//! [`Groups`]: crate::scene::Groups

mod blend;
mod nearest;
mod picture;

pub use picture::render;

use super::ewa;
use super::single_pass::{BinCount, DepthTest};
use crate::error::{Error, Result};
use crate::shade::optics::Refraction;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Footprints, epsilon, culling.
    pub splats: ewa::Settings,
    /// The bins of the low-precision depth.
    pub bins: BinCount,
    /// What a group that has nothing at a pixel gives to the average.
    pub holes: Holes,
    /// Algorithm 3, the nearest layer separately, with this depth test; none: Algorithm 2.
    pub nearest: Option<DepthTest>,
    /// How light is bent at the nearest layer; needs `nearest`, and an environment to be seen.
    pub refraction: Option<Refraction>,
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
            splats: ewa::Settings { cull: false, ..ewa::Settings::default() },
            bins: BinCount::default(),
            holes: Holes::default(),
            nearest: None,
            refraction: None,
        }
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not, or if refraction is wanted without the nearest layer.
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        self.bins.check()?;
        if let Some(DepthTest::Voronoi(bins)) = &self.nearest {
            bins.check()?;
        }
        match &self.refraction {
            None => Ok(()),
            Some(_) if self.nearest.is_none() => Err(Error::Invalid(
                "refraction: light is bent at the nearest layer; give a method that has one".into(),
            )),
            Some(refraction) => refraction.check(),
        }
    }
}
