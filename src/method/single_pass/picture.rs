//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::compositing::{Composite, composites};
use super::geometry::{Geometry, ImagePixel};
use super::{Settings, fast, planes};
use crate::error::Result;
use crate::frame::{NamedPlane, Pool, Rect, Wanted};
use crate::method::Job;
use crate::method::clock::{Clock, Stopwatch};
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Picture, finish, framebuffer};
use crate::method::stage::{Keep, unknown};
use crate::method::surface::{self, SurfacePixel};
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::scene::Scene;
use crate::splat::{Shared, View};

/// The stages that run tile by tile.
const STAGES: [&str; 2] = ["geometry", "compositing"];

/// The definition, in any number type. With `stages`, every stage leaves its planes.
///
/// Both passes run over one tile before they run over the next. So unless their planes are kept,
/// the images of the groups exist for one tile at a time.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let geometry = Geometry::<R>::project(job, settings)?;
    clock.lap("projection");

    let Passes { images, composites } = passes(job, &geometry, stages, STAGES, &mut clock);

    let averages = composites.map(Composite::surface);
    let target = surface::framebuffer(job, &averages, wanted(job.scene, stages));
    clock.lap("compositing");
    let mut left = Vec::new();
    if stages {
        left.extend(planes::image_planes(job, &ImagePixel::GROUPS, settings.depth, &images));
        left.extend(planes::sums(job, &composites));
        left.extend(surface::colors(job, &averages));
    }
    Ok(finish(target, left, geometry.splats.tally, clock, job))
}

/// The results of both passes.
pub(crate) struct Passes<R> {
    /// The depth-image of each group, if the images are kept.
    pub(crate) images: Vec<Tiled<ImagePixel<R>>>,
    pub(crate) composites: Tiled<Composite<R>>,
}

/// Runs the geometry and the compositing pass, timed as two stages. `keep` keeps the images.
pub(crate) fn passes<R: Exact>(
    job: &Job<'_>,
    geometry: &Geometry<'_, R>,
    keep: bool,
    stages: [&'static str; 2],
    clock: &mut Clock,
) -> Passes<R> {
    let grid = job.grid();
    let (epsilon, empty) = (geometry.splats.epsilon, geometry.shared().empty());
    let tiles = grid.rects().into_iter().enumerate().collect();
    let done = job.exec.ordered(tiles, |(tile, rect): (usize, Rect)| {
        let mut watch = Stopwatch::start();
        let images = geometry.images(tile, rect);
        watch.lap(0);
        let composites = composites(&images, rect.pixels(), epsilon, empty);
        watch.lap(1);
        ((keep.then_some(images), composites), watch.times())
    });
    let (done, times): (Vec<_>, Vec<_>) = done.into_iter().unzip();
    clock.shares(stages, &times);
    let (images, composites): (Vec<_>, Vec<_>) = done.into_iter().unzip();
    let images = Tiled::images(grid, images.into_iter().flatten().collect());
    Passes { images, composites: Tiled::from_tiles(grid, composites) }
}

/// Runs the compositing pass over a client's depth-images.
pub(crate) fn composite<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    images: &[Tiled<ImagePixel<R>>],
) -> Tiled<Composite<R>> {
    let shared = Shared::<R>::new(&View::new(job.camera), &settings.splats.kernel);
    let epsilon = R::from_f32(settings.splats.epsilon.resolve(&job.scene.surfels));
    Tiled::new(job, |tile, rect| {
        let images: Vec<_> = images.iter().map(|image| image.tile(tile)).collect();
        composites(&images, rect.pixels(), epsilon, shared.empty())
    })
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    match stage {
        "geometry" => {
            let geometry = Geometry::<R>::project(job, settings)?;
            let images = passes(job, &geometry, true, STAGES, &mut Clock::default()).images;
            Ok(planes::image_planes(job, &ImagePixel::GROUPS, settings.depth, &images))
        }
        "compositing" => {
            let images = planes::given_images(job, &ImagePixel::GROUPS, given)?;
            let composites = composite(job, settings, &images);
            let mut left = planes::sums(job, &composites);
            let averages = composites.map(Composite::surface);
            left.extend(averages.planes(&SurfacePixel::PLANES, 0, &job.there(Keep::Alone)));
            Ok(left)
        }
        "shading" => surface::shade(job, given, job.scene.surfels.color().is_some()),
        _ => Err(unknown(stage)),
    }
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut target = framebuffer(job, wanted(job.scene, false), pool);
    let (tally, clock) = fast::render(job, settings, &mut target)?;
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
