//! Draw transparent surfels: blend them from back to front within groups, and average the groups
//! \[ZP06, Algorithm 2\].
//!
//! Each surfel has its own opacity alpha; in a scene without opacities it is 1. Opaque and
//! transparent surfels mix freely. Back faces are layers too, because [`Settings::default`] does
//! not cull.
//!
//! # Algorithm 2
//!
//! 1. **Order.** Sort the surfels from back to front, see [`crate::index::order`]. A surfel is
//!    drawn once in each of its groups, its radius (or tangents) times the scale of the group, see
//!    [`Groups`]. The order of a surfel's groups does not matter.
//! 2. **Shading.** `Decided:` each surfel is shaded once, by [`crate::shade::phong`] at its centre
//!    with the normal of the side that is seen, because blended fragments cannot be shaded later.
//! 3. **Geometry pass.** Take each fragment that is inside (q <= k^2). The kernel's weight plays no
//!    part (section 3.3). The fragment has a bin of low-precision depth (eq. 6,
//!    [`crate::composite::bins`]; the bins of the group, see below). It passes if `bin < bin of the
//!    pixel`; the bin of the pixel is +inf at first. A fragment that passes changes the pixel:
//!    - The pixel takes the fragment's bin.
//!    - The pixel blends ([`crate::composite::over`]) the fragment's shaded colour by alpha.
//!    - Alpha is added to the pixel's sum of opacities (section 5.2.3). `Departs:` an opaque
//!      fragment sets that sum to 0 and marks the pixel as hiding the fragments behind, because eq.
//!      11 assumes one opacity everywhere.
//!    - One is added to the pixel's count of layers. A count of 255 stays 255.
//!    - The pixel takes the depth t and the surfel of the fragment. So the depth and the surfel of
//!      the group belong to the fragment that passed last.
//! 4. **Compositing pass.** Average the images, see [`Holes`]: colour, opacity, sum of opacities,
//!    hidden part, count of layers. Each is a sum in the order of the groups, divided once by the
//!    count of the groups that [`Holes`] takes. The sums begin at 0. The average of no group is 0.
//!
//! **Bins of a group.** `Decided:` each group has its own bins. Eq. 6 with an n has one set of
//! bins, but \[ZP06\] does not say that all images have to share it. By default the bins of group k
//! of K are [moved](crate::composite::bins) towards the eye by k/K of a bin; the bins of group 0 do
//! not move. k/K is a quotient of the whole numbers in `f32`, the same for every number type.
//!
//! Where fragments of a layer fall on either side of an edge, a group shows an arc. Moved bins put
//! the arcs of each group in a different place, so that the average shows each arc with 1/K of its
//! strength. So it matters which group has which number, and with one bin a group may have two.
//! [`BinEdges::Common`] moves no bins. (`docs/zp06.md` has the error of both.)
//!
//! # The nearest surfel
//!
//! The planes `Z` and `id` of the picture come from one group: the group of the least depth. Depths
//! decide, not nearnesses. The depth is t = 1/w (or -w under an orthographic camera), rounded to
//! the number type, so that two groups of different nearness can tie. If depths are equal, the
//! lower surfel index wins ([`crate::composite::decide::before_or_lower`]). A group without a
//! fragment has the depth +inf and the surfel `0xFFFF_FFFF`.
//!
//! `Decided:` within a group the depth test compares bins. A fragment that is nearer than the layer
//! before, but in the same bin, is dropped, and leaves no depth. So `Z` can be deeper than the
//! nearest fragment that is inside.
//!
//! An environment is behind everything: colour + (1 - A) env(ray of the pixel), and A becomes 1.
//! Without an environment, colours are over black, that is, multiplied by A.
//!
//! # What the method gets wrong
//!
//! - Two fragments of one layer and one group that fall on either side of a bin's edge are blended
//!   as two layers. The picture shows darker arcs: more of them with more bins, and fainter ones
//!   with staggered edges.
//! - Two layers in one bin are one layer: you see the layer that is drawn first, the farther one.
//! - A group that does not cover a layer leaves holes in it. See [`crate::index::grouping`] for the
//!   extensions that close them, and [`Holes`].
//! - Overlapping surfels are ordered by their centres, see [`crate::index::order`].
//!
//! [`super::peeling`] is the truth that the method is compared with.
//!
//! The definition is over any [`Exact`] number; `fast` gives the same bits for `f32`.
//!
//! [`Groups`]: crate::scene::Groups
//!
//! What a right implementation may leave of each stage: [`crate::verdict::transparent`].

pub(crate) mod averaging;
pub(crate) mod blending;
pub mod explain;
pub(super) mod fast;
pub(super) mod picture;
pub(crate) mod planes;
mod settings;

pub use settings::{BinEdges, Holes, Settings};

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

/// K = 4, which \[ZP06, section 6.2\] finds sufficient; groups are extended by adding surfels.
pub(crate) const GROUPING: Grouping = Grouping {
    rules: Rules { overlap: 1.0, opposite: true, coplanar: None },
    count: Some(4),
    extension: Extension::Add { most: 0.5 },
};

impl Algorithm for Settings {
    const NAME: &'static str = "transparent";
    const SUMMARY: &'static str = "blend layers within groups, average the groups [ZP06, Algorithm \
                                   2]";
    const STAGES: &'static [Stage] = planes::STAGES;
    const BLENDS: bool = true;
    const GROUPING: Option<Grouping> = Some(GROUPING);
    const BACK_TO_FRONT: bool = true;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(48);
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
        let mut resolved = self.splats.settings_in_scene(scene);
        resolved.extend(self.bins.settings_in_scene(&self.splats, scene, camera));
        resolved
    }
}
