//! Share code among the fast paths for `f32`: records of splats, the blocks of a tile, and the work
//! on a block that every method has. [`crate::method`] describes the layout.

pub(super) mod fragments;
pub(super) mod groups;
pub(super) mod layered;
pub(super) mod lists;
pub(super) mod resolve;
pub(super) mod store;
pub(super) mod tile;

use super::algorithm::Job;
use super::picture::wall_shares;
use super::prepare::Prepared;
use crate::frame::{Framebuffer, Rect};
use crate::splat::SplatSettings;
use crate::splat::batch;
use std::time::{Duration, Instant};
use tile::{Record, Surface, Tile};

/// Projects the splats and sorts them into tiles.
pub(super) fn prepare(job: &Job<'_>, settings: &SplatSettings) -> Prepared<f32, Record> {
    let surfels = &job.scene.surfels;
    let colors = surfels.color();
    Prepared::new(
        (job, &job.strips()),
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

/// The times of the stages of a tile; the work between two laps belongs to the second.
pub(super) struct Stopwatch<const N: usize> {
    last: Instant,
    times: [Duration; N],
}

impl<const N: usize> Stopwatch<N> {
    /// Stage `stage` ends.
    pub(super) fn lap(&mut self, stage: usize) {
        let now = Instant::now();
        self.times[stage] += now - self.last;
        self.last = now;
    }
}

/// Draws every tile of a framebuffer, and returns the stages' shares of the wall time.
///
/// `gather` starts a tile: its splats, in the order of their surfels, and its empty blocks. `stages`
/// leaves depths, averages and directions in the blocks of a tile that has splats. It ends a lap
/// after each stage but the last. The first lap includes gathering the splats, the last storing the
/// pixels.
pub(super) fn draw<const N: usize>(
    job: &Job<'_>,
    target: &mut Framebuffer<f32>,
    gather: impl Fn(&mut Tile, usize, Rect) + Sync + Send,
    stages: impl Fn(&mut Tile, &mut Stopwatch<N>) + Sync + Send,
) -> [Duration; N] {
    let start = Instant::now();
    let times = job.exec.ordered(target.cut(&job.strips(), job.exec), |mut pixels| {
        let mut watch = Stopwatch { last: Instant::now(), times: [Duration::ZERO; N] };
        let mut tile = Tile::new([pixels.normal.is_some(), pixels.color.is_some()]);
        gather(&mut tile, pixels.depth.index, pixels.depth.rect);
        if tile.splats.is_empty() {
            store::clear(&mut pixels);
            watch.lap(N - 1);
        } else {
            stages(&mut tile, &mut watch);
            store::store(&tile, &mut pixels);
            watch.lap(N - 1);
        }
        watch.times
    });
    wall_shares(start.elapsed(), &times)
}
