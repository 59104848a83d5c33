//! The planes of the projection, out and in, and how planes of any stage are read.

use super::{Has, PixelSample, SampleKind};
use crate::error::{Error, Result};
use crate::frame::{Frame, NamedPlane, Plane, Samples};
use crate::method::picture::named;
use crate::method::{Holds, PlaneRow, Stage, When};
use crate::number::{Exact, Vector2, Vector3};

/// The stage, with which several methods begin.
pub const STAGE: Stage = Stage { name: "projection", reads: &[], leaves: &PLANES };

/// The planes of [`PixelSample`]s; where a pixel is empty, those of [`PixelSample::empty`].
pub const PLANES: [PlaneRow; 10] = {
    use Holds::{Color, Count, Index, Scalar, Vector};
    use When::{Colored, Stages, StagesOfTubes};
    [
        PlaneRow::new("projection.id", Index, "", "which, see the ids of the projection", Stages),
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
pub(in crate::method) fn write<R: Exact>(
    samples: &Plane<PixelSample<R>>,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let [id, kind, depth, normal, extent, radius, left, upper, color, tangent] =
        PLANES.map(|row| row.name);
    let mut planes = vec![
        named(id, Samples::Index(samples.map(|s| s.id))),
        named(kind, Samples::Count(samples.map(|s| s.kind as u8))),
        named(depth, Samples::Scalar(samples.map(|s| s.depth))),
        named(normal, Samples::Vector(samples.map(|s| components(s.normal)))),
        named(extent, Samples::Scalar(samples.map(|s| s.extent))),
        named(radius, Samples::Scalar(samples.map(|s| s.radius))),
        named(left, Samples::Scalar(samples.map(|s| s.center.x))),
        named(upper, Samples::Scalar(samples.map(|s| s.center.y))),
    ];
    if has.color {
        planes.push(named(color, Samples::Color(samples.map(|s| s.color))));
    }
    if has.tangent {
        planes.push(named(tangent, Samples::Vector(samples.map(|s| components(s.tangent)))));
    }
    planes
}

/// The planes as they come in.
///
/// # Errors
/// [`Error::Invalid`] if a plane is missing, of another type, or not of the size of the frame, or if
/// a pixel has a kind that there is not.
pub fn read<R: Exact>(frame: &Frame<R>, has: Has) -> Result<Plane<PixelSample<R>>> {
    let [id, kind, depth, normal, extent, radius, left, upper, color, tangent] =
        PLANES.map(|row| row.name);
    let given = GivenPlanes(frame);
    let kinds = given.kinds(kind)?;
    let id = given.indices(id)?;
    let [depth, extent, radius] =
        [given.scalar(depth)?, given.scalar(extent)?, given.scalar(radius)?];
    let [left, upper] = [given.scalar(left)?, given.scalar(upper)?];
    let normal = given.vector(normal)?;
    let color = given.color_if(has.color, color)?;
    let tangent = given.vector_if(has.tangent, tangent)?;
    Ok(given.corner([frame.width, frame.height], |i| PixelSample {
        kind: kinds[i],
        id: id[i],
        depth: depth[i],
        radius: radius[i],
        extent: extent[i],
        center: Vector2::new(left[i], upper[i]),
        normal: vector(normal[i]),
        tangent: vector(tangent.map_or([R::ZERO; 3], |of| of[i])),
        color: color.map_or([R::ZERO; 3], |of| of[i]),
    }))
}

/// Somebody's planes, each found by its name, its type and its size.
///
/// Their values are taken as they are: a stage computes with what a client has stored.
pub(in crate::method) struct GivenPlanes<'a, R>(pub(in crate::method) &'a Frame<R>);

impl<'a, R: Exact> GivenPlanes<'a, R> {
    /// The values of a plane, which must be of the size of the frame.
    fn values<T>(&self, name: &str, plane: &'a Plane<T>) -> Result<&'a [T]> {
        let (found, frame) = ((plane.width(), plane.height()), self.0);
        if found == (frame.width, frame.height) {
            return Ok(plane.values());
        }
        Err(Error::Invalid(format!(
            "the plane `{name}` has {} x {} pixels; expected {} x {}",
            found.0, found.1, frame.width, frame.height
        )))
    }

    pub(in crate::method) fn scalar(&self, name: &str) -> Result<&'a [R]> {
        self.values(name, self.0.scalar(name)?)
    }

    pub(in crate::method) fn vector(&self, name: &str) -> Result<&'a [[R; 3]]> {
        self.values(name, self.0.vector(name)?)
    }

    /// The vectors of a scene that has these.
    pub(in crate::method) fn vector_if(
        &self,
        has: bool,
        name: &str,
    ) -> Result<Option<&'a [[R; 3]]>> {
        if has { self.vector(name).map(Some) } else { Ok(None) }
    }

    /// The colours of a scene that has colours.
    pub(in crate::method) fn color_if(
        &self,
        has: bool,
        name: &str,
    ) -> Result<Option<&'a [[R; 3]]>> {
        if has { self.values(name, self.0.color(name)?).map(Some) } else { Ok(None) }
    }

    pub(in crate::method) fn indices(&self, name: &str) -> Result<&'a [u32]> {
        self.values(name, self.0.index(name)?)
    }

    pub(in crate::method) fn counts(&self, name: &str) -> Result<&'a [u8]> {
        self.values(name, self.0.count(name)?)
    }

    /// What each pixel shows.
    pub(in crate::method) fn kinds(&self, name: &str) -> Result<Vec<SampleKind>> {
        let kind = |(i, &value): (usize, &u8)| {
            SampleKind::ALL.get(usize::from(value)).copied().ok_or_else(|| {
                let (x, y) = (i % self.0.width as usize, i / self.0.width as usize);
                let last = SampleKind::ALL.len() - 1;
                let what = format!("the plane `{name}` has {value} at ({x}, {y}); at most {last}");
                Error::Invalid(what)
            })
        };
        self.counts(name)?.iter().enumerate().map(kind).collect()
    }

    /// What lies in the upper left corner of the planes; `value` is asked for a place in them.
    pub(in crate::method) fn corner<T>(
        &self,
        [width, height]: [u32; 2],
        value: impl Fn(usize) -> T,
    ) -> Plane<T> {
        let (row, whole) = (width as usize, self.0.width as usize);
        let places = (0..height as usize).flat_map(|y| (0..row).map(move |x| y * whole + x));
        Plane::from_values(width, height, places.map(value).collect())
    }
}

/// The components of a vector, as planes hold it.
pub(in crate::method) fn components<R: Exact>(v: Vector3<R>) -> [R; 3] {
    [v.x, v.y, v.z]
}

/// The vector of these components.
pub(in crate::method) fn vector<R: Exact>([x, y, z]: [R; 3]) -> Vector3<R> {
    Vector3::new(x, y, z)
}
