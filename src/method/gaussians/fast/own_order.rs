//! Blend a tile in an order of each pixel's own.

use super::blending::{Block, Limits, before, fragments, inside, opaque};
use super::discs;
use crate::frame::Rect;
use crate::method::clock::{Work, spend};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::gaussians::blending::{Blending, GaussianPixel};
use crate::method::gaussians::splats::{Beside, GaussianSplat, Solid};
use crate::number::lanes::{LANES, Lanes, each, vectorized};
use crate::number::real::ordered_f32;
use crate::splat::gaussian::GaussianProjector;
use multiversion::target::target_cfg_f;

/// A fragment of a pixel.
#[derive(Clone, Copy)]
struct Fragment {
    depth: f32,
    alpha: f32,
    /// Which of the tile's splats it is of.
    splat: u32,
}

/// The fragments of a pixel, which are ordered by depth, then by place.
#[derive(Default)]
struct PixelList {
    fragments: Vec<Fragment>,
    /// For each fragment its depth, as a number whose order is that of depths, above its place in the
    /// list: sorting them moves half as many bytes, and calls nothing to compare.
    keys: Vec<u64>,
}

/// A splat of a tile, with its place in the order of the indices. All of it is copied, so that blocks do
/// not look for it all over memory.
struct Near {
    splat: GaussianSplat<f32>,
    beside: Beside<f32>,
    place: u32,
}

/// The most bytes that a splat takes while its tile is blended: itself, its number in each block of a
/// row, and a fragment in each pixel of a block. A list that grows has up to twice the room that it needs.
pub(super) const BYTES_A_SPLAT: u64 = {
    let fragment = size_of::<Fragment>() + size_of::<u64>();
    // The largest tile has 64 pixels a side.
    let row = 64 / SIDE as usize * size_of::<u32>();
    (size_of::<Near>() + 2 * (row + LANES * fragment)) as u64
};

/// The blocks of a tile.
pub(super) fn blend(blending: &Blending<'_, f32>, places: &[usize], rect: Rect) -> Vec<Block> {
    spend(Work::Blend);
    let splats = blending.splats;
    let near = |&place: &usize| {
        let (splat, beside) = (*splats.at(place), *splats.beside(place)?);
        Some(Near { splat, beside, place: place as u32 })
    };
    let mut all: Vec<Near> = places.iter().filter_map(near).collect();
    // Fragments that come about in order are sorted fast; the order of the lists decides nothing.
    all.sort_unstable_by_key(|near| (ordered_f32(near.splat.depth), near.place));
    let limits = Limits::new(blending.source.settings);
    let mut lists: [PixelList; LANES] = Default::default();
    let grid = BlockGrid::new(rect);
    let mut row = vec![Vec::new(); grid.columns as usize];
    let blocks = (0..grid.len()).map(|block| {
        let (mut pixels, corner) = (Block::EMPTY, grid.corner(block));
        let column = block % row.len();
        if column == 0 {
            list_row(&mut row, &all, (rect, corner.1));
        }
        lists.iter_mut().for_each(PixelList::clear);
        let surface = blending.source.surface().map(|surface| opaque(surface, rect, corner));
        let rules = (&limits, &blending.source.projector);
        list(&mut lists, (&all, &row[column]), rules, (rect, corner, surface.as_ref()));
        for (i, list) in lists.iter_mut().enumerate() {
            if !list.keys.is_empty() {
                pixels.set(i, blended(blending, &all, list));
            }
        }
        pixels
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

impl PixelList {
    fn clear(&mut self) {
        self.fragments.clear();
        self.keys.clear();
    }

    #[inline(always)]
    fn push(&mut self, fragment: Fragment) {
        // From 1 to 2^32 - 1 for every float.
        let depth = (ordered_f32(fragment.depth) + (1 << 31)) as u64;
        self.keys.push(depth << 32 | self.fragments.len() as u64);
        self.fragments.push(fragment);
    }

    /// Sorts the fragments. Few have the same depth.
    fn sort(&mut self, all: &[Near]) {
        let Self { fragments, keys } = self;
        keys.sort_unstable();
        for tied in keys.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|tied| tied.len() > 1) {
            tied.sort_unstable_by_key(|&key| {
                all[fragments[key as u32 as usize].splat as usize].place
            });
        }
    }

    fn iter(&self) -> impl Iterator<Item = Fragment> {
        self.keys.iter().map(|&key| self.fragments[key as u32 as usize])
    }
}

/// Sorts the fragments of a pixel and blends them.
fn blended(blending: &Blending<'_, f32>, all: &[Near], list: &mut PixelList) -> GaussianPixel<f32> {
    list.sort(all);
    let mut pixel = GaussianPixel::EMPTY;
    for Fragment { depth, alpha, splat } in list.iter() {
        if blending.rules.ends(pixel.blend.through * (1.0 - alpha)) {
            break;
        }
        pixel = blending.add(pixel, &all[splat as usize].splat, alpha, depth);
    }
    pixel.finished()
}

vectorized!(
    /// Lists the fragments of a block, which are of some of the tile's splats.
    fn list(
        lists: &mut [PixelList; LANES],
        (all, some): (&[Near], &[u32]),
        (limits, projector): (&Limits, &GaussianProjector<f32>),
        (rect, corner, opaque): (Rect, (u32, u32), Option<&Lanes>),
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let own = inside(rect, corner);
        let pixel = |i: usize| (corner.0 + i as u32 % SIDE, corner.1 + i as u32 / SIDE);
        let (u, v) = (each(|i| projector.ray(pixel(i))[0]), each(|i| projector.ray(pixel(i))[1]));
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
            for i in 0..LANES {
                if takes[i] != 0 {
                    lists[i].push(Fragment { depth: depth[i], alpha: alpha[i], splat: index });
                }
            }
        }
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
