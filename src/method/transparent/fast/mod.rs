//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! A surfel is projected once for all groups that draw it with the same radius, and its fragments
//! are computed once for them. Block after block is finished. A fragment is blended into the images
//! of its groups, which the nearest cache holds. Then the groups are averaged, in their order. So
//! no image of a group is kept beyond its block, and both stages have one lap.

mod averaging;
mod blending;
mod projection;

pub(crate) use averaging::AverageBlock;
pub(crate) use blending::Nearest;
pub(crate) use projection::{Layer, LayerOfSurface};

use super::{Holes, Settings, planes};
use crate::composite::bins::DepthBins;
use crate::error::Result;
use crate::frame::Pool;
use crate::index::members::Set;
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::fast::layered::{LayeredBlock, LayeredPlanes};
use crate::method::fast::lists::BlockLists;
use crate::method::fast::tile::{BlockGrid, Record};
use crate::method::picture::Picture;
use crate::method::prepare::Prepared;
use blending::LayersBlock;
use projection::Blended;

/// The splats of all groups as records with `A`, projected, shaded and sorted into tiles.
pub(crate) struct FastBlending<A> {
    pub(crate) prepared: Prepared<f32, Record<A>>,
    /// The bins of each group.
    bins: Vec<DepthBins<f32>>,
    holes: Holes,
}

/// Draws the picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let mut clock = Clock::default();
    let blending = FastBlending::<Layer>::project(job, settings, Set::count_ones)?;
    clock.lap("projection");
    let (size, grid) = (job.size(), job.strips());
    let mut target = LayeredPlanes::new(size, pool.scalar(size), pool);
    job.exec.ordered(target.cut(&grid, job.exec), |mut pixels| {
        let mut splats = Vec::new();
        blending.prepared.gather_f32(pixels.depth.index, &pixels.depth.rect, &mut splats);
        if splats.is_empty() {
            pixels.clear(0.0);
        } else {
            let grid = BlockGrid::new(pixels.depth.rect);
            let averages = blending.averages::<false>(&splats, &grid, |_| Nearest::NONE);
            let blocks: Vec<_> = averages.iter().map(AverageBlock::layers).collect();
            pixels.store(&blocks, |layers| layers);
        }
    });
    let LayeredPlanes { color, alpha, depth, id, layers } = target;
    let mut left: Vec<_> = planes::before(job, color, alpha).into();
    left.extend(planes::nearest_planes(depth, id, layers));
    clock.lap("blending and averaging");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: blending.tally(), timings, seen: None })
}

impl<A: Blended> FastBlending<A> {
    /// Runs both passes over the splats of a tile, and returns the average of its blocks.
    ///
    /// With `BEHIND`, fragments that are not strictly beyond the nearest layer of a block are
    /// dropped, and the sums of opacities are computed.
    pub(crate) fn averages<const BEHIND: bool>(
        &self,
        splats: &[Record<A>],
        grid: &BlockGrid,
        nearest: impl Fn(usize) -> Nearest,
    ) -> Vec<AverageBlock> {
        let lists = BlockLists::new(splats, grid, &self.prepared.shared);
        let mut averages = vec![AverageBlock::EMPTY; grid.len()];
        let mut images = vec![LayersBlock::EMPTY; self.bins.len()];
        for (block, list) in lists.blocks() {
            let (average, corner) = (&mut averages[block], grid.corner(block));
            let nearest = nearest(block);
            self.blend::<BEHIND>(average, &mut images, splats, list, corner, &nearest);
        }
        averages
    }
}

impl AverageBlock {
    /// The part of the average that pictures keep.
    fn layers(&self) -> LayeredBlock {
        let Self { color, alpha, depth, id, layers, .. } = *self;
        LayeredBlock { color, alpha, depth, id, layers }
    }
}
