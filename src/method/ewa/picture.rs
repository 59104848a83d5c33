//! All stages in one call: from a scene to named planes; and one stage on somebody's planes.

use super::attributes::attributes;
use super::margin::margins;
use super::normalization::resolve;
use super::visibility::visibility;
use super::{Settings, fast, planes};
use crate::error::Result;
use crate::frame::{NamedPlane, Pool, Wanted};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Clock, Picture, finish, framebuffer};
use crate::method::prepare::Prepared;
use crate::method::stage::unknown;
use crate::method::surface;
use crate::number::Exact;
use crate::scene::Scene;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let splats = Prepared::splats(job, settings);
    clock.lap("projection");
    let visible = visibility(job, &splats);
    clock.lap("visibility");
    let sums = attributes(job, &splats, &visible);
    clock.lap("attributes");
    let averages = visible.with(&sums, resolve);
    clock.lap("normalization");

    let mut left = Vec::new();
    if stages {
        left.extend(planes::visibility(&visible));
        left.extend(planes::attributes(job, &sums));
        left.push(planes::margin(&margins(job, settings, &visible)));
        left.extend(surface::colors(job, &averages));
    }
    let target = surface::framebuffer(job, &averages, wanted(job.scene, stages));
    Ok(finish(target, left, splats.tally, clock, job))
}

/// One stage on somebody's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let splats = || Prepared::splats(job, settings);
    match stage {
        "visibility" => Ok(planes::visibility(&visibility::<R>(job, &splats()))),
        "attributes" => {
            let visible = planes::given_visibility(job, given)?;
            Ok(planes::attributes(job, &attributes(job, &splats(), &visible)))
        }
        "normalization" => {
            let visible = planes::given_visibility(job, given)?;
            let sums = planes::given_attributes(job, given)?;
            Ok(surface::planes(job, &visible.with(&sums, resolve)))
        }
        "shading" => surface::shade(job, given, job.scene.surfels.color().is_some()),
        _ => Err(unknown(stage)),
    }
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut target = framebuffer(job.camera, wanted(job.scene, false), pool);
    let (tally, laps) = fast::render(job, settings, &mut target);
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), job))
}

/// The planes that a scene needs.
fn wanted(scene: &Scene, stages: bool) -> Wanted {
    Wanted {
        normal: stages || !scene.lights.is_empty(),
        color: scene.surfels.color().is_some(),
        observed: stages,
    }
}
