//! List the planes that each stage leaves, and read them back from a client.
//!
//! Planes of ids hold the lowest 32 bits of each id. A polygon has no id: its pixel holds
//! `0xFFFF_FFFF` and a depth. The highest 8 bits of ids of 40 bits have planes of their own, beside
//! the planes of the lowest bits, because \[GBP04, 4.2\] has them in the stencil buffer.

use super::indices::Kept;
use super::part::Whole;
use super::visibility::{NONE, Nearest, POLYGON};
use crate::error::{Error, Result};
use crate::frame::{NamedPlane, Plane};
use crate::method::Job;
use crate::method::ewa::attributes::Sums;
use crate::method::input_planes::InputPlanes;
use crate::method::record::Part::{HighId, LowId, Number};
use crate::method::record::{Field, joined, rows};
use crate::method::stage::Holds::{Depth, HighIndex, Index};
use crate::method::stage::When::Wide;
use crate::method::stage::{Keep, PlaneRow, Stage};
use crate::method::surface::{self, SurfacePixel};
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

const fn surfel(name: &'static str, meaning: &'static str) -> PlaneRow {
    PlaneRow::new(name, Index, meaning).unit("surfel")
}

const fn high(name: &'static str) -> PlaneRow {
    let meaning = "the highest 8 bits of that surfel's id; 0 where there is none";
    PlaneRow::new(name, HighIndex, meaning).when(Wide)
}

impl<R> Nearest<R> {
    /// The planes that the first pass of visibility splatting leaves.
    pub(crate) const BEFORE: [Field<Self, R>; 3] = Self::planes([
        PlaneRow::new(
            "visibility.Z",
            Depth,
            "depth of the nearest fragment of polygons and of the surfels whose flags are set; +inf where \
             there is none",
        ),
        surfel("visibility.id", "surfel of that fragment; 0xFFFF_FFFF where there is none"),
        high("visibility.stencil"),
    ]);
    /// The planes that both passes of visibility splatting leave.
    pub(crate) const BOTH: [Field<Self, R>; 3] = Self::planes([
        PlaneRow::new(
            "difference.Z",
            Depth,
            "depth of the nearest fragment of these and of the selected surfels whose flags are not set; \
             +inf where there is none",
        ),
        surfel("difference.id", "surfel of that fragment; 0xFFFF_FFFF where there is none"),
        high("difference.stencil"),
    ]);

    const fn planes([depth, id, high]: [PlaneRow; 3]) -> [Field<Self, R>; 3] {
        [
            depth.at(Number(|pixel| &mut pixel.depth)),
            id.at(LowId(|pixel| &mut pixel.id)),
            high.at(HighId(|pixel| &mut pixel.id)),
        ]
    }
}

impl<R> Kept<R> {
    /// The planes that the pass of indices leaves.
    pub(crate) const PLANES: [Field<Self, R>; 3] = [
        Field::new("indices.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth of the nearest centre in the pixel that passes the test of depth; +inf where there is \
             none"),
        surfel(
            "indices.id",
            "surfel of that centre, which is selected; 0xFFFF_FFFF where there is none",
        )
        .at(LowId(|pixel| &mut pixel.id)),
        high("indices.stencil").at(HighId(|pixel| &mut pixel.id)),
    ];
}

/// The highest bits of the ids that a picture shows.
const fn shown_planes<R>() -> [Field<u64, R>; 1] {
    [high("stencil").at(HighId(|id| id))]
}

/// The stages. Every picture has the planes of the last two stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "visibility", reads: &[], leaves: &rows(&Nearest::<f32>::BEFORE) },
    Stage { name: "indices", reads: &["visibility"], leaves: &rows(&Kept::<f32>::PLANES) },
    Stage {
        name: "difference",
        reads: &["visibility", "indices"],
        leaves: &rows(&Nearest::<f32>::BOTH),
    },
    Stage {
        name: "attributes",
        reads: &["indices", "difference"],
        leaves: &rows(&Sums::<f32>::PLANES),
    },
    Stage {
        name: "normalization",
        reads: &["indices", "difference", "attributes"],
        leaves: joined!(rows(&SurfacePixel::<f32>::PLANES), rows(&shown_planes::<f32>())),
    },
    surface::shading(&["normalization"]),
];

/// The highest bits of the ids that a picture shows, if ids have such bits.
pub(super) fn shown<R: Exact>(job: &Job<'_>, ids: &Tiled<u64>) -> Vec<NamedPlane<R>> {
    ids.planes(&shown_planes(), 0, &job.there(Keep::Stages))
}

/// Reads a client's visibility, of the first pass or of both. Nearness is computed from the
/// client's depth, rounded.
pub(super) fn given_visibility<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
    fields: &[Field<Nearest<R>, R>; 3],
) -> Result<Tiled<Nearest<R>>> {
    let empty = Nearest { nearness: R::ZERO, depth: R::INFINITY, id: NONE };
    let [width, height] = job.camera.size();
    let visible = given.records(fields, 0, Plane::filled(width, height, empty))?;
    check_ids(job, visible.values().iter().map(|pixel| pixel.id), fields)?;
    let view = View::new(job.camera);
    Ok(given.tiled(|x, y| {
        let Nearest { depth, id, .. } = *visible.at(x, y);
        let id = if id == NONE && depth < R::INFINITY { POLYGON } else { id };
        Nearest { nearness: view.nearness(depth), depth, id }
    }))
}

/// Reads the surfels B(i) that a client selected, ascending, each surfel once.
pub(super) fn given_selected<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<u64>> {
    let [_depth, ids @ ..] = &Kept::<R>::PLANES;
    let [width, height] = job.camera.size();
    let kept = given.records(ids, 0, Plane::filled(width, height, Kept::EMPTY))?;
    let mut selected: Vec<u64> = kept.values().iter().map(|pixel| pixel.id).collect();
    check_ids(job, selected.iter().copied(), ids)?;
    selected.retain(|&id| id != NONE);
    selected.sort_unstable();
    selected.dedup();
    Ok(selected)
}

/// Checks that the scene has all ids. Ids of 32 bits were checked when they were read.
fn check_ids<T, R>(
    job: &Job<'_>,
    mut ids: impl Iterator<Item = u64>,
    fields: &[Field<T, R>],
) -> Result<()> {
    let whole = Whole::new(job.scene);
    let is_unknown = |&id: &u64| id != NONE && whole.ids().find(id).is_none();
    match ids.find(is_unknown).filter(|_| whole.ids().is_wide()) {
        Some(id) => {
            let [.., low, high] = fields else { unreachable!("ids have two planes") };
            let planes = format!("the planes `{}` and `{}`", low.row.name, high.row.name);
            Err(Error::Invalid(format!("{planes} have the id {id}; none of the scene's")))
        }
        None => Ok(()),
    }
}
