//! Blend a tile in an order of each pixel's own.

use super::blending::{Block, Limits, before, fragments, inside, opaque};
use super::discs;
use crate::frame::Rect;
use crate::method::clock::{Work, spend};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::gaussians::blending::Blending;
use crate::method::gaussians::splats::{Beside, GaussianSplat, Solid};
use crate::number::lanes::{LANES, Lanes, each, vectorized};
use crate::number::real::ordered_f32;
use crate::splat::gaussian::GaussianProjector;
use multiversion::target::target_cfg_f;

/// The fragments of a splat in a block, of which some are drawn.
#[derive(Clone, Copy)]
struct Fragments {
    alpha: Lanes,
    depth: Lanes,
    color: [f32; 3],
    index: u32,
    /// Its place in the order of the indices.
    place: u32,
}

/// The fragments of a block, and the order that each pixel has for its own.
#[derive(Default)]
struct BlockList {
    fragments: Vec<Fragments>,
    /// For each fragment of a pixel its depth, as a number whose order is that of depths, above its number
    /// in `fragments`; [`Self::room`] of them for each pixel. Sorting these moves few bytes, and calls
    /// nothing to compare.
    keys: Vec<u64>,
    /// The most fragments of a pixel.
    room: usize,
    /// Where the keys of each pixel end.
    ends: [usize; LANES],
}

/// A splat of a tile, with its place in the order of the indices. All of it is copied, so that blocks do
/// not look for it all over memory.
struct Near {
    splat: GaussianSplat<f32>,
    beside: Beside<f32>,
    place: u32,
}

/// The most bytes that a splat takes while its tile is blended: itself, its number in each block of a
/// row, and its fragments in a block. A list that grows has up to twice the room that it needs.
pub(super) const BYTES_A_SPLAT: u64 = {
    // The largest tile has 64 pixels a side.
    let row = 64 / SIDE as usize * size_of::<u32>();
    let fragments = size_of::<Fragments>() + LANES * size_of::<u64>();
    (size_of::<Near>() + 2 * (row + fragments)) as u64
};

/// The blocks of a tile.
pub(super) fn blend(
    blending: &Blending<'_, f32>,
    mut places: Vec<usize>,
    rect: Rect,
) -> Vec<Block> {
    spend(Work::Blend);
    let splats = blending.splats;
    let limits = Limits::new(blending.source.settings);
    let near = |&place: &usize| {
        let (splat, beside) = (*splats.at(place), *splats.beside(place)?);
        Some(Near { splat, beside, place: place as u32 })
    };
    // Fragments that come about in order are sorted fast; the order of the lists decides nothing.
    places.sort_by_cached_key(|&place| ordered_f32(splats.at(place).depth));
    let all: Vec<Near> = places.iter().filter_map(near).collect();
    let mut own = BlockList::default();
    let grid = BlockGrid::new(rect);
    let mut row = vec![Vec::new(); grid.columns as usize];
    let blocks = (0..grid.len()).map(|block| {
        let (column, corner) = (block % row.len(), grid.corner(block));
        if column == 0 {
            list_row(&mut row, &all, (rect, corner.1));
        }
        own.clear(row[column].len());
        let surface = blending.source.surface().map(|surface| opaque(surface, rect, corner));
        let rules = (&limits, &blending.source.projector);
        list(&mut own, (&all, &row[column]), rules, (rect, corner, surface.as_ref()));
        own.sort();
        blended(&own, &limits)
    });
    blocks.collect()
}

/// Lists, for each block of the row that begins at line `y`, the splats whose bounds it touches.
fn list_row(row: &mut [Vec<u32>], all: &[Near], (rect, y): (Rect, u32)) {
    row.iter_mut().for_each(Vec::clear);
    let line = Rect { y0: y, y1: y + SIDE, ..rect };
    for (index, near) in (0..).zip(all) {
        let touched = near.splat.bounds.intersection(&line);
        if !touched.is_empty() {
            let columns = (touched.x0 - rect.x0) / SIDE..(touched.x1 - rect.x0).div_ceil(SIDE);
            let columns = columns.start as usize..columns.end as usize;
            row[columns].iter_mut().for_each(|block| block.push(index));
        }
    }
}

impl BlockList {
    /// Makes room for this many fragments a pixel.
    fn clear(&mut self, room: usize) {
        self.fragments.clear();
        self.keys.resize(self.keys.len().max(LANES * room), 0);
        (self.room, self.ends) = (room, each(|i| i * room));
    }

    /// Sorts the fragments of each pixel by depth, then by place. Few have the same depth.
    fn sort(&mut self) {
        let Self { fragments, keys, room, ends } = self;
        for (i, &end) in ends.iter().enumerate() {
            let own = &mut keys[i * *room..end];
            own.sort_unstable();
            for tied in own.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|tied| tied.len() > 1) {
                tied.sort_unstable_by_key(|&key| fragments[key as u32 as usize].place);
            }
        }
    }
}

vectorized!(
    /// Blends the sorted fragments of a block, the first of each pixel, then the second of each.
    fn blended(list: &BlockList, limits: &Limits) -> Block {
        let mut block = Block::EMPTY;
        let longest = (0..LANES).map(|i| list.ends[i] - i * list.room).max().unwrap_or(0);
        for step in 0..longest {
            let (mut alpha, mut depth, mut takes) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
            let (mut color, mut index) = ([[0.0; 3]; LANES], [0; LANES]);
            for i in 0..LANES {
                let place = i * list.room + step;
                if place < list.ends[i] {
                    let own = &list.fragments[list.keys[place] as u32 as usize];
                    (alpha[i], depth[i], takes[i]) = (own.alpha[i], own.depth[i], block.alive[i]);
                    (color[i], index[i]) = (own.color, own.index);
                }
            }
            block.add(limits, (&alpha, &takes), |i| index[i], |i| color[i], |i| depth[i]);
        }
        block.finish();
        block
    }
);

vectorized!(
    /// Lists the fragments of a block, which are of some of the tile's splats.
    fn list(
        list: &mut BlockList,
        (all, some): (&[Near], &[u32]),
        (limits, projector): (&Limits, &GaussianProjector<f32>),
        (rect, corner, opaque): (Rect, (u32, u32), Option<&Lanes>),
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let own = inside(rect, corner);
        let pixel = |i: usize| (corner.0 + i as u32 % SIDE, corner.1 + i as u32 / SIDE);
        let (u, v) = (each(|i| projector.ray(pixel(i))[0]), each(|i| projector.ray(pixel(i))[1]));
        let mut ends = list.ends;
        for &index in some {
            let near = &all[index as usize];
            let found = match &near.beside {
                Beside::Solid(solid) => {
                    let found = fragments::<FUSED>(&near.splat, limits, corner, &own);
                    found.map(|(alpha, takes)| (alpha, takes, depths(projector, solid, &u, &v)))
                }
                Beside::Disc(disc) => {
                    let splat = (&near.splat, disc);
                    discs::fragments::<FUSED>(splat, (&projector.rays, limits), corner, &own)
                }
            };
            let Some((alpha, takes, depth)) = found else { continue };
            let takes = before(&takes, opaque, |i| depth[i]);
            let row = list.fragments.len() as u64;
            let (place, GaussianSplat { color, index, .. }) = (near.place, near.splat);
            list.fragments.push(Fragments { alpha, depth, color, index, place });
            // From 1 to 2^32 - 1 for every float.
            let above = |depth: f32| (ordered_f32(depth) + (1 << 31)) as u64;
            let keys = each(|i| above(depth[i]) << 32 | row);
            // A key that is not taken is written over by the next one.
            for i in 0..LANES {
                list.keys[ends[i]] = keys[i];
                ends[i] += (takes[i] & 1) as usize;
            }
        }
        list.ends = ends;
    }
);

/// The depths of a splat along the rays of a block.
#[inline(always)]
fn depths(projector: &GaussianProjector<f32>, solid: &Solid<f32>, u: &Lanes, v: &Lanes) -> Lanes {
    let mut depth = [0.0; LANES];
    for i in 0..LANES {
        depth[i] = projector.deepest(&solid.adjugate, solid.place, [u[i], v[i]]);
    }
    depth
}
