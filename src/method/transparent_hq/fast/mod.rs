//! The fast path for `f32`: the bits of the definition, from the fast paths of both its parts, a
//! tile after the other, see [`crate::method`].

mod compositing;
mod nearest;

use super::compositing::Through;
use super::{Settings, picture, planes};
use crate::error::Result;
use crate::frame::Pool;
use crate::method::algorithm::Job;
use crate::method::fast::layered::LayeredPlanes;
use crate::method::fast::store::{clear_plane, interleaved, row, store_plane};
use crate::method::picture::{Clock, Picture};
use crate::method::transparent::fast::{FastBlending, Nearest};
use crate::method::transparent::planes as layers;
use crate::scene::Environment;
use compositing::compositing;
use nearest::FastNearest;
use std::time::{Duration, Instant};

/// The picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    picture::check(job, settings)?;
    let mut clock = Clock::default();
    let nearest = FastNearest::project(job, settings)?;
    let blending = FastBlending::project(job, &settings.layers)?;
    clock.lap("projection");
    let through = Through::new(job, settings, Environment::radiance);
    let (size, grid) = (job.camera.size(), job.grid());
    let mut target = LayeredPlanes::new(size, pool.scalar(size), pool);
    let (mut normal, mut weight) = (pool.triple(size), pool.scalar(size));
    let normals = grid.cut(&mut normal, job.exec).into_iter();
    let beside = normals.zip(grid.cut(&mut weight, job.exec));
    let jobs = target.strips(&grid, job.exec).into_iter().zip(beside).collect();
    let times = job.exec.ordered(jobs, |(mut pixels, (mut normal, mut weight))| {
        let mut times = [Duration::ZERO; 4];
        for (index, rect) in pixels.depth.strip.tiles() {
            let start = Instant::now();
            let Some((mut blocks, mut images)) = nearest.geometry(index, rect) else {
                // Where there is no nearest layer nothing is seen.
                pixels.clear(&rect, 0.0);
                clear_plane(&rect, &mut normal, [0.0; 3]);
                clear_plane(&rect, &mut weight, 0.0);
                times[0] += start.elapsed();
                continue;
            };
            let drawn = Instant::now();
            let fronts = nearest.resolve(&mut blocks, &mut images);
            let resolved = Instant::now();
            let band = |block: usize| Nearest(blocks.blocks[block].least);
            let others = blending.averages::<true>(index, rect, band);
            let blended = Instant::now();
            let shown = compositing(&through, &blocks, &fronts, others.as_deref());
            pixels.store(&rect, &shown, |layers| layers);
            store_plane(&rect, &blocks.blocks, &mut normal, |b, i| interleaved(&b.normal, i));
            store_plane(&rect, &blocks.blocks, &mut weight, |b, i| row(&b.weight, i));
            let laps = [drawn - start, resolved - drawn, blended - resolved, blended.elapsed()];
            times.iter_mut().zip(laps).for_each(|(sum, lap)| *sum += lap);
        }
        times
    });
    clock.shares(["geometry", "nearest", "blending", "compositing"], &times);
    let LayeredPlanes { color, alpha, depth, id, layers: counts } = target;
    let mut left: Vec<_> = layers::before(job, color, alpha).into();
    left.push(planes::layers(counts));
    left.extend(planes::nearest_planes(depth, normal, weight, id));
    clock.lap("compositing");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: nearest.prepared.tally, timings, seen: None })
}
