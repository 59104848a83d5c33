//! Draw surfels as oriented discs in squares on the screen \[BJFM19, 4.2\].
//!
//! Each surfel is a point primitive: a square with a side in pixels around its centre. In each
//! pixel of the square the ray meets the surfel's plane. If it meets the plane farther from the
//! centre than the radius, the fragment is discarded. The rest of the square is an opaque disc, an
//! ellipse on the screen. The nearest fragment of a pixel stays. Nothing is averaged and nothing is
//! filtered.
//!
//! The method does not choose which surfels are drawn, how large they are and how large their
//! squares are. [`crate::scene::objects::detail`] chooses them: the prefix of an order, and its
//! side \[BJFM19, 4.1\]. [`controller`] makes the size of discs follow the time of frames.
//!
//! # The square
//!
//! With p the centre and n the normal in view space, r the radius, t = -p.z, m = 1/t and (a, b) =
//! (p.x m, p.y m) (orthographic: m = 1 and (a, b) = (p.x, p.y)):
//!
//! ```text
//!   centre  X = cx + fx a                  Y = cy - fy b
//!   g       = (n.x a + n.y b) - n.z        orthographic: -n.z;   < 0: the front is seen
//!   half    h = s 1/2                      with the side s of crate::scene::Sides
//!           h = rho, at least 1/2          of a surfel without one: rho = r (f m), at most 2^48, with
//!                                          f = sqrt(fx fy)
//!   pixel (x, y) is in the square if       X - h <= x + 1/2 < X + h and Y - h <= y + 1/2 < Y + h
//! ```
//!
//! `Decided:` the upper ends are not part of the square, so that squares that touch share no
//! pixels. So the rim of a disc is not drawn there either, where it passes through the centre of a
//! pixel.
//!
//! `Decided:` without a side, a point primitive is as large as its disc when the disc faces the
//! camera, and at least one pixel, so that it holds one centre of a pixel. The square cuts any part
//! of the disc that reaches beyond it. A disc that faces the eye at an angle of theta off the axis
//! of a perspective camera is 1 / cos theta as long, and a tilted one is longer on its near side.
//!
//! Fates, in this order:
//!
//! 1. `Behind` unless t > near;
//! 2. `Degenerate` if X, Y, t or g is not finite;
//! 3. with culling, `BackFacing` if g >= 0;
//! 4. `Outside` if no pixel of the picture is in the square;
//! 5. else the surfel is drawn.
//!
//! `Departs:` GL drops a point whose centre is outside the view, with all of its square. Here the
//! part of the square that reaches into the picture is drawn, so that no border of large points is
//! lost. The near plane is an exception: a surfel whose centre is not beyond it is lost.
//!
//! # The disc
//!
//! For each pixel in the square:
//!
//! ```text
//!   ray          a = ((x + 1/2) - cx) / fx       b = -(((y + 1/2) - cy) / fy)
//!   perspective  t = ((n.x p.x + n.y p.y) + n.z p.z) / ((n.x a + n.y b) - n.z)
//!                d = (t a - p.x, t b - p.y, t + p.z)
//!   orthographic d.x = a - p.x     d.y = b - p.y     d.z = (n.x d.x + n.y d.y) / n.z
//!                t = d.z - p.z
//!   offset       o = (d.x d.x + d.y d.y) + d.z d.z
//!   it stays if  t > near, o <= r r, and t and o are finite
//! ```
//!
//! (d.z points away from the camera, unlike p.z: its sign does not matter.) The rim is part of the
//! disc. A plane that the ray meets edge-on has no fragment: the quotient is infinite or NaN.
//! `Decided:` an elliptical surfel counts as the disc of its radius, and opacity is ignored,
//! because the paper knows opaque discs only.
//!
//! # The pixel
//!
//! A pixel keeps the least t of the fragments that stay, ties: the lower surfel index. It has that
//! depth, the weight 1, the surfel's normal in world space, reversed if g > 0, and the surfel's
//! colour. A surfel without a colour has the material's if triangles have colours. Then comes
//! **deferred shading**, see [`crate::shade`]; for opaque discs it equals shading in the fragment
//! shader.
//!
//! **Triangles** beside the surfels are the original geometry of \[BJFM19, 4\].
//! [`mod@super::projection`] draws them, with the same culling and the corners snapped to 1/256 px,
//! into the same depth. A triangle takes a pixel if it is strictly nearer than the disc there. Its
//! id is its index, counted on after the surfels. In a scene of objects, surfels have ids of
//! [`crate::scene::objects::ids`] in a view that draws no triangle. In a view that draws at least
//! one, both are counted: the drawn surfels from 0 in the order of their ids, then the triangles in
//! the order of the scene. A triangle's normal is turned to world space and divided
//! by its length.
//!
//! # What to expect
//!
//! - A disc narrower than a pixel is seen only where it holds a pixel's centre. Surfels whose radii
//!   are not chosen for the view leave holes when you see them from afar, and a larger square does
//!   not close these holes.
//! - A pixel shows one surfel. Dense surfels flicker as the view moves.
//! - Discs of neighbours cut each other, so that borders between colours are arcs.
//!
//! The definition is over any [`Exact`] number; `fast` gives the same bits for `f32`. What each
//! stage leaves: [`mod@super::planes`].
//!
//! [`Exact`]: crate::number::Exact
//!
//! What a right implementation may leave of each stage: [`crate::verdict::blue`].

pub mod controller;
pub(crate) mod discs;
pub mod explain;
pub(crate) mod fast;
mod picture;
pub(crate) mod planes;
mod polygons;
mod settings;
pub(crate) mod squares;

pub use settings::Settings;

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::{Picture, Stage};
use crate::number::Exact;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "blue";
    const SUMMARY: &'static str = "draw oriented discs in screen squares, for progressive blue \
                                   surfels [BJFM19]";
    const STAGES: &'static [Stage] = planes::STAGES;
    const DRAWS_POLYGONS: bool = true;
    // 52 for the picture, and the samples of triangles, if there are any.
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(160);
    type Memory = ();

    fn check(&self) -> Result<()> {
        Ok(())
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

    fn weights(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let surfel = explain::explain::<f64>(job, self, pixel)?.surfel();
        Ok(surfel.map(|surfel| (surfel, 1.0)).into_iter().collect())
    }
}
