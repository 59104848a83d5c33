//! Blend splats into the blocks of a tile, compiled for every vector width.

use crate::frame::{NO_ID, Rect};
use crate::method::fast::tile::{BlockGrid, SIDE};
use crate::method::gaussians::Settings;
use crate::method::gaussians::blending::Rules;
use crate::method::gaussians::splats::GaussianSplat;
use crate::number::Real;
use crate::number::elementary::exp_f32_in_range;
use crate::number::lanes::{LANES, Lanes, any, mask, vectorized};
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
    alive: [u32; LANES],
}

impl Block {
    const EMPTY: Self = Self {
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
}

/// The blocks of a tile.
pub(super) struct Blocks {
    grid: BlockGrid,
    all: Vec<Block>,
}

impl Blocks {
    pub(super) fn new(rect: Rect) -> Self {
        let grid = BlockGrid::new(rect);
        let mut all = vec![Block::EMPTY; grid.len()];
        // Lanes beyond the edge of the picture never begin, so that they hold up no block.
        for (block, pixels) in all.iter_mut().enumerate() {
            let (x, y) = grid.corner(block);
            pixels.alive = mask(|i| {
                let (column, row) = (i as u32 % SIDE, i as u32 / SIDE);
                x + column < rect.x1 && y + row < rect.y1
            });
        }
        Self { grid, all }
    }

    /// Blends splats in their order.
    pub(super) fn blend(&mut self, splats: &[GaussianSplat<f32>], settings: &Settings) {
        let rules = Rules::new(settings);
        let limits = Limits {
            inside: rules.limit.unwrap_or(f32::INFINITY),
            least: rules.least,
            most: rules.most,
            // No transmittance is below 0, so none ends.
            stop: if settings.stop > 0.0 { settings.stop } else { -1.0 },
            stop_at: settings.stop_at,
        };
        blend(self, splats, &limits);
    }

    /// The blocks when all splats are blended.
    pub(super) fn finished(&mut self) -> &[Block] {
        for block in &mut self.all {
            for i in 0..LANES {
                let mean = block.moment[i] / block.alpha[i];
                block.expected[i] = if block.alpha[i] > 0.0 { mean } else { f32::INFINITY };
            }
        }
        &self.all
    }
}

/// The limits of the decisions on a fragment.
#[derive(Clone, Copy)]
struct Limits {
    inside: f32,
    least: f32,
    most: f32,
    stop: f32,
    stop_at: bool,
}

vectorized!(
    fn blend(blocks: &mut Blocks, splats: &[GaussianSplat<f32>], limits: &Limits) {
        const FUSED: bool = target_cfg_f!(target_feature = "fma");
        let rect = blocks.grid.rect;
        let mut left = blocks.all.len();
        for splat in splats {
            let touched = splat.bounds.intersection(&rect);
            let (first, last) =
                ((touched.x0 - rect.x0) / SIDE, (touched.x1 - rect.x0).div_ceil(SIDE));
            for row in (touched.y0 - rect.y0) / SIDE..(touched.y1 - rect.y0).div_ceil(SIDE) {
                for column in first..last {
                    let place = (row * blocks.grid.columns + column) as usize;
                    let block = &mut blocks.all[place];
                    if !any(&block.alive) {
                        continue;
                    }
                    let corner = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                    block.meet::<FUSED>(splat, limits, corner);
                    left -= usize::from(!any(&block.alive));
                }
            }
            if left == 0 {
                break;
            }
        }
    }
);

impl Block {
    /// Blends the fragments of a splat.
    #[inline(always)]
    fn meet<const FUSED: bool>(
        &mut self,
        splat: &GaussianSplat<f32>,
        limits: &Limits,
        (x, y): (u32, u32),
    ) {
        let mut own = *self;
        let Rect { x0, y0, x1, y1 } = splat.bounds;
        let ([xx, xy, yy], center) = (splat.conic, splat.center);
        let (mut alpha, mut takes) = ([0.0; LANES], [0_u32; LANES]);
        for i in 0..LANES {
            let (column, row) = (x + i as u32 % SIDE, y + i as u32 / SIDE);
            let dx = center.x - (column as f32 + 0.5);
            let dy = center.y - (row as f32 + 0.5);
            let power = 0.5 * (xx * (dx * dx) + yy * (dy * dy)) + xy * (dx * dy);
            // A greater q/2 gives 0 as well, and no other number is used.
            let negative = (-power).clamped(-104.0, 0.0);
            alpha[i] = (splat.alpha * exp_f32_in_range::<FUSED>(negative)).at_most(limits.most);
            let inside = (power >= 0.0)
                & (power <= limits.inside)
                & (column >= x0)
                & (column < x1)
                & (row >= y0)
                & (row < y1);
            let drawn = inside & (alpha[i] >= limits.least);
            takes[i] = if drawn { own.alive[i] } else { 0 };
        }
        if !any(&takes) {
            return;
        }
        let [r, g, b] = splat.color;
        for i in 0..LANES {
            let through = own.through[i] * (1.0 - alpha[i]);
            let ends = if limits.stop_at { through <= limits.stop } else { through < limits.stop };
            let met = takes[i] != 0;
            own.alive[i] = if met & ends { 0 } else { own.alive[i] };
            let drawn = met & !ends;
            let weight = own.through[i] * alpha[i];
            let adds = drawn & (weight > 0.0);
            own.color[0][i] = if adds { own.color[0][i] + weight * r } else { own.color[0][i] };
            own.color[1][i] = if adds { own.color[1][i] + weight * g } else { own.color[1][i] };
            own.color[2][i] = if adds { own.color[2][i] + weight * b } else { own.color[2][i] };
            own.alpha[i] = if adds { own.alpha[i] + weight } else { own.alpha[i] };
            let moment = own.moment[i] + weight * splat.depth;
            own.moment[i] = if drawn { moment } else { own.moment[i] };
            let half = drawn & (own.through[i] > 0.5);
            own.median[i] = if half { splat.depth } else { own.median[i] };
            let first = drawn & (own.id[i] == NO_ID);
            own.id[i] = if first { splat.index } else { own.id[i] };
            own.depth[i] = if first { splat.depth } else { own.depth[i] };
            let heavier = drawn & ((own.heaviest[i] == NO_ID) | (weight > own.weight[i]));
            own.heaviest[i] = if heavier { splat.index } else { own.heaviest[i] };
            own.weight[i] = if heavier { weight } else { own.weight[i] };
            let more = drawn & (own.count[i] < 255);
            own.count[i] += u32::from(more);
            own.through[i] = if drawn { through } else { own.through[i] };
        }
        *self = own;
    }
}
