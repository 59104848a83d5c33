//! From a scene to named planes: all stages in one call, or one of them on somebody's planes.

use super::fast::CenterLevels;
use super::normalization::normalize;
use super::planes::{self, SHADING};
use super::propagation::{self, propagate};
use super::reconstruction::gather;
use super::{Center, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Frame, NamedPlane, Plane, Pool, Wanted, pyramid};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, finish, framebuffer};
use crate::method::projection::{self, Has};
use crate::method::stage::{check_size, unknown};
use crate::number::Exact;
use crate::splat::Tally;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
    let has = Has::of(scene);
    let mut clock = Clock::default();
    let projected = projection::project::<R>(scene, camera, settings.cull, Snap::default(), exec)?;
    clock.lap("projection");
    let levels = propagate(&projected.samples, settings, exec);
    clock.lap("propagation");
    let gathered = gather(&levels, settings, exec);
    clock.lap("reconstruction");
    let mut planes = Vec::new();
    if stages {
        planes = projection::planes::write(&projected.samples, has);
        planes.extend((1..).zip(&levels[1..]).flat_map(|(level, cells)| write(level, cells, job)));
        planes.extend(planes::write_gathered(&gathered, has));
    }
    clock.restart();
    let normals = stages || !scene.lights.is_empty();
    let target = normalize(&gathered, camera, has, normals);
    clock.lap("normalization");
    Ok(finish(target, planes, projected.tally, clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut CenterLevels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let color = Has::of(scene).color;
    let wanted = Wanted { normal: !scene.lights.is_empty(), color, observed: false };
    let mut target = framebuffer(camera, wanted, pool);
    let (tally, laps) = levels.draw(scene, camera, settings, exec, &mut target);
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), job))
}

/// The planes of a level.
fn write<R: Exact>(level: usize, cells: &Plane<Center<R>>, job: &Job<'_>) -> Vec<NamedPlane<R>> {
    let size = [job.camera.width, job.camera.height];
    planes::write_level(level, cells, size, Has::of(job.scene))
}

/// One stage on somebody's planes, see [`super::planes`].
///
/// In the propagation every level is computed from the finer one *as the planes have it*, and where
/// its planes are missing, from the level just computed: so a mistake in one level does not spread
/// to the next, if all are given, and the planes of the projection alone are enough.
///
/// # Errors
/// [`crate::Error::Invalid`] as [`crate::method::Algorithm::stage`].
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    from: &Frame<R>,
) -> Result<Frame<R>> {
    check_size(from, job.camera)?;
    let Job { scene, camera, exec, .. } = *job;
    let has = Has::of(scene);
    let planes = match stage {
        "projection" => {
            let snap = Snap::default();
            let projected = projection::project::<R>(scene, camera, settings.cull, snap, exec)?;
            projection::planes::write(&projected.samples, has)
        }
        "propagation" => propagated(job, settings, from)?,
        "reconstruction" => {
            let gathered = gather(&levels(job, settings, from)?, settings, exec);
            let mut planes = planes::write_gathered(&gathered, has);
            planes.push(planes::write_id(&gathered));
            planes
        }
        "normalization" => {
            let gathered = planes::read_gathered(from, has)?;
            planes::write_normalized(normalize(&gathered, camera, has, true))
        }
        "shading" => {
            let target = planes::read_normalized(from, has)?;
            let shaded = finish(target, Vec::new(), Tally::default(), Clock::default(), job);
            let mut planes = shaded.frame.planes;
            planes.retain(|plane| SHADING.iter().any(|row| row.is_called(&plane.name)));
            planes
        }
        _ => return Err(unknown(stage)),
    };
    Ok(Frame { width: from.width, height: from.height, planes })
}

/// The number of the top level.
fn top<R: Exact>(settings: &Settings, from: &Frame<R>) -> usize {
    propagation::top(settings, &pyramid::sizes(from.width, from.height))
}

/// All levels as the planes have them.
fn levels<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    from: &Frame<R>,
) -> Result<Vec<Plane<Center<R>>>> {
    let has = Has::of(job.scene);
    let mut levels = vec![projection::planes::read(from, has)?.map(Center::new)];
    for level in 1..=top(settings, from) {
        levels.push(planes::read_level(from, level, has)?);
    }
    Ok(levels)
}

/// The planes of the propagation.
fn propagated<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    from: &Frame<R>,
) -> Result<Vec<NamedPlane<R>>> {
    let has = Has::of(job.scene);
    let mut fine = projection::planes::read(from, has)?.map(Center::new);
    let mut planes = Vec::new();
    for level in 1..=top(settings, from) {
        let reach = R::from_f32(settings.reach(level - 1));
        let coarse = propagation::coarser(&fine, reach, job.exec);
        planes.extend(write(level, &coarse, job));
        let given = planes::has_level(from, level);
        fine = if given { planes::read_level(from, level, has)? } else { coarse };
    }
    Ok(planes)
}
