//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::attributes::{Sums, attributes};
use super::margin::margins;
use super::normalization::resolve;
use super::planes::{MARGIN, given_attributes, given_visibility};
use super::visibility::{Foremost, visibility};
use super::{Settings, fast};
use crate::error::Result;
use crate::frame::{NamedPlane, Pool, Wanted};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Picture, finish, framebuffer};
use crate::method::prepare::Prepared;
use crate::method::stage::{Keep, unknown};
use crate::method::surface::{self, SurfacePixel};
use crate::number::Exact;
use crate::scene::Scene;

/// The definition, in any number type. With `stages`, every stage leaves its planes.
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
    let target = surface::framebuffer(job, &averages, wanted(job.scene, stages));
    clock.lap("normalization");

    let mut left = Vec::new();
    if stages {
        let there = job.there(Keep::Stages);
        left.extend(visible.planes(&Foremost::PLANES, 0, &there));
        left.extend(sums.planes(&Sums::PLANES, 0, &there));
        let margins = margins(job, settings, &visible);
        left.push(MARGIN.scalar(0, margins.plane(|margin| *margin)));
        left.extend(surface::colors(job, &averages));
    }
    Ok(finish(target, left, splats.tally, clock, job))
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let (splats, there) = (|| Prepared::splats(job, settings), job.there(Keep::Alone));
    match stage {
        "visibility" => Ok(visibility(job, &splats()).planes(&Foremost::PLANES, 0, &there)),
        "attributes" => {
            let visible = given_visibility(job, given)?;
            Ok(attributes(job, &splats(), &visible).planes(&Sums::PLANES, 0, &there))
        }
        "normalization" => {
            let (visible, sums) = (given_visibility(job, given)?, given_attributes(given)?);
            Ok(visible.with(&sums, resolve).planes(&SurfacePixel::PLANES, 0, &there))
        }
        "shading" => surface::shade(job, given, job.scene.surfels.color().is_some()),
        _ => Err(unknown(stage)),
    }
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut target = framebuffer(job, wanted(job.scene, false), pool);
    let (tally, clock) = fast::render(job, settings, &mut target);
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
