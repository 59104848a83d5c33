//! List the planes that each stage leaves, and read them back from a client.
//!
//! A level lies in the upper left corner of its planes, which have the size of the picture. Outside
//! the level they hold an [empty cell](Center::empty).

use super::Center;
use super::reconstruction::Gathered;
use crate::composite::sum;
use crate::error::Result;
use crate::frame::{Framebuffer, NO_ID, NamedPlane, Plane, pyramid};
use crate::method::Job;
use crate::method::PlaneRow;
use crate::method::input_planes::InputPlanes;
use crate::method::projection::Has;
use crate::method::record::Part::{Count, Direction, Id, Number, Triple};
use crate::method::record::{self, Field};
use crate::method::stage::Holds::{self, Color, Depth, Index, Normal, Scalar, Vector};
use crate::method::stage::Keep;
use crate::method::stage::When::{Always, Colored, Lit};
use crate::number::Exact;

impl<R> Center<R> {
    /// The planes of the levels 1 to the top. `##` is the level. The planes of level 0 are the
    /// planes of the projection.
    pub(crate) const PLANES: [Field<Self, R>; 8] = [
        Field::new("level##.id", Index, Id(|p: &mut Self| &mut p.id))
            .says("the surfel, of several that were merged the foremost; 0xFFFF_FFFF if empty"),
        Field::new("level##.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth t; +inf if empty"),
        Field::new("level##.radius", Scalar, Number(|p: &mut Self| &mut p.radius))
            .unit("world units")
            .says("radius r"),
        Field::new("level##.extent", Scalar, Number(|p: &mut Self| &mut p.extent))
            .unit("px")
            .says("radius rho"),
        Field::new("level##.center.X", Scalar, Number(|p: &mut Self| &mut p.center.x))
            .unit("px")
            .says("the centre's column"),
        Field::new("level##.center.Y", Scalar, Number(|p: &mut Self| &mut p.center.y))
            .unit("px")
            .says("the centre's row"),
        Field::new("level##.normal", Vector, Direction(|p: &mut Self| &mut p.normal))
            .says("view space, of any length"),
        Field::new("level##", Color, Triple(|p: &mut Self| &mut p.color))
            .when(Colored)
            .says("colour"),
    ];
}

impl<R> Gathered<R> {
    pub(crate) const WEIGHT: Field<Self, R> =
        Field::new("gathered.weight", Scalar, Number(|p: &mut Self| &mut p.weight))
            .says("sum of the weights");
    pub(crate) const DEPTHS: Field<Self, R> =
        Field::new("gathered.depths", Scalar, Number(|p: &mut Self| &mut p.depths))
            .unit("world units")
            .says("weighted sum of depths");
    pub(crate) const NORMALS: Field<Self, R> =
        Field::new("gathered.normal", Vector, Triple(|p: &mut Self| &mut p.normals))
            .says("weighted sum of normals, view space");
    const COLORS: Field<Self, R> =
        Field::new("gathered", Color, Triple(|p: &mut Self| &mut p.colors))
            .when(Colored)
            .says("weighted sum of colours");

    /// The planes that the reconstruction leaves. The last, the id, is a plane of the picture.
    pub(crate) const PLANES: [Field<Self, R>; 8] = [
        Field::new("gathered.count", Holds::Count, Count(|p: &mut Self| &mut p.count))
            .says("centres in the sums, up to 255"),
        Self::WEIGHT,
        Self::DEPTHS,
        Field::new("gathered.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth of the nearest centre blended; +inf if there is none"),
        Field::new("gathered.radius", Scalar, Number(|p: &mut Self| &mut p.radius))
            .unit("world units")
            .says("radius r of the nearest centre blended"),
        Self::NORMALS,
        Self::COLORS,
        Field::new("id", Index, Id(|p: &mut Self| &mut p.id))
            .when(Always)
            .says("the surfel of the nearest centre blended; 0xFFFF_FFFF if there is none"),
    ];
}

pub(crate) const DEPTH: PlaneRow =
    PlaneRow::new("Z", Depth, "average depth; +inf if nothing was gathered").when(Always);
pub(crate) const NORMAL: PlaneRow =
    PlaneRow::new("normal", Normal, "direction of the average normal, world space; 0 if empty")
        .when(Lit);
pub(crate) const WEIGHT: PlaneRow =
    PlaneRow::new("weight", Scalar, "sum of the weights; 0 if empty").when(Always);

pub(crate) const SHADED: PlaneRow = PlaneRow::new("", Color, "the shaded colour").when(Always);
pub(crate) const ALPHA: PlaneRow =
    PlaneRow::new("A", Scalar, "1 where a surfel or the environment is seen, else 0").when(Always);

/// Makes the planes that the propagation leaves for a level, with the size of the picture.
pub(super) fn write_level<R: Exact>(
    level: usize,
    cells: &Plane<Center<R>>,
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let size = job.camera.size();
    let whole = pyramid::in_corner(cells, size, Center::empty());
    let there = job.there(Keep::Stages);
    record::planes(&Center::PLANES, level, job.picture(), &|x, y| *whole.at(x, y), &there)
}

/// Makes the planes that the reconstruction leaves.
pub(super) fn write_gathered<R: Exact>(
    pixels: &Plane<Gathered<R>>,
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let at = |x, y| *pixels.at(x, y);
    record::planes(&Gathered::PLANES, 0, job.picture(), &at, &job.there(Keep::Stages))
}

/// Reads the planes that the reconstruction left.
///
/// # Errors
/// As [`InputPlanes::records`].
pub(super) fn read_gathered<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Plane<Gathered<R>>> {
    let [width, height] = job.camera.size();
    given.records(&Gathered::PLANES, 0, Plane::filled(width, height, Gathered::empty()))
}

/// Makes the planes that the normalization leaves. The colour is shaded before it leaves.
pub(super) fn write_normalized<R: Exact>(target: Framebuffer<R>) -> Vec<NamedPlane<R>> {
    let mut planes = vec![DEPTH.scalar(0, target.depth)];
    planes.extend(target.normal.map(|plane| NORMAL.triple(0, plane)));
    planes.push(WEIGHT.scalar(0, target.weight));
    planes
}

/// Reads the planes for the shading: the planes of the normalization, and the sums of colours.
///
/// # Errors
/// As [`InputPlanes::records`].
pub(super) fn read_normalized<R: Exact>(
    given: &InputPlanes<'_, R>,
    has: Has,
) -> Result<Framebuffer<R>> {
    let (depth, weight) = (given.scalar(&DEPTH, 0)?, given.scalar(&WEIGHT, 0)?);
    let normal = given.triple(&NORMAL, 0)?;
    let colors = Gathered::<R>::COLORS.row;
    let colors = has.color.then(|| given.triple(&colors, 0)).transpose()?;
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
