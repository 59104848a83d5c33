//! List the planes that each stage leaves.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture. Outside
//! the level they hold an [empty cell](Cell::empty).

use super::Cell;
use super::gbuffer::GBuffer;
use crate::frame::{NamedPlane, Plane, pyramid};
use crate::method::Job;
use crate::method::PlaneRow;
use crate::method::record::Part::{Direction, Kind, Number, Triple};
use crate::method::record::{self, Field};
use crate::method::stage::Holds::{Color, Count, Depth, Normal, Scalar, Vector};
use crate::method::stage::Keep;
use crate::method::stage::When::{Always, Colored, Lit, StagesOfTubes, Tubes};
use crate::number::Exact;

/// The planes of the [`Cell`]s of a level. `##` is the level.
macro_rules! level {
    ($level:literal) => {
        [
            Field::new(concat!($level, ".kind"), Count, Kind(|p: &mut Self| &mut p.kind))
                .says("0 nothing, 1 surfel, 2 ribbon, 3 tube, 4 triangle"),
            Field::new(concat!($level, ".front"), Scalar, Number(|p: &mut Self| &mut p.front))
                .unit("world units")
                .says("where the interval of depth begins; +inf if empty"),
            Field::new(concat!($level, ".back"), Scalar, Number(|p: &mut Self| &mut p.back))
                .unit("world units")
                .says("where the interval of depth ends; -inf if empty"),
            Field::new(concat!($level, ".extent"), Scalar, Number(|p: &mut Self| &mut p.extent))
                .unit("px")
                .says("radius of the ellipse, in pixels of level 0"),
            Field::new(
                concat!($level, ".displacement.X"),
                Scalar,
                Number(|p: &mut Self| &mut p.displacement.x),
            )
            .unit("px")
            .says("from the cell's centre right to the ellipse's"),
            Field::new(
                concat!($level, ".displacement.Y"),
                Scalar,
                Number(|p: &mut Self| &mut p.displacement.y),
            )
            .unit("px")
            .says("from the cell's centre down to the ellipse's"),
            Field::new(concat!($level, ".normal"), Vector, Direction(|p: &mut Self| &mut p.normal))
                .says("view space, of any length"),
            Field::new($level, Color, Triple(|p: &mut Self| &mut p.color))
                .when(Colored)
                .says("colour"),
            Field::new(
                concat!($level, ".tangent"),
                Vector,
                Direction(|p: &mut Self| &mut p.tangent),
            )
            .when(StagesOfTubes)
            .says("of a tube, view space, of any length; else the null vector"),
        ]
    };
}

/// The planes of the cells of a level.
pub(crate) type CellFields<R> = [Field<Cell<R>, R>; 9];

impl<R> Cell<R> {
    /// The planes of the levels 1 to the last, as the pull phase left them.
    pub(crate) const PULL: CellFields<R> = level!("pull##");
    /// The planes of the levels 0 to the last but one, as the push phase left them. The push does
    /// not change the last level.
    pub(crate) const PUSH: CellFields<R> = level!("push##");
}

pub(crate) const SHADED: PlaneRow = PlaneRow::new("", Color, "the shaded colour").when(Always);
pub(crate) const ALPHA: PlaneRow =
    PlaneRow::new("A", Scalar, "1 where something or the environment is seen, else 0").when(Always);
pub(crate) const DEPTH: PlaneRow = PlaneRow::new("Z", Depth, "depth t; +inf if empty").when(Always);
pub(crate) const NORMAL: PlaneRow =
    PlaneRow::new("normal", Normal, "unit vector in world space; 0 if empty").when(Lit);
pub(crate) const TANGENT: PlaneRow =
    PlaneRow::new("tangent", Vector, "of a tube, unit vector in world space; else 0").when(Tubes);
pub(crate) const KIND: PlaneRow = PlaneRow::new("kind", Count, "as in the levels").when(Always);

/// Makes the planes that a stage leaves for a level, with the size of the picture.
pub(super) fn write_level<R: Exact>(
    fields: &CellFields<R>,
    level: usize,
    cells: &Plane<Cell<R>>,
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let size = job.camera.size();
    let whole = pyramid::in_corner(cells, size, Cell::empty());
    record::planes(fields, level, job.picture(), &|x, y| *whole.at(x, y), &job.there(Keep::Stages))
}

/// Makes the planes of the picture.
pub(super) fn write_picture<R: Exact>(shaded: GBuffer<R>) -> Vec<NamedPlane<R>> {
    let mut planes = vec![
        SHADED.triple(0, shaded.color),
        ALPHA.scalar(0, shaded.alpha),
        DEPTH.scalar(0, shaded.depth),
    ];
    planes.extend(shaded.normal.map(|plane| NORMAL.triple(0, plane)));
    planes.extend(shaded.tangent.map(|plane| TANGENT.triple(0, plane)));
    planes.push(KIND.count(0, shaded.kind));
    planes
}
