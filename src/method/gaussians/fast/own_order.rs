//! Blend a tile in an order of each pixel's own.

use super::blending::{Block, Limits, before, fragments, inside, opaque};
use super::discs;
use crate::frame::Rect;
use crate::method::clock::{Work, spend};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::gaussians::blending::Blending;
use crate::method::gaussians::splats::{Beside, GaussianSplat, Solid};
use crate::number::lanes::{LANES, Lanes, Mask, any, each, mask, vectorized};
use crate::number::real::ordered_f32;
use crate::splat::gaussian::GaussianProjector;
use multiversion::target::target_cfg_f;

/// The fragments of a block: a row for each splat, in the order of the indices, and the order that each
/// pixel has for its own.
#[derive(Default)]
struct BlockList {
    alphas: Vec<Lanes>,
    depths: Vec<Lanes>,
    paints: Vec<Paint>,
    /// First the depth of each fragment that is drawn, as a number whose order is that of depths, and 0 for
    /// the others; see [`height`]. Sorted: the first fragment of each pixel, then the second of each. The
    /// last `bits` of a key are a row, and a pixel without more fragments has [`END`].
    keys: Vec<[u32; LANES]>,
    bits: u32,
}

/// What all fragments of a splat have.
struct Paint {
    color: [f32; 3],
    index: u32,
}

/// Behind the last fragment of a pixel.
const END: u32 = u32::MAX;

/// A number above 0 whose order is that of depths.
#[inline(always)]
fn height(depth: f32) -> u32 {
    (ordered_f32(depth) + (1 << 31)) as u32
}

/// Where a block is.
struct BlockPlace {
    /// Its first pixel.
    corner: (u32, u32),
    /// The pixels that are in the tile.
    inside: Mask,
    /// The depths of the surface, if there is one.
    opaque: Option<Lanes>,
}

/// A splat of a tile. All of it is copied, so that blocks do not look for it all over memory.
struct Near {
    splat: GaussianSplat<f32>,
    beside: Beside<f32>,
}

/// The most bytes that a splat takes while its tile is blended: itself, its number in each block of a
/// row, and its fragments in a block. A list that grows has up to twice the room that it needs.
pub(super) const BYTES_A_SPLAT: u64 = {
    // The largest tile has 64 pixels a side.
    let row = 64 / SIDE as usize * size_of::<u32>();
    let fragments = size_of::<Paint>() + 3 * size_of::<Lanes>();
    (size_of::<Near>() + 2 * (row + fragments)) as u64
};

/// The blocks of a tile.
pub(super) fn blend(blending: &Blending<'_, f32>, places: &[usize], rect: Rect) -> Vec<Block> {
    spend(Work::Blend);
    let splats = blending.splats;
    let limits = Limits::new(blending.source.settings);
    let mut all = Vec::with_capacity(places.len());
    for &place in places {
        if let Some(&beside) = splats.beside(place) {
            all.push(Near { splat: *splats.at(place), beside });
        }
    }
    let mut own = BlockList::default();
    let grid = BlockGrid::new(rect);
    let mut row = vec![Vec::new(); grid.columns as usize];
    let blocks = (0..grid.len()).map(|block| {
        let (column, corner) = (block % row.len(), grid.corner(block));
        if column == 0 {
            list_row(&mut row, &all, rect, corner.1);
        }
        own.clear();
        let surface = blending.source.surface().map(|surface| opaque(surface, rect, corner));
        let place = BlockPlace { corner, inside: inside(rect, corner), opaque: surface };
        list(&mut own, &all, &row[column], &limits, &blending.source.projector, &place);
        own.sort();
        blended(&own, &limits)
    });
    blocks.collect()
}

/// Lists, for each block of the row that begins at line `y`, the splats whose bounds it touches.
fn list_row(row: &mut [Vec<u32>], all: &[Near], rect: Rect, y: u32) {
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
    fn clear(&mut self) {
        self.alphas.clear();
        self.depths.clear();
        self.paints.clear();
        self.keys.clear();
    }

    /// Sorts the fragments of each pixel by depth, then by row.
    fn sort(&mut self) {
        self.bits = usize::BITS - self.keys.len().leading_zeros();
        if !sort_in_step(&mut self.keys, self.bits) {
            for i in 0..LANES {
                self.sort_pixel(i);
            }
        }
    }

    /// Sorts the fragments of one pixel.
    fn sort_pixel(&mut self, i: usize) {
        let heights = (0..).zip(self.keys.iter().map(|heights| heights[i]));
        let mut own: Vec<(u32, u32)> =
            heights.filter(|(_, height)| *height > 0).map(|(row, height)| (height, row)).collect();
        own.sort_unstable();
        let sorted = own.iter().map(|(_, row)| *row).chain(std::iter::repeat(END));
        self.keys.iter_mut().zip(sorted).for_each(|(keys, row)| keys[i] = row);
    }
}

vectorized!(
    /// Turns heights into keys and sorts these, all pixels side by side; false if a key has no room for a
    /// height and a row.
    fn sort_in_step(keys: &mut [[u32; LANES]], bits: u32) -> bool {
        let (mut least, mut most) = ([END; LANES], [0; LANES]);
        for heights in keys.iter() {
            // The height of no fragment becomes the greatest.
            least = each(|i| least[i].min(heights[i].wrapping_sub(1)));
            most = each(|i| most[i].max(heights[i]));
        }
        let base = least.iter().fold(END, |a, b| a.min(*b)).wrapping_add(1);
        let range = most.iter().fold(0, |a, b| a.max(*b)).saturating_sub(base);
        // One less, so that no key is the end.
        if u64::from(range) + 1 >= 1 << 32_u32.saturating_sub(bits) {
            return false;
        }
        for (row, heights) in (0..).zip(keys.iter_mut()) {
            let own = *heights;
            *heights = each(|i| {
                let key = own[i].wrapping_sub(base) << bits | row;
                if own[i] == 0 { END } else { key }
            });
        }
        merge_exchange(keys);
        true
    }
);

/// Sorts each lane: Knuth, The Art of Computer Programming, volume 3, section 5.2.2, Algorithm M. Which
/// rows it compares depends on their number alone, so that all lanes are sorted at once.
#[inline(always)]
fn merge_exchange(keys: &mut [[u32; LANES]]) {
    let half = keys.len().next_power_of_two() / 2;
    let mut p = half;
    while p > 0 {
        let (mut q, mut first, mut apart) = (half, 0, p);
        loop {
            for start in (first..keys.len() - apart).step_by(2 * p) {
                for row in start..(start + p).min(keys.len() - apart) {
                    let (a, b) = (keys[row], keys[row + apart]);
                    keys[row] = each(|i| a[i].min(b[i]));
                    keys[row + apart] = each(|i| a[i].max(b[i]));
                }
            }
            if q == p {
                break;
            }
            (apart, q, first) = (q - p, q / 2, p);
        }
        p /= 2;
    }
}

vectorized!(
    /// Blends the sorted fragments of a block, the first of each pixel, then the second of each.
    fn blended(list: &BlockList, limits: &Limits) -> Block {
        let mut block = Block::EMPTY;
        let rows = (1 << list.bits) - 1;
        // Lanes without a fragment read one that they do not take, because a branch costs more.
        let last = list.keys.len().saturating_sub(1);
        for keys in &list.keys {
            let some = mask(|i| keys[i] != END);
            if !any(&some) {
                break;
            }
            let takes = each(|i| some[i] & block.alive[i]);
            let (mut alpha, mut depth) = ([0.0; LANES], [0.0; LANES]);
            let (mut color, mut index) = ([[0.0; 3]; LANES], [0; LANES]);
            for i in 0..LANES {
                let row = ((keys[i] & rows) as usize).min(last);
                let paint = &list.paints[row];
                (alpha[i], depth[i]) = (list.alphas[row][i], list.depths[row][i]);
                (color[i], index[i]) = (paint.color, paint.index);
            }
            block.add(limits, &alpha, &takes, |i| index[i], |i| color[i], |i| depth[i]);
        }
        block.finish();
        block
    }
);

vectorized!(
    /// Lists the fragments of a block, which are of some of the tile's splats.
    fn list(
        list: &mut BlockList,
        all: &[Near],
        some: &[u32],
        limits: &Limits,
        projector: &GaussianProjector<f32>,
        place: &BlockPlace,
    ) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let (corner, own) = (place.corner, &place.inside);
        let pixel = |i: usize| (corner.0 + i as u32 % SIDE, corner.1 + i as u32 / SIDE);
        let (u, v) = (each(|i| projector.ray(pixel(i))[0]), each(|i| projector.ray(pixel(i))[1]));
        for &index in some {
            let near = &all[index as usize];
            let found = match &near.beside {
                Beside::Solid(solid) => {
                    let found = fragments::<FUSED>(&near.splat, limits, corner, own);
                    found.map(|(alpha, takes)| (alpha, takes, depths(projector, solid, &u, &v)))
                }
                Beside::Disc(disc) => {
                    let rays = &projector.rays;
                    discs::fragments::<FUSED>(&near.splat, disc, rays, limits, corner, own)
                }
            };
            let Some((alpha, takes, depth)) = found else { continue };
            let takes = before(&takes, place.opaque.as_ref(), |i| depth[i]);
            let GaussianSplat { color, index, .. } = near.splat;
            list.alphas.push(alpha);
            list.depths.push(depth);
            list.paints.push(Paint { color, index });
            list.keys.push(each(|i| height(depth[i]) & takes[i]));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;

    #[test]
    fn pixels_are_sorted_side_by_side_as_one_by_one() {
        let mut in_step = 0;
        for (seed, count) in (0..200).chain([1000, 3000]).enumerate() {
            // Depths from a few that are all alike to all that there are, and a fragment in most lanes.
            let depths = 2.0 + seed as f32 * if seed % 2 == 0 { 0.01 } else { 1e30 };
            let random = |i: usize, k: u64| unit(seed as u64, 64 * i as u64 + k);
            let heights = |row: usize| {
                each(|i| {
                    let depth = (random(row, i as u64) * 8.0).floor() / 8.0 * depths + 1.0;
                    if random(row, 16 + i as u64) < 0.3 { 0 } else { height(depth) }
                })
            };
            let keys: Vec<_> = (0..count).map(heights).collect();
            let mut list = BlockList { keys: keys.clone(), ..BlockList::default() };
            list.sort();
            in_step += u32::from(sort_in_step(&mut keys.clone(), list.bits));
            let rows = (1 << list.bits) - 1;
            for i in 0..LANES {
                let mut expected: Vec<_> =
                    (0..count).filter(|row| keys[*row][i] != 0).map(|row| row as u32).collect();
                expected.sort_by_key(|row| keys[*row as usize][i]);
                let own = list.keys.iter().map(|keys| keys[i]);
                let own: Vec<_> = own.take_while(|key| *key != END).map(|key| key & rows).collect();
                assert_eq!(own, expected, "{count} rows, pixel {i}");
                assert!(list.keys[own.len()..].iter().all(|keys| keys[i] == END));
            }
        }
        assert!((50..150).contains(&in_step), "{in_step}");
    }
}
