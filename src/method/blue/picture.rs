//! Run both stages in one call, from a scene to named planes; or one stage on a client's planes.

use super::discs::{Kept, nearest, shown};
use super::polygons::Polygons;
use super::squares::Squares;
use super::{Settings, fast, planes};
use crate::error::Result;
use crate::frame::{Framebuffer, NamedPlane, Pool, Wanted};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Picture, finish, framebuffer};
use crate::method::projection::Has;
use crate::method::stage::unknown;
use crate::method::surface;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::Tally;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let Drawn { target, kept, tally } = discs(job, settings, stages)?;
    clock.lap("discs");
    let left = if stages { planes::stages(job, &kept, &target) } else { Vec::new() };
    Ok(finish(target, left, tally, clock, job))
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    match stage {
        "discs" => {
            let Drawn { target, kept, .. } = discs(job, settings, true)?;
            let mut left = planes::stages(job, &kept, &target);
            left.extend(planes::pixels(target));
            Ok(left)
        }
        "shading" => surface::shade(job, given, Has::in_scene(job.scene).color),
        _ => Err(unknown(stage)),
    }
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut clock = Clock::default();
    let mut target = framebuffer(job, wanted(job, false), pool);
    let tally = fast::render(job, settings, &mut target);
    if let Some(polygons) = Polygons::draw(job, settings)? {
        polygons.over(&mut target, job);
    }
    clock.lap("discs");
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// The output of the discs stage.
struct Drawn<R> {
    target: Framebuffer<R>,
    kept: Tiled<Kept<R>>,
    tally: Tally,
}

fn discs<R: Exact>(job: &Job<'_>, settings: &Settings, stages: bool) -> Result<Drawn<R>> {
    let squares = Squares::new(job, settings.cull);
    let kept = nearest(job, &squares);
    let wanted = wanted(job, stages);
    let pixels = kept.map(|kept| shown(job, kept, wanted.color));
    let mut target = surface::framebuffer(job, &pixels, wanted);
    if let Some(polygons) = Polygons::draw(job, settings)? {
        polygons.over(&mut target, job);
    }
    Ok(Drawn { target, kept, tally: squares.tally })
}

/// The planes that a scene needs.
fn wanted(job: &Job<'_>, stages: bool) -> Wanted {
    Wanted {
        normal: stages || !job.scene.lights.is_empty(),
        color: Has::in_scene(job.scene).color,
        observed: false,
    }
}
