//! Blend splats into the blocks of a tile, compiled for every vector width.

use crate::frame::{NO_ID, Rect};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::gaussians::Settings;
use crate::method::gaussians::blending::Rules;
use crate::method::gaussians::splats::GaussianSplat;
use crate::number::Real;
use crate::number::elementary::exp_f32_in_range;
use crate::number::lanes::{LANES, Lanes, Mask, any, each, mask, select, select_u32, vectorized};
use crate::scene::Surface;
use multiversion::target::target_cfg_f;

/// The pixels of a block, row by row.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Block {
    pub(super) color: [Lanes; 3],
    alpha: Lanes,
    pub(super) through: Lanes,
    moment: Lanes,
    /// The mean depth, when all splats are blended.
    pub(super) expected: Lanes,
    pub(super) median: Lanes,
    pub(super) depth: Lanes,
    weight: Lanes,
    pub(super) id: [u32; LANES],
    pub(super) heaviest: [u32; LANES],
    pub(super) count: [u32; LANES],
    /// Whether blending goes on: all bits, or none.
    pub(super) alive: [u32; LANES],
}

impl Block {
    pub(super) const EMPTY: Self = Self {
        color: [[0.0; LANES]; 3],
        alpha: [0.0; LANES],
        through: [1.0; LANES],
        moment: [0.0; LANES],
        expected: [f32::INFINITY; LANES],
        median: [f32::INFINITY; LANES],
        depth: [f32::INFINITY; LANES],
        weight: [0.0; LANES],
        id: [NO_ID; LANES],
        heaviest: [NO_ID; LANES],
        count: [0; LANES],
        alive: [u32::MAX; LANES],
    };

    /// The block when all splats are blended.
    pub(super) fn finish(&mut self) {
        for i in 0..LANES {
            let mean = self.moment[i] / self.alpha[i];
            self.expected[i] = if self.alpha[i] > 0.0 { mean } else { f32::INFINITY };
        }
    }
}

/// The blocks of a tile.
pub(super) struct Blocks {
    grid: BlockGrid,
    all: Vec<Block>,
    /// The depths of the surface in each block; empty without one.
    opaque: Vec<Lanes>,
}

impl Blocks {
    pub(super) fn new(rect: Rect, surface: Option<&Surface>) -> Self {
        let grid = BlockGrid::new(rect);
        let mut all = vec![Block::EMPTY; grid.len()];
        // Lanes beyond the edge of the picture never begin, so that they hold up no block.
        for (block, pixels) in all.iter_mut().enumerate() {
            pixels.alive = inside(rect, grid.corner(block));
        }
        let depths = |surface| {
            (0..grid.len()).map(|block| opaque(surface, rect, grid.corner(block))).collect()
        };
        let opaque = surface.map_or_else(Vec::new, depths);
        Self { grid, all, opaque }
    }

    /// Blends splats in their order.
    pub(super) fn blend(&mut self, splats: &[GaussianSplat<f32>], limits: &Limits) {
        blend(self, splats, limits);
    }

    /// Calls `add` for every splat in order, with each block that its bounds touch and that blending
    /// goes on in, with the depths of the surface there, and with the first pixel of the block.
    #[inline(always)]
    pub(super) fn each<S>(
        &mut self,
        splats: &[S],
        bounds: impl Fn(&S) -> Rect,
        mut add: impl FnMut(&S, &mut Block, Option<&Lanes>, (u32, u32)),
    ) {
        let rect = self.grid.rect;
        let mut left = self.all.len();
        for splat in splats {
            let touched = bounds(splat).intersection(&rect);
            let (first, last) =
                ((touched.x0 - rect.x0) / SIDE, (touched.x1 - rect.x0).div_ceil(SIDE));
            for row in (touched.y0 - rect.y0) / SIDE..(touched.y1 - rect.y0).div_ceil(SIDE) {
                for column in first..last {
                    let index = (row * self.grid.columns + column) as usize;
                    let block = &mut self.all[index];
                    if !any(&block.alive) {
                        continue;
                    }
                    let opaque = self.opaque.get(index);
                    add(splat, block, opaque, (rect.x0 + column * SIDE, rect.y0 + row * SIDE));
                    left -= usize::from(!any(&block.alive));
                }
            }
            if left == 0 {
                break;
            }
        }
    }

    /// The blocks when all splats are blended.
    pub(super) fn finished(&mut self) -> &[Block] {
        self.all.iter_mut().for_each(Block::finish);
        &self.all
    }
}

/// The limits of the decisions on a fragment.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) inside: f32,
    least: f32,
    most: f32,
    stop: f32,
    stop_at: bool,
}

impl Limits {
    pub(super) fn new(settings: &Settings) -> Self {
        let rules = Rules::new(settings);
        Self {
            inside: rules.limit.unwrap_or(f32::INFINITY),
            least: rules.least,
            most: rules.most,
            // No transmittance is below 0, so none ends.
            stop: if settings.stop > 0.0 { settings.stop } else { -1.0 },
            stop_at: settings.stop_at,
        }
    }
}

vectorized!(
    fn blend(blocks: &mut Blocks, splats: &[GaussianSplat<f32>], limits: &Limits) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        blocks.each(
            splats,
            |splat| splat.bounds,
            |splat, block, opaque, corner| {
                let seen = before(&block.alive, opaque, |_| splat.depth);
                let fragments = fragments::<FUSED>(splat, limits, corner, &seen);
                if let Some((alpha, takes)) = fragments {
                    let (index, color, depth) = (splat.index, splat.color, splat.depth);
                    block.add(limits, &alpha, &takes, |_| index, |_| color, |_| depth);
                }
            },
        );
    }
);

/// The pixels of a block that are in a tile.
pub(super) fn inside(rect: Rect, (x, y): (u32, u32)) -> Mask {
    mask(|i| {
        let (column, row) = (i as u32 % SIDE, i as u32 / SIDE);
        x + column < rect.x1 && y + row < rect.y1
    })
}

/// The depths of the surface in a block of a tile from this pixel on; +inf beside the tile.
pub(super) fn opaque(surface: &Surface, rect: Rect, (x, y): (u32, u32)) -> Lanes {
    each(|i| {
        let (column, row) = (x + i as u32 % SIDE, y + i as u32 / SIDE);
        let inside = column < rect.x1 && row < rect.y1;
        if inside { *surface.depths().at(column, row) } else { f32::INFINITY }
    })
}

/// The lanes among `of` in which a fragment is not behind the surface.
#[inline(always)]
pub(super) fn before(of: &Mask, opaque: Option<&Lanes>, depth: impl Fn(usize) -> f32) -> Mask {
    match opaque {
        Some(opaque) => each(|i| if depth(i) > opaque[i] { 0 } else { of[i] }),
        None => *of,
    }
}

/// The alphas of a splat in a block from this pixel on, and the lanes among `of` that take them; none
/// if no lane does.
#[inline(always)]
pub(super) fn fragments<const FUSED: bool>(
    splat: &GaussianSplat<f32>,
    limits: &Limits,
    (x, y): (u32, u32),
    of: &Mask,
) -> Option<(Lanes, Mask)> {
    let of = *of;
    let Rect { x0, y0, x1, y1 } = splat.bounds;
    let ([xx, xy, yy], center) = (splat.conic, splat.center);
    // Most blocks that a splat does not touch are left before the exponential.
    let limit = limits.inside.at_most(splat.reach);
    let (mut power, mut takes) = ([0.0; LANES], [0_u32; LANES]);
    for i in 0..LANES {
        let (column, row) = (x + i as u32 % SIDE, y + i as u32 / SIDE);
        let dx = center.x - (column as f32 + 0.5);
        let dy = center.y - (row as f32 + 0.5);
        power[i] = 0.5 * (xx * (dx * dx) + yy * (dy * dy)) + xy * (dx * dy);
        let inside = (power[i] >= 0.0)
            & (power[i] <= limit)
            & (column >= x0)
            & (column < x1)
            & (row >= y0)
            & (row < y1);
        takes[i] = if inside { of[i] } else { 0 };
    }
    if !any(&takes) {
        return None;
    }
    alphas::<FUSED>(splat, limits, &power, takes)
}

/// The alphas of fragments with these q/2, and the lanes that are dense enough; none if no lane is.
#[inline(always)]
pub(super) fn alphas<const FUSED: bool>(
    splat: &GaussianSplat<f32>,
    limits: &Limits,
    power: &Lanes,
    mut takes: Mask,
) -> Option<(Lanes, Mask)> {
    let mut alpha = [0.0; LANES];
    for i in 0..LANES {
        // A greater q/2 gives 0 as well, and no other number is used.
        let negative = (-power[i]).clamped(-104.0, 0.0);
        alpha[i] = (splat.alpha * exp_f32_in_range::<FUSED>(negative)).at_most(limits.most);
        takes[i] = if alpha[i] >= limits.least { takes[i] } else { 0 };
    }
    any(&takes).then_some((alpha, takes))
}

impl Block {
    /// Blends a fragment in each lane that takes one: of this splat, with this colour and depth. Numbers
    /// that few fragments change are touched only by those.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        limits: &Limits,
        alpha: &Lanes,
        takes: &Mask,
        index: impl Fn(usize) -> u32,
        color: impl Fn(usize) -> [f32; 3] + Copy,
        depth: impl Fn(usize) -> f32 + Copy,
    ) {
        let before = self.through;
        let weight = each(|i| before[i] * alpha[i]);
        let through = each(|i| before[i] * (1.0 - alpha[i]));
        let ends = if limits.stop_at {
            mask(|i| through[i] <= limits.stop)
        } else {
            mask(|i| through[i] < limits.stop)
        };
        let drawn = each(|i| takes[i] & !ends[i]);
        self.alive = each(|i| self.alive[i] & !(takes[i] & ends[i]));
        self.through = select(&drawn, &through, &before);
        let adds = mask(|i| (drawn[i] != 0) & (weight[i] > 0.0));
        self.color[0] = sum(&adds, &self.color[0], &weight, |i| color(i)[0]);
        self.color[1] = sum(&adds, &self.color[1], &weight, |i| color(i)[1]);
        self.color[2] = sum(&adds, &self.color[2], &weight, |i| color(i)[2]);
        self.alpha = sum(&adds, &self.alpha, &weight, |_| 1.0);
        self.moment = sum(&drawn, &self.moment, &weight, depth);
        // There are fewer than 2^32 splats.
        self.count = each(|i| self.count[i] + (drawn[i] & 1));
        self.mark(index, &before, &weight, &drawn, depth);
    }

    /// Notes the fragment in the lanes where it is the first, the heaviest or the median.
    #[inline(always)]
    fn mark(
        &mut self,
        index: impl Fn(usize) -> u32,
        before: &Lanes,
        weight: &Lanes,
        drawn: &Mask,
        depth: impl Fn(usize) -> f32 + Copy,
    ) {
        let half = mask(|i| (drawn[i] != 0) & (before[i] > 0.5));
        if any(&half) {
            self.median = select(&half, &each(depth), &self.median);
        }
        let (id, heaviest, most) = (self.id, self.heaviest, self.weight);
        let first = mask(|i| (drawn[i] != 0) & (id[i] == NO_ID));
        if any(&first) {
            self.id = select_u32(&first, &each(&index), &id);
            self.depth = select(&first, &each(depth), &self.depth);
        }
        let heavier = mask(|i| (drawn[i] != 0) & ((heaviest[i] == NO_ID) | (weight[i] > most[i])));
        if any(&heavier) {
            self.heaviest = select_u32(&heavier, &each(index), &heaviest);
            self.weight = select(&heavier, weight, &most);
        }
    }
}

/// The sums with weight times a factor in the chosen lanes.
#[inline(always)]
fn sum(chosen: &Mask, sums: &Lanes, weight: &Lanes, factor: impl Fn(usize) -> f32) -> Lanes {
    let more = each(|i| sums[i] + weight[i] * factor(i));
    select(chosen, &more, sums)
}
