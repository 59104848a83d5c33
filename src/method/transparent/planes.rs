//! List the planes that each stage leaves, and read them back from a client.

use super::averaging::GroupAverage;
use super::blending::GroupLayers;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NamedPlane, Plane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::before_environment;
use crate::method::record::Part::{Count, Id, Number, Triple};
use crate::method::record::{Field, joined, rows};
use crate::method::stage::Holds::{self, Color, Depth, Index, Scalar};
use crate::method::stage::When::{Alone, Always};
use crate::method::stage::{Conditions, PlaneRow, Stage};
use crate::method::surface::{self, ALPHA, SHADED};
use crate::method::tiled::Tiled;
use crate::number::Exact;

impl<R> GroupLayers<R> {
    pub(crate) const BIN: Field<Self, R> =
        Field::new("blended.group##.bin", Scalar, Number(|p: &mut Self| &mut p.bin))
            .unit("bins")
            .says("low-precision depth of the nearest layer; +inf where there is none");
    pub(crate) const COUNT: Field<Self, R> =
        Field::new("blended.group##.count", Holds::Count, Count(|p: &mut Self| &mut p.count))
            .unit("layers")
            .says("how many layers were blended, each of one fragment, up to 255");
    pub(crate) const DEPTH: Field<Self, R> =
        Field::new("blended.group##.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .when(Alone)
            .says(
                "depth of the layer that was blended last, the nearest; +inf where there is none",
            );

    /// The planes of the image of a group.
    pub(crate) const PLANES: [Field<Self, R>; 8] = [
        Field::new("blended.group##", Color, Triple(|p: &mut Self| &mut p.blend.color))
            .says("the layers of the group, blended over black; black where there is none"),
        Field::new("blended.group##.A", Scalar, Number(|p: &mut Self| &mut p.blend.alpha))
            .says("opacity of the layers of the group together, in [0, 1]; 0 where there is none"),
        Field::new("blended.group##.opacities", Scalar, Number(|p: &mut Self| &mut p.opacity))
            .says(
                "sum of the opacities of the layers in front of the nearest opaque one; 0 where \
             there is none",
            ),
        Self::BIN,
        Self::COUNT,
        Field::new("blended.group##.id", Index, Id(|p: &mut Self| &mut p.surfel))
            .unit("surfel")
            .says(
                "surfel of the layer that was blended last, the nearest; 0xFFFF_FFFF where there \
             is none",
            ),
        Field::new("blended.group##.hidden", Scalar, Number(|p: &mut Self| &mut p.hidden))
            .when(Alone)
            .says("1 if an opaque layer hides what is behind, else 0"),
        Self::DEPTH,
    ];
}

impl<R> GroupAverage<R> {
    /// The planes that the average of the groups leaves, whatever reads the average.
    pub(crate) const PLANES: [Field<Self, R>; 5] = [
        Field::new("blended", Color, Triple(|p: &mut Self| &mut p.blend.color))
            .says("average of the groups' colours over black, before the environment"),
        Field::new("blended.A", Scalar, Number(|p: &mut Self| &mut p.blend.alpha))
            .says("average of the groups' opacities, in [0, 1]"),
        Field::new("blended.opacities", Scalar, Number(|p: &mut Self| &mut p.opacity))
            .says("average of the groups' sums of opacities"),
        Field::new("blended.hidden", Scalar, Number(|p: &mut Self| &mut p.hidden)).says(
            "the part of the groups in which an opaque layer hides what is behind, in [0, 1]",
        ),
        Field::new("blended.layers", Scalar, Number(|p: &mut Self| &mut p.layers))
            .unit("layers")
            .says("average of the groups' counts of layers"),
    ];
}

const DEPTH: PlaneRow = surface::DEPTH.says(
    "least depth of the groups, each that of the layer blended last; +inf where \
     there is none",
);
const ID: PlaneRow = surface::ID
    .says("surfel of that layer, of equal depths the lower; 0xFFFF_FFFF where there is none");
pub(crate) const LAYERS: PlaneRow = PlaneRow::new(
    "layers",
    Scalar,
    "average of the groups' counts of layers; 0 where nothing is seen",
)
.unit("layers")
.when(Always);

const BLENDED: [PlaneRow; GroupLayers::<f32>::PLANES.len()] = rows(&GroupLayers::<f32>::PLANES);

/// The stage of blending, which reads the stages `reads`.
pub(crate) const fn blending(reads: &'static [&'static str]) -> Stage {
    Stage { name: "blending", reads, leaves: &BLENDED }
}

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    blending(&["projection"]),
    Stage {
        name: "averaging",
        reads: &["blending"],
        leaves: joined!(rows(&GroupAverage::<f32>::PLANES), [SHADED, ALPHA, DEPTH, ID, LAYERS]),
    },
];

/// Makes the planes of the image of each group.
pub(crate) fn images<R: Exact>(
    images: &[Tiled<GroupLayers<R>>],
    there: &Conditions,
) -> Vec<NamedPlane<R>> {
    let planes = |(k, image): (usize, &Tiled<_>)| image.planes(&GroupLayers::PLANES, k, there);
    images.iter().enumerate().flat_map(planes).collect()
}

/// Reads a client's image of each group of the scene.
pub(crate) fn given_images<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<GroupLayers<R>>>> {
    let image = |k: usize| given.pixels(&GroupLayers::PLANES, k, GroupLayers::EMPTY);
    (0..job.index.groups()?.len()).map(image).collect()
}

/// Makes the colour and the opacity of the picture: what each pixel shows, in front of the
/// environment.
pub(crate) fn shown<R: Exact>(job: &Job<'_>, shown: &Tiled<Blend<R>>) -> [NamedPlane<R>; 2] {
    before(job, shown.plane(|pixel| pixel.color), shown.plane(|pixel| pixel.alpha))
}

/// Makes the same planes from planes of colour and opacity.
pub(crate) fn before<R: Exact>(
    job: &Job<'_>,
    color: Plane<[R; 3]>,
    alpha: Plane<R>,
) -> [NamedPlane<R>; 2] {
    let (color, alpha) = before_environment(job, color, alpha);
    [SHADED.triple(0, color), ALPHA.scalar(0, alpha)]
}

/// Makes the planes that every picture has beside its colour and opacity.
pub(super) fn nearest<R: Exact>(averages: &Tiled<GroupAverage<R>>) -> [NamedPlane<R>; 3] {
    nearest_planes(
        averages.plane(|pixel| pixel.depth),
        averages.plane(|pixel| pixel.surfel),
        averages.plane(|pixel| pixel.layers),
    )
}

/// Makes the same planes from planes of depth, id and layers.
pub(super) fn nearest_planes<R: Exact>(
    depth: Plane<R>,
    id: Plane<u32>,
    layers: Plane<R>,
) -> [NamedPlane<R>; 3] {
    [DEPTH.scalar(0, depth), ID.index(0, id), LAYERS.scalar(0, layers)]
}
