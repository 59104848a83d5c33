//! Run all layers in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::Settings;
use super::blending::shown;
use super::layers::{PeeledLayer, PeeledPixel, Peeling};
use super::planes::{self, STAGES};
use crate::error::Result;
use crate::frame::{NamedPlane, Rect};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::fragment::TileSplats;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::Picture;
use crate::method::stage::{Keep, unknown};
use crate::method::tiled::Tiled;
use crate::number::Exact;

/// The definition, in any number type. With `stages`, the first [`STAGES`] layers leave their
/// planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let peeling = Peeling::<R>::project(job, settings);
    clock.lap("projection");
    let keep = if stages { settings.layers.min(STAGES) as usize } else { 0 };
    let peeled = peel(job, &peeling, settings, keep, &mut clock);
    let (color, alpha) = shown(job, &peeled.pixels.map(|pixel| pixel.blend));
    let (color, alpha) =
        (color.map(|color| job.buffers.color(*color)), alpha.map(|alpha| job.buffers.sum(*alpha)));
    let pixels = planes::pixels(&peeled.pixels);
    clock.lap("blending");
    let mut left = peeled.layer_planes(job);
    left.extend(planes::shown(color, alpha));
    left.extend(pixels);
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: peeling.splats.tally, timings, seen: None })
}

/// The results of the stage of layers.
struct Peeled<R> {
    pixels: Tiled<PeeledPixel<R>>,
    kept: Vec<Tiled<PeeledLayer<R>>>,
}

impl<R: Exact> Peeled<R> {
    fn layer_planes(&self, job: &Job<'_>) -> Vec<NamedPlane<R>> {
        let there = job.there(Keep::Stages);
        let planes = |(number, layer): (usize, &Tiled<PeeledLayer<R>>)| {
            layer.planes(&PeeledLayer::PLANES, number, &there)
        };
        (1..).zip(&self.kept).flat_map(planes).collect()
    }
}

/// Peels and blends the layers of every tile.
fn peel<R: Exact>(
    job: &Job<'_>,
    peeling: &Peeling<'_, R>,
    settings: &Settings,
    keep: usize,
    clock: &mut Clock,
) -> Peeled<R> {
    let grid = job.grid();
    let tiles = job
        .exec
        .ordered(grid.rects().into_iter().enumerate().collect(), |(tile, rect): (usize, Rect)| {
            peeling.tile(tile, rect, settings.layers, keep)
        });
    let times: Vec<_> = tiles.iter().map(|tile| tile.times).collect();
    clock.shares(["layers", "blending"], &times);
    let (pixels, kept) = tiles.into_iter().map(|tile| (tile.pixels, tile.kept)).unzip();
    Peeled { pixels: Tiled::from_tiles(grid, pixels), kept: Tiled::images(grid, kept) }
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    match (stage, planes::given_layers(given)) {
        ("layers", 0) => {
            let keep = settings.layers.min(STAGES) as usize;
            let peeling = Peeling::project(job, settings);
            let peeled = peel(job, &peeling, settings, keep, &mut Clock::default());
            let mut left = peeled.layer_planes(job);
            left.extend(planes::pixels(&peeled.pixels));
            Ok(left)
        }
        ("layers", before) => {
            let layer = next_layer(job, settings, given, before)?;
            Ok(layer.planes(&PeeledLayer::PLANES, before + 1, &job.there(Keep::Alone)))
        }
        ("blending", _) => {
            let (color, alpha) = shown(job, &planes::given_blends(given)?);
            Ok(planes::shown(color, alpha).into())
        }
        _ => Err(unknown(stage)),
    }
}

/// The layer after the client's layer `before`.
fn next_layer<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    given: &InputPlanes<'_, R>,
    before: usize,
) -> Result<Tiled<PeeledLayer<R>>> {
    let peeling = Peeling::<R>::project(job, settings);
    let limits = planes::given_limits(given, before, peeling.splats.epsilon)?;
    Ok(Tiled::new(job, |tile, rect| {
        let splats = TileSplats::new(&peeling.splats, tile, rect);
        let layer = peeling.layer(&splats, limits.tile(tile));
        layer.unwrap_or_else(|| vec![PeeledLayer::NONE; rect.pixels()])
    }))
}
