//! The planes of the stages, out and in.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture; outside
//! the level they hold an [empty cell](Center::empty).

use super::Center;
use super::reconstruction::Gathered;
use crate::composite::sum;
use crate::error::Result;
use crate::frame::{Frame, Framebuffer, NO_ID, NamedPlane, Plane, Samples, pyramid};
use crate::method::picture::named;
use crate::method::projection::Has;
use crate::method::projection::planes::{GivenPlanes, components, vector};
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
    size: [u32; 2],
    has: Has,
) -> Vec<NamedPlane<R>> {
    let whole = pyramid::in_corner(cells, size, Center::empty());
    let names = LEVELS.map(|row| row.numbered(level));
    let [id, depth, radius, extent, left, upper, normal, color] = &names;
    let scalar = |name: &str, of: fn(&Center<R>) -> R| named(name, Samples::Scalar(whole.map(of)));
    let mut planes = vec![
        named(id, Samples::Index(whole.map(|cell| cell.id))),
        scalar(depth, |cell| cell.depth),
        scalar(radius, |cell| cell.radius),
        scalar(extent, |cell| cell.extent),
        scalar(left, |cell| cell.center.x),
        scalar(upper, |cell| cell.center.y),
        named(normal, Samples::Vector(whole.map(|cell| components(cell.normal)))),
    ];
    if has.color {
        planes.push(named(color, Samples::Color(whole.map(|cell| cell.color))));
    }
    planes
}

/// Whether a frame has a level.
pub(super) fn has_level<R: Exact>(frame: &Frame<R>, level: usize) -> bool {
    frame.plane(&LEVELS[0].numbered(level)).is_some()
}

/// A level as it comes in. What lies outside the level is not read.
///
/// # Errors
/// [`crate::Error::Invalid`] if a plane is missing, of another type, or not of the size of the
/// frame.
///
/// # Panics
/// If a picture of the frame's size has no such level.
pub fn read_level<R: Exact>(frame: &Frame<R>, level: usize, has: Has) -> Result<Plane<Center<R>>> {
    let names = LEVELS.map(|row| row.numbered(level));
    let [id, depth, radius, extent, left, upper, normal, color] = &names;
    let given = GivenPlanes(frame);
    let id = given.indices(id)?;
    let [depth, radius] = [given.scalar(depth)?, given.scalar(radius)?];
    let [extent, left, upper] = [given.scalar(extent)?, given.scalar(left)?, given.scalar(upper)?];
    let normal = given.vector(normal)?;
    let color = given.color_if(has.color, color)?;
    let size = pyramid::sizes(frame.width, frame.height)[level];
    Ok(given.corner(size, |i| Center {
        id: id[i],
        depth: depth[i],
        radius: radius[i],
        extent: extent[i],
        center: Vector2::new(left[i], upper[i]),
        normal: vector(normal[i]),
        color: color.map_or([R::ZERO; 3], |of| of[i]),
    }))
}

/// The planes that leave the reconstruction, but for the id, which is a plane of the picture.
pub(super) fn write_gathered<R: Exact>(
    pixels: &Plane<Gathered<R>>,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let [count, weight, depths, depth, radius, normal, color, _] = GATHERED.map(|row| row.name);
    let mut planes = vec![
        named(count, Samples::Count(pixels.map(|pixel| pixel.count))),
        named(weight, Samples::Scalar(pixels.map(|pixel| pixel.weight))),
        named(depths, Samples::Scalar(pixels.map(|pixel| pixel.depths))),
        named(depth, Samples::Scalar(pixels.map(|pixel| pixel.depth))),
        named(radius, Samples::Scalar(pixels.map(|pixel| pixel.radius))),
        named(normal, Samples::Vector(pixels.map(|pixel| pixel.normals))),
    ];
    if has.color {
        planes.push(named(color, Samples::Color(pixels.map(|pixel| pixel.colors))));
    }
    planes
}

/// The id of the nearest centre blended.
pub(super) fn write_id<R: Exact>(pixels: &Plane<Gathered<R>>) -> NamedPlane<R> {
    let [.., id] = GATHERED.map(|row| row.name);
    named(id, Samples::Index(pixels.map(|pixel| pixel.id)))
}

/// What was gathered as it comes in.
///
/// # Errors
/// [`crate::Error::Invalid`] if a plane is missing, of another type, or not of the size of the
/// frame.
pub fn read_gathered<R: Exact>(frame: &Frame<R>, has: Has) -> Result<Plane<Gathered<R>>> {
    let [count, weight, depths, depth, radius, normal, color, id] = GATHERED.map(|row| row.name);
    let given = GivenPlanes(frame);
    let (count, id) = (given.counts(count)?, given.indices(id)?);
    let [weight, depths] = [given.scalar(weight)?, given.scalar(depths)?];
    let [depth, radius] = [given.scalar(depth)?, given.scalar(radius)?];
    let normal = given.vector(normal)?;
    let color = given.color_if(has.color, color)?;
    Ok(given.corner([frame.width, frame.height], |i| Gathered {
        id: id[i],
        depth: depth[i],
        radius: radius[i],
        weight: weight[i],
        depths: depths[i],
        normals: normal[i],
        colors: color.map_or([R::ZERO; 3], |of| of[i]),
        count: count[i],
    }))
}

/// The planes that leave the normalization; the colour is shaded before it leaves.
pub(super) fn write_normalized<R: Exact>(target: Framebuffer<R>) -> Vec<NamedPlane<R>> {
    let [depth, normal, weight] = NORMALIZATION.map(|row| row.name);
    let mut planes = vec![named(depth, Samples::Scalar(target.depth))];
    planes.extend(target.normal.map(|plane| named(normal, Samples::Vector(plane))));
    planes.push(named(weight, Samples::Scalar(target.weight)));
    planes
}

/// What the shading reads as it comes in: the planes of the normalization, and the sums of colours.
///
/// # Errors
/// As [`read_gathered`].
pub(super) fn read_normalized<R: Exact>(frame: &Frame<R>, has: Has) -> Result<Framebuffer<R>> {
    let [depth, normal, weight] = NORMALIZATION.map(|row| row.name);
    let [.., colors, _] = GATHERED.map(|row| row.name);
    let given = GivenPlanes(frame);
    let (depth, weight) = (given.scalar(depth)?, given.scalar(weight)?);
    let normal = given.vector(normal)?;
    let colors = given.color_if(has.color, colors)?;
    let (width, height) = (frame.width, frame.height);
    let size = [width, height];
    Ok(Framebuffer {
        width,
        height,
        depth: given.corner(size, |i| depth[i]),
        id: Plane::filled(width, height, NO_ID),
        weight: given.corner(size, |i| weight[i]),
        normal: Some(given.corner(size, |i| normal[i])),
        color: colors.map(|colors| given.corner(size, |i| sum::average(colors[i], weight[i]))),
        stencil: None,
        margin: None,
    })
}
