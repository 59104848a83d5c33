//! Draw in `f32`, fast: the bits of the definition, from the fast paths of both parts, tile after
//! tile, see [`crate::method`]. A splat is projected, sorted into tiles and gathered once for both
//! parts, if no group enlarges it.

mod compositing;
mod nearest;
mod projection;

use super::compositing::Through;
use super::{Settings, picture, planes};
use crate::error::Result;
use crate::frame::Pool;
use crate::method::Job;
use crate::method::clock::{Clock, Stopwatch};
use crate::method::fast::layered::LayeredPlanes;
use crate::method::fast::store::{clear_plane, store_plane};
use crate::method::picture::Picture;
use crate::method::transparent::fast::Nearest;
use crate::method::transparent::planes as layers;
use crate::number::lanes::components;
use crate::scene::Environment;
use compositing::compositing;
use nearest::FastNearest;
use projection::Splats;

/// Draws the picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    picture::check(job, settings)?;
    let mut clock = Clock::default();
    let nearest = FastNearest::new(job, settings)?;
    let splats = Splats::project(job, settings)?;
    clock.lap("projection");
    let through = Through::new(job, settings, Environment::radiance);
    let (size, grid) = (job.size(), job.strips());
    let mut target = LayeredPlanes::new(size, pool.scalar(size), pool);
    let (mut normal, mut weight) = (pool.triple(size), pool.scalar(size));
    let normals = grid.cut(&mut normal, job.exec).into_iter();
    let beside = normals.zip(grid.cut(&mut weight, job.exec));
    let jobs = target.cut(&grid, job.exec).into_iter().zip(beside).collect();
    let times = job.exec.ordered(jobs, |(mut pixels, (mut normal, mut weight))| {
        let mut watch = Stopwatch::start();
        let mut gathered = splats.gather(pixels.depth.index, pixels.depth.rect);
        if gathered.nearest.splats.is_empty() {
            // Without a nearest layer nothing is seen, because pass 2 drops all fragments there.
            watch.lap(0);
            pixels.clear(0.0);
            clear_plane(&mut normal, [0.0; 3]);
            clear_plane(&mut weight, 0.0);
            watch.lap(3);
            return watch.times();
        }
        let mut images = nearest.geometry(&gathered);
        watch.lap(0);
        let fronts = nearest.resolve(&mut gathered.nearest, &mut images);
        watch.lap(1);
        let (layers, blocks) = (&gathered.layers, &gathered.nearest);
        let band = |block: usize| Nearest(blocks.blocks[block].least);
        let others = splats.blending.averages::<true>(layers, &blocks.grid, band);
        watch.lap(2);
        let shown = compositing(&through, blocks, &fronts, &others);
        pixels.store(&shown, |layers| layers);
        store_plane(&blocks.blocks, &mut normal, |block, i| components(&block.normal, i));
        store_plane(&blocks.blocks, &mut weight, |block, i| block.weight[i]);
        watch.lap(3);
        watch.times()
    });
    let stages = ["geometry", "nearest", "blending and averaging", "compositing"];
    clock.shares(stages, &times);
    let LayeredPlanes { color, alpha, depth, id, layers: counts } = target;
    let mut left: Vec<_> = layers::before(job, color, alpha).into();
    left.push(planes::layers(counts));
    left.extend(planes::nearest_planes(depth, normal, weight, id));
    clock.lap("compositing");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: splats.tally(), timings, seen: None })
}
