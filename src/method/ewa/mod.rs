//! Draw smooth surfaces: EWA surface splatting in two geometry passes and a normalization.
//!
//! The passes are those of \[GBP04, section 3\] (after \[GP03\]) and of the 2+1-pass method of
//! \[ZP06, section 3.1\]:
//!
//! 1. **Projection.** Each surfel becomes a [`Splat`] (see [`mod@crate::splat::project`]).
//! 2. **Visibility splatting.** Each pixel keeps the greatest nearness of all fragments that are
//!    inside (q <= k^2), and the surfel it came from. Ties: the lower surfel index.
//! 3. **Attribute splatting.** Each fragment that is inside and whose depth passes the epsilon-z
//!    test `t <= t_nearest + epsilon` adds its weight, weight times normal and weight times colour,
//!    in ascending surfel index. `Decided:` a surfel seen from behind adds its normal reversed, so
//!    that surfels without a consistent orientation do not cancel.
//! 4. **Normalization.** Depth from nearness; colour = sum / weight; normal = direction of sum /
//!    weight. A pixel without weight is empty.
//! 5. **Deferred shading**, see [`crate::shade`].
//!
//! # The margin: which pixels every right renderer decides alike
//!
//! The plane `margin` says how far the closest decision at a pixel is from being undecided. Its
//! unit is the rounding error that the decision's operands may carry.
//!
//! - Beyond 1, right renderers take the same decisions at the pixel: the same nearest surfel, the
//!   same fragments in the sums. This holds for every renderer that rounds each operation once, to
//!   nearest, and may fuse a product with the sum it goes into.
//! - Up to 1, two right renderers may differ.
//!
//! The surfels are projected in [`Ball`](crate::number::ball)s of the profile
//! [`Ieee`](crate::number::ball::Ieee), whatever the number of the picture, and so are their
//! fragments. `distance(a, b)` of two balls is the distance of their midpoints divided by the sum of
//! their radii: +inf if both radii are 0, 0 if a radius is not finite.
//!
//! A surfel takes part unless there certainly is a reason not to draw it. A fragment of it takes
//! part unless it certainly is outside: its q certainly is beyond k k, or its pixel is not in the
//! [bounds](mod@crate::splat::bounds) of the splat in balls, which hold every pixel that may be
//! inside. The bounds of the picture's own splats play no part. The bounds in balls are needed
//! because the ball of q forgets that `ux dx` and `uy dy` cancel; along a thin ellipse q alone
//! would never be certain.
//!
//! `id` is the nearest surfel that the picture has at the pixel; `w_1` and `t_1` are nearness and
//! depth of its fragment, in balls. The distances, with q, w and t of a fragment that takes part:
//!
//! ```text
//!   distance(q, k k)               unless certainly t > t_1 + epsilon: a hidden fragment changes
//!                                  nothing
//!   distance(t, t_1 + epsilon)     unless the surfel is id, or the pixel is empty
//!   distance(w, w_1)               likewise
//!   0                              if it is not certain that the surfel is drawn, or (perspective
//!                                  outline, ray casting) whether it reaches the near plane
//! ```
//!
//! The margin is the least of these, rounded to `f32`; +inf where no distance applies, or all
//! operands are exact. If surfels are coplanar, the nearest is not certain, and the margin is
//! small; the sums may be equal all the same.
//!
//! The definition is over any [`Exact`] number, one fragment at a time; `fast` gives the same bits
//! for `f32`. [`explain`] lists every decision at one pixel. What each stage leaves:
//! [`mod@super::planes`].
//!
//! [`Splat`]: crate::splat::Splat
//! [`Exact`]: crate::number::Exact
//!
//! What a right implementation may leave of each stage: [`crate::verdict::ewa`].

pub(crate) mod attributes;
pub mod explain;
mod fast;
mod margin;
pub(super) mod normalization;
mod picture;
pub(crate) mod planes;
pub(crate) mod possible;
pub(crate) mod visibility;

pub use crate::splat::SplatSettings as Settings;

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::decisions::Touch;
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "ewa";
    const SUMMARY: &'static str = "splat surfaces by EWA in 2+1 passes [ZPvBG01, GP03]";
    const STAGES: &'static [Stage] = planes::STAGES;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(64);
    type Memory = ();

    fn splats(&self) -> Option<&Settings> {
        Some(self)
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

    fn weights(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let replay = explain::explain::<f64>(job, self, pixel)?;
        let given = |touch: &Touch<f64>| Some((touch.surfel, touch.gives?.1));
        Ok(replay.visible.iter().filter_map(given).collect())
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display> {
        explain::explain::<R>(job, self, pixel)
    }
}
