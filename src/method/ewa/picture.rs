//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::fast;
use super::plain::Plain;
use crate::error::Result;
use crate::frame::{Pool, Samples, Wanted};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, finish, framebuffer, named};
use crate::number::Exact;
use crate::scene::Scene;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
    let mut clock = Clock::default();
    let mut planes = Vec::new();
    let mut plain =
        Plain::<R>::project(&scene.surfels, camera, settings, exec, wanted(scene, stages));
    clock.lap("projection");

    plain.visibility();
    clock.lap("visibility");
    if stages {
        planes.push(named("visibility.Z", Samples::Scalar(plain.depth())));
        planes.push(named("visibility.id", Samples::Index(plain.target.id.clone())));
    }

    clock.restart();
    plain.attributes();
    clock.lap("attributes");
    if stages {
        let target = &mut plain.target;
        planes.extend(target.color.clone().map(|p| named("attributes", Samples::Color(p))));
        planes
            .extend(target.normal.clone().map(|p| named("attributes.normal", Samples::Vector(p))));
        planes.push(named("attributes.weight", Samples::Scalar(target.weight.clone())));
        planes.extend(target.stencil.take().map(|p| named("attributes.count", Samples::Count(p))));
        planes.extend(target.margin.take().map(|p| named("margin", Samples::Scalar(p))));
    }

    clock.restart();
    plain.normalize();
    clock.lap("normalization");
    if stages {
        let color = plain.target.color.clone();
        planes.extend(color.map(|p| named("resolved", Samples::Color(p))));
    }
    let tally = plain.tally();
    Ok(finish(plain.target, planes, tally, clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let mut target = framebuffer(camera, wanted(scene, false), pool);
    let (tally, times) = fast::render(&scene.surfels, camera, settings, exec, &mut target);
    let clock = Clock::of(vec![
        ("projection", times.project),
        ("visibility", times.visibility),
        ("attributes", times.attributes),
        ("normalization", times.normalize),
    ]);
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// The planes that a scene needs.
fn wanted(scene: &Scene, stages: bool) -> Wanted {
    Wanted {
        normal: stages || !scene.lights.is_empty(),
        color: scene.surfels.color().is_some(),
        observed: stages,
    }
}
