//! Draw the truth of transparency by depth peeling \[ZP06, sections 2 and 6.2, Fig. 12\].
//!
//! The method follows \[Mam89\] (Mammen: *Transparency and Antialiasing Algorithms Implemented with
//! the Virtual Pixel Maps Technique*, IEEE CG&A 9(4), 1989) and \[Eve02\] (Everitt: *Interactive
//! Order-Independent Transparency*, 2002). The opaque method of [`super::ewa`] draws each layer,
//! one layer after the other from the front:
//!
//! 1. **Projection**, as in [`super::ewa`].
//! 2. **Visibility splatting** of layer j = 1, 2, ...: take the fragments that are inside (q <=
//!    k^2) and strictly beyond the layer before, `t > limit_(j-1)`. Each pixel keeps their greatest
//!    nearness, and the surfel it came from (ties: the lower index); `t_j` is its depth. `limit_0`
//!    is -inf, so that layer 1 takes all fragments.
//! 3. **Attribute splatting**: each of the same fragments with `t <= limit_j` adds its weight, and
//!    its weight times normal, times colour and times opacity, in ascending surfel index;
//!    `limit_j = t_j + epsilon`, see [`crate::composite::decide`]. A surfel seen from behind adds
//!    its normal reversed. In a scene without opacities each opacity is 1.
//! 4. **Normalization**: colour and opacity `a_j` = sum / weight, normal = direction of sum /
//!    weight.
//! 5. **Deferred shading** ([`crate::shade::phong`]) of the layer at depth `t_j`, to its colour
//!    `C_j`.
//! 6. **Blending** under the layers before, see [`crate::composite::under`]: with T = 1 at first,
//!    `C += (T a_j) C_j` and `A += T a_j`, then `T *= 1 - a_j`. In the end A is cut at 1.
//!
//! A pixel is done when no fragment is left beyond its last layer, or after [`Settings::layers`].
//! `Decided:` not earlier: layers behind an opaque one are peeled too, so that their number does
//! not depend on the opacities. Every layer takes at least its nearest fragment, and no fragment is
//! in two layers.
//!
//! `Decided:` from front to back, where \[ZP06\] collects all layers and blends them from back to
//! front, because then no layer has to be kept. The result is the same up to rounding.
//!
//! So layer 1 is the picture of [`super::ewa`], and a scene of opaque surfels gives that picture
//! bit for bit. There is one exception: where all weights underflow to 0, and A is 0 in both, the
//! colour here is black.
//!
//! `Decided:` the average of colours is not weighted by opacity, because within a layer a surfel's
//! opacity says how dense the surface is there, not how much of its colour counts.
//!
//! # What even the truth gets wrong
//!
//! A layer consists of the fragments within epsilon of depth, and these need not belong to one
//! surface.
//!
//! - A surface steeper than its band allows is cut into several layers at one pixel and blended
//!   with itself. So it is too opaque at silhouettes.
//! - Two surfaces closer than epsilon are one layer and are averaged: too transparent.
//!
//! So epsilon must exceed the depth that a surface spans within a footprint on the screen. The
//! low-pass filter makes that depth more than a radius where surfels are smaller than a pixel. An
//! example is a torus of 10 k, 100 k and 1 M surfels whose sight lines nearly all meet two
//! surfaces, at 512 x 512. With epsilon = 1 median radius, 99 %, 91 % and 23 % of the covered
//! pixels have two layers; with 8, 92 %, 99 % and 92 %. The planes `layer#.count` and `layers` show
//! where the result is wrong.
//!
//! # What it costs
//!
//! Every layer is a 2-pass method over all splats: L layers cost 2 L passes. Each pass runs over
//! all fragments, also over those already peeled. Fragments grow with the layers, so the time grows
//! with their square. \[ZP06\] reports less than 2 frames a second for 8 layers, where its single
//! pass makes 9. The method is for comparison, not for speed. But other pictures are often compared
//! with it, so `fast` gives the same bits for `f32` sooner: a fragment is computed once, and is
//! gone when its layer is peeled.
//!
//! What a right implementation may leave of each stage: [`crate::verdict::peeling`].

mod blending;
pub mod explain;
mod fast;
pub(crate) mod layers;
mod picture;
pub(crate) mod planes;
mod settings;
#[cfg(test)]
mod tests;

pub use planes::STAGES;
pub use settings::{MAX_LAYERS, Settings};

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use crate::splat::SplatSettings;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "peeling";
    const SUMMARY: &'static str = "peel layer by layer with 2+1 passes each, as a reference for \
                                   transparency [Mam89, Eve02]";
    const STAGES: &'static [Stage] = planes::ROWS;
    const BLENDS: bool = true;
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
        Ok(fast::draw(job, self, pool))
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
}
