//! The planes of the stages: where they leave, and where they come in.

use super::attributes::Sums;
use super::visibility::Foremost;
use crate::error::Result;
use crate::frame::NamedPlane;
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

pub(crate) const NEAREST: PlaneRow = PlaneRow::new(
    "visibility.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest fragment; +inf where there is none",
    When::Stages,
);
pub(crate) const NEAREST_ID: PlaneRow = PlaneRow::new(
    "visibility.id",
    Holds::Index,
    "surfel",
    "surfel of the nearest fragment; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(crate) const COLOR_SUM: PlaneRow = PlaneRow::new(
    "attributes",
    Holds::Color,
    "linear RGB",
    "sum of weight times colour over the visible fragments; 0 where there is none",
    When::Colored,
);
pub(crate) const NORMAL_SUM: PlaneRow = PlaneRow::new(
    "attributes.normal",
    Holds::Vector,
    "",
    "sum of weight times normal over the visible fragments, in world space; 0 where there is none",
    When::Stages,
);
pub(crate) const WEIGHT_SUM: PlaneRow = PlaneRow::new(
    "attributes.weight",
    Holds::Scalar,
    "",
    "sum of the weights of the visible fragments; 0 where there is none",
    When::Stages,
);
pub(crate) const COUNT: PlaneRow = PlaneRow::new(
    "attributes.count",
    Holds::Count,
    "fragments",
    "how many fragments are visible, up to 255; 0 where there is none",
    When::Stages,
);
const MARGIN: PlaneRow = PlaneRow::new(
    "margin",
    Holds::Scalar,
    "radii",
    "how far the closest decision at the pixel is from being undecided: q against k^2, depth against \
     the end of the visible band, nearness against that of the nearest; beyond 1 all right renderers \
     agree; +inf where nothing was decided",
    When::Whole,
);

/// The stages; the planes of the last two are those of every picture.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "visibility", reads: &["projection"], leaves: &[NEAREST, NEAREST_ID] },
    Stage {
        name: "attributes",
        reads: &["projection", "visibility"],
        leaves: &[COLOR_SUM, NORMAL_SUM, WEIGHT_SUM, COUNT, MARGIN],
    },
    Stage {
        name: "normalization",
        reads: &["visibility", "attributes"],
        leaves: &[surface::COLOR, surface::DEPTH, surface::NORMAL, surface::WEIGHT, surface::ID],
    },
    surface::shading(&["normalization"]),
];

/// What visibility splatting leaves.
pub(crate) fn visibility<R: Exact>(visible: &Tiled<Foremost<R>>) -> Vec<NamedPlane<R>> {
    vec![
        NEAREST.scalar(0, visible.plane(|pixel| pixel.depth)),
        NEAREST_ID.index(0, visible.plane(|pixel| pixel.id)),
    ]
}

/// Somebody's visibility; nearness is that of the depth, rounded.
pub(crate) fn given_visibility<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Tiled<Foremost<R>>> {
    let (depth, id) = (given.scalar(&NEAREST, 0)?, given.ids(&NEAREST_ID, 0)?);
    let view = View::new(job.camera);
    Ok(given.tiled(|x, y| {
        let depth = *depth.at(x, y);
        Foremost { nearness: view.nearness(depth), depth, id: *id.at(x, y) }
    }))
}

/// What attribute splatting leaves, but for the margin.
pub(crate) fn attributes<R: Exact>(job: &Job<'_>, sums: &Tiled<Sums<R>>) -> Vec<NamedPlane<R>> {
    let colored = job.scene.surfels.color().is_some();
    let color = colored.then(|| COLOR_SUM.triple(0, sums.plane(|pixel| pixel.color)));
    let mut planes: Vec<_> = color.into_iter().collect();
    planes.push(NORMAL_SUM.triple(0, sums.plane(|pixel| pixel.normal)));
    planes.push(WEIGHT_SUM.scalar(0, sums.plane(|pixel| pixel.weight)));
    planes.push(COUNT.count(0, sums.plane(|pixel| pixel.count)));
    planes
}

/// The margin of attribute splatting.
pub(crate) fn margin<R: Exact>(margins: &Tiled<R>) -> NamedPlane<R> {
    MARGIN.scalar(0, margins.plane(|margin| *margin))
}

/// Somebody's sums; opacities play no part in this method.
pub(crate) fn given_attributes<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Tiled<Sums<R>>> {
    let (normal, weight) = (given.triple(&NORMAL_SUM, 0)?, given.scalar(&WEIGHT_SUM, 0)?);
    let colored = job.scene.surfels.color().is_some();
    let color = colored.then(|| given.triple(&COLOR_SUM, 0)).transpose()?;
    Ok(given.tiled(|x, y| Sums {
        weight: *weight.at(x, y),
        normal: *normal.at(x, y),
        color: color.map_or(Sums::NONE.color, |plane| *plane.at(x, y)),
        ..Sums::NONE
    }))
}
