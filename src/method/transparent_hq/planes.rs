//! The planes of the stages: where they leave, and where they come in.

use super::Settings;
use super::compositing::{count, count_by_opacity};
use super::nearest::FrontLayer;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NO_ID, NamedPlane, Plane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::single_pass::geometry::ImagePixel;
use crate::method::single_pass::planes::{ImageRows, given_images, image_planes};
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface::{self, ALPHA, DEPTH, ID, SHADED, WEIGHT};
use crate::method::tiled::Tiled;
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::planes::{AVERAGES, blending, shown};
use crate::number::Exact;

pub(crate) const IMAGES: ImageRows = ImageRows::new([
    "nearest.group##.Z",
    "nearest.group##.id",
    "nearest.group##.weight",
    "nearest.group##.normal",
    "nearest.group##",
    "nearest.group##.voronoi",
]);

pub(crate) const NEAREST_COLOR: PlaneRow = PlaneRow::new(
    "nearest",
    Holds::Color,
    "linear RGB",
    "shaded colour C_F of the nearest layer, not multiplied by its opacity; black where there is \
     none",
    When::Stages,
);
pub(crate) const NEAREST_ALPHA: PlaneRow = PlaneRow::new(
    "nearest.A",
    Holds::Scalar,
    "",
    "average opacity alpha of the nearest layer in [0, 1]; 0 where there is none",
    When::Stages,
);
pub(crate) const NEAREST_MASK: PlaneRow = PlaneRow::new(
    "nearest.mask",
    Holds::Count,
    "",
    "the stencil: 1 where the nearest layer is, else 0",
    When::Stages,
);
const NORMAL: PlaneRow = PlaneRow { when: When::Always, ..surface::NORMAL };
pub(crate) const LAYERS_BY_OPACITY: PlaneRow = PlaneRow::new(
    "l",
    Holds::Scalar,
    "layers",
    "1 + the average sum of opacities of the other layers over the opacity of the nearest layer; 0 \
     where the nearest layer is not, or has an opacity of 0",
    When::Stages,
);
pub(crate) const LAYERS: PlaneRow = PlaneRow::new(
    "layers",
    Holds::Scalar,
    "layers",
    "average of the groups' counts of layers behind the nearest one, and 1 for the nearest one; 0 \
     where nothing is seen",
    When::Always,
);

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "geometry", reads: &["projection"], leaves: &IMAGES.all() },
    Stage {
        name: "nearest",
        reads: &["geometry"],
        leaves: &[NEAREST_COLOR, NEAREST_ALPHA, NEAREST_MASK, DEPTH, NORMAL, WEIGHT, ID],
    },
    blending(&["projection", "nearest"]),
    Stage { name: "averaging", reads: &["blending"], leaves: &AVERAGES },
    Stage {
        name: "compositing",
        reads: &["nearest", "averaging"],
        leaves: &[SHADED, ALPHA, LAYERS_BY_OPACITY, LAYERS],
    },
];

/// The depth-images of the nearest layer.
pub(super) fn geometry<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    images: &[Tiled<ImagePixel<R>>],
) -> Vec<NamedPlane<R>> {
    image_planes(job, &IMAGES, settings.nearest, images)
}

/// Somebody's depth-images of the nearest layer.
pub(super) fn given_geometry<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<ImagePixel<R>>>> {
    given_images(job, &IMAGES, given)
}

/// What the nearest layer leaves with the planes of the stages.
pub(super) fn nearest_stages<R: Exact>(nearest: &Tiled<FrontLayer<R>>) -> [NamedPlane<R>; 3] {
    [
        NEAREST_COLOR.triple(0, nearest.plane(|pixel| pixel.color)),
        NEAREST_ALPHA.scalar(0, nearest.plane(|pixel| pixel.opacity)),
        NEAREST_MASK.count(0, nearest.plane(|pixel| pixel.mask)),
    ]
}

/// What the nearest layer leaves in every picture.
pub(super) fn nearest<R: Exact>(nearest: &Tiled<FrontLayer<R>>) -> [NamedPlane<R>; 4] {
    nearest_planes(
        nearest.plane(|pixel| pixel.depth),
        nearest.plane(|pixel| pixel.normal),
        nearest.plane(|pixel| pixel.weight),
        nearest.plane(|pixel| pixel.id),
    )
}

/// The same of planes.
pub(super) fn nearest_planes<R: Exact>(
    depth: Plane<R>,
    normal: Plane<[R; 3]>,
    weight: Plane<R>,
    id: Plane<u32>,
) -> [NamedPlane<R>; 4] {
    [DEPTH.scalar(0, depth), NORMAL.triple(0, normal), WEIGHT.scalar(0, weight), ID.index(0, id)]
}

/// Somebody's nearest layer, as the other layers need it: without surfel and weight.
pub(super) fn given_nearest<R: Exact>(given: &InputPlanes<'_, R>) -> Result<Tiled<FrontLayer<R>>> {
    let (color, opacity) = (given.triple(&NEAREST_COLOR, 0)?, given.scalar(&NEAREST_ALPHA, 0)?);
    let (mask, depth) = (given.count(&NEAREST_MASK, 0)?, given.scalar(&DEPTH, 0)?);
    let normal = given.triple(&NORMAL, 0)?;
    Ok(given.tiled(|x, y| FrontLayer {
        depth: *depth.at(x, y),
        id: NO_ID,
        weight: R::ZERO,
        normal: *normal.at(x, y),
        color: *color.at(x, y),
        opacity: *opacity.at(x, y),
        mask: *mask.at(x, y),
    }))
}

/// l, with the planes of the stages.
pub(super) fn layers_by_opacity<R: Exact>(
    nearest: &Tiled<FrontLayer<R>>,
    others: &Tiled<GroupAverage<R>>,
) -> NamedPlane<R> {
    LAYERS_BY_OPACITY.scalar(0, nearest.with(others, count_by_opacity).plane(|count| *count))
}

/// What the last pass leaves in every picture.
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

/// The counts of layers.
pub(super) fn layers<R: Exact>(layers: Plane<R>) -> NamedPlane<R> {
    LAYERS.scalar(0, layers)
}
