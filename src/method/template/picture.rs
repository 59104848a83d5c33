//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::fast::CenterLevels;
use super::normalization::normalize;
use super::planes::{self, ALPHA, SHADED};
use super::propagation::{self, propagate};
use super::reconstruction::gather;
use super::{Center, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{NamedPlane, Plane, Pool, Wanted, pyramid};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Picture, finish, framebuffer};
use crate::method::projection::{self, Has, Projected};
use crate::method::stage::unknown;
use crate::number::Exact;
use crate::splat::Tally;

/// The definition, in any number type. With `stages`, every stage leaves its planes. Of a part of a
/// picture, the projection alone leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let projected = projection::project::<R>(job, settings.cull, Snap::default())?;
    if job.is_part() {
        return Ok(projected.alone(job, clock));
    }
    clock.lap("projection");
    Ok(reconstruct(job, settings, stages, projected, clock))
}

/// The stages after the projection, on the planes of the projection.
///
/// # Errors
/// As [`InputPlanes::records`].
pub(super) fn finish_joined(
    job: &Job<'_>,
    settings: &Settings,
    given: &InputPlanes<'_, f32>,
    stages: bool,
) -> Result<Picture<f32>> {
    let projected = Projected { samples: given.projection()?, tally: Tally::default() };
    Ok(reconstruct(job, settings, stages, projected, Clock::default()))
}

/// The stages after the projection.
fn reconstruct<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
    projected: Projected<R>,
    mut clock: Clock,
) -> Picture<R> {
    let (Job { scene, camera, exec, .. }, has) = (*job, job.has());
    let levels = propagate(&projected.samples, settings, exec);
    clock.lap("propagation");
    let gathered = gather(&levels, settings, exec);
    clock.lap("reconstruction");
    let mut planes = Vec::new();
    if stages {
        planes = projected.planes(job);
        let level = |(level, cells)| planes::write_level(level, cells, job);
        planes.extend((1..).zip(&levels[1..]).flat_map(level));
        planes.extend(planes::write_gathered(&gathered, job));
        // The id, the last plane, is a plane of the picture.
        planes.pop();
    }
    clock.restart();
    let normals = stages || !scene.lights.is_empty();
    let target = normalize(&gathered, camera, has, normals);
    clock.lap("normalization");
    finish(target, planes, projected.tally, clock, job)
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut CenterLevels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    if job.is_part() {
        return define(job, settings, false);
    }
    let Job { scene, camera, exec, .. } = *job;
    let color = Has::in_scene(scene).color;
    let wanted = Wanted { normal: !scene.lights.is_empty(), color, observed: false };
    let mut target = framebuffer(job, wanted, pool);
    let (tally, clock) = levels.draw(scene, camera, settings, exec, &mut target);
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// Runs one stage on a client's planes, see [`super::planes`].
///
/// The propagation computes every level from the finer level *as the planes have it*. Where the
/// planes of the finer level are missing, the level just computed takes its place. So if all levels
/// are given, a mistake in one level does not spread beyond the next. And the planes of the
/// projection alone are enough to run the stage.
///
/// # Errors
/// [`crate::Error::Invalid`] as [`crate::method::Algorithm::stage`].
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let Job { scene, camera, exec, .. } = *job;
    let has = Has::in_scene(scene);
    match stage {
        "projection" => {
            let snap = Snap::default();
            let projected = projection::project::<R>(job, settings.cull, snap)?;
            Ok(projected.planes(job))
        }
        "propagation" => propagated(job, settings, given),
        "reconstruction" => {
            let gathered = gather(&given_levels(job, settings, given)?, settings, exec);
            Ok(planes::write_gathered(&gathered, job))
        }
        "normalization" => {
            let gathered = planes::read_gathered(job, given)?;
            Ok(planes::write_normalized(normalize(&gathered, camera, has, true)))
        }
        "shading" => {
            let target = planes::read_normalized(given, has)?;
            let shaded = finish(target, Vec::new(), Tally::default(), Clock::default(), job);
            let mut planes = shaded.frame.planes;
            planes.retain(|plane| [SHADED, ALPHA].iter().any(|row| row.is_called(&plane.name)));
            Ok(planes)
        }
        _ => Err(unknown(stage)),
    }
}

/// The levels that a stage makes from each other, in order: the propagation makes ever coarser
/// levels.
pub(super) fn levels(job: &Job<'_>, settings: &Settings, stage: &str) -> Vec<usize> {
    let count = if stage == "propagation" { sizes(job, settings).len() } else { 0 };
    (1..count).collect()
}

/// The sizes of the levels 0 to the top.
fn sizes(job: &Job<'_>, settings: &Settings) -> Vec<[u32; 2]> {
    let mut sizes = pyramid::sizes(job.camera.width, job.camera.height);
    sizes.truncate(propagation::top(settings, &sizes) + 1);
    sizes
}

/// Reads all levels from the planes.
fn given_levels<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Plane<Center<R>>>> {
    let sizes = sizes(job, settings);
    (0..sizes.len()).map(|level| given_level(level, &sizes, given)).collect()
}

/// Reads a level from the planes.
fn given_level<R: Exact>(
    level: usize,
    sizes: &[[u32; 2]],
    given: &InputPlanes<'_, R>,
) -> Result<Plane<Center<R>>> {
    if level == 0 {
        return Ok(given.projection()?.map(Center::new));
    }
    let [width, height] = sizes[level];
    given.records(&Center::PLANES, level, Plane::filled(width, height, Center::empty()))
}

/// Runs the propagation, and returns its planes.
fn propagated<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let sizes = sizes(job, settings);
    let levels = job.only(levels(job, settings, "propagation"));
    let Some(first) = levels.first() else { return Ok(Vec::new()) };
    let mut fine = given_level(first - 1, &sizes, given)?;
    let mut planes = Vec::new();
    for level in levels {
        let reach = R::from_f32(settings.reach(level - 1));
        let coarse = propagation::coarser(&fine, reach, job.exec);
        planes.extend(planes::write_level(level, &coarse, job));
        fine = if given.has(&Center::<R>::PLANES[0].row, level) {
            given_level(level, &sizes, given)?
        } else {
            coarse
        };
    }
    Ok(planes)
}
