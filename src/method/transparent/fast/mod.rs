//! The fast path for `f32`: the bits of the definition, from another layout, see [`crate::method`].
//!
//! In a tile the splats are sorted by group, back to front within each. Then block after block is
//! finished: the layers of one group are blended, the group is added to the average, and the next
//! group begins with the same numbers. So no image of a group is kept at all.

mod averaging;
mod blending;
mod projection;

pub(in crate::method) use averaging::AverageBlock;
pub(in crate::method) use blending::Nearest;

use super::{Holes, Settings, planes};
use crate::composite::bins::DepthBins;
use crate::error::Result;
use crate::frame::{Pool, Rect};
use crate::method::algorithm::Job;
use crate::method::fast::groups::sorted;
use crate::method::fast::layered::{LayeredBlock, LayeredPlanes};
use crate::method::fast::lists::BlockLists;
use crate::method::fast::tile::{BlockGrid, Record};
use crate::method::picture::{Clock, Picture};
use crate::method::prepare::Prepared;
use projection::Layer;
use std::time::Instant;

/// The splats of all groups, projected, shaded and sorted into tiles.
pub(in crate::method) struct FastBlending {
    pub(in crate::method) prepared: Prepared<f32, Record<Layer>>,
    /// Of each group.
    bins: Vec<DepthBins<f32>>,
    holes: Holes,
}

/// The picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut clock = Clock::default();
    let blending = FastBlending::project(job, settings)?;
    clock.lap("projection");
    let (size, grid) = (job.camera.size(), job.grid());
    let mut target = LayeredPlanes::new(size, pool.scalar(size), pool);
    let times = job.exec.ordered(target.strips(&grid, job.exec), |mut pixels| {
        let start = Instant::now();
        for (index, rect) in pixels.depth.strip.tiles() {
            match blending.averages::<false>(index, rect, |_| Nearest::NONE) {
                Some(averages) => {
                    let blocks: Vec<_> = averages.iter().map(AverageBlock::layers).collect();
                    pixels.store(&rect, &blocks, |layers| layers);
                }
                None => pixels.clear(&rect, 0.0),
            }
        }
        [start.elapsed()]
    });
    clock.shares(["blending"], &times);
    let LayeredPlanes { color, alpha, depth, id, layers } = target;
    let mut left: Vec<_> = planes::before(job, color, alpha).into();
    left.extend(planes::nearest_planes(depth, id, layers));
    clock.lap("averaging");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: blending.prepared.tally, timings, seen: None })
}

impl FastBlending {
    /// Both passes over a tile: the average of its blocks; none if it has no splats.
    ///
    /// With `BEHIND`, fragments that are not strictly beyond the nearest layer of a block are
    /// dropped, and the sums of opacities are there.
    pub(in crate::method) fn averages<const BEHIND: bool>(
        &self,
        tile: usize,
        rect: Rect,
        nearest: impl Fn(usize) -> Nearest,
    ) -> Option<Vec<AverageBlock>> {
        let mut splats = Vec::new();
        self.prepared.gather_f32(tile, &rect, &mut splats);
        if splats.is_empty() {
            return None;
        }
        let grid = BlockGrid::new(rect);
        let own: Vec<u8> = splats.iter().map(|splat| splat.attributes.group).collect();
        let (order, _) = sorted(&own, self.bins.len());
        let shared = &self.prepared.shared;
        let lists = BlockLists::new(&splats, order.iter().copied(), &grid, shared);
        let mut averages = vec![AverageBlock::EMPTY; grid.len()];
        for (block, list) in lists.blocks() {
            let (average, corner) = (&mut averages[block], grid.corner(block));
            let nearest = nearest(block);
            self.blend::<BEHIND>(average, &splats, list, corner, &nearest);
        }
        Some(averages)
    }
}

impl AverageBlock {
    /// What pictures keep of the average.
    fn layers(&self) -> LayeredBlock {
        let Self { color, alpha, depth, id, layers, .. } = *self;
        LayeredBlock { color, alpha, depth, id, layers }
    }
}
