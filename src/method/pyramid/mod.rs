//! Fill the gaps between points: draw one pixel a point, and interpolate by pull and push
//! \[MKC08\].
//!
//! 1. **Projection** to single pixels, see [`mod@super::projection`]; each sample becomes a
//!    [`Cell`] of level 0 with the interval [t, t + r], the radius rho, displacement (0, 0),
//!    normal, tangent and colour.
//! 2. **Pull** ([`mod@pull`]): each coarser level from the finer one, four cells to one.
//! 3. **Push** ([`mod@push`]): from the coarsest level down, cells that are empty or occluded are
//!    computed again from four coarser ones; every other cell is copied.
//! 4. **Deferred shading** of level 0, see [`crate::shade`]. The depth of a pixel is its cell's
//!    `front`. Its normal is the cell's normal, turned to world space and divided by its length,
//!    plus 0 (of length 0: the null vector). A tube's normal is treated so too. A tube is lit by
//!    its tangent, treated likewise.
//!
//! [`crate::frame::pyramid::sizes`] gives the levels. A cell's ellipse is defined in
//! [`crate::splat::ellipse`]; its centre is the centre of the cell plus the displacement.
//! `Decided:` wherever a cell is an average of others, cells of a tube are never averaged with
//! cells of anything else, because neither their light nor their vectors agree (\[MKC08\] 5.2
//! excludes it too). The average has the kind of the foremost.
//!
//! # What the method gets wrong
//!
//! - The projection is without sub-pixel accuracy (section 3.6): a sample lies at the centre of its
//!   pixel.
//! - The silhouette of a wide tube zig-zags, by up to 30 % of the radius of the one straight tube
//!   that was measured (bench `lines`, `docs/image-space.md`: by radius and angle, orthographic).
//!   The reason is that a tube is reconstructed from discs parallel to the view, which the paper
//!   calls "only appropriate for thin projections".
//!
//! The passes are the definition, over any [`crate::number::Real`]; [`planes`] has every plane that
//! they leave.
//!
//! What a right implementation may leave of each stage: [`crate::verdict::pyramid`].

mod cell;
mod explain;
mod fast;
mod gbuffer;
mod picture;
pub mod planes;
pub mod pull;
pub mod push;
mod settings;
#[cfg(test)]
pub(crate) mod tests;

pub use cell::Cell;
pub use settings::{Occlusion, Settings, Weights};

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::record::rows;
use crate::method::{Picture, Stage, projection};
use crate::number::Exact;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "pyramid";
    const SUMMARY: &'static str = "draw one pixel per point, interpolate by pull and push; \
                                   ribbons, tubes, polygons and hybrids [MKC08]";
    const STAGES: &'static [Stage] = &[
        projection::planes::STAGE,
        Stage { name: "pull", reads: &["projection"], leaves: &rows(&Cell::<f32>::PULL) },
        Stage { name: "push", reads: &["projection", "pull"], leaves: &rows(&Cell::<f32>::PUSH) },
        // A picture of one pixel has no level to push: its shading reads the projection.
        Stage {
            name: "shading",
            reads: &["projection", "push"],
            leaves: &[
                planes::SHADED,
                planes::ALPHA,
                planes::DEPTH,
                planes::NORMAL,
                planes::TANGENT,
                planes::KIND,
            ],
        },
    ];
    const DRAWS_PRIMITIVES: bool = true;
    const NEEDS_WHOLE_PICTURE: Option<&'static str> =
        Some("its coarse levels average pixels from everywhere");
    const PROJECTS_REGIONS: bool = true;
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(224);
    type Memory = fast::CellLevels;

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut fast::CellLevels,
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

    fn finish(
        &self,
        job: &Job<'_>,
        given: &InputPlanes<'_, f32>,
        stages: bool,
    ) -> Result<Picture<f32>> {
        picture::finish_joined(job, self, given, stages)
    }

    fn levels(&self, job: &Job<'_>, stage: &str) -> Vec<usize> {
        picture::levels(job, stage)
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display> {
        explain::explain::<R>(job, self, pixel)
    }
}
