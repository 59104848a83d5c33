//! The planes of the stages, out and in.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture; outside
//! the level they hold an [empty cell](Cell::empty).

use super::Cell;
use super::gbuffer::GBuffer;
use crate::error::Result;
use crate::frame::{Frame, NamedPlane, Plane, Samples, pyramid};
use crate::method::picture::named;
use crate::method::projection::Has;
use crate::method::projection::planes::{GivenPlanes, components, vector};
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
    size: [u32; 2],
    has: Has,
) -> Vec<NamedPlane<R>> {
    let whole = pyramid::in_corner(cells, size, Cell::empty());
    let names = rows.map(|row| row.numbered(level));
    let [kind, front, back, extent, right, down, normal, color, tangent] = &names;
    let scalar = |name: &str, of: fn(&Cell<R>) -> R| named(name, Samples::Scalar(whole.map(of)));
    let mut planes = vec![
        named(kind, Samples::Count(whole.map(|cell| cell.kind as u8))),
        scalar(front, |cell| cell.front),
        scalar(back, |cell| cell.back),
        scalar(extent, |cell| cell.extent),
        scalar(right, |cell| cell.displacement.x),
        scalar(down, |cell| cell.displacement.y),
        named(normal, Samples::Vector(whole.map(|cell| components(cell.normal)))),
    ];
    if has.color {
        planes.push(named(color, Samples::Color(whole.map(|cell| cell.color))));
    }
    if has.tangent {
        let tangents = whole.map(|cell| components(cell.tangent));
        planes.push(named(tangent, Samples::Vector(tangents)));
    }
    planes
}

/// Whether a frame has a level.
pub(super) fn has_level<R: Exact>(frame: &Frame<R>, rows: &[PlaneRow; 9], level: usize) -> bool {
    frame.plane(&rows[0].numbered(level)).is_some()
}

/// A level as it comes in; `rows` are [`PULL`] or [`PUSH`]. What lies outside the level is not read.
///
/// # Errors
/// [`crate::Error::Invalid`] if a plane is missing, of another type, or not of the size of the
/// frame, or if a cell has a kind that there is not.
///
/// # Panics
/// If a picture of the frame's size has no such level.
pub fn read_level<R: Exact>(
    frame: &Frame<R>,
    rows: &[PlaneRow; 9],
    level: usize,
    has: Has,
) -> Result<Plane<Cell<R>>> {
    let names = rows.map(|row| row.numbered(level));
    let [kind, front, back, extent, right, down, normal, color, tangent] = &names;
    let given = GivenPlanes(frame);
    let kind = given.kinds(kind)?;
    let [front, back, extent] = [given.scalar(front)?, given.scalar(back)?, given.scalar(extent)?];
    let [right, down] = [given.scalar(right)?, given.scalar(down)?];
    let normal = given.vector(normal)?;
    let color = given.color_if(has.color, color)?;
    let tangent = given.vector_if(has.tangent, tangent)?;
    let size = pyramid::sizes(frame.width, frame.height)[level];
    Ok(given.corner(size, |i| Cell {
        kind: kind[i],
        front: front[i],
        back: back[i],
        extent: extent[i],
        displacement: Vector2::new(right[i], down[i]),
        normal: vector(normal[i]),
        tangent: vector(tangent.map_or([R::ZERO; 3], |of| of[i])),
        color: color.map_or([R::ZERO; 3], |of| of[i]),
    }))
}

/// The planes of the picture.
pub(super) fn write_picture<R: Exact>(shaded: GBuffer<R>) -> Vec<NamedPlane<R>> {
    let [color, alpha, depth, normal, tangent, kind] = SHADING.map(|row| row.name);
    let mut planes = vec![
        named(color, Samples::Color(shaded.color)),
        named(alpha, Samples::Scalar(shaded.alpha)),
        named(depth, Samples::Scalar(shaded.depth)),
    ];
    planes.extend(shaded.normal.map(|plane| named(normal, Samples::Vector(plane))));
    planes.extend(shaded.tangent.map(|plane| named(tangent, Samples::Vector(plane))));
    planes.push(named(kind, Samples::Count(shaded.kind)));
    planes
}
