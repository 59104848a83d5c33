//! The planes of the stages: where they leave, and where they come in.
//!
//! Planes of ids hold the lowest 32 bits of each; a polygon has none, and is `0xFFFF_FFFF` with a depth. Of
//! ids of 40 bits the highest 8 have planes of their own, beside those of the others, as \[GBP04, 4.2\] has
//! them in the stencil buffer.

use super::indices::Kept;
use super::part::Whole;
use super::visibility::{NONE, Nearest, POLYGON};
use crate::error::{Error, Result};
use crate::frame::{NO_ID, NamedPlane, Plane};
use crate::method::Job;
use crate::method::ewa::planes::{COLOR_SUM, COUNT, NORMAL_SUM, WEIGHT_SUM};
use crate::method::input_planes::InputPlanes;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

pub(crate) const BEFORE: PlaneRow = PlaneRow::new(
    "visibility.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest fragment of polygons and of the surfels whose flags are set; +inf where there \
     is none",
    When::Stages,
);
pub(crate) const BEFORE_ID: PlaneRow = PlaneRow::new(
    "visibility.id",
    Holds::Index,
    "surfel",
    "surfel of that fragment; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(crate) const CENTRE: PlaneRow = PlaneRow::new(
    "indices.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest centre in the pixel that passes the test of depth; +inf where there is none",
    When::Stages,
);
pub(crate) const CENTRE_ID: PlaneRow = PlaneRow::new(
    "indices.id",
    Holds::Index,
    "surfel",
    "surfel of that centre, which is selected; 0xFFFF_FFFF where there is none",
    When::Stages,
);
pub(crate) const NEAREST: PlaneRow = PlaneRow::new(
    "difference.Z",
    Holds::Scalar,
    "world units",
    "depth of the nearest fragment of these and of the selected surfels whose flags are not set; \
     +inf where there is none",
    When::Stages,
);
pub(crate) const NEAREST_ID: PlaneRow = PlaneRow::new(
    "difference.id",
    Holds::Index,
    "surfel",
    "surfel of that fragment; 0xFFFF_FFFF where there is none",
    When::Stages,
);

const HIGH: &str = "the highest 8 bits of that surfel's id; 0 where there is none";

pub(super) const BEFORE_HIGH: PlaneRow =
    PlaneRow::new("visibility.stencil", Holds::Count, "", HIGH, When::Wide);
pub(super) const CENTRE_HIGH: PlaneRow =
    PlaneRow::new("indices.stencil", Holds::Count, "", HIGH, When::Wide);
pub(super) const NEAREST_HIGH: PlaneRow =
    PlaneRow::new("difference.stencil", Holds::Count, "", HIGH, When::Wide);
pub(super) const SHOWN_HIGH: PlaneRow =
    PlaneRow::new("stencil", Holds::Count, "", HIGH, When::Wide);

/// The stages; the planes of the last two are those of every picture.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "visibility", reads: &[], leaves: &[BEFORE, BEFORE_ID, BEFORE_HIGH] },
    Stage { name: "indices", reads: &["visibility"], leaves: &[CENTRE, CENTRE_ID, CENTRE_HIGH] },
    Stage {
        name: "difference",
        reads: &["visibility", "indices"],
        leaves: &[NEAREST, NEAREST_ID, NEAREST_HIGH],
    },
    Stage {
        name: "attributes",
        reads: &["indices", "difference"],
        leaves: &[COLOR_SUM, NORMAL_SUM, WEIGHT_SUM, COUNT],
    },
    Stage {
        name: "normalization",
        reads: &["indices", "difference", "attributes"],
        leaves: &[
            surface::COLOR,
            surface::DEPTH,
            surface::NORMAL,
            surface::WEIGHT,
            surface::ID,
            SHOWN_HIGH,
        ],
    },
    surface::shading(&["normalization"]),
];

/// What a pass of visibility splatting leaves: the first, or both.
pub(super) fn visibility<R: Exact>(
    job: &Job<'_>,
    visible: &Tiled<Nearest<R>>,
    both: bool,
) -> Vec<NamedPlane<R>> {
    let [depth, id, stencil] = rows(both);
    let mut planes = vec![
        depth.scalar(0, visible.plane(|pixel| pixel.depth)),
        id.index(0, visible.plane(|pixel| pixel.id as u32)),
    ];
    if is_wide(job) {
        planes.push(stencil.count(0, visible.plane(|pixel| high(pixel.id))));
    }
    planes
}

fn rows(both: bool) -> [PlaneRow; 3] {
    if both { [NEAREST, NEAREST_ID, NEAREST_HIGH] } else { [BEFORE, BEFORE_ID, BEFORE_HIGH] }
}

/// The highest bits of the ids that a picture shows, if there are any.
pub(super) fn shown<R: Exact>(job: &Job<'_>, ids: &Tiled<u64>) -> Option<NamedPlane<R>> {
    is_wide(job).then(|| SHOWN_HIGH.count(0, ids.plane(|&id| high(id))))
}

/// Whether ids have more than 32 bits.
fn is_wide(job: &Job<'_>) -> bool {
    Whole::new(job.scene).ids().is_wide()
}

/// The bits of an id above the lowest 32.
fn high(id: u64) -> u8 {
    if id as u32 == NO_ID { 0 } else { (id >> 32) as u8 }
}

/// Somebody's visibility; nearness is that of the depth, rounded.
pub(super) fn given_visibility<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
    both: bool,
) -> Result<Tiled<Nearest<R>>> {
    let [depth, id, stencil] = rows(both);
    let (depth, id) = (given.scalar(&depth, 0)?, ids(job, given, [&id, &stencil])?);
    let view = View::new(job.camera);
    Ok(given.tiled(|x, y| {
        let depth = *depth.at(x, y);
        let id = match id.at(x, y) {
            NONE if depth < R::INFINITY => POLYGON,
            id => id,
        };
        Nearest { nearness: view.nearness(depth), depth, id }
    }))
}

/// What the pass of indices leaves.
pub(super) fn indices<R: Exact>(job: &Job<'_>, kept: &Tiled<Kept<R>>) -> Vec<NamedPlane<R>> {
    let mut planes = vec![
        CENTRE.scalar(0, kept.plane(|pixel| pixel.depth)),
        CENTRE_ID.index(0, kept.plane(|pixel| pixel.id as u32)),
    ];
    if is_wide(job) {
        planes.push(CENTRE_HIGH.count(0, kept.plane(|pixel| high(pixel.id))));
    }
    planes
}

/// B(i) as somebody selected it, ascending, each surfel once.
pub(super) fn given_selected<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<u64>> {
    let mut selected: Vec<u64> = ids(job, given, [&CENTRE_ID, &CENTRE_HIGH])?.all();
    selected.retain(|&id| id != NONE);
    selected.sort_unstable();
    selected.dedup();
    Ok(selected)
}

/// Somebody's ids.
struct GivenIds<'a> {
    low: &'a Plane<u32>,
    /// The highest bits, if there are any.
    high: Option<&'a Plane<u8>>,
}

impl GivenIds<'_> {
    fn at(&self, x: u32, y: u32) -> u64 {
        let high = self.high.map_or(0, |high| *high.at(x, y));
        widened(*self.low.at(x, y), high)
    }

    /// Those of all pixels.
    fn all(&self) -> Vec<u64> {
        let low = self.low.values().iter();
        match self.high {
            Some(high) => low.zip(high.values()).map(|(&id, &high)| widened(id, high)).collect(),
            None => low.map(|&id| widened(id, 0)).collect(),
        }
    }
}

/// The planes of ids, with their highest bits if 32 do not say all of them.
fn ids<'a, R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'a, R>,
    [id, stencil]: [&PlaneRow; 2],
) -> Result<GivenIds<'a>> {
    let whole = Whole::new(job.scene);
    let low = given.ids(id, 0)?;
    if !whole.ids().is_wide() {
        return Ok(GivenIds { low, high: None });
    }
    let found = GivenIds { low, high: Some(given.count(stencil, 0)?) };
    let name = id.name;
    let unknown = |&id: &u64| id != NONE && whole.ids().find(id).is_none();
    match found.all().into_iter().find(unknown) {
        Some(id) => {
            let planes = format!("the planes `{name}` and `{}`", stencil.name);
            Err(Error::Invalid(format!("{planes} have the id {id}; none of the scene's")))
        }
        None => Ok(found),
    }
}

fn widened(id: u32, high: u8) -> u64 {
    if id == NO_ID { NONE } else { u64::from(high) << 32 | u64::from(id) }
}
