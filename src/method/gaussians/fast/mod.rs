//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! A tile gathers its splats in their order. Each splat is blended into the blocks that it may touch;
//! a block whose pixels are all done is left out, and the tile ends when all of its blocks are. In an
//! order of each pixel's own, a block lists all fragments first, each pixel sorts its own, and the block
//! then blends the first of each pixel, the second of each, and so on. Discs that meet rays evaluate the
//! definition's own function in each lane. With a surface, each block has its depths, and a lane leaves
//! out what is behind its own.

mod blending;
mod discs;
mod own_order;

use super::blending::{Blending, GaussianPixel, Rules};
use super::order::Splats;
use super::picture::{self, display};
use super::splats::{Beside, Source};
use super::{Order, Settings, planes};
use crate::error::Result;
use crate::frame::{Grid, NO_ID, NamedPlane, Plane, Pool, TileMut};
use crate::memory;
use crate::method::Job;
use crate::method::buffer_formats::Buffers;
use crate::method::clock::{Clock, Work, spend};
use crate::method::fast::store::{clear_plane, store_plane};
use crate::method::picture::Picture;
use blending::{Block, Blocks, Limits};

/// Draws the picture.
///
/// # Errors
/// [`crate::Error::Invalid`] if the process may not hold the lists of pixels with orders of their own.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    if job.buffers != Buffers::F32 {
        return Ok(picture::define(job, settings, false));
    }
    let mut clock = Clock::default();
    let source = Source::<f32>::new(job.scene, job.camera, settings);
    let own = settings.order == Order::Pixel;
    // Strips for one order; blocks that list their splats look at fewer in a square tile.
    let grid = if own { job.grid() } else { job.strips() };
    let splats = Splats::new(job, &grid, &source);
    clock.lap(planes::STAGES[0].name);
    if own {
        let (tiles, most) = (grid.len() as u64, splats.most_in_a_tile(&grid) as u64);
        let at_once = tiles.min(job.exec.threads() as u64);
        memory::ask(at_once * most * own_order::BYTES_A_SPLAT, || {
            format!("a tile of {most} splats, which each pixel sorts by itself,")
        })?;
    }
    let rules = Rules::new(settings);
    let (buffers, key) = (Buffers::F32, job.key);
    let blending = Blending { source, splats: &splats, rules, buffers, key };
    let mut target = Target::new(job.size(), pool);
    let tiles = target.cut(&grid, job);
    job.exec.ordered(tiles, |mut tile| {
        let (index, rect) = (tile.depth.index, tile.depth.rect);
        let places = splats.places(index, rect);
        if places.is_empty() {
            tile.clear();
        } else if own {
            tile.store(&own_order::blend(&blending, &places, rect));
        } else {
            let mut blocks = Blocks::new(rect, blending.source.surface());
            blend(&blending, &places, &mut blocks);
            tile.store(blocks.finished());
        }
    });
    clock.lap(planes::STAGES[1].name);
    let mut left = Vec::new();
    let (mut shown, mut alpha) = (pool.triple(job.size()), pool.scalar(job.size()));
    shown.values_mut().copy_from_slice(target.color.values());
    alpha.values_mut().copy_from_slice(target.through.values());
    let (color, through) = (&target.color, &target.through);
    let shown = display(job, &blending.source, (color, through), (shown, alpha));
    left.extend(target.planes());
    left.extend(shown);
    clock.lap(planes::STAGES[2].name);
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Ok(Picture { frame, tally: splats.tally, timings, seen: None })
}

/// Blends the splats at these places into the blocks of a tile.
fn blend(blending: &Blending<'_, f32>, places: &[usize], blocks: &mut Blocks) {
    spend(Work::Blend);
    let (source, splats) = (&blending.source, blending.splats);
    let limits = Limits::new(source.settings);
    if source.settings.meets_rays() {
        let disc = |&place: &usize| match splats.beside(place) {
            Some(Beside::Disc(disc)) => Some((*splats.at(place), *disc)),
            _ => None,
        };
        let gathered: Vec<_> = places.iter().filter_map(disc).collect();
        discs::blend(blocks, &gathered, &source.projector.rays, &limits);
    } else {
        let gathered: Vec<_> = places.iter().map(|&place| *splats.at(place)).collect();
        blocks.blend(&gathered, &limits);
    }
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
        store_plane(blocks, &mut self.count, |block, i| block.count[i].min(255) as u8);
    }
}

#[cfg(test)]
mod tests;
