//! The surface at each pixel before it is shaded. The passes of opaque splats end with it, and
//! share the stage of shading that reads it.

use super::algorithm::Job;
use super::input_planes::InputPlanes;
use super::picture::shaded;
use super::record::Field;
use super::record::Part::{Id, Number, Triple};
use super::stage::Holds::{Color, Depth, Index, Normal, Scalar};
use super::stage::When::{Always, Colored, Lit};
use super::stage::{Keep, PlaneRow, Stage};
use super::tiled::Tiled;
use crate::error::Result;
use crate::frame::{Framebuffer, NO_ID, NamedPlane, Wanted};
use crate::number::Exact;

/// The averages of the visible fragments at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePixel<R> {
    /// Depth of the nearest fragment in world units; +inf where there is none.
    pub(crate) depth: R,
    /// Surfel of the nearest fragment; [`crate::frame::NO_ID`] where there is none.
    pub(crate) id: u32,
    /// Sum of the weights.
    pub(crate) weight: R,
    /// Direction of the average normal, in world space.
    pub(crate) normal: [R; 3],
    /// Average colour; 0 where the scene has no colours.
    pub(crate) color: [R; 3],
}

impl<R: Exact> SurfacePixel<R> {
    /// A pixel without weight.
    pub(crate) const EMPTY: Self = Self {
        depth: R::INFINITY,
        id: NO_ID,
        weight: R::ZERO,
        normal: [R::ZERO; 3],
        color: [R::ZERO; 3],
    };
}

pub(crate) const COLOR: PlaneRow = PlaneRow::new(
    "resolved",
    Color,
    "average colour of the visible fragments, before shading; 0 where there is none",
)
.when(Colored);
pub(crate) const DEPTH: PlaneRow =
    PlaneRow::new("Z", Depth, "depth of the nearest fragment; +inf where there is none")
        .when(Always);
pub(crate) const NORMAL: PlaneRow = PlaneRow::new(
    "normal",
    Normal,
    "direction of the average normal of the visible fragments, in world space, of length 1; the \
     null vector where there is none",
)
.when(Lit);
pub(crate) const WEIGHT: PlaneRow = PlaneRow::new(
    "weight",
    Scalar,
    "sum of the weights of the visible fragments; 0 where there is none",
)
.when(Always);
pub(crate) const ID: PlaneRow =
    PlaneRow::new("id", Index, "surfel of the nearest fragment; 0xFFFF_FFFF where there is none")
        .unit("surfel")
        .when(Always);
/// The colour of a picture.
pub(crate) const SHADED: PlaneRow = PlaneRow::new(
    "",
    Color,
    "the picture: shaded, multiplied by A where several layers are seen, before the environment; \
     black where nothing is seen",
)
.when(Always);
/// The opacity of a picture.
pub(crate) const ALPHA: PlaneRow = PlaneRow::new(
    "A",
    Scalar,
    "opacity of the picture in [0, 1]; 1 where the environment or a surface behind splats is seen, 0 where nothing is",
)
.when(Always);

impl<R> SurfacePixel<R> {
    /// The planes of the averages.
    pub(crate) const PLANES: [Field<Self, R>; 5] = [
        COLOR.at(Triple(|pixel| &mut pixel.color)),
        DEPTH.at(Number(|pixel| &mut pixel.depth)),
        NORMAL.at(Triple(|pixel| &mut pixel.normal)),
        WEIGHT.at(Number(|pixel| &mut pixel.weight)),
        ID.at(Id(|pixel| &mut pixel.id)),
    ];
}

/// Deferred shading, as a stage after the stage called `normalized`.
pub(crate) const fn shading(normalized: &'static [&'static str]) -> Stage {
    Stage { name: "shading", reads: normalized, leaves: &[SHADED, ALPHA] }
}

/// The average colours, if the scene has colours. Pictures without stages do not keep them.
pub(crate) fn colors<R: Exact>(
    job: &Job<'_>,
    pixels: &Tiled<SurfacePixel<R>>,
) -> Vec<NamedPlane<R>> {
    pixels.planes(&SurfacePixel::PLANES[..1], 0, &job.there(Keep::Stages))
}

/// Turns the averages into a framebuffer that can be shaded.
pub(crate) fn framebuffer<R: Exact>(
    job: &Job<'_>,
    pixels: &Tiled<SurfacePixel<R>>,
    wanted: Wanted,
) -> Framebuffer<R> {
    let [width, height] = job.size();
    Framebuffer {
        width,
        height,
        depth: pixels.plane(|pixel| pixel.depth),
        id: pixels.plane(|pixel| pixel.id),
        weight: pixels.plane(|pixel| pixel.weight),
        normal: wanted.normal.then(|| pixels.plane(|pixel| pixel.normal)),
        color: wanted.color.then(|| pixels.plane(|pixel| pixel.color)),
        stencil: None,
        margin: None,
    }
}

/// Runs the stage of shading on a client's averages. `colored` says whether the surfels have
/// colours.
pub(crate) fn shade<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
    colored: bool,
) -> Result<Vec<NamedPlane<R>>> {
    let (depth, weight) = (given.scalar(&DEPTH, 0)?, given.scalar(&WEIGHT, 0)?);
    let lit = !job.scene.lights.is_empty();
    let normal = lit.then(|| given.triple(&NORMAL, 0)).transpose()?;
    let color = colored.then(|| given.triple(&COLOR, 0).cloned()).transpose()?;
    let (color, alpha) = shaded(job, depth, normal, weight, color);
    Ok(vec![SHADED.triple(0, color), ALPHA.scalar(0, alpha)])
}
