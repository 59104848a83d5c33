//! The planes of the stages: where they leave, and where they come in.

use super::averaging::GroupAverage;
use super::blending::GroupLayers;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NamedPlane, Plane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::before_environment;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface::{self, ALPHA, SHADED};
use crate::method::tiled::Tiled;
use crate::number::Exact;

pub(crate) const GROUP_COLOR: PlaneRow = PlaneRow::new(
    "blended.group##",
    Holds::Color,
    "linear RGB",
    "the layers of the group, blended over black; black where there is none",
    When::Stages,
);
pub(crate) const GROUP_ALPHA: PlaneRow = PlaneRow::new(
    "blended.group##.A",
    Holds::Scalar,
    "",
    "opacity of the layers of the group together, in [0, 1]; 0 where there is none",
    When::Stages,
);
pub(crate) const GROUP_OPACITY: PlaneRow = PlaneRow::new(
    "blended.group##.opacities",
    Holds::Scalar,
    "",
    "sum of the opacities of the layers in front of the nearest opaque one; 0 where there is none",
    When::Stages,
);
pub(crate) const GROUP_BIN: PlaneRow = PlaneRow::new(
    "blended.group##.bin",
    Holds::Scalar,
    "bins",
    "low-precision depth of the nearest layer; +inf where there is none",
    When::Stages,
);
pub(crate) const GROUP_COUNT: PlaneRow = PlaneRow::new(
    "blended.group##.count",
    Holds::Count,
    "layers",
    "how many layers were blended, each of one fragment, up to 255",
    When::Stages,
);
pub(crate) const GROUP_ID: PlaneRow = PlaneRow::new(
    "blended.group##.id",
    Holds::Index,
    "surfel",
    "surfel of the layer that was blended last, the nearest; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(crate) const GROUP_HIDDEN: PlaneRow = PlaneRow::new(
    "blended.group##.hidden",
    Holds::Scalar,
    "",
    "1 if an opaque layer hides what is behind, else 0",
    When::Alone,
);
pub(crate) const GROUP_DEPTH: PlaneRow = PlaneRow::new(
    "blended.group##.Z",
    Holds::Scalar,
    "world units",
    "depth of the layer that was blended last, the nearest; +inf where there is none",
    When::Alone,
);

const AVERAGE_COLOR: PlaneRow = PlaneRow::new(
    "blended",
    Holds::Color,
    "linear RGB",
    "average of the groups' colours over black, before the environment",
    When::Stages,
);
const AVERAGE_ALPHA: PlaneRow = PlaneRow::new(
    "blended.A",
    Holds::Scalar,
    "",
    "average of the groups' opacities, in [0, 1]",
    When::Stages,
);
const AVERAGE_OPACITY: PlaneRow = PlaneRow::new(
    "blended.opacities",
    Holds::Scalar,
    "",
    "average of the groups' sums of opacities",
    When::Stages,
);
const AVERAGE_HIDDEN: PlaneRow = PlaneRow::new(
    "blended.hidden",
    Holds::Scalar,
    "",
    "the part of the groups in which an opaque layer hides what is behind, in [0, 1]",
    When::Stages,
);
const AVERAGE_LAYERS: PlaneRow = PlaneRow::new(
    "blended.layers",
    Holds::Scalar,
    "layers",
    "average of the groups' counts of layers",
    When::Stages,
);
const DEPTH: PlaneRow = PlaneRow {
    meaning: "least depth of the groups, each that of the layer blended last; +inf where there is none",
    ..surface::DEPTH
};
const ID: PlaneRow = PlaneRow {
    meaning: "surfel of that layer, of equal depths the lower; 0xFFFF_FFFF where there is none",
    ..surface::ID
};
pub(crate) const LAYERS: PlaneRow = PlaneRow::new(
    "layers",
    Holds::Scalar,
    "layers",
    "average of the groups' counts of layers; 0 where nothing is seen",
    When::Always,
);

/// The stage of blending, after some others.
pub(crate) const fn blending(reads: &'static [&'static str]) -> Stage {
    let leaves = &[
        GROUP_COLOR,
        GROUP_ALPHA,
        GROUP_OPACITY,
        GROUP_BIN,
        GROUP_COUNT,
        GROUP_ID,
        GROUP_HIDDEN,
        GROUP_DEPTH,
    ];
    Stage { name: "blending", reads, leaves }
}

/// What the average of the groups leaves, whatever is done with it.
pub(crate) const AVERAGES: [PlaneRow; 5] =
    [AVERAGE_COLOR, AVERAGE_ALPHA, AVERAGE_OPACITY, AVERAGE_HIDDEN, AVERAGE_LAYERS];

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    blending(&["projection"]),
    Stage {
        name: "averaging",
        reads: &["blending"],
        leaves: &[
            AVERAGE_COLOR,
            AVERAGE_ALPHA,
            AVERAGE_OPACITY,
            AVERAGE_HIDDEN,
            AVERAGE_LAYERS,
            SHADED,
            ALPHA,
            DEPTH,
            ID,
            LAYERS,
        ],
    },
];

/// The image of each group, as pictures keep it.
pub(crate) fn images<R: Exact>(images: &[Tiled<GroupLayers<R>>]) -> Vec<NamedPlane<R>> {
    let of = |(k, image): (usize, &Tiled<GroupLayers<R>>)| {
        [
            GROUP_COLOR.triple(k, image.plane(|pixel| pixel.blend.color)),
            GROUP_ALPHA.scalar(k, image.plane(|pixel| pixel.blend.alpha)),
            GROUP_OPACITY.scalar(k, image.plane(|pixel| pixel.opacity)),
            GROUP_BIN.scalar(k, image.plane(|pixel| pixel.bin)),
            GROUP_COUNT.count(k, image.plane(|pixel| pixel.count)),
            GROUP_ID.index(k, image.plane(|pixel| pixel.surfel)),
        ]
    };
    images.iter().enumerate().flat_map(of).collect()
}

/// What the average takes beside the planes that pictures keep.
pub(crate) fn images_alone<R: Exact>(images: &[Tiled<GroupLayers<R>>]) -> Vec<NamedPlane<R>> {
    let of = |(k, image): (usize, &Tiled<GroupLayers<R>>)| {
        [
            GROUP_HIDDEN.scalar(k, image.plane(|pixel| pixel.hidden)),
            GROUP_DEPTH.scalar(k, image.plane(|pixel| pixel.depth)),
        ]
    };
    images.iter().enumerate().flat_map(of).collect()
}

/// Somebody's image of each group of the scene.
pub(crate) fn given_images<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<GroupLayers<R>>>> {
    let image = |k: usize| {
        let (color, alpha) = (given.triple(&GROUP_COLOR, k)?, given.scalar(&GROUP_ALPHA, k)?);
        let opacity = given.scalar(&GROUP_OPACITY, k)?;
        let (bin, count) = (given.scalar(&GROUP_BIN, k)?, given.count(&GROUP_COUNT, k)?);
        let (depth, surfel) = (given.scalar(&GROUP_DEPTH, k)?, given.ids(&GROUP_ID, k)?);
        let hidden = given.scalar(&GROUP_HIDDEN, k)?;
        Ok(given.tiled(|x, y| GroupLayers {
            bin: *bin.at(x, y),
            blend: Blend { color: *color.at(x, y), alpha: *alpha.at(x, y) },
            opacity: *opacity.at(x, y),
            hidden: *hidden.at(x, y),
            count: *count.at(x, y),
            depth: *depth.at(x, y),
            surfel: *surfel.at(x, y),
        }))
    };
    (0..job.index.groups()?.len()).map(image).collect()
}

/// The averages of the groups.
pub(crate) fn averages<R: Exact>(averages: &Tiled<GroupAverage<R>>) -> [NamedPlane<R>; 5] {
    [
        AVERAGE_COLOR.triple(0, averages.plane(|pixel| pixel.blend.color)),
        AVERAGE_ALPHA.scalar(0, averages.plane(|pixel| pixel.blend.alpha)),
        AVERAGE_OPACITY.scalar(0, averages.plane(|pixel| pixel.opacity)),
        AVERAGE_HIDDEN.scalar(0, averages.plane(|pixel| pixel.hidden)),
        AVERAGE_LAYERS.scalar(0, averages.plane(|pixel| pixel.layers)),
    ]
}

/// Somebody's averages, without a nearest surfel.
pub(crate) fn given_averages<R: Exact>(
    given: &InputPlanes<'_, R>,
) -> Result<Tiled<GroupAverage<R>>> {
    let (color, alpha) = (given.triple(&AVERAGE_COLOR, 0)?, given.scalar(&AVERAGE_ALPHA, 0)?);
    let opacity = given.scalar(&AVERAGE_OPACITY, 0)?;
    let (hidden, layers) = (given.scalar(&AVERAGE_HIDDEN, 0)?, given.scalar(&AVERAGE_LAYERS, 0)?);
    Ok(given.tiled(|x, y| GroupAverage {
        blend: Blend { color: *color.at(x, y), alpha: *alpha.at(x, y) },
        opacity: *opacity.at(x, y),
        hidden: *hidden.at(x, y),
        layers: *layers.at(x, y),
        ..GroupAverage::EMPTY
    }))
}

/// The colour and the opacity of the picture: what each pixel shows before the environment.
pub(crate) fn shown<R: Exact>(job: &Job<'_>, shown: &Tiled<Blend<R>>) -> [NamedPlane<R>; 2] {
    before(job, shown.plane(|pixel| pixel.color), shown.plane(|pixel| pixel.alpha))
}

/// The same of planes.
pub(crate) fn before<R: Exact>(
    job: &Job<'_>,
    color: Plane<[R; 3]>,
    alpha: Plane<R>,
) -> [NamedPlane<R>; 2] {
    let (color, alpha) = before_environment(job.scene, job.camera, color, alpha, job.exec);
    [SHADED.triple(0, color), ALPHA.scalar(0, alpha)]
}

/// The planes of every picture beside its colour.
pub(super) fn nearest<R: Exact>(averages: &Tiled<GroupAverage<R>>) -> [NamedPlane<R>; 3] {
    nearest_planes(
        averages.plane(|pixel| pixel.depth),
        averages.plane(|pixel| pixel.surfel),
        averages.plane(|pixel| pixel.layers),
    )
}

/// The same of planes.
pub(super) fn nearest_planes<R: Exact>(
    depth: Plane<R>,
    id: Plane<u32>,
    layers: Plane<R>,
) -> [NamedPlane<R>; 3] {
    [DEPTH.scalar(0, depth), ID.index(0, id), LAYERS.scalar(0, layers)]
}
