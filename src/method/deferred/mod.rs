//! Deferred splatting: the expensive passes on visible surfels only \[GBP04\].
//!
//! Surfels are those that the high level leaves: of objects with [levels of
//! detail](crate::scene::objects::detail) the nodes that this view draws, else all \[GBP04, 7.2\]. A
//! [`Session`](super::Session) does not choose them: the scene of a frame has them from
//! [`Objects::seen_from`](crate::scene::Objects::seen_from), of the same camera, and otherwise the surfels
//! that its geometries were made of.
//!
//! The passes of frame i \[GBP04, 4.1\], in which B(i) is the list of surfels that are selected. All of
//! them run over surfels in ascending [id](crate::scene::objects::ids); the surfels of a scene without
//! objects are one object, and their ids are their indices.
//!
//! 1. **Visibility splatting of B(i-1)**: the pass of [`super::ewa`] over every surfel whose flag is
//!    set, with the places and the camera of this frame. A flag stands for m consecutive surfels of one
//!    object \[GBP04, 4.3\], see [`crate::index::seen`]; of its surfels those are drawn that the high level
//!    leaves in this frame. In the first frame no flag is set, and the pass draws nothing.
//! 2. **Indices**: every surfel becomes one pixel, that of its centre, as in [`super::projection`]: with
//!    the same fates, pixel and depth t. It is drawn if `t <= Z + epsilon`, with Z the depth that pass
//!    1 left at the pixel, +inf if none; of those that are drawn into a pixel the one of the least t is
//!    kept, ties: the lower id. B(i) are the surfels that are kept in some pixel.
//! 3. **Visibility splatting of B(i) - B(i-1)**: the pass over those surfels of B(i) whose flag is not
//!    set, into the depth that pass 1 left; of equally near fragments of both passes the lower id wins.
//!    The setting `second` turns the pass off \[GBP04, Fig. 3 a\].
//! 4. **EWA splatting of B(i)**: attribute splatting of [`super::ewa`] over B(i), against the depth that
//!    pass 3 left; in prefiltered colours where surfels have some, see [`filter`].
//! 5. **Normalization**, as in [`super::ewa`]; then deferred shading.
//!
//! The stage `difference` run alone turns depths into nearness again: under a perspective camera its depths
//! may be one rounding off those of the whole picture.
//!
//! Objects of which the last frame saw little may be left out of all passes, see [`Settings::share`].
//! `Decided:` an object of which it selected nothing is not: \[GBP04, 7\] leaves out what has no higher share
//! than the threshold, and what is left out once would never be seen again. So an object of a small share is
//! there every other frame. The comparison is `selected > 0 and selected <= share n`, in f64, with n the
//! number of the object's surfels that the high level leaves now. What is left out keeps its ids, its part in
//! epsilon and its polygons; its flags are not set after the frame.
//!
//! Triangles beside the surfels are drawn before pass 1, see [`polygons`].
//!
//! The flags of B(i), and how many surfels of each object B(i) has, are what frame i + 1 is given; no flags,
//! and none set, give the same frame. A frame is a function of these, scene, camera and settings alone.
//!
//! # Decided
//!
//! - Pass 2 tests depth with the epsilon of pass 4: a surfel is selected if its centre belongs to the
//!   visible surface by the test that its fragments have to pass. \[GBP04\] does not say how the depth
//!   test of pass 2 is biased. Without a bias, epsilon = 0, nearly every centre lies behind a splat of a
//!   neighbour, and surfaces come and go; with too large a one the sheet behind is selected through
//!   the gaps between the centres, and takes pixels from the sheet in front.
//! - With culling on, a surfel that is seen from behind takes no pixel: no pass would draw it. One that
//!   `ewa` calls `Degenerate`, such as one seen exactly edge-on, may be selected: it takes its pixel,
//!   and no pass draws it.
//! - The limit of passes 2 and 4, Z + epsilon, is one sum in the arithmetic of the picture. Epsilon in
//!   median radii is that of [`crate::scene::Objects::median_radius`] in the frame, one product in `f32`.
//! - A disc whose centre is outside the picture is lost even where it reaches into the picture, as in
//!   every method that draws a surfel as one pixel.
//! - Pass 1 draws all surfels of a flagged group. \[GBP04, 4.2\] also reads as if the list of B(i-1)
//!   itself were drawn; then a surfel of B(i) - B(i-1) in a flagged group would be drawn by neither pass.
//! - The id of a pixel is that of the nearest fragment of passes 1 and 3, and may be of a surfel that is
//!   flagged and not in B(i): colour, normal and weight are of B(i), depth and id need not be. A pixel
//!   without weight is empty, whatever depth passes 1 and 3 left. Where
//!   these left no depth, as may be without pass 3, all fragments of B(i) are added up, and the pixel shows
//!   depth and id of the nearest of them. Where they did leave one, fragments of B(i) in front of that
//!   depth are in the sums, and the pixel shows the depth of pass 1; but where that is a polygon's and a
//!   fragment of B(i) is nearer, depth and id of that fragment.
//! - Opacity plays no part, as in [`super::ewa`].
//!
//! # What the papers' readers should expect
//!
//! The tally of a picture counts the surfels of B(i) alone.
//!
//! One surfel a pixel is selected. Where a pixel holds many centres the others are lost, and with
//! them their colours: pictures of dense surfels flicker as these change places \[GBP04, 4.4\].
//! Surfels that bring prefiltered colours are drawn in those that fit the picture's pixels: see
//! [`mod@filter`].
//!
//! The definition is over any [`Exact`] number. What each stage leaves: [`mod@super::planes`].
//!
//! [`Exact`]: crate::number::Exact
//!
//! What a right implementation may leave of each stage: [`crate::verdict::deferred`].

pub mod explain;
mod fast;
pub mod filter;
pub(crate) mod indices;
pub(crate) mod part;
pub(crate) mod picture;
pub(crate) mod planes;
pub mod polygons;
pub mod queries;
mod settings;
#[cfg(test)]
mod tests;
pub(crate) mod visibility;

pub use settings::Settings;

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use crate::scene::objects::Ids;
use crate::scene::{Camera, Scene};
use crate::splat::SplatSettings;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "deferred";
    const SUMMARY: &'static str = "splat by EWA only the surfels that the last frame and an index \
                                   buffer select [GBP04]";
    const STAGES: &'static [Stage] = planes::STAGES;
    const DRAWS_OBJECTS: bool = true;
    const DRAWS_POLYGONS: bool = true;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(256);
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

    fn settings_in_scene(&self, scene: &Scene, _: &Camera) -> Vec<(&'static str, String)> {
        let median = part::Whole::new(scene).median_radius();
        vec![("epsilon_in_world_units", format!("{:?}", self.splats.epsilon.in_units(median)))]
    }
}

/// The ids of the surfels of a scene.
#[must_use]
pub fn ids(scene: &Scene) -> Ids {
    part::Whole::new(scene).ids().clone()
}
