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

/// A fragment of a pixel. Fragments are ordered by depth, then by place.
#[derive(Clone, Copy)]
struct Fragment {
    depth: f32,
    /// See [`Near::place`].
    place: u32,
    alpha: f32,
    /// Which of the tile's splats it is of.
    splat: u32,
}

/// A splat of a tile, with its place in the order of the indices.
struct Near<'a> {
    splat: GaussianSplat<f32>,
    beside: &'a Beside<f32>,
    place: u32,
}

/// The most bytes that a splat takes while its tile is blended: itself, and a fragment in each pixel
/// of a block. A list that grows has up to twice the room that it needs.
pub(super) const BYTES_A_SPLAT: u64 =
    (size_of::<Near<'_>>() + 2 * LANES * size_of::<Fragment>()) as u64;

/// The blocks of a tile.
pub(super) fn blend(blending: &Blending<'_, f32>, places: &[usize], rect: Rect) -> Vec<Block> {
    spend(Work::Blend);
    let splats = blending.splats;
    let near = |&place: &usize| {
        let (splat, beside) = (*splats.at(place), splats.beside(place)?);
        Some(Near { splat, beside, place: place as u32 })
    };
    let mut all: Vec<Near<'_>> = places.iter().filter_map(near).collect();
    // Fragments that come about in order are sorted fast; the order of the lists decides nothing.
    all.sort_unstable_by_key(|near| (ordered_f32(near.splat.depth), near.place));
    let limits = Limits::new(blending.source.settings);
    let mut lists: [Vec<Fragment>; LANES] = Default::default();
    let grid = BlockGrid::new(rect);
    let blocks = (0..grid.len()).map(|block| {
        let mut pixels = Block::EMPTY;
        lists.iter_mut().for_each(Vec::clear);
        let corner = grid.corner(block);
        let surface = blending.source.surface().map(|surface| opaque(surface, rect, corner));
        let rules = (&limits, &blending.source.projector);
        list(&mut lists, &all, rules, (rect, corner, surface.as_ref()));
        for (i, list) in lists.iter_mut().enumerate() {
            if !list.is_empty() {
                pixels.set(i, blended(blending, &all, list));
            }
        }
        pixels
    });
    blocks.collect()
}

/// Sorts the fragments of a pixel and blends them.
fn blended(
    blending: &Blending<'_, f32>,
    all: &[Near<'_>],
    list: &mut [Fragment],
) -> GaussianPixel<f32> {
    list.sort_unstable_by_key(|one| (ordered_f32(one.depth), one.place));
    let mut pixel = GaussianPixel::EMPTY;
    for &Fragment { depth, alpha, splat, .. } in &*list {
        if blending.rules.ends(pixel.blend.through * (1.0 - alpha)) {
            break;
        }
        pixel = blending.add(pixel, &all[splat as usize].splat, alpha, depth);
    }
    pixel.finished()
}

vectorized!(
    /// Lists the fragments of a block.
    fn list(
        lists: &mut [Vec<Fragment>; LANES],
        all: &[Near<'_>],
        (limits, projector): (&Limits, &GaussianProjector<f32>),
        (rect, corner, opaque): (Rect, (u32, u32), Option<&Lanes>),
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let own = inside(rect, corner);
        let block = Rect { x0: corner.0, y0: corner.1, x1: corner.0 + SIDE, y1: corner.1 + SIDE };
        let pixel = |i: usize| (corner.0 + i as u32 % SIDE, corner.1 + i as u32 / SIDE);
        let (u, v) = (each(|i| projector.ray(pixel(i))[0]), each(|i| projector.ray(pixel(i))[1]));
        for (index, near) in (0..).zip(all) {
            if near.splat.bounds.intersection(&block).is_empty() {
                continue;
            }
            let found = match near.beside {
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
                    let (depth, alpha) = (depth[i], alpha[i]);
                    lists[i].push(Fragment { depth, place: near.place, alpha, splat: index });
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
