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
use super::clock::{Clock, Stopwatch};
use super::prepare::Prepared;
use crate::frame::{Framebuffer, FramebufferTile};
use crate::scene::Surfels;
use crate::splat::batch::{self, Enlarged};
use crate::splat::{Projector, Splat, SplatSettings, Tally};
use std::ops::Range;
use tile::{Record, Surface, Tile};

/// Projects the splats and sorts them into tiles.
pub(super) fn prepare(job: &Job<'_>, settings: &SplatSettings) -> Prepared<f32, Record> {
    let surfels = &job.scene.surfels;
    prepared(job, settings, surfels.len(), |projector, range, records| {
        batch::splats_f32(projector, surfels, range, |splat| records.push(record(&splat, surfels)))
    })
}

/// The same for the surfels of a scene with these indices, which ascend. A record has the place of its
/// surfel in the list.
pub(super) fn prepare_some(
    job: &Job<'_>,
    settings: &SplatSettings,
    indices: &[u64],
) -> Prepared<f32, Record> {
    let surfels = &job.scene.surfels;
    prepared(job, settings, indices.len(), |projector, range, records| {
        let first = range.start;
        let item = |&i: &u64| Enlarged { surfel: i as u32, scale: 1.0, times: 1 };
        let list: Vec<_> = indices[range].iter().map(item).collect();
        batch::enlarged_f32(projector, surfels, &list, |place, splat| {
            records.push(Record { surfel: (first + place) as u32, ..record(&splat, surfels) });
        })
    })
}

/// The splats of `count` surfels in the tiles of a picture.
fn prepared(
    job: &Job<'_>,
    settings: &SplatSettings,
    count: usize,
    project: impl Fn(&Projector<f32>, Range<usize>, &mut Vec<Record>) -> Tally + Sync + Send,
) -> Prepared<f32, Record> {
    Prepared::new(job, &job.strips(), settings, count, project, Record::bounds)
}

#[inline(always)]
fn record(splat: &Splat<f32>, surfels: &Surfels) -> Record {
    Record::new(splat, Surface::new(splat, surfels.normal(), surfels.color()))
}

/// Draws every tile of a framebuffer. The stages with these names get their shares of the time since
/// the last lap of the clock.
///
/// `gather` starts a tile: its splats, in the order of their surfels, and its blocks, empty or with what
/// the pixels held before. `stages`
/// leaves depths, averages and directions in the blocks of a tile that has splats. It ends a lap
/// after each stage but the last. The first lap includes gathering the splats, unless `gather` ends
/// another lap. The last lap includes storing the pixels.
pub(super) fn draw<const N: usize>(
    job: &Job<'_>,
    target: &mut Framebuffer<f32>,
    clock: &mut Clock,
    names: [&'static str; N],
    gather: impl Fn(&mut Tile, &mut FramebufferTile<'_, f32>, &mut Stopwatch<N>) + Sync + Send,
    stages: impl Fn(&mut Tile, &mut Stopwatch<N>) + Sync + Send,
) {
    let times = job.exec.ordered(target.cut(&job.strips(), job.exec), |mut pixels| {
        let mut watch = Stopwatch::start();
        let mut tile = Tile::new([pixels.normal.is_some(), pixels.color.is_some()]);
        gather(&mut tile, &mut pixels, &mut watch);
        if tile.splats.is_empty() {
            watch.lap(0);
            store::clear(&mut pixels);
            watch.lap(N - 1);
        } else {
            stages(&mut tile, &mut watch);
            store::store(&tile, &mut pixels);
            watch.lap(N - 1);
        }
        watch.times()
    });
    clock.shares(names, &times);
}
