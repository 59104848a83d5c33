//! What the fast paths for `f32` share: records of splats, the blocks of a tile, and what is done
//! with a block whatever the method. The layout: [`crate::method`].

pub(super) mod fragments;
pub(super) mod groups;
pub(super) mod layered;
pub(super) mod lists;
pub(super) mod resolve;
pub(super) mod store;
pub(super) mod tile;

use super::algorithm::Job;
use super::prepare::Prepared;
use crate::frame::Framebuffer;
use crate::splat::SplatSettings;
use crate::splat::batch;
use std::time::{Duration, Instant};
use tile::{Record, Surface, Tile};

/// Projection and binning.
pub(super) fn prepare(job: &Job<'_>, settings: &SplatSettings) -> Prepared<f32, Record> {
    let surfels = &job.scene.surfels;
    let colors = surfels.color();
    Prepared::new(
        job,
        settings,
        surfels.len(),
        |projector, range, records| {
            batch::splats_f32(projector, surfels, range, |splat| {
                records.push(Record::new(&splat, Surface::new(&splat, surfels.normal(), colors)));
            })
        },
        Record::bounds,
    )
}

/// Draws every tile of a framebuffer, and gives the stages' shares of the wall time.
///
/// `stages` leaves depths, averages and directions in the blocks of a tile that has splats, and
/// tells how long each stage took; the first includes gathering the splats, the last storing the
/// pixels.
pub(super) fn draw<const N: usize>(
    job: &Job<'_>,
    prepared: &Prepared<f32, Record>,
    target: &mut Framebuffer<f32>,
    stages: impl Fn(&mut Tile) -> [Duration; N] + Sync + Send,
) -> [Duration; N] {
    let start = Instant::now();
    let tiles = target.tiles(&job.grid(), job.exec).into_iter().enumerate().collect();
    let times = job.exec.ordered(tiles, |(index, mut pixels)| {
        let start = Instant::now();
        let wanted = [pixels.normal.is_some(), pixels.color.is_some()];
        let mut tile = Tile::gather(prepared, index, pixels.rect, wanted);
        let mut times = [Duration::ZERO; N];
        if tile.splats.is_empty() {
            store::clear(&mut pixels);
            times[0] = start.elapsed();
            return times;
        }
        let gathered = start.elapsed();
        times = stages(&mut tile);
        let start = Instant::now();
        store::store(&tile, &mut pixels);
        times[0] += gathered;
        times[N - 1] += start.elapsed();
        times
    });
    let wall = start.elapsed();
    let zero = [Duration::ZERO; N];
    let sums = times.iter().fold(zero, |a, b| std::array::from_fn(|i| a[i] + b[i]));
    let total: Duration = sums.iter().sum();
    sums.map(|part| match total.as_secs_f64() {
        0.0 => Duration::ZERO,
        total => wall.mul_f64(part.as_secs_f64() / total),
    })
}
