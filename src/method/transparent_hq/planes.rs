//! List the planes that each stage leaves, and read them back from a client.

use super::compositing::{count, count_by_opacity};
use super::nearest::FrontLayer;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NO_ID, NamedPlane, Plane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::record::Part::{Count, Id, Number, Triple};
use crate::method::record::{Field, joined, rows};
use crate::method::single_pass::geometry::ImagePixel;
use crate::method::stage::Holds::{self, Color, Scalar};
use crate::method::stage::When::Always;
use crate::method::stage::{PlaneRow, Stage};
use crate::method::surface::{self, ALPHA, DEPTH, ID, SHADED, WEIGHT};
use crate::method::tiled::Tiled;
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::planes::{blending, shown};
use crate::number::Exact;

impl<R> FrontLayer<R> {
    /// The planes of the nearest layer that only pictures with stages have.
    pub(crate) const STAGES: [Field<Self, R>; 3] = [
        Field::new("nearest", Color, Triple(|p: &mut Self| &mut p.color))
            .says("shaded colour C_F of the nearest layer, not multiplied by its opacity; black where there is \
             none"),
        Field::new("nearest.A", Scalar, Number(|p: &mut Self| &mut p.opacity))
            .says("average opacity alpha of the nearest layer in [0, 1]; 0 where there is none"),
        Field::new("nearest.mask", Holds::Count, Count(|p: &mut Self| &mut p.mask))
            .says("the stencil: 1 where the nearest layer is, else 0"),
    ];
    /// The planes of the nearest layer that every picture has.
    pub(super) const PICTURE: [Field<Self, R>; 4] = [
        DEPTH.at(Number(|pixel| &mut pixel.depth)),
        NORMAL.at(Triple(|pixel| &mut pixel.normal)),
        WEIGHT.at(Number(|pixel| &mut pixel.weight)),
        ID.at(Id(|pixel| &mut pixel.id)),
    ];
}

const NORMAL: PlaneRow = surface::NORMAL.when(Always);
pub(crate) const LAYERS_BY_OPACITY: PlaneRow = PlaneRow::new(
    "l",
    Scalar,
    "1 + the average sum of opacities of the other layers over the opacity of the nearest layer; 0 \
     where the nearest layer is not, or has an opacity of 0",
)
.unit("layers");
pub(crate) const LAYERS: PlaneRow = PlaneRow::new(
    "layers",
    Scalar,
    "average of the groups' counts of layers behind the nearest one, and 1 for the nearest one; 0 \
     where nothing is seen",
)
.unit("layers")
.when(Always);

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "geometry", reads: &["projection"], leaves: &rows(&ImagePixel::<f32>::NEAREST) },
    Stage {
        name: "nearest",
        reads: &["geometry"],
        leaves: joined!(rows(&FrontLayer::<f32>::STAGES), rows(&FrontLayer::<f32>::PICTURE)),
    },
    blending(&["projection", "nearest"]),
    Stage { name: "averaging", reads: &["blending"], leaves: &rows(&GroupAverage::<f32>::PLANES) },
    Stage {
        name: "compositing",
        reads: &["nearest", "averaging"],
        leaves: &[SHADED, ALPHA, LAYERS_BY_OPACITY, LAYERS],
    },
];

/// Makes the planes of the nearest layer that every picture has.
pub(super) fn nearest_planes<R: Exact>(
    depth: Plane<R>,
    normal: Plane<[R; 3]>,
    weight: Plane<R>,
    id: Plane<u32>,
) -> [NamedPlane<R>; 4] {
    [DEPTH.scalar(0, depth), NORMAL.triple(0, normal), WEIGHT.scalar(0, weight), ID.index(0, id)]
}

/// Reads a client's nearest layer, as the other layers need it: without surfel and weight.
pub(super) fn given_nearest<R: Exact>(given: &InputPlanes<'_, R>) -> Result<Tiled<FrontLayer<R>>> {
    let empty = FrontLayer {
        depth: R::INFINITY,
        id: NO_ID,
        weight: R::ZERO,
        normal: [R::ZERO; 3],
        color: [R::ZERO; 3],
        opacity: R::ZERO,
        mask: 0,
    };
    let near = given.pixels(&FrontLayer::STAGES, 0, empty)?;
    let (depth, normal) = (given.scalar(&DEPTH, 0)?, given.triple(&NORMAL, 0)?);
    Ok(given.tiled(|x, y| FrontLayer {
        depth: *given.at(depth, x, y),
        normal: *given.at(normal, x, y),
        ..*near.at(x, y)
    }))
}

/// Makes the plane of l, which belongs to the planes of the stages.
pub(super) fn layers_by_opacity<R: Exact>(
    nearest: &Tiled<FrontLayer<R>>,
    others: &Tiled<GroupAverage<R>>,
) -> NamedPlane<R> {
    LAYERS_BY_OPACITY.scalar(0, nearest.with(others, count_by_opacity).plane(|count| *count))
}

/// Makes the planes that the last pass leaves in every picture.
pub(super) fn compositing<R: Exact>(
    job: &Job<'_>,
    blends: &Tiled<Blend<R>>,
    nearest: &Tiled<FrontLayer<R>>,
    others: &Tiled<GroupAverage<R>>,
) -> Vec<NamedPlane<R>> {
    let mut planes: Vec<_> = shown(job, blends).into();
    planes.push(layers(nearest.with(others, count).plane(|count| *count)));
    planes
}

/// Makes the plane of the counts of layers.
pub(super) fn layers<R: Exact>(layers: Plane<R>) -> NamedPlane<R> {
    LAYERS.scalar(0, layers)
}
