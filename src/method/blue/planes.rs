//! List the planes that each stage leaves.

use super::discs::Kept;
use crate::frame::{Framebuffer, NamedPlane, Plane, Rect};
use crate::method::Job;
use crate::method::stage::Holds::Scalar;
use crate::method::stage::{PlaneRow, Stage};
use crate::method::surface;
use crate::method::tiled::Tiled;
use crate::number::Exact;

pub(crate) const COLOR: PlaneRow =
    surface::COLOR.says("colour of the nearest fragment, before shading; 0 where there is none");
pub(crate) const OFFSET: PlaneRow = PlaneRow::new(
    "discs.offset",
    Scalar,
    "o, the squared distance of the nearest fragment from the centre of its disc; 0 of a triangle, and where \
     there is none",
)
            .unit("square world units");
pub(crate) const NORMAL: PlaneRow = surface::NORMAL.says(
    "normal of the nearest fragment, towards the viewer, in world space; the null \
     vector where there is none",
);
pub(crate) const WEIGHT: PlaneRow = surface::WEIGHT.says("1 where there is a fragment, else 0");
pub(crate) const ID: PlaneRow = surface::ID.unit("").says(
    "surfel of the nearest fragment, or its triangle, counted on after the surfels; 0xFFFF_FFFF where there \
     is none",
);

/// The stages, see [`mod@crate::method::planes`].
pub(super) const STAGES: &[Stage] = &[
    Stage {
        name: "discs",
        reads: &[],
        leaves: &[COLOR, OFFSET, surface::DEPTH, NORMAL, WEIGHT, ID],
    },
    surface::shading(&["discs"]),
];

/// The planes of the discs that only pictures with stages have.
pub(super) fn stages<R: Exact>(
    job: &Job<'_>,
    kept: &Tiled<Kept<R>>,
    target: &Framebuffer<R>,
) -> Vec<NamedPlane<R>> {
    let surfels = job.scene.surfels.len();
    let Rect { x0, y0, .. } = job.window;
    let offset = |x, y| {
        let triangle = *target.id.at(x - x0, y - y0) as usize >= surfels;
        if triangle { R::ZERO } else { kept.at(x, y).offset }
    };
    let color = target.color.clone().map(|plane| COLOR.triple(0, plane));
    let offset = OFFSET.scalar(0, Plane::of_window(job.window, offset));
    color.into_iter().chain([offset]).collect()
}

/// The planes of the discs that every picture has.
pub(super) fn pixels<R: Exact>(target: Framebuffer<R>) -> Vec<NamedPlane<R>> {
    let Framebuffer { depth, id, weight, normal, .. } = target;
    let mut planes = vec![surface::DEPTH.scalar(0, depth)];
    planes.extend(normal.map(|plane| NORMAL.triple(0, plane)));
    planes.push(WEIGHT.scalar(0, weight));
    planes.push(ID.index(0, id));
    planes
}
