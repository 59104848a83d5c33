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
use crate::splat::{Footprint, Shared, Splat, Tally, batch};
use glam::Vec3;
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

/// A splat with its attributes: 80 bytes, so that a tile finds all it needs in one place.
#[derive(Clone, Copy)]
struct Record {
    footprint: Footprint<f32>,
    surfel: u32,
    /// First and last column, first and last row.
    bounds: [u16; 4],
    /// The normal of the side that is seen.
    normal: [f32; 3],
    color: [f32; 3],
}

/// What one tile works with, kept by its thread from tile to tile.
struct Scratch {
    splats: Vec<Record>,
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
    let colors = surfels.color();
    let prepared = Prepared::new(
        surfels,
        camera,
        settings,
        (exec, &grid),
        |projector, range, records| {
            batch::splats_f32(projector, surfels, range, |splat| {
                records.push(Record::new(&splat, surfels.normal(), colors));
            })
        },
        Record::bounds,
    );
    let project = start.elapsed();

    let start = Instant::now();
    let jobs = target.tiles(&grid).into_iter().enumerate().collect();
    let times = exec.ordered(jobs, |(index, mut tile)| {
        let start = Instant::now();
        let mut scratch = Scratch::gather(&prepared, index, &tile.rect);
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
        if surfels.color().is_some() {
            normalize::<true>(&mut scratch, &prepared.shared);
        } else {
            normalize::<false>(&mut scratch, &prepared.shared);
        }
        store(&scratch, &mut tile);
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

impl Record {
    #[inline(always)]
    fn new(splat: &Splat<f32>, normals: &[Vec3], colors: Option<&[Vec3]>) -> Self {
        let Rect { x0, y0, x1, y1 } = splat.bounds;
        let i = splat.surfel as usize;
        Self {
            footprint: splat.footprint,
            surfel: splat.surfel,
            // Pictures have at most 65,536 pixels a side, so the last pixel fits.
            bounds: [x0, x1 - 1, y0, y1 - 1].map(|pixel| pixel as u16),
            normal: facing(normals[i].to_array(), splat.back),
            color: colors.map_or([0.0; 3], |c| c[i].to_array()),
        }
    }

    fn bounds(&self) -> Rect {
        let [x0, x1, y0, y1] = self.bounds.map(u32::from);
        Rect { x0, y0, x1: x1 + 1, y1: y1 + 1 }
    }

    /// The blocks of a tile that it may touch: columns and rows, the ends exclusive.
    #[inline(always)]
    fn blocks(&self, tile: &Rect) -> Rect {
        let inside = self.bounds().intersection(tile);
        if inside.is_empty() {
            return Rect::default();
        }
        Rect {
            x0: (inside.x0 - tile.x0) / SIDE,
            y0: (inside.y0 - tile.y0) / SIDE,
            x1: (inside.x1 - tile.x0).div_ceil(SIDE),
            y1: (inside.y1 - tile.y0).div_ceil(SIDE),
        }
    }
}

impl Scratch {
    /// The splats of a tile, and its empty blocks.
    fn gather(prepared: &Prepared<f32, Record>, index: usize, rect: &Rect) -> Self {
        let mut splats = Vec::with_capacity(prepared.count(index));
        prepared.for_each(index, |record| splats.push(*record));
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
        Self { splats, blocks: vec![empty; (columns * rows) as usize], columns }
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
    for splat in &scratch.splats {
        let (footprint, surfel) = (splat.footprint, splat.surfel);
        let blocks = splat.blocks(rect);
        for row in blocks.y0..blocks.y1 {
            for column in blocks.x0..blocks.x1 {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let (mut nearest, mut id) = (block.nearest, block.id);
                for i in 0..LANES {
                    let hit = (q[i] <= shared.limit) & (w[i] > nearest[i]);
                    nearest[i] = if hit { w[i] } else { nearest[i] };
                    id[i] = if hit { surfel } else { id[i] };
                }
                (block.nearest, block.id) = (nearest, id);
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
    for splat in &scratch.splats {
        let (footprint, normal, color) = (splat.footprint, splat.normal, splat.color);
        let blocks = splat.blocks(rect);
        for row in blocks.y0..blocks.y1 {
            for column in blocks.x0..blocks.x1 {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let least = block.least;
                let mut hit = [0_u32; LANES];
                for i in 0..LANES {
                    hit[i] = u32::from((q[i] <= shared.limit) & (w[i] >= least[i]));
                }
                if hit.iter().all(|&h| h == 0) {
                    continue;
                }
                let mut weight = [0.0; LANES];
                for i in 0..LANES {
                    let value = footprint.weight(q[i]);
                    weight[i] = if hit[i] != 0 { value } else { 0.0 };
                }
                add(&mut block.weight, &weight, 1.0);
                for c in 0..3 {
                    add(&mut block.normal[c], &weight, normal[c]);
                }
                if COLOR {
                    for c in 0..3 {
                        add(&mut block.color[c], &weight, color[c]);
                    }
                }
            }
        }
    }
}

/// `sum + weight value` in each lane.
#[inline(always)]
fn add(sum: &mut Lanes, weight: &Lanes, value: f32) {
    let mut lanes = *sum;
    for i in 0..LANES {
        lanes[i] += weight[i] * value;
    }
    *sum = lanes;
}

/// Normalization, in place.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn normalize<const COLOR: bool>(scratch: &mut Scratch, shared: &Shared<f32>) {
    let shared = *shared;
    for block in &mut scratch.blocks {
        let weight = block.weight;
        let (mut depth, mut normal, mut color) = (block.nearest, block.normal, block.color);
        for i in 0..LANES {
            depth[i] = shared.depth(depth[i]);
            let [x, y, z] = sum::direction([normal[0][i], normal[1][i], normal[2][i]], weight[i]);
            (normal[0][i], normal[1][i], normal[2][i]) = (x, y, z);
            if COLOR {
                let [r, g, b] = sum::average([color[0][i], color[1][i], color[2][i]], weight[i]);
                (color[0][i], color[1][i], color[2][i]) = (r, g, b);
            }
        }
        (block.nearest, block.normal, block.color) = (depth, normal, color);
    }
}

/// Copies the blocks into the rows of the framebuffer.
fn store(scratch: &Scratch, tile: &mut FramebufferTile<'_, f32>) {
    let columns = scratch.columns as usize;
    for y in 0..(tile.rect.y1 - tile.rect.y0) as usize {
        let blocks = &scratch.blocks[y / ROW * columns..][..columns];
        let first = y % ROW * ROW;
        store_row(blocks, tile.depth.row(y), |block| row(&block.nearest, first));
        store_row(blocks, tile.id.row(y), |block| row(&block.id, first));
        store_row(blocks, tile.weight.row(y), |block| row(&block.weight, first));
        store_row(blocks, tile.normal.row(y), |block| interleaved(&block.normal, first));
        if let Some(color) = &mut tile.color {
            store_row(blocks, color.row(y), |block| interleaved(&block.color, first));
        }
    }
}

/// Pixels of a row of a block.
const ROW: usize = SIDE as usize;

/// Copies one row of pixels, a block at a time; the last may be cut by the edge of the picture.
#[inline(always)]
fn store_row<T: Copy>(blocks: &[Block], pixels: &mut [T], row: impl Fn(&Block) -> [T; ROW]) {
    let (whole, rest) = pixels.as_chunks_mut::<ROW>();
    for (block, pixels) in blocks.iter().zip(whole.iter_mut()) {
        *pixels = row(block);
    }
    if let Some(block) = blocks.get(whole.len()) {
        rest.copy_from_slice(&row(block)[..rest.len()]);
    }
}

/// The row of a block that starts at a lane.
#[inline(always)]
fn row<T: Copy>(lanes: &[T; LANES], first: usize) -> [T; ROW] {
    std::array::from_fn(|x| lanes[first + x])
}

/// The row of three components that starts at a lane.
#[inline(always)]
fn interleaved(components: &[Lanes; 3], first: usize) -> [[f32; 3]; ROW] {
    let [a, b, c] = components.each_ref().map(|lanes| row(lanes, first));
    std::array::from_fn(|x| [a[x], b[x], c[x]])
}
