//! Draw fewer surfels: run the expensive passes on visible surfels only \[GBP04\].
//!
//! The method draws the surfels that the high level leaves. For objects with [levels of
//! detail](crate::scene::objects::detail) these are the nodes that this view draws, else all
//! surfels \[GBP04, 7.2\]. A [`Session`](super::Session) does not choose them. The scene of a frame
//! has them from [`Objects::seen_from`](crate::scene::Objects::seen_from), for the same camera.
//! Without that call it has the surfels that its geometries were made of.
//!
//! These are the passes of frame i \[GBP04, 4.1\]; B(i) is the list of surfels that are selected.
//! All passes run over surfels in ascending [id](crate::scene::objects::ids). The surfels of a
//! scene without objects are one object, and their ids are their indices.
//!
//! 1. **Visibility splatting of B(i-1)**: run the pass of [`super::ewa`] over every surfel whose
//!    flag is set, with the places and the camera of this frame. A flag stands for m consecutive
//!    surfels of one object \[GBP04, 4.3\], see [`crate::index::seen`]; the pass draws the surfels
//!    of a flag that the high level leaves in this frame. In the first frame no flag is set, and
//!    the pass draws nothing.
//! 2. **Indices**: every surfel becomes one pixel, the pixel of its centre, with the same fates,
//!    pixel and depth t as in [`super::projection`]. It is drawn if `t <= Z + epsilon`, with Z the
//!    depth that pass 1 left at the pixel, +inf if none. A pixel keeps the drawn surfel of the
//!    least t, ties: the lower id. B(i) are the surfels that are kept in some pixel.
//! 3. **Visibility splatting of B(i) - B(i-1)**: run the pass over the surfels of B(i) whose flag
//!    is not set, into the depth that pass 1 left. If fragments of both passes are equally near,
//!    the lower id wins. The setting `second` turns the pass off \[GBP04, Fig. 3 a\].
//! 4. **EWA splatting of B(i)**: run attribute splatting of [`super::ewa`] over B(i), against the
//!    depth that pass 3 left. Surfels with prefiltered colours are drawn in these, see [`filter`].
//! 5. **Normalization**, as in [`super::ewa`]; then deferred shading.
//!
//! The stage `difference` run alone turns depths into nearness again. So under a perspective camera
//! its depths may be one rounding off the depths of the whole picture.
//!
//! Pass 1 may leave out objects that were little seen in the last frame, see [`Settings::share`].
//! The comparison is `selected > 0 and selected <= share n`, in f64, with n the number of the
//! object's surfels that the high level leaves now. Pass 3 then draws every surfel of B(i) of such
//! an object. The object keeps its ids, its part in epsilon and its polygons, and its flags are set
//! after the frame. `Departs:` \[GBP04, 7\] leaves out such objects of all passes. An object that no
//! pass draws has no selected surfel, so it would never be seen again, or every other frame. With
//! passes 2 to 4 it stays, and only the cost of pass 1 is saved.
//!
//! B(i) and the flags name surfels by their numbers alone. So objects and the points of a geometry may
//! move from frame to frame \[GBP04, 4.3\]; scene files [do both](crate::io::scene_file#points-that-move).
//!
//! Triangles beside the surfels are drawn before pass 1, see [`polygons`].
//!
//! Frame i + 1 receives the flags of B(i), and how many surfels of each object B(i) has. No flags,
//! and flags of which none is set, give the same frame. A frame is a function of these, scene,
//! camera and settings alone.
//!
//! # Decided
//!
//! - Pass 2 tests depth with the epsilon of pass 4: a surfel is selected if its centre belongs to
//!   the visible surface by the test that its fragments have to pass. \[GBP04\] does not say how
//!   the depth test of pass 2 is biased. Without a bias, epsilon = 0, nearly every centre lies
//!   behind a splat of a neighbour, and surfaces come and go. With too large a bias, the sheet
//!   behind is selected through the gaps between the centres, and takes pixels from the sheet in
//!   front.
//! - With culling on, a surfel that is seen from behind takes no pixel, because no pass would draw
//!   it. A surfel that `ewa` calls `Degenerate`, such as one seen exactly edge-on, may be selected:
//!   it takes its pixel, and no pass draws it.
//! - The limit of passes 2 and 4, Z + epsilon, is one sum in the arithmetic of the picture. Epsilon
//!   in median radii uses [`crate::scene::Objects::median_radius`] in the frame, one product in
//!   `f32`.
//! - A disc whose centre is outside the picture is lost even where it reaches into the picture, as
//!   in every method that draws a surfel as one pixel.
//! - Pass 1 draws all surfels of a flagged group; by default a group is one surfel. \[GBP04, 4.2\] also reads as if the list of
//!   B(i-1) itself were drawn; then a surfel of B(i) - B(i-1) in a flagged group would be drawn by
//!   neither pass.
//! - The id of a pixel comes from the nearest fragment of passes 1 and 3. Its surfel may be flagged
//!   and not in B(i): colour, normal and weight come from B(i), depth and id need not.
//!   - A pixel without weight is empty, whatever depth passes 1 and 3 left.
//!   - Passes 1 and 3 may leave no depth if pass 3 is off. Then all fragments of B(i) are added up,
//!     and the pixel shows depth and id of the nearest of them.
//!   - If they left a depth, fragments of B(i) in front of that depth are in the sums, and the
//!     pixel shows the depth of pass 1. But if that depth is a polygon's and a fragment of B(i) is
//!     nearer, the pixel shows depth and id of that fragment.
//! - Opacity plays no part, as in [`super::ewa`].
//!
//! # What readers of the papers should expect
//!
//! The tally of a picture counts the surfels of B(i) alone.
//!
//! One surfel a pixel is selected. If a pixel holds many centres, the others are lost, and with
//! them their colours. So pictures of dense surfels flicker as the selected surfels change places
//! \[GBP04, 4.4\]. Give surfels prefiltered colours against this; they are drawn in the colours
//! that fit the picture's pixels: see [`mod@filter`].
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
    const NEEDS_WHOLE_PICTURE: Option<&'static str> =
        Some("the pixels of the whole picture select the surfels that it draws");
    /// The centres of each share of pass 2.
    type Memory = Vec<fast::Centres>;

    fn splats(&self) -> Option<&SplatSettings> {
        Some(&self.splats)
    }

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut Vec<fast::Centres>,
        pool: &mut Pool,
    ) -> Result<Picture<f32>> {
        picture::draw(job, self, memory, pool)
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
