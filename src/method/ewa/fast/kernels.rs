//! The passes over the blocks of one tile, each compiled for every vector width.
//!
//! Lanes are read into local arrays, changed there and written back: the loops over them then become
//! single vector instructions.

use super::scratch::{Block, LANES, Lanes, Record, SIDE, Scratch};
use crate::composite::{epsilon, sum};
use crate::frame::Rect;
use crate::number::Real;
use crate::number::elementary::exp_f32_in_range;
use crate::splat::{Footprint, Shared};
use multiversion::multiversion;

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

impl Scratch {
    /// Visibility splatting.
    pub(super) fn visibility(&mut self, shared: &Shared<f32>) {
        if shared.ray_cast {
            visibility::<true>(self, shared);
        } else {
            visibility::<false>(self, shared);
        }
    }

    /// The least nearness of each pixel that passes the epsilon-z test.
    pub(super) fn limits(&mut self, shared: &Shared<f32>, epsilon: f32) {
        limits(&mut self.blocks, shared, epsilon);
    }

    /// Attribute splatting.
    pub(super) fn attributes(&mut self, shared: &Shared<f32>) {
        match (shared.ray_cast, self.normal, self.color) {
            (false, false, false) => attributes::<false, false, false>(self, shared),
            (false, false, true) => attributes::<false, false, true>(self, shared),
            (false, true, false) => attributes::<false, true, false>(self, shared),
            (false, true, true) => attributes::<false, true, true>(self, shared),
            (true, false, false) => attributes::<true, false, false>(self, shared),
            (true, false, true) => attributes::<true, false, true>(self, shared),
            (true, true, false) => attributes::<true, true, false>(self, shared),
            (true, true, true) => attributes::<true, true, true>(self, shared),
        }
    }

    /// Normalization, in place.
    pub(super) fn normalize(&mut self, shared: &Shared<f32>) {
        match (self.normal, self.color) {
            (false, false) => normalize::<false, false>(&mut self.blocks, shared),
            (false, true) => normalize::<false, true>(&mut self.blocks, shared),
            (true, false) => normalize::<true, false>(&mut self.blocks, shared),
            (true, true) => normalize::<true, true>(&mut self.blocks, shared),
        }
    }
}

/// The blocks of one row that a splat may touch: first column and column after the last.
///
/// Splats of few columns keep their bounds. For a wide one the ellipse is cut into bands of
/// [`SIDE`] pixel rows: in the band, |v| is at least `v`, so |u| is at most sqrt(limit - v v), and
/// dx lies within that over ux about -(uy/ux) dy. Widened for rounding, as the bounds are.
#[inline(always)]
fn columns<const RAY_CAST: bool>(
    record: &Record,
    blocks: &Rect,
    row: u32,
    tile: &Rect,
    limit: f32,
) -> (u32, u32) {
    if RAY_CAST || blocks.x1 - blocks.x0 < WIDE {
        return (blocks.x0, blocks.x1);
    }
    let f = &record.footprint;
    let top = (tile.y0 + row * SIDE) as f32 + 0.5 - f.center.y;
    let bottom = top + (SIDE - 1) as f32;
    let closest = if top > 0.0 {
        top
    } else if bottom < 0.0 {
        bottom
    } else {
        0.0
    };
    let v = f.vy * closest;
    // Near the tip of the ellipse the difference is all rounding error, and its root is not small.
    let reach = ((limit - v * v).at_least(0.0) + limit * (1.0 / 1_048_576.0)).sqrt() / f.ux;
    let skew = -(f.uy / f.ux);
    let (a, b) = (skew * top, skew * bottom);
    let (left, right) = if a < b { (a, b) } else { (b, a) };
    let slack = 1.0 / 64.0 + (reach + (a.abs() + b.abs())) * (1.0 / 65_536.0);
    let origin = f.center.x - tile.x0 as f32;
    let first = (origin + left - reach - slack - 0.5) * (1.0 / SIDE as f32);
    let last = (origin + right + reach + slack - 0.5) * (1.0 / SIDE as f32) + 1.0;
    let (start, end) = (blocks.x0 as f32, blocks.x1 as f32);
    // Comparisons that NaN fails: such a row keeps its bounds.
    let first = if first > start { first.at_most(end) } else { start };
    let last = if last < end { last.at_least(0.0) } else { end };
    (first.to_pixel(), last.to_pixel())
}

/// Columns of blocks from which on the rows of a splat are cut to its ellipse.
const WIDE: u32 = 6;

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn visibility<const RAY_CAST: bool>(scratch: &mut Scratch, shared: &Shared<f32>) {
    let (shared, rect) = (*shared, scratch.rect);
    for splat in &scratch.splats {
        let (footprint, surfel) = (splat.footprint, splat.surfel);
        let blocks = splat.blocks(&rect);
        for row in blocks.y0..blocks.y1 {
            let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
            for column in first..last {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let inside = inside(&q, &w, shared.limit);
                let (before, mut id) = (block.nearest, block.id);
                let mut nearest = before;
                for i in 0..LANES {
                    nearest[i] = if inside[i] > before[i] { inside[i] } else { before[i] };
                }
                for i in 0..LANES {
                    // A select of integers by a comparison of floats would not become a vector.
                    let mask = u32::from(inside[i] > before[i]).wrapping_neg();
                    id[i] = (surfel & mask) | (id[i] & !mask);
                }
                (block.nearest, block.id) = (nearest, id);
            }
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn limits(blocks: &mut [Block], shared: &Shared<f32>, epsilon: f32) {
    let shared = *shared;
    for block in blocks {
        for i in 0..LANES {
            let limit = epsilon::limit(shared.depth(block.nearest[i]), epsilon);
            block.least[i] = least_nearness(&shared, limit);
        }
    }
}

/// The smallest nearness whose depth, rounded, is at most `limit`.
///
/// Under a perspective camera the correctly rounded 1/w never grows with w: it is at most `limit`
/// from a w on that is 1/(limit + ulp/2). That is less than an ulp below 1/limit, so the answer is
/// the rounded 1/limit or one of its neighbours. `limit` is > 0; +inf gives 0.
#[inline(always)]
fn least_nearness(shared: &Shared<f32>, limit: f32) -> f32 {
    if !shared.perspective {
        return -limit;
    }
    let middle = 1.0 / limit;
    let above = f32::from_bits(middle.to_bits().wrapping_add(1));
    let below = f32::from_bits(middle.to_bits().saturating_sub(1));
    let least = if 1.0 / middle <= limit { middle } else { above };
    if 1.0 / below <= limit { below } else { least }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn attributes<const RAY_CAST: bool, const NORMAL: bool, const COLOR: bool>(
    scratch: &mut Scratch,
    shared: &Shared<f32>,
) {
    let (shared, rect) = (*shared, scratch.rect);
    for splat in &scratch.splats {
        let (footprint, normal, color) = (splat.footprint, splat.normal, splat.color);
        let blocks = splat.blocks(&rect);
        for row in blocks.y0..blocks.y1 {
            let (first, last) = columns::<RAY_CAST>(splat, &blocks, row, &rect, shared.limit);
            for column in first..last {
                let block = &mut scratch.blocks[(row * scratch.columns + column) as usize];
                let (x, y) = (rect.x0 + column * SIDE, rect.y0 + row * SIDE);
                let (q, w) = fragments::<RAY_CAST>(&shared, &footprint, x, y);
                let Some(weight) = weights(&q, &w, &block.least, shared.limit, &footprint) else {
                    continue;
                };
                add(&mut block.weight, &weight, 1.0);
                if NORMAL {
                    for (sum, value) in block.normal.iter_mut().zip(normal) {
                        add(sum, &weight, value);
                    }
                }
                if COLOR {
                    for (sum, value) in block.color.iter_mut().zip(color) {
                        add(sum, &weight, value);
                    }
                }
            }
        }
    }
}

/// The nearness of the fragments that are inside; NaN, which fails every comparison, for the others.
#[inline(always)]
fn inside(q: &Lanes, w: &Lanes, limit: f32) -> Lanes {
    let mut inside = [f32::NAN; LANES];
    for i in 0..LANES {
        inside[i] = if q[i] <= limit { w[i] } else { inside[i] };
    }
    inside
}

/// The weights of the fragments that are inside and visible, 0 for the others; none if all are.
#[inline(always)]
fn weights(
    q: &Lanes,
    w: &Lanes,
    least: &Lanes,
    limit: f32,
    footprint: &Footprint<f32>,
) -> Option<Lanes> {
    let inside = inside(q, w, limit);
    let mut hit = [0_u32; LANES];
    for i in 0..LANES {
        hit[i] = u32::from(inside[i] >= least[i]);
    }
    if hit.iter().all(|&h| h == 0) {
        return None;
    }
    let mut weight = [0.0; LANES];
    for i in 0..LANES {
        // q of a fragment that counts is in [0, 16]; the others may give any number.
        let value = footprint.amplitude * exp_f32_in_range(q[i] * -0.5);
        weight[i] = if hit[i] != 0 { value } else { 0.0 };
    }
    Some(weight)
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

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn normalize<const NORMAL: bool, const COLOR: bool>(blocks: &mut [Block], shared: &Shared<f32>) {
    let shared = *shared;
    for block in blocks {
        let weight = block.weight;
        let (mut depth, mut normal, mut color) = (block.nearest, block.normal, block.color);
        for i in 0..LANES {
            depth[i] = shared.depth(depth[i]);
            if NORMAL {
                let sums = [normal[0][i], normal[1][i], normal[2][i]];
                [normal[0][i], normal[1][i], normal[2][i]] = sum::direction(sums, weight[i]);
            }
            if COLOR {
                let sums = [color[0][i], color[1][i], color[2][i]];
                [color[0][i], color[1][i], color[2][i]] = sum::average(sums, weight[i]);
            }
        }
        (block.nearest, block.normal, block.color) = (depth, normal, color);
    }
}
