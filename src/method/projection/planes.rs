//! The planes of the stage.

use super::{Has, Projected};
use crate::frame::{NamedPlane, Samples};
use crate::method::picture::{color, named, scalar};
use crate::number::Exact;

/// The planes of the stage, see the page of [`super`].
pub(in crate::method) fn planes<R: Exact>(
    projected: &Projected<R>,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let samples = &projected.samples;
    let mut planes = vec![
        named("projection.id", Samples::Index(samples.map(|s| s.id))),
        named("projection.kind", Samples::Count(samples.map(|s| s.kind as u8))),
        scalar("projection.Z", samples.map(|s| s.depth)),
        named(
            "projection.normal",
            Samples::Vector(samples.map(|s| [s.normal.x, s.normal.y, s.normal.z])),
        ),
        scalar("projection.extent", samples.map(|s| s.extent)),
        scalar("projection.radius", samples.map(|s| s.radius)),
        scalar("projection.centre.X", samples.map(|s| s.center.x)),
        scalar("projection.centre.Y", samples.map(|s| s.center.y)),
    ];
    if has.color {
        planes.push(color("projection", samples.map(|s| s.color)));
    }
    if has.tangent {
        let tangents = samples.map(|s| [s.tangent.x, s.tangent.y, s.tangent.z]);
        planes.push(named("projection.tangent", Samples::Vector(tangents)));
    }
    planes
}
