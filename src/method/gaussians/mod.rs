//! Draw 3D Gaussian splats as the programs that train and show them do.
//!
//! The scene has [`Gaussians`](crate::scene::Gaussians). Or it has surfels, which are Gaussians
//! without extent along their normals (2D Gaussian splats), each with its opacity and its own
//! colour, without light, and from both sides.
//!
//! Programs share the formulas and differ in details. Each detail is a setting, and
//! [`Settings::KHR`], [`Settings::INRIA`], [`Settings::GSPLAT`], [`Settings::MIP`],
//! [`Settings::EXACT`] and [`Settings::DISCS`] are presets of all of them.
//!
//! With [`DiscRule::Ray`] or [`DiscRule::RayBox`] the splats are discs instead: surfels, and Gaussians
//! without their third axis. The rays of the pixels meet their planes, see
//! [`mod@crate::splat::ray_disc`].
//!
//! # Stages
//!
//! 1. **Projection**, see [`mod@crate::splat::gaussian`]. A splat then has a colour, an alpha and
//!    bounds:
//!    - Colour: [`crate::shade::harmonics`] up to [`Settings::degree`] in the unit direction from
//!      the camera's centre to the splat's, in the world. The camera's centre is
//!      [`Camera::eye`](crate::scene::Camera::eye), rounded to `f32` once. Under an orthographic
//!      camera the direction is that of the rays, -r2 of the view matrix, which is not divided by
//!      its length again. The colour is bounded ([`ColorBounds`]), then put into the space of
//!      blending ([`BlendSpace`]). A surfel without a colour has
//!      [`Phong::color`](crate::scene::Phong::color).
//!    - o = opacity times compensation. That of a disc is its opacity.
//!    - Bounds of an ellipse, in f64 from the numbers of this arithmetic: the pixels whose centres are within e of
//!      the centre, with e as [`Support`] says; under `ellipse` e = k sqrt(Vxx) (1 + 2^-10) + 1 px, and
//!      so for y. If [`Settings::least_alpha`] is above 0, also within e = sqrt(2 ln(o / least) Vxx)
//!      (1 + 2^-10) + 1, beyond which alpha is less; there are none if o is less than it. The 1 and
//!      the factor exceed what rounding moves the rim of a splat that is not extremely thin.
//!      `Decided:` a pixel out of bounds has no fragment, even where its rounded q says otherwise.
//!    - Bounds of a disc, in f64 from the numbers of this arithmetic, with r rounded to f32. `Around`
//!      r standard deviations are the pixels whose centres are within sqrt(E) (1 + 2^-10) + 1 px of M,
//!      E and M of the box of r; those within r sqrt(h) (1 + 2^-10) + 1 px of F; and the rectangle
//!      about both. It is the picture if the box does not exist. Under `ellipse` the bounds are those
//!      around k. If the least alpha is above 0, also those around sqrt(2 ln(o / least)). Under
//!      `tiles`, E and M are of the box of k, and e = ceil(max(sqrt(max(0.0001, Ex)), sqrt(max(0.0001,
//!      Ey)), k sqrt(h))) about M in the tiles that [`Support::Tiles`] says; under `boxes`, E and M are
//!      of the box of 1, and e = ceil(k sqrt(max(0.0001, E))) for x and for y. They are the picture
//!      if a number of the box is not finite.
//! 2. **Order** ([`Order`]): ascending, ties to the lower index. The depth of a fragment is t of the
//!    centre of its splat, whatever the order; only under `pixel` it is the depth along the ray. A disc
//!    has the depth of its fragment at each pixel, under every order.
//! 3. **Blending**, at each pixel from front to back with T = 1 at first. Of each splat whose bounds
//!    hold the pixel:
//!    - q/2, see [`power`](crate::splat::gaussian::ProjectedGaussian::power); of a disc, 1/2 rho. A
//!      fragment with q/2 < 0 is skipped, and one of a disc that the ray does not meet. Under `ellipse` one is skipped unless q/2 <= (k k) / 2.
//!    - alpha = the lesser of o e^(-q/2) and [`Settings::most_alpha`]. A fragment is skipped unless
//!      alpha >= [`Settings::least_alpha`].
//!    - With a surface, a fragment is skipped where its depth > Z, the surface's depth at the pixel. So
//!      a fragment at Z itself is drawn. `Decided:` the depth that is compared is the one of the planes:
//!      t of the centre, whatever the order; under `pixel`, and of a disc, the depth at the pixel.
//!      Buffers of few digits compare both depths as the depth buffer holds them. What is skipped counts
//!      nowhere: not for the count, the ids, T, the early stop or the depths.
//!    - T' = T (1 - alpha). If T' < [`Settings::stop`] (or T' = it, with [`Settings::stop_at`]), the
//!      pixel is done, without this fragment. A stop of 0 never ends a pixel, not even where T' is 0.
//!    - Else [`crate::composite::under`]: C += (T alpha) c, A += T alpha, T = T'. The other planes
//!      follow, see [`planes`](mod@crate::method::planes). A fragment with alpha = 0 that is not
//!      skipped counts as drawn. Where all weights are 0, the expected depth is +inf.
//! 4. **Display.** An environment is seen behind the layers: its light, in the space of blending,
//!    times T is added to C, and the opacity becomes 1. Without one the opacity is 1 - T. If colours
//!    were blended in sRGB, C is decoded: the plane of the picture holds linear light over black.
//!    Where Z is finite, the surface's colour stands in the place of the environment's light. `Decided:`
//!    if C is 0 and T is 1 there, the picture has the surface's colour itself, which encoding and
//!    decoding would round. A pixel where Z is +inf is as without a surface.
//!    A PNG is divided by the opacity, so that only where that is 1 it shows the values that were
//!    blended.
//!
//! # A surface
//!
//! A [`Surface`](crate::scene::Surface) is opaque geometry that another pass drew from the same camera: a
//! depth Z, linear, and a colour, linear light, at each pixel. Both are `f32` whatever the arithmetic.
//! `Decided:` the planes of blending are those of the splats alone. The surface adds nothing to the
//! expected and the median depth, because its own depth is at hand, and T says how much of it is seen.
//!
//! A scene stores its colours as [`Encoding`](crate::scene::gaussians::Encoding) says; surfels store
//! linear light.
//!
//! # What the method gets wrong
//!
//! - One order for the picture is not the order of a pixel: splats pop when the camera turns.
//! - An ellipse is a linearized projection: splats beside the camera are too long, which [`Clamp`]
//!   hides.
//! - Overlapping Gaussians are blended as if one were in front of the other.
//!
//! [`Clamp`]: crate::splat::gaussian::Clamp
//! [`DiscRule::Ray`]: crate::splat::ray_disc::DiscRule::Ray
//! [`DiscRule::RayBox`]: crate::splat::ray_disc::DiscRule::RayBox
//!
//! What a right implementation may leave of each stage: [`crate::verdict::gaussians`].

pub(crate) mod blending;
pub(crate) mod bounds;
pub mod explain;
mod fast;
mod order;
pub(crate) mod picture;
pub(crate) mod planes;
pub mod record;
mod settings;
pub(crate) mod splats;

pub use settings::{BlendSpace, ColorBounds, Order, Settings, Support};

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "gaussians";
    const SUMMARY: &'static str =
        "blend 3D Gaussian splats, or surfels as 2D ones, from front to back";
    const STAGES: &'static [Stage] = planes::STAGES;
    const DRAWS_GAUSSIANS: bool = true;
    const BLENDS: bool = true;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(160);
    type Memory = ();

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        Ok(picture::define(job, self, stages))
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

    fn weights(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let replay = explain::explain::<f64>(job, self, pixel)?;
        Ok(replay.fragments.iter().filter_map(|f| Some((f.index, f.weight?))).collect())
    }
}
