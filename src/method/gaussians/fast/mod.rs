//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! A tile gathers its splats in their order. Each splat is blended into the blocks that it may touch;
//! a block whose pixels are all done is left out, and the tile ends when all of its blocks are. In an
//! order of each pixel's own, the definition draws each block from the splats that may touch it.

mod blending;

use super::blending::{Blending, GaussianPixel, Rules};
use super::picture::{self, display};
use super::splats::{Source, Splats};
use super::{Order, Settings, planes};
use crate::frame::{Grid, NO_ID, NamedPlane, Plane, Pool, Rect, TileMut};
use crate::method::Job;
use crate::method::buffer_formats::Buffers;
use crate::method::fast::store::{clear_plane, store_plane};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::picture::{Clock, Picture};
use crate::method::stage::Keep;
use crate::method::tiled::{self, Tiled};
use blending::{Block, Blocks};

/// Draws the picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Picture<f32> {
    if job.buffers != Buffers::F32 {
        return picture::define(job, settings, false);
    }
    let mut clock = Clock::default();
    let source = Source::<f32>::new(job.scene, job.camera, settings);
    if settings.order == Order::Pixel {
        return by_pixels(job, source, clock);
    }
    let grid = job.strips();
    let splats = Splats::new(job, &grid, &source);
    clock.lap(planes::STAGES[0].name);
    let mut target = Target::new(job.camera.size(), pool);
    let tiles = target.cut(&grid, job);
    job.exec.ordered(tiles, |mut tile| {
        let rect = tile.depth.rect;
        let places = splats.places(tile.depth.index, rect);
        let gathered: Vec<_> = places.into_iter().map(|place| splats.all[place]).collect();
        if gathered.is_empty() {
            tile.clear();
        } else {
            let mut blocks = Blocks::new(rect);
            blocks.blend(&gathered, settings);
            tile.store(blocks.finished());
        }
    });
    clock.lap(planes::STAGES[1].name);
    let mut left = Vec::new();
    let shown = display(job, &source, &target.color, &target.through);
    left.extend(target.planes());
    left.extend(shown);
    clock.lap(planes::STAGES[2].name);
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Picture { frame, tally: splats.tally, timings, seen: None }
}

/// Draws a picture in an order of each pixel's own: as the definition does, but each pixel looks only
/// at the splats of its block.
fn by_pixels(job: &Job<'_>, source: Source<'_, f32>, mut clock: Clock) -> Picture<f32> {
    let splats = Splats::new(job, &job.grid(), &source);
    clock.lap(planes::STAGES[0].name);
    let rules = Rules::new(source.settings);
    let blending = Blending { source, splats: &splats, rules, buffers: Buffers::F32 };
    let blended = Tiled::new(job, |tile, rect| {
        let places = splats.places(tile, rect);
        let mut pixels = vec![GaussianPixel::EMPTY; rect.pixels()];
        let grid = BlockGrid::new(rect);
        for block in 0..grid.len() {
            let (x0, y0) = grid.corner(block);
            let own = Rect { x0, y0, x1: x0 + SIDE, y1: y0 + SIDE }.intersection(&rect);
            let touches =
                |place: &&usize| !splats.all[**place].bounds.intersection(&own).is_empty();
            let near: Vec<usize> = places.iter().filter(touches).copied().collect();
            for (x, y) in tiled::pixels(own) {
                let at = (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
                pixels[at] = blending.pixel(&near, (x, y), |_, _, _| ());
            }
        }
        pixels
    });
    clock.lap(planes::STAGES[1].name);
    picture::finished(job, (&blending.source, &blended), (splats.tally, clock), Keep::Picture)
}

/// The planes of blending.
struct Target {
    color: Plane<[f32; 3]>,
    through: Plane<f32>,
    depth: Plane<f32>,
    expected: Plane<f32>,
    median: Plane<f32>,
    id: Plane<u32>,
    heaviest: Plane<u32>,
    count: Plane<u8>,
}

/// One tile of the planes, writable.
struct TargetTile<'a> {
    color: TileMut<'a, [f32; 3]>,
    through: TileMut<'a, f32>,
    depth: TileMut<'a, f32>,
    expected: TileMut<'a, f32>,
    median: TileMut<'a, f32>,
    id: TileMut<'a, u32>,
    heaviest: TileMut<'a, u32>,
    count: TileMut<'a, u8>,
}

impl Target {
    /// Planes in memory that is used again; their values are arbitrary.
    fn new(size: [u32; 2], pool: &mut Pool) -> Self {
        Self {
            color: pool.triple(size),
            through: pool.scalar(size),
            depth: pool.scalar(size),
            expected: pool.scalar(size),
            median: pool.scalar(size),
            id: pool.index(size),
            heaviest: pool.index(size),
            count: pool.count(size),
        }
    }

    /// The tiles, row by row.
    fn cut(&mut self, grid: &Grid, job: &Job<'_>) -> Vec<TargetTile<'_>> {
        let exec = job.exec;
        let mut through = grid.cut(&mut self.through, exec).into_iter();
        let mut depth = grid.cut(&mut self.depth, exec).into_iter();
        let mut expected = grid.cut(&mut self.expected, exec).into_iter();
        let mut median = grid.cut(&mut self.median, exec).into_iter();
        let mut id = grid.cut(&mut self.id, exec).into_iter();
        let mut heaviest = grid.cut(&mut self.heaviest, exec).into_iter();
        let mut count = grid.cut(&mut self.count, exec).into_iter();
        let color = grid.cut(&mut self.color, exec).into_iter();
        let all = color.map_while(|color| {
            Some(TargetTile {
                color,
                through: through.next()?,
                depth: depth.next()?,
                expected: expected.next()?,
                median: median.next()?,
                id: id.next()?,
                heaviest: heaviest.next()?,
                count: count.next()?,
            })
        });
        all.collect()
    }

    /// The planes by their names, in the order of the definition.
    fn planes(self) -> [NamedPlane<f32>; 8] {
        let [color, through, depth, expected, median, id, heaviest, count] =
            crate::method::record::rows(&GaussianPixel::<f32>::PLANES);
        [
            color.triple(0, self.color),
            through.scalar(0, self.through),
            depth.scalar(0, self.depth),
            expected.scalar(0, self.expected),
            median.scalar(0, self.median),
            id.index(0, self.id),
            heaviest.index(0, self.heaviest),
            count.count(0, self.count),
        ]
    }
}

impl TargetTile<'_> {
    /// Writes a tile without splats.
    fn clear(&mut self) {
        clear_plane(&mut self.color, [0.0; 3]);
        clear_plane(&mut self.through, 1.0);
        for plane in [&mut self.depth, &mut self.expected, &mut self.median] {
            clear_plane(plane, f32::INFINITY);
        }
        for plane in [&mut self.id, &mut self.heaviest] {
            clear_plane(plane, NO_ID);
        }
        clear_plane(&mut self.count, 0);
    }

    /// Copies the blocks of a tile into its rows.
    fn store(&mut self, blocks: &[Block]) {
        store_plane(blocks, &mut self.color, |block, i| {
            [block.color[0][i], block.color[1][i], block.color[2][i]]
        });
        store_plane(blocks, &mut self.through, |block, i| block.through[i]);
        store_plane(blocks, &mut self.depth, |block, i| block.depth[i]);
        store_plane(blocks, &mut self.expected, |block, i| block.expected[i]);
        store_plane(blocks, &mut self.median, |block, i| block.median[i]);
        store_plane(blocks, &mut self.id, |block, i| block.id[i]);
        store_plane(blocks, &mut self.heaviest, |block, i| block.heaviest[i]);
        store_plane(blocks, &mut self.count, |block, i| block.count[i] as u8);
    }
}

#[cfg(test)]
mod tests;
