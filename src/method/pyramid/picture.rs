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
use crate::method::PlaneRow;
use crate::method::algorithm::Job;
use crate::method::given::Given;
use crate::method::picture::{Clock, Picture};
use crate::method::projection::{self, Has};
use crate::method::stage::unknown;
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
    let projected = projection::project::<R>(job, settings.cull, snap)?;
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
    let Job { scene, camera, .. } = *job;
    let mut target = GBuffer::new(scene, camera, pool);
    let (tally, laps) = levels.draw(job, settings, &mut target)?;
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
    Picture {
        frame: Frame { width, height, planes },
        tally,
        timings: clock.into_laps(),
        seen: None,
    }
}

/// The planes of consecutive levels.
fn write<R: Exact>(
    rows: &[PlaneRow; 9],
    first: usize,
    levels: &[Plane<Cell<R>>],
    job: &Job<'_>,
) -> Vec<NamedPlane<R>> {
    let level = |(level, cells)| planes::write_level(rows, level, cells, job);
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
    given: &Given<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let levels = GivenLevels::new(job, given);
    match stage {
        "projection" => {
            let snap = Snap::new(settings.subpixel_bits)?;
            let projected = projection::project::<R>(job, settings.cull, snap)?;
            Ok(projection::planes::write(&projected.samples, levels.has))
        }
        "pull" => levels.pull(),
        "push" => levels.push(settings),
        "shading" => {
            let target = GBuffer::of(&levels.finest()?, job.camera, levels.has, true);
            Ok(planes::write_picture(target.shaded(job)))
        }
        _ => Err(unknown(stage)),
    }
}

/// The levels as somebody's planes have them.
struct GivenLevels<'a, R> {
    job: &'a Job<'a>,
    given: &'a Given<'a, R>,
    has: Has,
    /// The size of every level.
    sizes: Vec<[u32; 2]>,
}

impl<'a, R: Exact> GivenLevels<'a, R> {
    fn new(job: &'a Job<'a>, given: &'a Given<'a, R>) -> Self {
        let sizes = pyramid::sizes(job.camera.width, job.camera.height);
        Self { job, given, has: Has::of(job.scene), sizes }
    }

    /// The number of the coarsest level.
    fn last(&self) -> usize {
        self.sizes.len() - 1
    }

    /// Level 0 before the pull, from the planes of the projection.
    fn samples(&self) -> Result<Plane<Cell<R>>> {
        Ok(projection::planes::read(self.given, self.has)?.map(Cell::new))
    }

    /// A level of a phase.
    fn read(&self, rows: &[PlaneRow; 9], level: usize) -> Result<Plane<Cell<R>>> {
        planes::read_level(self.given, rows, level, self.sizes[level], self.has)
    }

    /// A level of a phase, or where its planes are missing, the level just computed.
    fn read_or(
        &self,
        rows: &[PlaneRow; 9],
        level: usize,
        computed: Plane<Cell<R>>,
    ) -> Result<Plane<Cell<R>>> {
        if self.given.has(&rows[0], level) { self.read(rows, level) } else { Ok(computed) }
    }

    /// A level before the push.
    fn pulled(&self, level: usize) -> Result<Plane<Cell<R>>> {
        if level == 0 { self.samples() } else { self.read(&PULL, level) }
    }

    /// Level 0 after the push; the level of one pixel is not pushed.
    fn finest(&self) -> Result<Plane<Cell<R>>> {
        if self.last() > 0 { self.read(&PUSH, 0) } else { self.samples() }
    }

    /// The planes of the pull phase.
    fn pull(&self) -> Result<Vec<NamedPlane<R>>> {
        let mut fine = self.samples()?;
        let mut planes = Vec::new();
        for level in 1..=self.last() {
            let coarse = pull::pull(&fine, side(level - 1), self.job.exec);
            planes.extend(planes::write_level(&PULL, level, &coarse, self.job));
            fine = self.read_or(&PULL, level, coarse)?;
        }
        Ok(planes)
    }

    /// The planes of the push phase.
    fn push(&self, settings: &Settings) -> Result<Vec<NamedPlane<R>>> {
        let mut coarse = self.pulled(self.last())?;
        let mut levels = Vec::new();
        for level in (0..self.last()).rev() {
            let fine = self.pulled(level)?;
            let found = push::push(&fine, &coarse, side(level), settings, self.job.exec);
            coarse = self.read_or(&PUSH, level, found.clone())?;
            levels.push(found);
        }
        levels.reverse();
        Ok(write(&PUSH, 0, &levels, self.job))
    }
}
