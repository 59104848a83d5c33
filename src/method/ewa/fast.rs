//! The fast path for `f32`: the bits of [`super::plain`], from another layout.
//!
//! A tile is done from beginning to end while it is in the cache: its splats are gathered into one
//! list, and its pixels are kept in blocks of 4 x 4, one vector of 16 lanes a quantity. A lane is a
//! pixel and never a partial sum, so every pixel sees the operations of the definition in their
//! order. Three things differ, and none of them changes a bit:
//!
//! - A block is visited whole. The lanes outside a splat's bounds have q > k^2.
//! - The epsilon-z test `1/w <= limit` becomes `w >= least`, with `least` the smallest `f32` that
//!   passes: 1/w, correctly rounded, never grows with w. See [`least_nearness`].
//! - A fragment that fails adds weight 0 instead of nothing.

use super::Settings;
use super::plain::facing;
use super::prepare::Prepared;
use crate::composite::{epsilon, sum};
use crate::frame::{Exec, Framebuffer, FramebufferTile, NO_ID, Rect};
use crate::scene::{Camera, Surfels};
use crate::splat::{Footprint, Shared, Tally, batch};
use multiversion::multiversion;
use std::time::{Duration, Instant};

/// Side of a block in pixels.
const SIDE: u32 = 4;
/// Pixels of a block.
const LANES: usize = (SIDE * SIDE) as usize;

/// One number for each pixel of a block, row by row.
type Lanes = [f32; LANES];

/// The pixels of a block.
#[derive(Clone)]
#[repr(align(64))]
struct Block {
    /// Nearness of the nearest fragment.
    nearest: Lanes,
    /// Its surfel.
    id: [u32; LANES],
    /// The least nearness that passes the epsilon-z test.
    least: Lanes,
    weight: Lanes,
    normal: [Lanes; 3],
    color: [Lanes; 3],
}

/// A splat as a tile draws it.
struct Drawn {
    footprint: Footprint<f32>,
    surfel: u32,
    /// The blocks it may touch: columns and rows of blocks in the tile, the ends exclusive.
    blocks: Rect,
    normal: [f32; 3],
    color: [f32; 3],
}

/// What one tile works with, kept by its thread from tile to tile.
struct Scratch {
    drawn: Vec<Drawn>,
    blocks: Vec<Block>,
    columns: u32,
}

/// Wall time of the stages; those of the fused passes are shares of their common time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings {
    /// Projection and binning.
    pub project: Duration,
    /// Visibility splatting, with the gathering of each tile's splats.
    pub visibility: Duration,
    /// Attribute splatting.
    pub attributes: Duration,
    /// Normalization.
    pub normalize: Duration,
}

/// Draws a scene into a framebuffer: both geometry passes and the normalization.
///
/// Every pixel of `target` is overwritten, so a framebuffer can be used for many pictures. Its
/// stencil and margin are not written; see [`super::plain`] for those.
///
/// # Panics
/// If the framebuffer has not the size of the camera's picture.
pub fn render(
    surfels: &Surfels,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    target: &mut Framebuffer<f32>,
) -> (Tally, Timings) {
    assert_eq!((target.width, target.height), (camera.width, camera.height), "framebuffer size");
    let start = Instant::now();
    let grid = exec.grid(camera.width, camera.height);
    let prepared = Prepared::new(surfels, camera, settings, exec, &grid, batch::splats_f32);
    let project = start.elapsed();

    let start = Instant::now();
    let jobs = target.tiles(&grid).into_iter().enumerate().collect();
    let times = exec.ordered(jobs, |(index, mut tile)| {
        let start = Instant::now();
        let mut scratch = Scratch::gather(&prepared, surfels, index, &tile.rect);
        let ray_cast = prepared.shared.ray_cast;
        if ray_cast {
            visibility::<true>(&mut scratch, &prepared.shared, &tile.rect);
        } else {
            visibility::<false>(&mut scratch, &prepared.shared, &tile.rect);
        }
        let visible = Instant::now();
        limits(&mut scratch, &prepared.shared, prepared.epsilon);
        match (ray_cast, surfels.color().is_some()) {
            (false, false) => {
                attributes::<false, false>(&mut scratch, &prepared.shared, &tile.rect)
            }
            (false, true) => attributes::<false, true>(&mut scratch, &prepared.shared, &tile.rect),
            (true, false) => attributes::<true, false>(&mut scratch, &prepared.shared, &tile.rect),
            (true, true) => attributes::<true, true>(&mut scratch, &prepared.shared, &tile.rect),
        }
        let added = Instant::now();
        normalize(&scratch, &prepared.shared, &mut tile);
        [visible - start, added - visible, added.elapsed()]
    });
    let wall = start.elapsed();
    let sums = times.iter().fold([Duration::ZERO; 3], |a, b| [0, 1, 2].map(|i| a[i] + b[i]));
    let total: Duration = sums.iter().sum();
    let share = |part: Duration| wall.mul_f64(part.as_secs_f64() / total.as_secs_f64().max(1e-9));
    let timings = Timings {
        project,
        visibility: share(sums[0]),
        attributes: share(sums[1]),
        normalize: share(sums[2]),
    };
    (prepared.tally, timings)
}

impl Scratch {
    /// The splats of a tile, and its empty blocks.
    fn gather(prepared: &Prepared<f32>, surfels: &Surfels, index: usize, rect: &Rect) -> Self {
        let (normals, colors) = (surfels.normal(), surfels.color());
        let mut drawn = Vec::new();
        prepared.for_each(index, |splat| {
            let inside = splat.bounds.intersection(rect);
            if !inside.is_empty() {
                let i = splat.surfel as usize;
                drawn.push(Drawn {
                    footprint: splat.footprint,
                    surfel: splat.surfel,
                    blocks: Rect {
                        x0: (inside.x0 - rect.x0) / SIDE,
                        y0: (inside.y0 - rect.y0) / SIDE,
                        x1: (inside.x1 - rect.x0).div_ceil(SIDE),
                        y1: (inside.y1 - rect.y0).div_ceil(SIDE),
                    },
                    normal: facing(normals[i].to_array(), splat.back),
                    color: colors.map_or([0.0; 3], |c| c[i].to_array()),
                });
            }
        });
        let columns = (rect.x1 - rect.x0).div_ceil(SIDE);
        let rows = (rect.y1 - rect.y0).div_ceil(SIDE);
        let zero = [0.0; LANES];
        let empty = Block {
            nearest: [prepared.shared.empty(); LANES],
            id: [NO_ID; LANES],
            least: zero,
            weight: zero,
            normal: [zero; 3],
            color: [zero; 3],
        };
        Self { drawn, blocks: vec![empty; (columns * rows) as usize], columns }
    }
}

/// q and nearness of a splat at the pixels of a block whose first pixel is (x, y).
#[inline(always)]
fn fragments<const RAY_CAST: bool>(
    shared: &Shared<f32>,
    footprint: &Footprint<f32>,
    x: u32,
    y: u32,
) -> (Lanes, Lanes) {
    let shared = Shared { ray_cast: RAY_CAST, ..*shared };
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let (mut q, mut w) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        let dx = (x + (i % SIDE as usize) as f32) - footprint.center.x;
        let dy = (y + (i / SIDE as usize) as f32) - footprint.center.y;
        (q[i], w[i]) = footprint.fragment(&shared, dx, dy);
    }
    (q, w)
}

/// Visibility splatting.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn visibility<const RAY_CAST: bool>(scratch: &mut Scratch, shared: &Shared<f32>, rect: &Rect) {
    let shared = *shared;
    for splat in &scratch.drawn {
        for row in splat.blocks.y0..splat.blocks.y1 {
            for column in splat.blocks.x0..splat.blocks.x1 {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &splat.footprint, x, y);
                for i in 0..LANES {
                    let hit = (q[i] <= shared.limit) & (w[i] > block.nearest[i]);
                    block.nearest[i] = if hit { w[i] } else { block.nearest[i] };
                    block.id[i] = if hit { splat.surfel } else { block.id[i] };
                }
            }
        }
    }
}

/// The least nearness of each pixel that passes the epsilon-z test.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn limits(scratch: &mut Scratch, shared: &Shared<f32>, epsilon: f32) {
    let shared = *shared;
    for block in &mut scratch.blocks {
        for i in 0..LANES {
            let limit = epsilon::limit(shared.depth(block.nearest[i]), epsilon);
            block.least[i] = least_nearness(&shared, limit);
        }
    }
}

/// The smallest nearness whose depth, rounded, is at most `limit`.
///
/// Under a perspective camera the correctly rounded 1/w never grows with w, and the answer lies
/// within two representable numbers of 1/limit: half an ulp of `limit` moves 1/limit by at most one
/// ulp, and the division rounds by another half. `limit` is > 0; +inf gives 0.
#[inline(always)]
fn least_nearness(shared: &Shared<f32>, limit: f32) -> f32 {
    if !shared.perspective {
        return -limit;
    }
    let middle = (1.0 / limit).to_bits();
    let mut least = f32::from_bits(middle.wrapping_add(2));
    for below in 0..4 {
        let candidate = f32::from_bits((middle + 1).saturating_sub(below));
        least = if 1.0 / candidate <= limit { candidate } else { least };
    }
    least
}

/// Attribute splatting.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn attributes<const RAY_CAST: bool, const COLOR: bool>(
    scratch: &mut Scratch,
    shared: &Shared<f32>,
    rect: &Rect,
) {
    let shared = *shared;
    for splat in &scratch.drawn {
        for row in splat.blocks.y0..splat.blocks.y1 {
            for column in splat.blocks.x0..splat.blocks.x1 {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &splat.footprint, x, y);
                let mut any = false;
                for i in 0..LANES {
                    any |= (q[i] <= shared.limit) & (w[i] >= block.least[i]);
                }
                if !any {
                    continue;
                }
                let mut weight = [0.0; LANES];
                for i in 0..LANES {
                    let hit = (q[i] <= shared.limit) & (w[i] >= block.least[i]);
                    let value = splat.footprint.weight(q[i]);
                    weight[i] = if hit { value } else { 0.0 };
                }
                for i in 0..LANES {
                    block.weight[i] += weight[i];
                }
                for c in 0..3 {
                    for i in 0..LANES {
                        block.normal[c][i] += weight[i] * splat.normal[c];
                    }
                }
                if COLOR {
                    for c in 0..3 {
                        for i in 0..LANES {
                            block.color[c][i] += weight[i] * splat.color[c];
                        }
                    }
                }
            }
        }
    }
}

/// Normalization, from the blocks into the rows of the framebuffer.
fn normalize(scratch: &Scratch, shared: &Shared<f32>, tile: &mut FramebufferTile<'_, f32>) {
    for y in 0..(tile.rect.y1 - tile.rect.y0) as usize {
        for x in 0..(tile.rect.x1 - tile.rect.x0) as usize {
            let side = SIDE as usize;
            let block = &scratch.blocks[y / side * scratch.columns as usize + x / side];
            let lane = y % side * side + x % side;
            let weight = block.weight[lane];
            tile.depth.row(y)[x] = shared.depth(block.nearest[lane]);
            tile.id.row(y)[x] = block.id[lane];
            tile.weight.row(y)[x] = weight;
            tile.normal.row(y)[x] =
                sum::direction(block.normal.each_ref().map(|c| c[lane]), weight);
            if let Some(color) = &mut tile.color {
                color.row(y)[x] = sum::average(block.color.each_ref().map(|c| c[lane]), weight);
            }
        }
    }
}
