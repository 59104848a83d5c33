//! Fill the gaps between points with templates of k x k pixels: image reconstruction \[MOC08\].
//!
//! 1. **Projection** to single pixels, see [`mod@super::projection`].
//! 2. **Propagation** ([`mod@propagation`]): each centre moves up the levels of a pyramid until k x
//!    k cells of its level cover it; centres that meet in a cell are merged.
//! 3. **Reconstruction** ([`mod@reconstruction`]): each pixel searches k x k cells around it in
//!    every level for ellipses that hold it, keeps the surface in front, and blends.
//! 4. **Normalization**: depth, normal and colour are sums divided by the sum of weights, see
//!    [`crate::composite::sum`]; the average normal is then turned to world space (down the columns
//!    of the view matrix, (m0 x + m1 y) + m2 z) before it is divided by its length.
//! 5. **Deferred shading**, see [`crate::shade`].
//!
//! The method draws surfels only. It refuses a scene with triangles or lines, which \[MOC08\] does
//! not have. The template is k = 3, 5 or 7 cells wide, h = (k - 1) / 2.
//! [`crate::frame::pyramid::sizes`] gives the levels. The **top** level is the first whose sides
//! are both at most h + 1. From any of its cells every other is found, so that (section 3.2)
//! coarser levels are not needed.
//!
//! The passes are the definition, over any [`crate::number::Real`]; [`planes`] has every plane that
//! they leave.
//!
//! What a right implementation may leave of each stage: [`crate::verdict::template`].

mod center;
mod explain;
mod fast;
pub(crate) mod normalization;
mod picture;
pub mod planes;
pub mod propagation;
pub mod reconstruction;
mod settings;
#[cfg(test)]
mod tests;

pub use center::Center;
pub use settings::{Falloff, LevelRule, Settings};

use crate::error::Result;
use crate::frame::{NamedPlane, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::input_planes::InputPlanes;
use crate::method::record::rows;
use crate::method::{Picture, Stage, projection};
use crate::number::Exact;
use reconstruction::Gathered;
use std::fmt::Display;

impl Algorithm for Settings {
    const NAME: &'static str = "template";
    const SUMMARY: &'static str = "draw one pixel per point, search with templates of k x k pixels \
                                   in a pyramid [MOC08]";
    const STAGES: &'static [Stage] = &[
        projection::planes::STAGE,
        Stage {
            name: "propagation",
            reads: &["projection"],
            leaves: &rows(&Center::<f32>::PLANES),
        },
        Stage {
            name: "reconstruction",
            reads: &["projection", "propagation"],
            leaves: &rows(&Gathered::<f32>::PLANES),
        },
        Stage {
            name: "normalization",
            reads: &["reconstruction"],
            leaves: &[planes::DEPTH, planes::NORMAL, planes::WEIGHT],
        },
        Stage {
            name: "shading",
            reads: &["reconstruction", "normalization"],
            leaves: &[planes::SHADED, planes::ALPHA],
        },
    ];
    const FAST_BYTES_A_PIXEL: Option<u64> = Some(224);
    const NEEDS_WHOLE_PICTURE: Option<&'static str> =
        Some("a pixel gathers splats of other pixels, level by level");
    const PROJECTS_REGIONS: bool = true;
    type Memory = fast::CenterLevels;

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut fast::CenterLevels,
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
        picture::levels(job, self, stage)
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display> {
        explain::explain::<R>(job, self, pixel)
    }
}
