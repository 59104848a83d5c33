//! All stages in one call: from a scene to named planes; and one stage on somebody's planes.

use super::compositing::compositing;
use super::nearest::{FrontLayer, nearest, single_pass};
use super::{Settings, planes};
use crate::error::{Error, Result};
use crate::frame::NamedPlane;
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Clock, Picture};
use crate::method::single_pass::geometry::Geometry;
use crate::method::single_pass::picture as first;
use crate::method::stage::unknown;
use crate::method::tiled::Tiled;
use crate::method::transparent::blending::Blending;
use crate::method::transparent::picture as second;
use crate::method::transparent::planes as layers;
use crate::number::Exact;

/// The stages of pass 1 that run tile by tile.
const FIRST: [&str; 2] = ["geometry", "nearest"];

/// The definition of Algorithm 3, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    check(job, settings)?;
    let mut clock = Clock::default();
    let geometry = Geometry::<R>::project(job, &single_pass(settings))?;
    let blending = Blending::project(job, &settings.layers)?;
    clock.lap("projection");

    // 1. The nearest layer.
    let first::Passes { images, composites } =
        first::passes(job, &geometry, stages, FIRST, &mut clock);
    let near = nearest(job, &composites);
    clock.lap("nearest");
    let mut left = planes::geometry(job, settings, &images);

    // 2. The other layers.
    let second::Blended { images, averages } =
        others(job, settings, &blending, &near, stages, &mut clock);

    // 3. Compositing.
    let blends = compositing(job, settings, &near, &averages);
    clock.lap("compositing");
    if stages {
        left.extend(planes::nearest_stages(&near));
        left.extend(layers::images(&images));
        left.extend(layers::averages(&averages));
        left.push(planes::layers_by_opacity(&near, &averages));
    }
    left.extend(planes::compositing(job, &blends, &near, &averages));
    left.extend(planes::nearest(&near));
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: geometry.splats.tally, timings, seen: None })
}

/// Whether there is something to be refracted.
pub(super) fn check(job: &Job<'_>, settings: &Settings) -> Result<()> {
    if settings.refraction.is_some() && job.scene.environment.is_none() {
        let what = "refraction needs something to be seen through it; give an environment";
        return Err(Error::Invalid(what.into()));
    }
    Ok(())
}

/// Algorithm 2 without the fragments of the nearest layer and what is before it.
fn others<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    blending: &Blending<R>,
    nearest: &Tiled<FrontLayer<R>>,
    keep: bool,
    clock: &mut Clock,
) -> second::Blended<R> {
    let epsilon = blending.epsilon();
    let passes = second::BlendPasses { blending, holes: settings.layers.holes, keep };
    passes.run(job, |tile, pixel, t| nearest.tile(tile)[pixel].is_before(t, epsilon), clock)
}

/// One stage on somebody's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    check(job, settings)?;
    let mut clock = Clock::default();
    match stage {
        "geometry" => {
            let geometry = Geometry::<R>::project(job, &single_pass(settings))?;
            let passes = first::passes(job, &geometry, true, FIRST, &mut clock);
            Ok(planes::geometry(job, settings, &passes.images))
        }
        "nearest" => {
            let images = planes::given_geometry(job, given)?;
            let near = nearest(job, &first::composite(job, &single_pass(settings), &images));
            let mut left: Vec<_> = planes::nearest_stages(&near).into();
            left.extend(planes::nearest(&near));
            Ok(left)
        }
        "blending" => {
            let near = planes::given_nearest(given)?;
            let blending = Blending::project(job, &settings.layers)?;
            let blended = others(job, settings, &blending, &near, true, &mut clock);
            Ok(second::blended_alone(&blended.images))
        }
        "averaging" => {
            let images = layers::given_images(job, given)?;
            Ok(layers::averages(&second::average(job, settings.layers.holes, &images)).into())
        }
        "compositing" => {
            let (near, others) = (planes::given_nearest(given)?, layers::given_averages(given)?);
            let blends = compositing(job, settings, &near, &others);
            let mut left = planes::compositing(job, &blends, &near, &others);
            left.push(planes::layers_by_opacity(&near, &others));
            Ok(left)
        }
        _ => Err(unknown(stage)),
    }
}
