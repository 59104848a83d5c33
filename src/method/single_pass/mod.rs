//! Render points in a single geometry pass: deferred blending over groups \[ZP06, Algorithm 1\].
//!
//! The method runs the passes of \[ZP06, Fig. 7\]. It needs surfels whose [`Groups`] are known. It
//! draws each surfel in its own group and at its own radius, because what an extension added or
//! enlarged is for transparency alone:
//!
//! 1. **Projection.** Each surfel becomes a [`Splat`], as in [`super::ewa`].
//! 2. **Geometry pass.** Each group k has a depth-image `I_k`. Take each fragment of the group's
//!    surfels that is inside (q <= k^2), in ascending surfel index. If it passes the depth test
//!    ([`DepthTest`]), it replaces the fragment that the pixel of `I_k` holds. The fragment kept
//!    leaves its depth, its weight, and its weight times normal and times colour (eq. 4), each
//!    added to 0, so that -0 becomes 0. A surfel seen from behind gives its normal reversed.
//! 3. **Compositing pass.** Apply the operator of Fig. 5 over all `I_k`, see
//!    [`crate::composite::groups`], with the sums in the order of the groups. Then compute depth,
//!    average colour and direction of the normal as in [`super::ewa`]. The id of a pixel is the
//!    surfel of the greatest nearness of all `I_k`, ties to the lower surfel.
//! 4. **Deferred shading**, see [`crate::shade`].
//!
//! The depth test of the geometry pass:
//!
//! - [`DepthTest::Plain`]: the greater nearness wins, ties to the lower surfel.
//! - [`DepthTest::Voronoi`]: the smaller Voronoi-enhanced depth wins (eq. 10, see
//!   [`crate::composite::bins`]), ties to the lower surfel, with `ratio = sqrt(q / (k k))`. With
//!   the paper's kernel, a disc by ray casting without low-pass filter, this ratio is `|f_i - p_i|
//!   / r_i`. `Decided:` the ratio has the same formula with any other footprint. There q is the
//!   squared distance from the footprint's own centre in its own standard deviations.
//!
//! `Decided:` `d_min` and `d_max` are the depths of [`depth_range`], because a backend knows them
//! before it has drawn anything. The depth of a fragment is clamped into the bins, because an
//! enlarged splat can leave them.
//!
//! # When the picture equals the 2+1-pass method
//!
//! The sums of both methods are over the same fragments at every pixel where no two fragments of
//! one group are within epsilon of the nearest fragment of all, if the depth test is the plain one.
//! There the pictures differ by the order of the sums alone. Groups that do not overlap (c = 1,
//! nothing relaxed) still have pixels where two fragments of one group are within epsilon:
//!
//! - discs that do not overlap in space, but do on the screen within epsilon of depth: at steep
//!   angles, at the silhouette, and where two sheets are closer than epsilon;
//! - footprints that are larger than their disc: the skirt of a low-pass filter, and the affine
//!   outline of a disc under perspective.
//!
//! There the group keeps only the nearer fragment.
//!
//! The definition is over any [`Exact`] number; `fast` gives the same bits for `f32`. [`explain`]
//! lists every decision at one pixel. What each stage leaves: [`mod@super::planes`].
//!
//! [`Splat`]: crate::splat::Splat
//! [`Exact`]: crate::number::Exact
//! [`Groups`]: crate::scene::Groups
//!
//! What a right implementation may leave of each stage: [`crate::verdict::single_pass`].

pub(super) mod compositing;
pub mod explain;
pub(super) mod fast;
pub(crate) mod geometry;
pub(super) mod picture;
pub(crate) mod planes;
mod settings;

pub use settings::{BinCount, DepthTest, Settings, depth_range};

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::splat::SplatSettings;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "single-pass";
    const SUMMARY: &'static str = "draw groups into depth-images in one geometry pass, composite \
                                   within epsilon [ZP06, Algorithm 1]";
    const STAGES: &'static [Stage] = planes::STAGES;
    /// c = 0.4, which \[ZP06, section 6.1\] finds acceptable; opposite normals relaxed.
    const GROUPING: Option<Grouping> = Some(Grouping {
        rules: Rules { overlap: 0.4, opposite: true, coplanar: None },
        count: None,
        extension: Extension::None,
    });
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(64);
    type Memory = ();

    fn splats(&self) -> Option<&SplatSettings> {
        Some(&self.splats)
    }

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(&self, job: &Job<'_>, (): &mut (), pool: &mut Pool) -> Result<Picture<f32>> {
        picture::draw(job, self, pool)
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
        let mut resolved = self.splats.settings_in_scene(scene);
        if let DepthTest::Voronoi(bins) = &self.depth {
            resolved.extend(bins.settings_in_scene(&self.splats, scene, camera));
        }
        resolved
    }
}
