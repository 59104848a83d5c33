//! The planes of the projection, out and in.

use super::{Has, PixelSample, SampleKind};
use crate::error::{Error, Result};
use crate::frame::{NamedPlane, Plane};
use crate::method::input_planes::InputPlanes;
use crate::method::{Holds, PlaneRow, Stage, When};
use crate::number::{Exact, Real, Vector2, Vector3};

/// The stage, with which several methods begin.
pub const STAGE: Stage = Stage { name: "projection", reads: &[], leaves: &PLANES };

/// The planes of [`PixelSample`]s; where a pixel is empty, those of [`PixelSample::empty`].
pub const PLANES: [PlaneRow; 10] = {
    use Holds::{Color, Count, Index, Scalar, Vector};
    use When::{Colored, Stages, StagesOfTubes};
    [
        PlaneRow::new(
            "projection.id",
            Index,
            "",
            "which, see the ids of the projection; 0xFFFF_FFFF where there is none",
            Stages,
        ),
        PlaneRow::new(
            "projection.kind",
            Count,
            "",
            "0 nothing, 1 surfel, 2 ribbon, 3 tube, 4 triangle: the stencil",
            Stages,
        ),
        PlaneRow::new("projection.Z", Scalar, "world units", "depth t; +inf if empty", Stages),
        PlaneRow::new("projection.normal", Vector, "", "towards the viewer, view space", Stages),
        PlaneRow::new("projection.extent", Scalar, "px", "radius rho", Stages),
        PlaneRow::new("projection.radius", Scalar, "world units", "radius r", Stages),
        PlaneRow::new("projection.center.X", Scalar, "px", "the centre's column", Stages),
        PlaneRow::new("projection.center.Y", Scalar, "px", "the centre's row", Stages),
        PlaneRow::new("projection", Color, "", "colour, linear RGB", Colored),
        PlaneRow::new(
            "projection.tangent",
            Vector,
            "",
            "of a tube, view space; else the null vector",
            StagesOfTubes,
        ),
    ]
};

/// The planes that leave the stage.
pub(crate) fn write<R: Exact>(samples: &Plane<PixelSample<R>>, has: Has) -> Vec<NamedPlane<R>> {
    let [id, kind, depth, normal, extent, radius, left, upper, color, tangent] = &PLANES;
    let scalar = |row: &PlaneRow, of: fn(&PixelSample<R>) -> R| row.scalar(0, samples.map(of));
    let mut planes = vec![
        id.index(0, samples.map(|s| s.id)),
        kind.count(0, samples.map(|s| s.kind as u8)),
        scalar(depth, |s| s.depth),
        normal.triple(0, samples.map(|s| components(s.normal))),
        scalar(extent, |s| s.extent),
        scalar(radius, |s| s.radius),
        scalar(left, |s| s.center.x),
        scalar(upper, |s| s.center.y),
    ];
    planes.extend(has.color.then(|| color.triple(0, samples.map(|s| s.color))));
    planes.extend(has.tangent.then(|| tangent.triple(0, samples.map(|s| components(s.tangent)))));
    planes
}

/// The planes as they come in.
///
/// # Errors
/// [`Error::Invalid`] if a plane is missing, or of another type or size, or if a pixel has a kind
/// that there is not.
pub(crate) fn read<R: Exact>(
    given: &InputPlanes<'_, R>,
    has: Has,
) -> Result<Plane<PixelSample<R>>> {
    let [id, kind, depth, normal, extent, radius, left, upper, color, tangent] = &PLANES;
    let (id, kind) = (given.ids(id, 0)?, kinds(given, kind, 0)?);
    let scalar = |row| given.scalar(row, 0);
    let [depth, extent, radius] = [scalar(depth)?, scalar(extent)?, scalar(radius)?];
    let [left, upper] = [scalar(left)?, scalar(upper)?];
    let normal = given.triple(normal, 0)?;
    let color = given.triple_if(has.color, color, 0)?;
    let tangent = given.triple_if(has.tangent, tangent, 0)?;
    Ok(Plane::from_pixels([id.width(), id.height()], |x, y| PixelSample {
        kind: *kind.at(x, y),
        id: *id.at(x, y),
        depth: *depth.at(x, y),
        radius: *radius.at(x, y),
        extent: *extent.at(x, y),
        center: Vector2::new(*left.at(x, y), *upper.at(x, y)),
        normal: vector(*normal.at(x, y)),
        tangent: vector(triple_at(tangent, x, y)),
        color: triple_at(color, x, y),
    }))
}

/// What each pixel shows.
///
/// # Errors
/// As [`InputPlanes::count`], and if a pixel has a kind that there is not.
pub(crate) fn kinds<R: Exact>(
    given: &InputPlanes<'_, R>,
    row: &PlaneRow,
    number: usize,
) -> Result<Plane<SampleKind>> {
    let counts = given.count(row, number)?;
    let last = SampleKind::ALL.len() - 1;
    if let Some(i) = counts.values().iter().position(|&value| usize::from(value) > last) {
        let (name, value, width) = (row.numbered(number), counts.values()[i], counts.width());
        let (x, y) = (i % width as usize, i / width as usize);
        let what = format!("the plane `{name}` has {value} at ({x}, {y}); at most {last}");
        return Err(Error::Invalid(what));
    }
    Ok(counts.map(|&value| SampleKind::ALL[usize::from(value)]))
}

/// The values of a plane at a pixel; 0 where the scene has no such plane.
pub(crate) fn triple_at<R: Exact>(plane: Option<&Plane<[R; 3]>>, x: u32, y: u32) -> [R; 3] {
    plane.map_or([R::ZERO; 3], |plane| *plane.at(x, y))
}

/// The components of a vector, as planes hold it.
pub(crate) fn components<R: Real>(v: Vector3<R>) -> [R; 3] {
    [v.x, v.y, v.z]
}

/// The vector of these components.
pub(crate) fn vector<R: Real>([x, y, z]: [R; 3]) -> Vector3<R> {
    Vector3::new(x, y, z)
}
