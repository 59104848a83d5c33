//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::averaging::{GroupAverage, averages};
use super::blending::{Blending, GroupLayers};
use super::{Holes, Settings, planes};
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NamedPlane, Rect};
use crate::method::Job;
use crate::method::clock::{Clock, Stopwatch};
use crate::method::input_planes::InputPlanes;
use crate::method::picture::Picture;
use crate::method::stage::{Keep, unknown};
use crate::method::tiled::Tiled;
use crate::number::Exact;

/// The definition of Algorithm 2, in any number type. With `stages`, every stage leaves its planes.
pub(crate) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let blending = Blending::project(job, settings)?;
    clock.lap("projection");
    let passes = BlendPasses { blending: &blending, holes: settings.holes, keep: stages };
    let Blended { images, averages } = passes.run(job, |_, _, _| true, &mut clock);
    let shown = picture(job, &averages);
    clock.lap("averaging");
    let there = job.there(if stages { Keep::Stages } else { Keep::Picture });
    let mut left = planes::images(&images, &there);
    left.extend(averages.planes(&GroupAverage::PLANES, 0, &there));
    left.extend(shown);
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: blending.tally(), timings, seen: None })
}

/// The planes that every picture has.
fn picture<R: Exact>(job: &Job<'_>, averages: &Tiled<GroupAverage<R>>) -> Vec<NamedPlane<R>> {
    let blends: Tiled<Blend<R>> = averages.map(|pixel| pixel.blend);
    let mut left: Vec<_> = planes::shown(job, &blends).into();
    left.extend(planes::nearest(averages));
    left
}

/// The geometry and the compositing pass.
pub(crate) struct BlendPasses<'a, R: Exact> {
    pub(crate) blending: &'a Blending<R>,
    pub(crate) holes: Holes,
    /// Whether the images of the groups are kept.
    pub(crate) keep: bool,
}

/// The results of both passes.
pub(crate) struct Blended<R> {
    /// The image of each group, if the images are kept.
    pub(crate) images: Vec<Tiled<GroupLayers<R>>>,
    pub(crate) averages: Tiled<GroupAverage<R>>,
}

impl<R: Exact> BlendPasses<'_, R> {
    /// Runs both passes over each tile. Drops the fragments for which `stays` (the tile, the pixel
    /// in it, and the depth) does not hold.
    pub(crate) fn run(
        &self,
        job: &Job<'_>,
        stays: impl Fn(usize, usize, R) -> bool + Sync + Send,
        clock: &mut Clock,
    ) -> Blended<R> {
        let grid = job.grid();
        let tiles = grid.rects().into_iter().enumerate().collect();
        let done = job.exec.ordered(tiles, |(tile, rect): (usize, Rect)| {
            let mut watch = Stopwatch::start();
            let images = self.blending.images(tile, rect, |pixel, t| stays(tile, pixel, t));
            watch.lap(0);
            let averages = averages(&images, rect.pixels(), self.holes);
            watch.lap(1);
            ((self.keep.then_some(images), averages), watch.times())
        });
        let (done, times): (Vec<_>, Vec<_>) = done.into_iter().unzip();
        clock.shares(["blending", "averaging"], &times);
        let (images, averages): (Vec<_>, Vec<_>) = done.into_iter().unzip();
        let images = Tiled::images(grid, images.into_iter().flatten().collect());
        Blended { images, averages: Tiled::from_tiles(grid, averages) }
    }
}

/// Runs the compositing pass over a client's images.
pub(crate) fn average<R: Exact>(
    job: &Job<'_>,
    holes: Holes,
    images: &[Tiled<GroupLayers<R>>],
) -> Tiled<GroupAverage<R>> {
    Tiled::new(job, |tile, rect| {
        let images: Vec<_> = images.iter().map(|image| image.tile(tile)).collect();
        averages(&images, rect.pixels(), holes)
    })
}

/// Runs one stage on a client's planes.
pub(crate) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    match stage {
        "blending" => {
            let blending = Blending::project(job, settings)?;
            let passes = BlendPasses { blending: &blending, holes: settings.holes, keep: true };
            let blended = passes.run(job, |_, _, _| true, &mut Clock::default());
            Ok(planes::images(&blended.images, &job.there(Keep::Alone)))
        }
        "averaging" => {
            let averages = average(job, settings.holes, &planes::given_images(job, given)?);
            let mut left = averages.planes(&GroupAverage::PLANES, 0, &job.there(Keep::Alone));
            left.extend(picture(job, &averages));
            Ok(left)
        }
        _ => Err(unknown(stage)),
    }
}
