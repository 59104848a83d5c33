//! From a scene to named planes: all stages in one call, or one of them on somebody's planes.

use super::fast::CellLevels;
use super::gbuffer::GBuffer;
use super::planes::{self, PULL, PUSH};
use super::pull::{self, pull_all, side};
use super::push::{self, push_all};
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Frame, NamedPlane, Plane, Pool, pyramid};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture};
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
    let (has, snap) = (Has::of(scene), Snap::new(settings.subpixel_bits)?);
    let mut clock = Clock::default();
    let projected = projection::project::<R>(scene, camera, settings.cull, snap, exec)?;
    clock.lap("projection");
    let pulled = pull_all(&projected.samples, exec);
    clock.lap("pull");
    let pushed = push_all(&pulled, settings, exec);
    clock.lap("push");
    let mut planes = Vec::new();
    if stages {
        planes = projection::planes::write(&projected.samples, has);
        planes.extend(write(&PULL, 1, &pulled[1..], job));
        planes.extend(write(&PUSH, 0, &pushed[..pushed.len() - 1], job));
    }
    let normals = stages || !scene.lights.is_empty();
    let target = GBuffer::of(&pushed[0], camera, has, normals);
    Ok(finish(target, planes, projected.tally, clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut CellLevels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let mut target = GBuffer::new(scene, camera, pool);
    let (tally, laps) = levels.draw(scene, camera, settings, exec, &mut target)?;
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), job))
}

/// Deferred shading, and the planes of the picture.
fn finish<R: Exact>(
    target: GBuffer<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    job: &Job<'_>,
) -> Picture<R> {
    let (width, height) = (job.camera.width, job.camera.height);
    clock.restart();
    let shaded = target.shaded(job);
    clock.lap("shading");
    planes.extend(planes::write_picture(shaded));
    Picture { frame: Frame { width, height, planes }, tally, timings: clock.into_laps() }
}

/// The planes of consecutive levels.
fn write<R: Exact>(
    rows: &[crate::method::PlaneRow; 9],
    first: usize,
    levels: &[Plane<Cell<R>>],
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let (size, has) = ([job.camera.width, job.camera.height], Has::of(job.scene));
    let level = |(level, cells)| planes::write_level(rows, level, cells, size, has);
    (first..).zip(levels).flat_map(level).collect()
}

/// One stage on somebody's planes, see [`super::planes`].
///
/// Every level is computed from the level before it *as the planes have it*: the finer one in the
/// pull, the coarser one in the push. Where the planes of that level are missing, from the level
/// just computed. So a mistake in one level does not spread to the next, if all are given; and the
/// planes of the projection alone, or of the pull, are enough to run the stage.
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
    let planes = match stage {
        "projection" => {
            let snap = Snap::new(settings.subpixel_bits)?;
            let Job { scene, camera, exec, .. } = *job;
            let projected = projection::project::<R>(scene, camera, settings.cull, snap, exec)?;
            projection::planes::write(&projected.samples, Has::of(scene))
        }
        "pull" => pulled(job, from)?,
        "push" => pushed(job, settings, from)?,
        "shading" => {
            let has = Has::of(job.scene);
            let last = pyramid::sizes(from.width, from.height).len() - 1;
            // The level of one pixel is not pushed.
            let finest = if last > 0 {
                planes::read_level(from, &PUSH, 0, has)?
            } else {
                samples(job, from)?
            };
            planes::write_picture(GBuffer::of(&finest, job.camera, has, true).shaded(job))
        }
        _ => return Err(unknown(stage)),
    };
    Ok(Frame { width: from.width, height: from.height, planes })
}

/// Level 0 before the pull, from the planes of the projection.
fn samples<R: Exact>(job: &Job<'_>, from: &Frame<R>) -> Result<Plane<Cell<R>>> {
    Ok(projection::planes::read(from, Has::of(job.scene))?.map(Cell::new))
}

/// A level of the pull phase as the planes have it.
fn pulled_level<R: Exact>(job: &Job<'_>, from: &Frame<R>, level: usize) -> Result<Plane<Cell<R>>> {
    if level == 0 {
        return samples(job, from);
    }
    planes::read_level(from, &PULL, level, Has::of(job.scene))
}

/// The planes of the pull phase.
fn pulled<R: Exact>(job: &Job<'_>, from: &Frame<R>) -> Result<Vec<NamedPlane<R>>> {
    let last = pyramid::sizes(from.width, from.height).len() - 1;
    let mut fine = samples(job, from)?;
    let mut planes = Vec::new();
    for level in 1..=last {
        let coarse = pull::pull(&fine, side(level - 1), job.exec);
        planes.extend(write(&PULL, level, std::slice::from_ref(&coarse), job));
        let given = planes::has_level(from, &PULL, level);
        fine = if given { pulled_level(job, from, level)? } else { coarse };
    }
    Ok(planes)
}

/// The planes of the push phase.
fn pushed<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    from: &Frame<R>,
) -> Result<Vec<NamedPlane<R>>> {
    let has = Has::of(job.scene);
    let last = pyramid::sizes(from.width, from.height).len() - 1;
    let mut coarse = pulled_level(job, from, last)?;
    let mut levels = Vec::new();
    for level in (0..last).rev() {
        let fine = pulled_level(job, from, level)?;
        let found = push::push(&fine, &coarse, side(level), settings, job.exec);
        let given = planes::has_level(from, &PUSH, level);
        coarse = if given { planes::read_level(from, &PUSH, level, has)? } else { found.clone() };
        levels.push(found);
    }
    levels.reverse();
    Ok(write(&PUSH, 0, &levels, job))
}
