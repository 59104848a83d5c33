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
    let times = job.exec.ordered(target.strips(&job.grid(), job.exec), |mut pixels| {
        let mut times = [Duration::ZERO; N];
        let mut tile = Tile::new([pixels.normal.is_some(), pixels.color.is_some()]);
        for (index, rect) in pixels.depth.strip.tiles() {
            let start = Instant::now();
            tile.gather(prepared, index, rect);
            if tile.splats.is_empty() {
                store::clear(&rect, &mut pixels);
                times[0] += start.elapsed();
                continue;
            }
            let gathered = Instant::now();
            let passes = stages(&mut tile);
            let drawn = Instant::now();
            store::store(&tile, &mut pixels);
            times.iter_mut().zip(passes).for_each(|(sum, time)| *sum += time);
            times[0] += gathered - start;
            times[N - 1] += drawn.elapsed();
        }
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
