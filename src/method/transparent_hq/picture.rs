//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::compositing::compositing;
use super::nearest::{FrontLayer, nearest, single_pass};
use super::{Settings, planes};
use crate::error::{Error, Result};
use crate::frame::NamedPlane;
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::Picture;
use crate::method::single_pass::geometry::{Geometry, ImagePixel};
use crate::method::single_pass::picture as first;
use crate::method::single_pass::planes::{given_images, image_planes};
use crate::method::stage::{Keep, unknown};
use crate::method::tiled::Tiled;
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::blending::Blending;
use crate::method::transparent::picture as second;
use crate::method::transparent::planes as layers;
use crate::number::Exact;

/// The stages of pass 1 that run tile by tile.
const FIRST: [&str; 2] = ["geometry", "nearest"];

/// The definition of Algorithm 3, in any number type. With `stages`, every stage leaves its planes.
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

    // 2. The other layers.
    let second::Blended { images: others_images, averages } =
        others(job, settings, &blending, &near, stages, &mut clock);

    // 3. Compositing.
    let blends = compositing(job, settings, &near, &averages);
    let shown = planes::compositing(job, &blends, &near, &averages);
    let pictured = near.planes(&FrontLayer::PICTURE, 0, &job.there(Keep::Picture));
    clock.lap("compositing");

    let mut left = image_planes(job, &ImagePixel::NEAREST, settings.nearest, &images);
    if stages {
        let there = job.there(Keep::Stages);
        left.extend(near.planes(&FrontLayer::STAGES, 0, &there));
        left.extend(layers::images(&others_images, &there));
        left.extend(averages.planes(&GroupAverage::PLANES, 0, &there));
        left.push(planes::layers_by_opacity(&near, &averages));
    }
    left.extend(shown);
    left.extend(pictured);
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: geometry.splats.tally, timings, seen: None })
}

/// Checks that there is something to refract.
pub(super) fn check(job: &Job<'_>, settings: &Settings) -> Result<()> {
    if settings.refraction.is_some() && job.scene.environment.is_none() {
        let what = "refraction needs something to be seen through it; give an environment";
        return Err(Error::Invalid(what.into()));
    }
    Ok(())
}

/// Runs Algorithm 2 without the fragments of the nearest layer and the fragments before it.
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

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    check(job, settings)?;
    let (mut clock, there) = (Clock::default(), job.there(Keep::Alone));
    match stage {
        "geometry" => {
            let geometry = Geometry::<R>::project(job, &single_pass(settings))?;
            let passes = first::passes(job, &geometry, true, FIRST, &mut clock);
            Ok(image_planes(job, &ImagePixel::NEAREST, settings.nearest, &passes.images))
        }
        "nearest" => {
            let images = given_images(job, &ImagePixel::NEAREST, given)?;
            let near = nearest(job, &first::composite(job, &single_pass(settings), &images));
            let mut left = near.planes(&FrontLayer::STAGES, 0, &there);
            left.extend(near.planes(&FrontLayer::PICTURE, 0, &there));
            Ok(left)
        }
        "blending" => {
            let near = planes::given_nearest(given)?;
            let blending = Blending::project(job, &settings.layers)?;
            let blended = others(job, settings, &blending, &near, true, &mut clock);
            Ok(layers::images(&blended.images, &there))
        }
        "averaging" => {
            let images = layers::given_images(job, given)?;
            let averages = second::average(job, settings.layers.holes, &images);
            Ok(averages.planes(&GroupAverage::PLANES, 0, &there))
        }
        "compositing" => {
            let near = planes::given_nearest(given)?;
            let others = given.pixels(&GroupAverage::PLANES, 0, GroupAverage::EMPTY)?;
            let blends = compositing(job, settings, &near, &others);
            let mut left = planes::compositing(job, &blends, &near, &others);
            left.push(planes::layers_by_opacity(&near, &others));
            Ok(left)
        }
        _ => Err(unknown(stage)),
    }
}
