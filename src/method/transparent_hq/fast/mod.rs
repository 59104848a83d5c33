//! The fast path for `f32`: the bits of the definition, from the fast paths of both its parts, a
//! tile after the other, see [`crate::method`].

mod compositing;
mod nearest;

use super::compositing::Through;
use super::{Settings, picture, planes};
use crate::error::Result;
use crate::frame::Pool;
use crate::method::algorithm::Job;
use crate::method::fast::layered::{LayeredPlanes, clear_plane, store_plane, tiles};
use crate::method::fast::store::{interleaved, row};
use crate::method::picture::{Clock, Picture};
use crate::method::transparent::fast::{FastBlending, Nearest};
use crate::method::transparent::planes as layers;
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
    let through = Through::new(job, settings);
    let (size, grid) = (job.camera.size(), job.grid());
    let mut target = LayeredPlanes::new(size, pool.scalar(size), pool);
    let (mut normal, mut weight) = (pool.triple(size), pool.scalar(size));
    let normals = tiles(&mut normal, &grid, job.exec);
    let beside = normals.into_iter().zip(tiles(&mut weight, &grid, job.exec));
    let jobs = target.tiles(&grid, job.exec).into_iter().zip(beside).enumerate().collect();
    let times = job.exec.ordered(jobs, |(index, (mut tile, (mut normal, mut weight)))| {
        let (start, rect) = (Instant::now(), tile.rect);
        let Some((mut blocks, mut images)) = nearest.geometry(index, rect) else {
            // Where there is no nearest layer nothing is seen.
            tile.clear(0.0);
            clear_plane(rect, &mut normal, [0.0; 3]);
            clear_plane(rect, &mut weight, 0.0);
            return [start.elapsed(), Duration::ZERO, Duration::ZERO, Duration::ZERO];
        };
        let drawn = Instant::now();
        let fronts = nearest.resolve(&mut blocks, &mut images);
        let resolved = Instant::now();
        let band = |block: usize| Nearest(blocks.blocks[block].least);
        let others = blending.averages::<true>(index, rect, band);
        let blended = Instant::now();
        let shown = compositing(&through, &blocks, &fronts, others.as_deref());
        tile.store(&shown, |layers| layers);
        store_plane(rect, &blocks.blocks, &mut normal, |b, i| interleaved(&b.normal, i));
        store_plane(rect, &blocks.blocks, &mut weight, |b, i| row(&b.weight, i));
        [drawn - start, resolved - drawn, blended - resolved, blended.elapsed()]
    });
    clock.shares(["geometry", "nearest", "blending", "compositing"], &times);
    let LayeredPlanes { color, alpha, depth, id, layers: counts } = target;
    let mut left: Vec<_> = layers::before(job, color, alpha).into();
    left.push(planes::layers(counts));
    left.extend(planes::nearest_planes(depth, normal, weight, id));
    clock.lap("compositing");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: nearest.prepared.tally, timings })
}
