//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::fast::CellLevels;
use super::gbuffer::GBuffer;
use super::planes::{self, CellFields};
use super::pull::{self, pull_all, side};
use super::push::{self, push_all};
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Frame, NamedPlane, Plane, Pool, pyramid};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::Picture;
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
    let snap = Snap::new(settings.subpixel_bits)?;
    let mut clock = Clock::default();
    let projected = projection::project::<R>(job, settings.cull, snap)?;
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
    let pulled = pull_all(&projected.samples, exec);
    clock.lap("pull");
    let pushed = push_all(&pulled, settings, exec);
    let normals = stages || !scene.lights.is_empty();
    let target = GBuffer::from_cells(&pushed[0], camera, has, normals);
    clock.lap("push");
    let mut planes = Vec::new();
    if stages {
        planes = projected.planes(job);
        planes.extend(write(&Cell::PULL, 1, &pulled[1..], job));
        planes.extend(write(&Cell::PUSH, 0, &pushed[..pushed.len() - 1], job));
    }
    finish(target, planes, projected.tally, clock, job)
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut CellLevels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    if job.is_part() {
        return define(job, settings, false);
    }
    let Job { scene, camera, .. } = *job;
    let mut target = GBuffer::new(scene, camera, pool);
    let (tally, clock) = levels.draw(job, settings, &mut target)?;
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// Shades a picture, and makes its planes.
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
    Picture {
        frame: Frame { width, height, planes },
        tally,
        timings: clock.into_laps(),
        seen: None,
    }
}

/// The planes of consecutive levels.
fn write<R: Exact>(
    fields: &CellFields<R>,
    first: usize,
    levels: &[Plane<Cell<R>>],
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let level = |(level, cells)| planes::write_level(fields, level, cells, job);
    (first..).zip(levels).flat_map(level).collect()
}

/// Runs one stage on a client's planes, see [`super::planes`].
///
/// Every level is computed from the level before it *as the planes have it*: the finer one in the
/// pull, the coarser one in the push. Where the planes of that level are missing, the level just
/// computed takes its place. So if all levels are given, a mistake in one level does not spread
/// beyond the next. And the planes of the projection alone, or of the pull, are enough to run the
/// stage.
///
/// # Errors
/// [`crate::Error::Invalid`] as [`crate::method::Algorithm::stage`].
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let levels = GivenLevels::new(job, given);
    match stage {
        "projection" => {
            let snap = Snap::new(settings.subpixel_bits)?;
            let projected = projection::project::<R>(job, settings.cull, snap)?;
            Ok(projected.planes(job))
        }
        "pull" => levels.pull(),
        "push" => levels.push(settings),
        "shading" => {
            let target = GBuffer::from_cells(&levels.pushed(0)?, job.camera, levels.has, true);
            Ok(planes::write_picture(target.shaded(job)))
        }
        _ => Err(unknown(stage)),
    }
}

/// The levels that a stage makes from each other, in order: the pull makes ever coarser levels, the
/// push ever finer ones.
pub(super) fn levels(job: &Job<'_>, stage: &str) -> Vec<usize> {
    let last = pyramid::sizes(job.camera.width, job.camera.height).len() - 1;
    match stage {
        "pull" => (1..=last).collect(),
        "push" => (0..last).rev().collect(),
        _ => Vec::new(),
    }
}

/// The levels in a client's planes.
struct GivenLevels<'a, R> {
    job: &'a Job<'a>,
    given: &'a InputPlanes<'a, R>,
    has: Has,
    /// The size of every level.
    sizes: Vec<[u32; 2]>,
}

impl<'a, R: Exact> GivenLevels<'a, R> {
    fn new(job: &'a Job<'a>, given: &'a InputPlanes<'a, R>) -> Self {
        let sizes = pyramid::sizes(job.camera.width, job.camera.height);
        Self { job, given, has: Has::in_scene(job.scene), sizes }
    }

    /// The number of the coarsest level.
    fn last(&self) -> usize {
        self.sizes.len() - 1
    }

    /// Level 0 before the pull, from the planes of the projection.
    fn samples(&self) -> Result<Plane<Cell<R>>> {
        Ok(self.given.projection()?.map(Cell::new))
    }

    /// Reads a level of a phase.
    fn read(&self, fields: &CellFields<R>, level: usize) -> Result<Plane<Cell<R>>> {
        let [width, height] = self.sizes[level];
        self.given.records(fields, level, Plane::filled(width, height, Cell::empty()))
    }

    /// Reads a level of a phase. Where its planes are missing, returns the level just computed.
    fn read_or(
        &self,
        fields: &CellFields<R>,
        level: usize,
        computed: Plane<Cell<R>>,
    ) -> Result<Plane<Cell<R>>> {
        if self.given.has(&fields[0].row, level) { self.read(fields, level) } else { Ok(computed) }
    }

    /// A level before the push.
    fn pulled(&self, level: usize) -> Result<Plane<Cell<R>>> {
        if level == 0 { self.samples() } else { self.read(&Cell::PULL, level) }
    }

    /// A level after the push. The level of one pixel is not pushed.
    fn pushed(&self, level: usize) -> Result<Plane<Cell<R>>> {
        if level == self.last() { self.pulled(level) } else { self.read(&Cell::PUSH, level) }
    }

    /// Runs the pull phase, and returns its planes.
    fn pull(&self) -> Result<Vec<NamedPlane<R>>> {
        let levels = self.job.only(levels(self.job, "pull"));
        let Some(first) = levels.first() else { return Ok(Vec::new()) };
        let mut fine = self.pulled(first - 1)?;
        let mut planes = Vec::new();
        for level in levels {
            let coarse = pull::pull(&fine, side(level - 1), self.job.exec);
            planes.extend(planes::write_level(&Cell::PULL, level, &coarse, self.job));
            fine = self.read_or(&Cell::PULL, level, coarse)?;
        }
        Ok(planes)
    }

    /// Runs the push phase, and returns its planes.
    fn push(&self, settings: &Settings) -> Result<Vec<NamedPlane<R>>> {
        let levels = self.job.only(levels(self.job, "push"));
        let Some(first) = levels.first() else { return Ok(Vec::new()) };
        let mut coarse = self.pushed(first + 1)?;
        let mut found = Vec::new();
        for level in levels {
            let fine = self.pulled(level)?;
            let pushed = push::push(&fine, &coarse, side(level), settings, self.job.exec);
            found.push(planes::write_level(&Cell::PUSH, level, &pushed, self.job));
            coarse = self.read_or(&Cell::PUSH, level, pushed)?;
        }
        found.reverse();
        Ok(found.into_iter().flatten().collect())
    }
}
