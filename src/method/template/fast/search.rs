//! Reconstruction and normalization in lanes; see [`super::super::reconstruction`].
//!
//! A block is [`LANES`] pixels of a row. At level 0 each has a template of its own: the centres
//! beside one another are read as lanes. A cell of a coarser level belongs to the templates of many
//! of them: it is one centre for all lanes, those outside its template masked. Either way every
//! lane meets its centres in the order of the definition.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::level::{COLOR, DEPTH, Level, NORMAL, PAD, PLACE, RADIUS, Row, SQUARE, TILT, lanes};
use crate::composite::sum;
use crate::frame::NO_ID;
use crate::method::projection::fast::{LANES, Lanes, put};
use crate::method::projection::world;
use crate::method::template::reconstruction::weight;
use crate::number::{Vector2, Vector3};
use crate::splat::{Ellipse, View};
use multiversion::multiversion;

/// What the pixels of a block have gathered.
struct Block {
    id: [u32; LANES],
    depth: Lanes,
    radius: Lanes,
    weight: Lanes,
    depths: Lanes,
    normals: [Lanes; 3],
    colors: [Lanes; 3],
}

/// One centre for each lane.
struct Centers {
    id: [u32; LANES],
    depth: Lanes,
    radius: Lanes,
    normal: [Lanes; 3],
    color: [Lanes; 3],
}

/// A row of the picture, to be written.
#[derive(Debug)]
pub(super) struct Target<'a> {
    pub(super) depth: &'a mut [f32],
    pub(super) id: &'a mut [u32],
    pub(super) weight: &'a mut [f32],
    pub(super) normal: Option<&'a mut [[f32; 3]]>,
    pub(super) color: Option<&'a mut [[f32; 3]]>,
}

/// A row of pixels: reconstruction and normalization; `half` is h.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
pub(super) fn search_row<const COLORED: bool>(
    levels: &[&Level],
    which: &[usize],
    half: usize,
    y: usize,
    view: &View<f32>,
    target: &mut Target<'_>,
) {
    let width = target.depth.len();
    for x in (0..width).step_by(LANES) {
        let mut block = Block {
            id: [NO_ID; LANES],
            depth: [f32::INFINITY; LANES],
            radius: [0.0; LANES],
            weight: [0.0; LANES],
            depths: [0.0; LANES],
            normals: [[0.0; LANES]; 3],
            colors: [[0.0; LANES]; 3],
        };
        for (&level, cells) in which.iter().zip(levels) {
            let row = y >> level;
            for cy in row.saturating_sub(half)..cells.shape.height.min(row + half + 1) {
                let cells = (cells.row(cy), cells.shape.stride, cells.shape.width);
                match (cells.0.has[0], level) {
                    (false, _) => {}
                    (true, 0) => beside::<COLORED>(&mut block, cells, (x, y, cy == y), half),
                    (true, _) => around::<COLORED>(&mut block, cells, (x, y, level), half),
                }
            }
        }
        normalize::<COLORED>(&block, x, view, target);
    }
}

/// One row of the templates at level 0.
#[inline(always)]
fn beside<const COLORED: bool>(
    block: &mut Block,
    (row, stride, _): (Row<'_>, usize, usize),
    (x, y, own_row): (usize, usize, bool),
    half: usize,
) {
    for dx in 0..=2 * half {
        let first = PAD + x + dx - half;
        let number = |attribute: usize| lanes(row.numbers, attribute * stride + first);
        let own = own_row && dx == half;
        let (px, py, square) = (number(PLACE), number(PLACE + 1), number(SQUARE));
        let (tx, ty) = (number(TILT), number(TILT + 1));
        let mut form = [0.0; LANES];
        let mut inside = [0_u32; LANES];
        for i in 0..LANES {
            let tilt = Vector2::new(tx[i], ty[i]);
            let ellipse = Ellipse { tilt, square: square[i] };
            form[i] = ellipse.form((x + i) as f32 + 0.5 - px[i], y as f32 + 0.5 - py[i]);
            let stays = !square[i].is_nan();
            inside[i] = u32::from(ellipse.holds(form[i]) | (own & stays));
        }
        if inside.iter().all(|&inside| inside == 0) {
            continue;
        }
        let mut ids = [0; LANES];
        ids.copy_from_slice(&row.ids[first..first + LANES]);
        let centers = Centers {
            id: ids,
            depth: number(DEPTH),
            radius: number(RADIUS),
            normal: [number(NORMAL), number(NORMAL + 1), number(NORMAL + 2)],
            color: if COLORED {
                [number(COLOR), number(COLOR + 1), number(COLOR + 2)]
            } else {
                [[0.0; LANES]; 3]
            },
        };
        block.add::<COLORED>(&centers, &inside, &form, &square);
    }
}

/// One row of the templates at a coarser level.
#[inline(always)]
fn around<const COLORED: bool>(
    block: &mut Block,
    (row, stride, width): (Row<'_>, usize, usize),
    (x, y, level): (usize, usize, usize),
    half: usize,
) {
    let first = (x >> level).saturating_sub(half);
    let last = width.min(((x + LANES - 1) >> level) + half + 1);
    for cx in first..last {
        let number = |attribute: usize| row.numbers[attribute * stride + PAD + cx];
        let square = number(SQUARE);
        let (left, upper) = (number(PLACE), number(PLACE + 1));
        let dy = y as f32 + 0.5 - upper;
        // The form is at least dy dy; the margin is for rounding. NaN: no centre stays here.
        if !(dy * dy <= square * (1.0 + 1.0 / 1_048_576.0)) {
            continue;
        }
        let tilt = Vector2::new(number(TILT), number(TILT + 1));
        let ellipse = Ellipse { tilt, square };
        let mut form = [0.0; LANES];
        let mut inside = [0_u32; LANES];
        for i in 0..LANES {
            form[i] = ellipse.form((x + i) as f32 + 0.5 - left, dy);
            let column = (x + i) >> level;
            let found = (column + half >= cx) & (column <= cx + half);
            inside[i] = u32::from(ellipse.holds(form[i]) & found);
        }
        if inside.iter().all(|&inside| inside == 0) {
            continue;
        }
        let all = |attribute: usize| [number(attribute); LANES];
        let centers = Centers {
            id: [row.ids[PAD + cx]; LANES],
            depth: all(DEPTH),
            radius: all(RADIUS),
            normal: [all(NORMAL), all(NORMAL + 1), all(NORMAL + 2)],
            color: if COLORED {
                [all(COLOR), all(COLOR + 1), all(COLOR + 2)]
            } else {
                [[0.0; LANES]; 3]
            },
        };
        block.add::<COLORED>(&centers, &inside, &form, &[square; LANES]);
    }
}

impl Block {
    /// The ternary test, and the sums, in the lanes that are inside.
    #[inline(always)]
    fn add<const COLORED: bool>(
        &mut self,
        c: &Centers,
        inside: &[u32; LANES],
        form: &Lanes,
        square: &Lanes,
    ) {
        // 0 where the sums start anew.
        let mut kept = [1_u32; LANES];
        let mut weights = [0.0; LANES];
        let mut takes = [0_u32; LANES];
        for i in 0..LANES {
            let (depth, radius) = (self.depth[i], self.radius[i]);
            let sum = c.radius[i] + radius;
            let before = (self.id[i] == NO_ID) | (depth - c.depth[i] > sum);
            let behind = !before & (c.depth[i] - depth > sum);
            let taken = (inside[i] != 0) & !behind;
            let anew = (inside[i] != 0) & before;
            weights[i] = weight(form[i], square[i]);
            let front = taken & (anew | (c.depth[i] < depth));
            self.id[i] = if front { c.id[i] } else { self.id[i] };
            self.depth[i] = if front { c.depth[i] } else { depth };
            self.radius[i] = if front { c.radius[i] } else { radius };
            kept[i] = u32::from(!anew);
            takes[i] = u32::from(taken);
        }
        let add = |sum: &mut Lanes, value: &Lanes| {
            let mut lanes = *sum;
            for i in 0..LANES {
                let old = if kept[i] != 0 { lanes[i] } else { 0.0 };
                let new = old + weights[i] * value[i];
                lanes[i] = if takes[i] != 0 { new } else { old };
            }
            *sum = lanes;
        };
        add(&mut self.weight, &[1.0; LANES]);
        add(&mut self.depths, &c.depth);
        for axis in 0..3 {
            add(&mut self.normals[axis], &c.normal[axis]);
        }
        if COLORED {
            for channel in 0..3 {
                add(&mut self.colors[channel], &c.color[channel]);
            }
        }
    }
}

/// Sums divided by the sum of weights, into the picture.
#[inline(always)]
fn normalize<const COLORED: bool>(
    block: &Block,
    x: usize,
    view: &View<f32>,
    target: &mut Target<'_>,
) {
    let count = LANES.min(target.depth.len() - x);
    let mut depth = [0.0; LANES];
    for i in 0..LANES {
        let seen = block.weight[i] > 0.0;
        depth[i] = if seen { block.depths[i] / block.weight[i] } else { f32::INFINITY };
    }
    put(&mut target.depth[x..x + count], &depth);
    put(&mut target.id[x..x + count], &block.id);
    put(&mut target.weight[x..x + count], &block.weight);
    let empty = block.id.iter().all(|&id| id == NO_ID);
    if let Some(normals) = &mut target.normal {
        let mut turned = [[0.0; 3]; LANES];
        if !empty {
            for i in 0..LANES {
                let sums = [block.normals[0][i], block.normals[1][i], block.normals[2][i]];
                let [x, y, z] = sum::average(sums, block.weight[i]);
                turned[i] = world(view, Vector3::new(x, y, z));
            }
        }
        put(&mut normals[x..x + count], &turned);
    }
    if let Some(colors) = target.color.as_mut().filter(|_| COLORED) {
        for (i, color) in colors[x..x + count].iter_mut().enumerate() {
            let sums = [block.colors[0][i], block.colors[1][i], block.colors[2][i]];
            *color = sum::average(sums, block.weight[i]);
        }
    }
}
