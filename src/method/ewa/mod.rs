//! EWA surface splatting in two geometry passes and a normalization.
//!
//! The passes of \[GBP04, section 3\] (after \[GP03\]) and of the 2+1-pass method of \[ZP06,
//! section 3.1\]:
//!
//! 1. **Projection.** Each surfel becomes a [`Splat`] (see [`mod@crate::splat::project`]).
//! 2. **Visibility splatting.** Each pixel keeps the greatest nearness of all fragments that are
//!    inside (q <= k^2), and the surfel it came from. Ties: the lower surfel index.
//! 3. **Attribute splatting.** Each fragment that is inside and whose depth passes the epsilon-z
//!    test `t <= t_nearest + epsilon` adds its weight, weight times normal and weight times colour,
//!    in ascending surfel index. A surfel seen from behind adds its normal reversed, so that
//!    surfels without a consistent orientation do not cancel (`Decided:`).
//! 4. **Normalization.** Depth from nearness; colour = sum / weight; normal = direction of sum /
//!    weight. A pixel without weight is empty.
//! 5. **Deferred shading**, see [`crate::shade`].
//!
//! # The margin
//!
//! The plane `margin` says how far the closest decision at a pixel was from flipping. The unit is a
//! step between neighbouring numbers of the arithmetic, `ulps(a, b)` of
//! [`ulps_to`](crate::number::Exact::ulps_to). Each distance is rounded to `f32`.
//!
//! A fragment is asked if its splat is drawn ([`Fate::Visible`](crate::splat::Fate)) and if the
//! [bounds](mod@crate::splat::bounds) of the splat hold the pixel. With q, the clamped nearness w and
//! t = 1/w (or -w) of the fragment, and with `w_1`, `t_1` and `id` of the nearest fragment of the
//! pixel (of an empty pixel: those of t = +inf), a fragment that is asked gives
//!
//! ```text
//!   ulps(q, k k)                   if t <= t_1 + epsilon: a hidden fragment changes nothing
//!   ulps(t, t_1 + epsilon)         if q <= k k
//!   ulps(w, w_1)                   if q <= k k, and the surfel is not id
//! ```
//!
//! The margin is the least of all that is given, and +inf where nothing is: where no fragment was
//! asked, or where all fragments that were asked are both outside and hidden. An empty pixel has a
//! margin where bounds hold the pixel.
//!
//! Bounds cut work away before the decision, and the margin knows nothing of what they cut. So the
//! margin is a function of the bounds too, which are defined to the bit. A fragment beyond its bounds
//! has q > k k, and would have given `ulps(q, k k)`. The bounds reach at least 1/128 px beyond the
//! extent. So such a fragment of an ellipse that extends e px from its centre, along x or y, has q >=
//! k k (1 + 1/(128 e))^2 in exact arithmetic: in `f32` it is at least about 2^17 / e steps away.
//! Likewise the margin knows nothing of the decisions about whole splats: facing, the near plane,
//! the sides of the view.
//!
//! A distance in steps is no distance in rounding errors. The operands carry the errors of all
//! operations before, of hundreds of steps where a splat is thin or grazing. A small margin warns; a
//! large margin promises nothing.
//!
//! The definition is over any [`Exact`] number, one fragment at a time; `fast` gives the same bits
//! for `f32`. [`explain`] lists every decision at one pixel. What each stage leaves:
//! [`mod@super::planes`].
//!
//! [`Splat`]: crate::splat::Splat
//! [`Exact`]: crate::number::Exact

pub(super) mod attributes;
pub mod explain;
mod fast;
mod margin;
pub(super) mod normalization;
mod picture;
mod planes;
pub(super) mod visibility;

pub use crate::splat::SplatSettings as Settings;

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::given::Given;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "ewa";
    const SUMMARY: &'static str = "EWA surface splatting in 2+1 passes [ZPvBG01, GP03]";
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
        given: &Given<'_, R>,
    ) -> Result<Vec<NamedPlane<R>>> {
        picture::stage(job, self, stage, given)
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display> {
        explain::explain::<R>(job, self, pixel)
    }
}
