//! List the planes that each stage leaves, and read them back from a client.

use super::attributes::Sums;
use super::visibility::Foremost;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::record::Part::{Count, Id, Number, Triple};
use crate::method::record::{Field, joined, rows};
use crate::method::stage::Holds::{self, Color, Depth, Diagnostic, Index, Scalar, Vector};
use crate::method::stage::When::{Colored, Whole};
use crate::method::stage::{PlaneRow, Stage};
use crate::method::surface::{self, SurfacePixel};
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

impl<R> Foremost<R> {
    /// The planes that visibility splatting leaves.
    pub(crate) const PLANES: [Field<Self, R>; 2] = [
        Field::new("visibility.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth of the nearest fragment; +inf where there is none"),
        Field::new("visibility.id", Index, Id(|p: &mut Self| &mut p.id))
            .unit("surfel")
            .says("surfel of the nearest fragment; 0xFFFF_FFFF where there is none"),
    ];
}

impl<R> Sums<R> {
    /// The planes that attribute splatting leaves, without the margin.
    pub(crate) const PLANES: [Field<Self, R>; 4] = [
        Field::new("attributes", Color, Triple(|p: &mut Self| &mut p.color))
            .when(Colored)
            .says("sum of weight times colour over the visible fragments; 0 where there is none"),
        Field::new("attributes.normal", Vector, Triple(|p: &mut Self| &mut p.normal)).says(
            "sum of weight times normal over the visible fragments, in world space; 0 where \
             there is none",
        ),
        Field::new("attributes.weight", Scalar, Number(|p: &mut Self| &mut p.weight))
            .says("sum of the weights of the visible fragments; 0 where there is none"),
        Field::new("attributes.count", Holds::Count, Count(|p: &mut Self| &mut p.count))
            .unit("fragments")
            .says("how many fragments are visible, up to 255; 0 where there is none"),
    ];
}

/// The plane of the margins of attribute splatting.
pub(super) const MARGIN: PlaneRow = PlaneRow::new(
    "margin",
    Diagnostic,
    "how far the closest decision at the pixel is from being undecided: q against k^2, depth against \
     the end of the visible band, nearness against that of the nearest; beyond 1 all right renderers \
     agree; +inf where nothing was decided",
)
            .unit("radii")
            .when(Whole);

/// The stages. Every picture has the planes of the last two stages.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "visibility", reads: &["projection"], leaves: &rows(&Foremost::<f32>::PLANES) },
    Stage {
        name: "attributes",
        reads: &["projection", "visibility"],
        leaves: joined!(rows(&Sums::<f32>::PLANES), [MARGIN]),
    },
    Stage {
        name: "normalization",
        reads: &["visibility", "attributes"],
        leaves: &rows(&SurfacePixel::<f32>::PLANES),
    },
    surface::shading(&["normalization"]),
];

/// Reads a client's visibility. Nearness is computed from the client's depth, rounded.
pub(crate) fn given_visibility<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Tiled<Foremost<R>>> {
    let empty = Foremost { nearness: R::ZERO, depth: R::INFINITY, id: NO_ID };
    let visible = given.pixels(&Foremost::PLANES, 0, empty)?;
    let view = View::new(job.camera);
    Ok(visible.map(|pixel| Foremost { nearness: view.nearness(pixel.depth), ..*pixel }))
}

/// Reads a client's sums. This method does not use opacities and counts.
pub(crate) fn given_attributes<R: Exact>(given: &InputPlanes<'_, R>) -> Result<Tiled<Sums<R>>> {
    let [read @ .., _] = &Sums::PLANES;
    given.pixels(read, 0, Sums::NONE)
}
