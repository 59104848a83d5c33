//! List the planes that the projection leaves.

use super::{PixelSample, Projected};
use crate::frame::NamedPlane;
use crate::method::Job;
use crate::method::record::Part::{Direction, Id, Kind, Number, Triple};
use crate::method::record::{self, Field, rows};
use crate::method::stage::Holds::{Color, Count, Depth, Index, Normal, Scalar, Vector};
use crate::method::stage::When::{Colored, StagesOfTubes};
use crate::method::stage::{Keep, Stage};
use crate::number::Real;

/// The stage with which several methods begin.
pub const STAGE: Stage =
    Stage { name: "projection", reads: &[], leaves: &rows(&PixelSample::<f32>::PLANES) };

impl<R> PixelSample<R> {
    pub(crate) const KIND: Field<Self, R> =
        Field::new("projection.kind", Count, Kind(|p: &mut Self| &mut p.kind))
            .says("0 nothing, 1 surfel, 2 ribbon, 3 tube, 4 triangle: the stencil");
    pub(crate) const LEFT: Field<Self, R> =
        Field::new("projection.center.X", Scalar, Number(|p: &mut Self| &mut p.center.x))
            .unit("px")
            .says("the centre's column");
    pub(crate) const UPPER: Field<Self, R> =
        Field::new("projection.center.Y", Scalar, Number(|p: &mut Self| &mut p.center.y))
            .unit("px")
            .says("the centre's row");

    /// The planes. An empty pixel holds the values of [`PixelSample::empty`].
    pub(crate) const PLANES: [Field<Self, R>; 10] = [
        Field::new("projection.id", Index, Id(|p: &mut Self| &mut p.id))
            .says("which, see the ids of the projection; 0xFFFF_FFFF where there is none"),
        Self::KIND,
        Field::new("projection.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth t; +inf if empty"),
        Field::new("projection.normal", Normal, Direction(|p: &mut Self| &mut p.normal))
            .says("towards the viewer, view space"),
        Field::new("projection.extent", Scalar, Number(|p: &mut Self| &mut p.extent))
            .unit("px")
            .says("radius rho"),
        Field::new("projection.radius", Scalar, Number(|p: &mut Self| &mut p.radius))
            .unit("world units")
            .says("radius r"),
        Self::LEFT,
        Self::UPPER,
        Field::new("projection", Color, Triple(|p: &mut Self| &mut p.color))
            .when(Colored)
            .says("colour"),
        Field::new("projection.tangent", Vector, Direction(|p: &mut Self| &mut p.tangent))
            .when(StagesOfTubes)
            .says("of a tube, view space; else the null vector"),
    ];
}

impl<R: Real> Projected<R> {
    /// Makes the planes of the samples.
    pub(crate) fn planes(&self, job: &Job<'_>) -> Vec<NamedPlane<R>> {
        let window = job.window;
        let at = |x, y| *self.samples.at(x - window.x0, y - window.y0);
        let there = job.there(Keep::Stages);
        record::planes(&PixelSample::PLANES, 0, window, &at, &there)
    }
}
