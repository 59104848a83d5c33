//! The planes of the stages: where they leave, and where they come in.
//!
//! Planes of ids hold the lowest 32 bits of each; a polygon has none, and is `0xFFFF_FFFF` with a depth.

use super::indices::Kept;
use super::visibility::{NONE, Nearest, POLYGON};
use crate::error::{Error, Result};
use crate::frame::{NO_ID, NamedPlane, Plane};
use crate::method::algorithm::Job;
use crate::method::ewa::planes::{COLOR_SUM, COUNT, NORMAL_SUM, WEIGHT_SUM};
use crate::method::given::Given;
use crate::method::resolved;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

pub(super) const BEFORE: PlaneRow = PlaneRow::new(
    "visibility.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest fragment of polygons and of the surfels whose flags are set; +inf where there \
     is none",
    When::Stages,
);
pub(super) const BEFORE_ID: PlaneRow = PlaneRow::new(
    "visibility.id",
    Holds::Index,
    "surfel",
    "surfel of that fragment; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(super) const CENTRE: PlaneRow = PlaneRow::new(
    "indices.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest centre in the pixel that passes the test of depth; +inf where there is none",
    When::Stages,
);
pub(super) const CENTRE_ID: PlaneRow = PlaneRow::new(
    "indices.id",
    Holds::Index,
    "surfel",
    "surfel of that centre, which is selected; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(super) const NEAREST: PlaneRow = PlaneRow::new(
    "difference.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest fragment of these and of the selected surfels whose flags are not set; \
     +inf where there is none",
    When::Stages,
);
pub(super) const NEAREST_ID: PlaneRow = PlaneRow::new(
    "difference.id",
    Holds::Index,
    "surfel",
    "surfel of that fragment; 0xFFFF_FFFF where there is none",
    When::Stages,
);

/// The stages; the planes of the last two are those of every picture.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "visibility", reads: &[], leaves: &[BEFORE, BEFORE_ID] },
    Stage { name: "indices", reads: &["visibility"], leaves: &[CENTRE, CENTRE_ID] },
    Stage { name: "difference", reads: &["visibility", "indices"], leaves: &[NEAREST, NEAREST_ID] },
    Stage {
        name: "attributes",
        reads: &["indices", "difference"],
        leaves: &[COLOR_SUM, NORMAL_SUM, WEIGHT_SUM, COUNT],
    },
    Stage {
        name: "normalization",
        reads: &["indices", "difference", "attributes"],
        leaves: &[
            resolved::COLOR,
            resolved::DEPTH,
            resolved::NORMAL,
            resolved::WEIGHT,
            resolved::ID,
        ],
    },
    resolved::shading(&["normalization"]),
];

/// What a pass of visibility splatting leaves: the first, or both.
pub(super) fn visibility<R: Exact>(visible: &Tiled<Nearest<R>>, both: bool) -> [NamedPlane<R>; 2] {
    let [depth, id] = rows(both);
    [
        depth.scalar(0, visible.plane(|pixel| pixel.depth)),
        id.index(0, visible.plane(|pixel| pixel.id as u32)),
    ]
}

fn rows(both: bool) -> [PlaneRow; 2] {
    if both { [NEAREST, NEAREST_ID] } else { [BEFORE, BEFORE_ID] }
}

/// Somebody's visibility; nearness is that of the depth, rounded.
pub(super) fn given_visibility<R: Exact>(
    job: &Job<'_>,
    given: &Given<'_, R>,
    both: bool,
) -> Result<Tiled<Nearest<R>>> {
    let [depth, id] = rows(both);
    let (depth, id) = (given.scalar(&depth, 0)?, ids(job, given, &id)?);
    let view = View::new(job.camera);
    Ok(given.tiled(|x, y| {
        let depth = *depth.at(x, y);
        let id = match widened(*id.at(x, y)) {
            NONE if depth < R::INFINITY => POLYGON,
            id => id,
        };
        Nearest { nearness: view.nearness(depth), depth, id }
    }))
}

/// What the pass of indices leaves.
pub(super) fn indices<R: Exact>(kept: &Tiled<Kept<R>>) -> [NamedPlane<R>; 2] {
    [
        CENTRE.scalar(0, kept.plane(|pixel| pixel.depth)),
        CENTRE_ID.index(0, kept.plane(|pixel| pixel.id as u32)),
    ]
}

/// B(i) as somebody selected it, ascending, each surfel once.
pub(super) fn given_selected<R: Exact>(job: &Job<'_>, given: &Given<'_, R>) -> Result<Vec<u64>> {
    let ids = ids(job, given, &CENTRE_ID)?.values().iter().map(|&id| widened(id));
    let mut selected: Vec<u64> = ids.filter(|&id| id != NONE).collect();
    selected.sort_unstable();
    selected.dedup();
    Ok(selected)
}

/// A plane of ids, if 32 bits say all of them.
fn ids<'a, R: Exact>(
    job: &Job<'_>,
    given: &Given<'a, R>,
    row: &PlaneRow,
) -> Result<&'a Plane<u32>> {
    if super::part::Whole::new(job.scene).ids().is_wide() {
        let what = "ids of 40 bits: planes of ids hold 32 of them, from which no stage can be run";
        return Err(Error::Invalid(what.into()));
    }
    given.ids(row, 0)
}

fn widened(id: u32) -> u64 {
    if id == NO_ID { NONE } else { u64::from(id) }
}
