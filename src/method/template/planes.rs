//! The planes of the stages, out and in.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture; outside
//! the level they hold an [empty cell](Center::empty).

use super::Center;
use super::reconstruction::Gathered;
use crate::composite::sum;
use crate::error::Result;
use crate::frame::{Framebuffer, NO_ID, NamedPlane, Plane, pyramid};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::projection::Has;
use crate::method::projection::planes::{components, triple_at, vector};
use crate::method::{Holds, PlaneRow, When};
use crate::number::{Exact, Vector2};

/// The planes of [`Center`]s of the levels 1 to the top; `##` is the level. Level 0 is the planes of
/// the projection.
pub const LEVELS: [PlaneRow; 8] = {
    use Holds::{Color, Index, Scalar, Vector};
    use When::{Colored, Stages};
    [
        PlaneRow::new(
            "level##.id",
            Index,
            "",
            "the surfel, of several that were merged the foremost; 0xFFFF_FFFF if empty",
            Stages,
        ),
        PlaneRow::new("level##.Z", Scalar, "world units", "depth t; +inf if empty", Stages),
        PlaneRow::new("level##.radius", Scalar, "world units", "radius r", Stages),
        PlaneRow::new("level##.extent", Scalar, "px", "radius rho", Stages),
        PlaneRow::new("level##.center.X", Scalar, "px", "the centre's column", Stages),
        PlaneRow::new("level##.center.Y", Scalar, "px", "the centre's row", Stages),
        PlaneRow::new("level##.normal", Vector, "", "view space, of any length", Stages),
        PlaneRow::new("level##", Color, "", "colour, linear RGB", Colored),
    ]
};

/// The planes of [`Gathered`] pixels.
pub const GATHERED: [PlaneRow; 8] = {
    use Holds::{Color, Count, Index, Scalar, Vector};
    use When::{Always, Colored, Stages};
    [
        PlaneRow::new("gathered.count", Count, "", "centres in the sums, up to 255", Stages),
        PlaneRow::new("gathered.weight", Scalar, "", "sum of the weights", Stages),
        PlaneRow::new("gathered.depths", Scalar, "world units", "weighted sum of depths", Stages),
        PlaneRow::new(
            "gathered.Z",
            Scalar,
            "world units",
            "depth of the nearest centre blended; +inf if there is none",
            Stages,
        ),
        PlaneRow::new(
            "gathered.radius",
            Scalar,
            "world units",
            "radius r of the nearest centre blended",
            Stages,
        ),
        PlaneRow::new("gathered.normal", Vector, "", "weighted sum of normals, view space", Stages),
        PlaneRow::new("gathered", Color, "", "weighted sum of colours", Colored),
        PlaneRow::new(
            "id",
            Index,
            "",
            "the surfel of the nearest centre blended; 0xFFFF_FFFF if there is none",
            Always,
        ),
    ]
};

/// The planes of the picture that the normalization leaves.
pub const NORMALIZATION: [PlaneRow; 3] = [
    PlaneRow::new(
        "Z",
        Holds::Scalar,
        "world units",
        "average depth; +inf if nothing was gathered",
        When::Always,
    ),
    PlaneRow::new(
        "normal",
        Holds::Vector,
        "",
        "direction of the average normal, world space; 0 if empty",
        When::Lit,
    ),
    PlaneRow::new("weight", Holds::Scalar, "", "sum of the weights; 0 if empty", When::Always),
];

/// The planes of the picture that the shading leaves.
pub const SHADING: [PlaneRow; 2] = [
    PlaneRow::new("", Holds::Color, "", "the shaded colour, linear RGB", When::Always),
    PlaneRow::new(
        "A",
        Holds::Scalar,
        "",
        "1 where a surfel or the environment is seen, else 0",
        When::Always,
    ),
];

/// The planes of a level that leave the propagation, of the size of the picture.
pub(super) fn write_level<R: Exact>(
    level: usize,
    cells: &Plane<Center<R>>,
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let whole = pyramid::in_corner(cells, job.camera.size(), Center::empty());
    let [id, depth, radius, extent, left, upper, normal, color] = &LEVELS;
    let scalar = |row: &PlaneRow, of: fn(&Center<R>) -> R| row.scalar(level, whole.map(of));
    let mut planes = vec![
        id.index(level, whole.map(|cell| cell.id)),
        scalar(depth, |cell| cell.depth),
        scalar(radius, |cell| cell.radius),
        scalar(extent, |cell| cell.extent),
        scalar(left, |cell| cell.center.x),
        scalar(upper, |cell| cell.center.y),
        normal.triple(level, whole.map(|cell| components(cell.normal))),
    ];
    let colors = || color.triple(level, whole.map(|cell| cell.color));
    planes.extend(Has::of(job.scene).color.then(colors));
    planes
}

/// A level as it comes in, of which `size` is the size. What lies outside the level is not read.
///
/// # Errors
/// [`crate::Error::Invalid`] if a plane is missing, or of another type or size, or if the scene has
/// no surfel of an id.
pub(super) fn read_level<R: Exact>(
    given: &InputPlanes<'_, R>,
    level: usize,
    size: [u32; 2],
    has: Has,
) -> Result<Plane<Center<R>>> {
    let [id, depth, radius, extent, left, upper, normal, color] = &LEVELS;
    let id = given.ids(id, level)?;
    let scalar = |row| given.scalar(row, level);
    let [depth, radius, extent] = [scalar(depth)?, scalar(radius)?, scalar(extent)?];
    let [left, upper] = [scalar(left)?, scalar(upper)?];
    let normal = given.triple(normal, level)?;
    let color = given.triple_if(has.color, color, level)?;
    Ok(Plane::from_pixels(size, |x, y| Center {
        id: *id.at(x, y),
        depth: *depth.at(x, y),
        radius: *radius.at(x, y),
        extent: *extent.at(x, y),
        center: Vector2::new(*left.at(x, y), *upper.at(x, y)),
        normal: vector(*normal.at(x, y)),
        color: triple_at(color, x, y),
    }))
}

/// The planes that leave the reconstruction, but for the id, which is a plane of the picture.
pub(super) fn write_gathered<R: Exact>(
    pixels: &Plane<Gathered<R>>,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let [count, weight, depths, depth, radius, normal, color, _] = &GATHERED;
    let scalar = |row: &PlaneRow, of: fn(&Gathered<R>) -> R| row.scalar(0, pixels.map(of));
    let mut planes = vec![
        count.count(0, pixels.map(|pixel| pixel.count)),
        scalar(weight, |pixel| pixel.weight),
        scalar(depths, |pixel| pixel.depths),
        scalar(depth, |pixel| pixel.depth),
        scalar(radius, |pixel| pixel.radius),
        normal.triple(0, pixels.map(|pixel| pixel.normals)),
    ];
    planes.extend(has.color.then(|| color.triple(0, pixels.map(|pixel| pixel.colors))));
    planes
}

/// The id of the nearest centre blended.
pub(super) fn write_id<R: Exact>(pixels: &Plane<Gathered<R>>) -> NamedPlane<R> {
    let [.., id] = &GATHERED;
    id.index(0, pixels.map(|pixel| pixel.id))
}

/// What was gathered as it comes in.
///
/// # Errors
/// As [`read_level`].
pub(super) fn read_gathered<R: Exact>(
    given: &InputPlanes<'_, R>,
    has: Has,
) -> Result<Plane<Gathered<R>>> {
    let [count, weight, depths, depth, radius, normal, color, id] = &GATHERED;
    let (count, id) = (given.count(count, 0)?, given.ids(id, 0)?);
    let scalar = |row| given.scalar(row, 0);
    let [weight, depths] = [scalar(weight)?, scalar(depths)?];
    let [depth, radius] = [scalar(depth)?, scalar(radius)?];
    let normal = given.triple(normal, 0)?;
    let color = given.triple_if(has.color, color, 0)?;
    Ok(Plane::from_pixels([id.width(), id.height()], |x, y| Gathered {
        id: *id.at(x, y),
        depth: *depth.at(x, y),
        radius: *radius.at(x, y),
        weight: *weight.at(x, y),
        depths: *depths.at(x, y),
        normals: *normal.at(x, y),
        colors: triple_at(color, x, y),
        count: *count.at(x, y),
    }))
}

/// The planes that leave the normalization; the colour is shaded before it leaves.
pub(super) fn write_normalized<R: Exact>(target: Framebuffer<R>) -> Vec<NamedPlane<R>> {
    let [depth, normal, weight] = &NORMALIZATION;
    let mut planes = vec![depth.scalar(0, target.depth)];
    planes.extend(target.normal.map(|plane| normal.triple(0, plane)));
    planes.push(weight.scalar(0, target.weight));
    planes
}

/// What the shading reads as it comes in: the planes of the normalization, and the sums of colours.
///
/// # Errors
/// As [`read_level`].
pub(super) fn read_normalized<R: Exact>(
    given: &InputPlanes<'_, R>,
    has: Has,
) -> Result<Framebuffer<R>> {
    let [depth, normal, weight] = &NORMALIZATION;
    let [.., colors, _] = &GATHERED;
    let (depth, weight) = (given.scalar(depth, 0)?, given.scalar(weight, 0)?);
    let normal = given.triple(normal, 0)?;
    let colors = given.triple_if(has.color, colors, 0)?;
    let size = [depth.width(), depth.height()];
    let average = |colors: &Plane<[R; 3]>| {
        Plane::from_pixels(size, |x, y| sum::average(*colors.at(x, y), *weight.at(x, y)))
    };
    Ok(Framebuffer {
        width: size[0],
        height: size[1],
        depth: depth.clone(),
        id: Plane::filled(size[0], size[1], NO_ID),
        weight: weight.clone(),
        normal: Some(normal.clone()),
        color: colors.map(average),
        stencil: None,
        margin: None,
    })
}
