//! Draw transparency behind a nearest layer in high quality, with reflection and refraction \[ZP06,
//! Algorithm 3\].
//!
//! 1. **Nearest layer.** Run the geometry and the compositing pass of [`mod@super::single_pass`],
//!    with opacity as one more weighted attribute. `Decided:` each surfel is drawn in its own group
//!    alone and with its own radius, because a surfel that an extension added elsewhere would count
//!    twice in a weighted sum. Deferred shading gives `C_F`; the average opacity is alpha. The
//!    stencil is 1 where the layer is.
//! 2. **Other layers.** Run Algorithm 2 without the fragments of the nearest layer and the
//!    fragments before it. These are the fragments with t <= Z + epsilon, where Z is the depth of
//!    pass 1. Where pass 1 left nothing, Z is +inf and all fragments are dropped, so that enlarged
//!    surfels do not stick out of the silhouette. The average is `C_O`.
//! 3. **Compositing.** I = alpha `C_F` + (1 - alpha) `C_O`, and so for the opacity, with 1 for
//!    `C_F`.
//!
//! With [`Settings::refraction`] and an environment, [`crate::shade::optics`] defines that sum. The
//! environment is otherwise as in [`mod@super::transparent`].
//!
//! # Two counts of layers
//!
//! Two planes count layers. They are different numbers.
//!
//! - `layers`, in every picture: the average count of pass 2, plus 1 where pass 1 left a layer,
//!   that is, where Z is finite. Where pass 1 left nothing, pass 2 left nothing either: the count
//!   is 0. The average count is defined in [`mod@super::transparent`]: a sum over the groups,
//!   divided once, of how many fragments each group blended. So the count is no integer in general.
//!   The depth test of the bins makes the layers, and the opacities play no part.
//! - `l`, with the planes of the stages: l of section 5.2.3, by opacity. With alpha the average
//!   opacity of pass 1 and S the average sum of opacities of pass 2, l = 1 + S / alpha where
//!   alpha > 0, else 0. An opaque fragment has set the sum of its group to 0. The plane is the same
//!   with and without refraction, and with one and with many layers that bend.
//!   and without refraction, and with one and with many layers that bend.
//!
//! The setting `bends` says how many layers refraction counts
//! ([`BendingLayers`](crate::shade::optics::BendingLayers)). With `multiple` the count is
//! l = 1 + S / alpha, and 1 where alpha is 0 (there the plane `l` has 0). With `single` the count is
//! 1, and the other layers are left out altogether. The count is the exponent of
//! [`refract`](crate::shade::optics::refract) and of
//! [`absorption`](crate::shade::optics::absorption); `layers` is the exponent of nothing.
//!
//! `Departs:` section 5.2.3 interpolates the position too, "if necessary". Here Phong lighting
//! takes the position of the nearest fragment: on the ray of the pixel, at the depth Z of pass 1.
//! Reflection and refraction need no position, because the environment is infinitely far away.
//!
//! # What the method gets wrong
//!
//! The method shares all errors of [`mod@super::transparent`], and has one of its own: a surfel
//! that its group enlarges can be drawn behind itself.
//!
//! - This happens where the nearest layer clamps its depth to its own radius (see
//!   [`mod@crate::splat::project`]) and epsilon < (scale - 1) r.
//! - With an epsilon of 0 it can happen anywhere, because depths of another radius round otherwise.
//!
//! The definition is over any [`Exact`] number; `fast` gives the same bits for `f32`.
//!
//! What a right implementation may leave of each stage: [`crate::verdict::transparent_hq`].

pub(crate) mod compositing;
pub mod explain;
mod fast;
pub(crate) mod nearest;
mod picture;
pub(crate) mod planes;
mod settings;

pub use settings::Settings;

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::index::grouping::Grouping;
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage, transparent};
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::splat::SplatSettings;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "transparent-hq";
    const SUMMARY: &'static str = "interpolate the nearest layer smoothly, average the layers \
                                   behind it; reflection, refraction, dispersion [ZP06, Algorithm \
                                   3]";
    const STAGES: &'static [Stage] = planes::STAGES;
    const BLENDS: bool = true;
    const GROUPING: Option<Grouping> = Some(transparent::GROUPING);
    const BACK_TO_FRONT: bool = true;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(72);
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

    fn draw(&self, job: &Job<'_>, (): &mut (), pool: &mut Pool) -> Result<Picture<f32>> {
        fast::draw(job, self, pool)
    }

    fn stage<R: Exact>(
        &self,
        job: &Job<'_>,
        stage: &str,
        given: &InputPlanes<'_, R>,
    ) -> Result<Vec<NamedPlane<R>>> {
        picture::stage(job, self, stage, given)
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display> {
        explain::explain::<R>(job, self, pixel)
    }

    fn settings_in_scene(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        self.layers.settings_in_scene(scene, camera)
    }
}
