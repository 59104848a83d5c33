//! Reconstruct and normalize in lanes; see [`super::super::reconstruction`].
//!
//! [`LANES`] pixels of a row search together. At level 0 each pixel has its own template: centres
//! beside one another are read as lanes. A cell of a coarser level belongs to the templates of many
//! pixels. It is one centre for all lanes; lanes outside its template are masked. Either way every
//! lane meets its centres in the order of the definition.

use super::level::{COLOR, CenterLevel, CenterRow, DEPTH, NORMAL, PLACE, RADIUS, SQUARE, TILT};
use crate::composite::sum;
use crate::frame::NO_ID;
use crate::method::clock::{Work, spend};
use crate::method::projection::fast::PAD;
use crate::method::projection::world;
use crate::method::template::Falloff;
use crate::method::template::reconstruction::weight;
use crate::number::lanes::{
    LANES, Lanes, Mask, any, components, each, load, mask, store_first, vectorized,
};
use crate::number::{Vector2, Vector3};
use crate::splat::{Ellipse, View};

/// The centres that [`LANES`] pixels of a row have gathered.
struct GatheredLanes {
    id: [u32; LANES],
    depth: Lanes,
    radius: Lanes,
    weight: Lanes,
    depths: Lanes,
    normals: [Lanes; 3],
    colors: [Lanes; 3],
}

/// One centre for each lane.
struct CenterLanes {
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

vectorized!(
    /// Reconstructs and normalizes a row of pixels; `half` is h.
    pub(super) fn search_row<const COLORED: bool, const GAUSSIAN: bool>(
        levels: &[&CenterLevel],
        which: &[usize],
        half: usize,
        y: usize,
        view: &View<f32>,
        target: &mut Target<'_>,
    ) {
        let width = target.depth.len();
        for x in (0..width).step_by(LANES) {
            let mut gathered = GatheredLanes::new();
            for (&level, cells) in which.iter().zip(levels) {
                let own = y >> level;
                for cy in own.saturating_sub(half)..cells.layout.height.min(own + half + 1) {
                    let row = cells.row(cy);
                    match (row.has[0], level) {
                        (false, _) => {}
                        (true, 0) => {
                            beside::<COLORED, GAUSSIAN>(&mut gathered, row, x, y, cy == y, half);
                        }
                        (true, _) => {
                            around::<COLORED, GAUSSIAN>(&mut gathered, row, x, y, level, half);
                        }
                    }
                }
            }
            normalize::<COLORED>(&gathered, x, view, target);
        }
    }
);

/// Gathers one row of the templates at level 0: centres beside one another.
#[inline(always)]
fn beside<const COLORED: bool, const GAUSSIAN: bool>(
    gathered: &mut GatheredLanes,
    row: CenterRow<'_>,
    x: usize,
    y: usize,
    own_row: bool,
    half: usize,
) {
    for dx in 0..=2 * half {
        // -- Which centres hold a pixel, and the pixel's own centre
        let first = PAD + x + dx - half;
        let own = own_row && dx == half;
        let [px, py] = [row.load(PLACE, first), row.load(PLACE + 1, first)];
        let [tx, ty] = [row.load(TILT, first), row.load(TILT + 1, first)];
        let square = row.load(SQUARE, first);
        let ellipse = |i: usize| Ellipse { tilt: Vector2::new(tx[i], ty[i]), square: square[i] };
        let form = each(|i| ellipse(i).form((x + i) as f32 + 0.5 - px[i], y as f32 + 0.5 - py[i]));
        let inside = mask(|i| ellipse(i).holds(form[i]) | (own & !square[i].is_nan()));
        if !any(&inside) {
            continue;
        }
        // -- The numbers of these centres
        let centers = CenterLanes {
            id: load(row.ids, first),
            depth: row.load(DEPTH, first),
            radius: row.load(RADIUS, first),
            normal: row.load_vectors(NORMAL, first),
            color: if COLORED { row.load_vectors(COLOR, first) } else { [[0.0; LANES]; 3] },
        };
        gathered.add::<COLORED, GAUSSIAN>(&centers, &inside, &form, &square);
    }
}

/// Gathers one row of the templates at a coarser level: each centre for all pixels around it.
#[inline(always)]
fn around<const COLORED: bool, const GAUSSIAN: bool>(
    gathered: &mut GatheredLanes,
    row: CenterRow<'_>,
    x: usize,
    y: usize,
    level: usize,
    half: usize,
) {
    let first = (x >> level).saturating_sub(half);
    let last = row.layout.width.min(((x + LANES - 1) >> level) + half + 1);
    for cx in first..last {
        // -- Whether the centre can hold a pixel at all
        let number = |attribute: usize| row.numbers[row.layout.at(attribute, cx)];
        let square = number(SQUARE);
        let (left, upper) = (number(PLACE), number(PLACE + 1));
        let dy = y as f32 + 0.5 - upper;
        // The form is at least dy dy; the margin allows for rounding. NaN: no centre stays here.
        if !(dy * dy <= square * (1.0 + 1.0 / 1_048_576.0)) {
            continue;
        }
        // -- Which pixels it holds, if they have it in their templates
        let ellipse = Ellipse { tilt: Vector2::new(number(TILT), number(TILT + 1)), square };
        let form = each(|i| ellipse.form((x + i) as f32 + 0.5 - left, dy));
        let inside = mask(|i| {
            let column = (x + i) >> level;
            let found = (column + half >= cx) & (column <= cx + half);
            ellipse.holds(form[i]) & found
        });
        if !any(&inside) {
            continue;
        }
        // -- The numbers of this centre
        let all = |attribute: usize| [number(attribute); LANES];
        let three = |first: usize| [all(first), all(first + 1), all(first + 2)];
        let centers = CenterLanes {
            id: [row.ids[PAD + cx]; LANES],
            depth: all(DEPTH),
            radius: all(RADIUS),
            normal: three(NORMAL),
            color: if COLORED { three(COLOR) } else { [[0.0; LANES]; 3] },
        };
        gathered.add::<COLORED, GAUSSIAN>(&centers, &inside, &form, &[square; LANES]);
    }
}

impl GatheredLanes {
    /// No centre.
    #[inline(always)]
    fn new() -> Self {
        Self {
            id: [NO_ID; LANES],
            depth: [f32::INFINITY; LANES],
            radius: [0.0; LANES],
            weight: [0.0; LANES],
            depths: [0.0; LANES],
            normals: [[0.0; LANES]; 3],
            colors: [[0.0; LANES]; 3],
        }
    }

    /// Makes the ternary test, and adds to the sums, in the lanes that are inside.
    #[inline(always)]
    fn add<const COLORED: bool, const GAUSSIAN: bool>(
        &mut self,
        c: &CenterLanes,
        inside: &Mask,
        form: &Lanes,
        square: &Lanes,
    ) {
        let falloff = if GAUSSIAN { Falloff::Gaussian } else { Falloff::Linear };
        // -- The ternary test
        let (mut anew, mut takes, mut weights) = ([0; LANES], [0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let (depth, radius) = (self.depth[i], self.radius[i]);
            let sum = c.radius[i] + radius;
            let before = (self.id[i] == NO_ID) | (depth - c.depth[i] > sum);
            let behind = !before & (c.depth[i] - depth > sum);
            let taken = (inside[i] != 0) & !behind;
            let first = (inside[i] != 0) & before;
            weights[i] = weight(falloff, form[i], square[i]);
            let front = taken & (first | (c.depth[i] < depth));
            self.id[i] = if front { c.id[i] } else { self.id[i] };
            self.depth[i] = if front { c.depth[i] } else { depth };
            self.radius[i] = if front { c.radius[i] } else { radius };
            anew[i] = u32::from(first).wrapping_neg();
            takes[i] = u32::from(taken).wrapping_neg();
        }
        // -- The sums
        let terms = TermLanes { anew, takes, weights };
        terms.add(&mut self.weight, &[1.0; LANES]);
        terms.add(&mut self.depths, &c.depth);
        for axis in 0..3 {
            terms.add(&mut self.normals[axis], &c.normal[axis]);
        }
        if COLORED {
            for channel in 0..3 {
                terms.add(&mut self.colors[channel], &c.color[channel]);
            }
        }
    }
}

/// The result of the ternary test on one centre for each lane.
struct TermLanes {
    /// Where the sums start anew.
    anew: Mask,
    /// Where the centre is added.
    takes: Mask,
    weights: Lanes,
}

impl TermLanes {
    /// Adds a number of the centres to its sum.
    #[inline(always)]
    fn add(&self, sum: &mut Lanes, value: &Lanes) {
        let mut lanes = *sum;
        for i in 0..LANES {
            let old = if self.anew[i] != 0 { 0.0 } else { lanes[i] };
            let new = old + self.weights[i] * value[i];
            lanes[i] = if self.takes[i] != 0 { new } else { old };
        }
        *sum = lanes;
    }
}

/// Divides the sums by the sum of weights, and writes them into the picture.
#[inline(always)]
fn normalize<const COLORED: bool>(
    gathered: &GatheredLanes,
    x: usize,
    view: &View<f32>,
    target: &mut Target<'_>,
) {
    spend(Work::Normalize);
    let GatheredLanes { id, weight, depths, normals, colors, .. } = gathered;
    let pixels = x..target.depth.len().min(x + LANES);
    let depth = each(|i| if weight[i] > 0.0 { depths[i] / weight[i] } else { f32::INFINITY });
    store_first(&mut target.depth[pixels.clone()], &depth);
    store_first(&mut target.id[pixels.clone()], id);
    store_first(&mut target.weight[pixels.clone()], weight);
    if let Some(plane) = &mut target.normal {
        let mut turned = [[0.0; 3]; LANES];
        if any(&mask(|i| id[i] != NO_ID)) {
            for i in 0..LANES {
                let [x, y, z] = sum::average(components(normals, i), weight[i]);
                turned[i] = world(view, Vector3::new(x, y, z));
            }
        }
        store_first(&mut plane[pixels.clone()], &turned);
    }
    if let Some(plane) = target.color.as_mut().filter(|_| COLORED) {
        for (i, color) in plane[pixels].iter_mut().enumerate() {
            *color = sum::average(components(colors, i), weight[i]);
        }
    }
}
