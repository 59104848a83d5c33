//! The planes of the stages, out and in.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture; outside
//! the level they hold an [empty cell](Cell::empty).

use super::Cell;
use super::gbuffer::GBuffer;
use crate::error::Result;
use crate::frame::{NamedPlane, Plane, pyramid};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::projection::Has;
use crate::method::projection::planes::{components, kinds, triple_at, vector};
use crate::method::{Holds, PlaneRow, When};
use crate::number::{Exact, Vector2};

/// The planes of [`Cell`]s of a level: `##` is the level.
macro_rules! level {
    ($level:literal) => {{
        use Holds::{Color, Count, Scalar, Vector};
        use When::{Colored, Stages, StagesOfTubes};
        [
            PlaneRow::new(
                concat!($level, ".kind"),
                Count,
                "",
                "0 nothing, 1 surfel, 2 ribbon, 3 tube, 4 triangle",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".front"),
                Scalar,
                "world units",
                "where the interval of depth begins; +inf if empty",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".back"),
                Scalar,
                "world units",
                "where the interval of depth ends; -inf if empty",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".extent"),
                Scalar,
                "px",
                "radius of the ellipse, in pixels of level 0",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".displacement.X"),
                Scalar,
                "px",
                "from the cell's centre right to the ellipse's",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".displacement.Y"),
                Scalar,
                "px",
                "from the cell's centre down to the ellipse's",
                Stages,
            ),
            PlaneRow::new(
                concat!($level, ".normal"),
                Vector,
                "",
                "view space, of any length",
                Stages,
            ),
            PlaneRow::new($level, Color, "", "colour, linear RGB", Colored),
            PlaneRow::new(
                concat!($level, ".tangent"),
                Vector,
                "",
                "of a tube, view space, of any length; else the null vector",
                StagesOfTubes,
            ),
        ]
    }};
}

/// The planes of the levels 1 to the last as the pull phase left them.
pub const PULL: [PlaneRow; 9] = level!("pull##");
/// The planes of the levels 0 to the last but one as the push phase left them; the push leaves the
/// last as it is.
pub const PUSH: [PlaneRow; 9] = level!("push##");
/// The planes of the picture.
pub const SHADING: [PlaneRow; 6] = [
    PlaneRow::new("", Holds::Color, "", "the shaded colour, linear RGB", When::Always),
    PlaneRow::new(
        "A",
        Holds::Scalar,
        "",
        "1 where something or the environment is seen, else 0",
        When::Always,
    ),
    PlaneRow::new("Z", Holds::Scalar, "world units", "depth t; +inf if empty", When::Always),
    PlaneRow::new("normal", Holds::Vector, "", "unit vector in world space; 0 if empty", When::Lit),
    PlaneRow::new(
        "tangent",
        Holds::Vector,
        "",
        "of a tube, unit vector in world space; else 0",
        When::Tubes,
    ),
    PlaneRow::new("kind", Holds::Count, "", "as in the levels", When::Always),
];

/// The planes of a level that leave a stage, of the size of the picture.
pub(super) fn write_level<R: Exact>(
    rows: &[PlaneRow; 9],
    level: usize,
    cells: &Plane<Cell<R>>,
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let has = Has::of(job.scene);
    let whole = pyramid::in_corner(cells, job.camera.size(), Cell::empty());
    let [kind, front, back, extent, right, down, normal, color, tangent] = rows;
    let scalar = |row: &PlaneRow, of: fn(&Cell<R>) -> R| row.scalar(level, whole.map(of));
    let mut planes = vec![
        kind.count(level, whole.map(|cell| cell.kind as u8)),
        scalar(front, |cell| cell.front),
        scalar(back, |cell| cell.back),
        scalar(extent, |cell| cell.extent),
        scalar(right, |cell| cell.displacement.x),
        scalar(down, |cell| cell.displacement.y),
        normal.triple(level, whole.map(|cell| components(cell.normal))),
    ];
    planes.extend(has.color.then(|| color.triple(level, whole.map(|cell| cell.color))));
    let tangents = || tangent.triple(level, whole.map(|cell| components(cell.tangent)));
    planes.extend(has.tangent.then(tangents));
    planes
}

/// A level as it comes in; `rows` are [`PULL`] or [`PUSH`], and `size` is that of the level. What
/// lies outside the level is not read.
///
/// # Errors
/// [`crate::Error::Invalid`] if a plane is missing, or of another type or size, or if a cell has a
/// kind that there is not.
pub(super) fn read_level<R: Exact>(
    given: &InputPlanes<'_, R>,
    rows: &[PlaneRow; 9],
    level: usize,
    size: [u32; 2],
    has: Has,
) -> Result<Plane<Cell<R>>> {
    let [kind, front, back, extent, right, down, normal, color, tangent] = rows;
    let kind = kinds(given, kind, level)?;
    let scalar = |row| given.scalar(row, level);
    let [front, back, extent] = [scalar(front)?, scalar(back)?, scalar(extent)?];
    let [right, down] = [scalar(right)?, scalar(down)?];
    let normal = given.triple(normal, level)?;
    let color = given.triple_if(has.color, color, level)?;
    let tangent = given.triple_if(has.tangent, tangent, level)?;
    Ok(Plane::from_pixels(size, |x, y| Cell {
        kind: *kind.at(x, y),
        front: *front.at(x, y),
        back: *back.at(x, y),
        extent: *extent.at(x, y),
        displacement: Vector2::new(*right.at(x, y), *down.at(x, y)),
        normal: vector(*normal.at(x, y)),
        tangent: vector(triple_at(tangent, x, y)),
        color: triple_at(color, x, y),
    }))
}

/// The planes of the picture.
pub(super) fn write_picture<R: Exact>(shaded: GBuffer<R>) -> Vec<NamedPlane<R>> {
    let [color, alpha, depth, normal, tangent, kind] = &SHADING;
    let mut planes = vec![
        color.triple(0, shaded.color),
        alpha.scalar(0, shaded.alpha),
        depth.scalar(0, shaded.depth),
    ];
    planes.extend(shaded.normal.map(|plane| normal.triple(0, plane)));
    planes.extend(shaded.tangent.map(|plane| tangent.triple(0, plane)));
    planes.push(kind.count(0, shaded.kind));
    planes
}
