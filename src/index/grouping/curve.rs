//! Points along a space-filling curve, so that points near each other in space are near each other
//! in the list.

use crate::frame::Exec;
use crate::number::MapInline;
use crate::number::Real;
use glam::{DVec3, Vec3};

/// The numbers 0, 1, 2 ... of the points, in the order of their cells along the Morton curve;
/// within one cell the smaller number comes first.
///
/// If more than `most` points share a cell, they are ordered by cells of their own box, and so on.
/// So a point far away from all others does not put the others into one cell.
pub(super) fn along(points: &[Vec3], most: usize, exec: &Exec) -> Vec<u32> {
    let numbered = Numbered::upto(points.len());
    let cells = Cells::around(points.iter().copied(), &numbered);
    let mut order = Vec::new();
    exec.extend(&mut order, points.len(), |i| numbered.with(cells.place(points[i]), i));
    exec.sort(&mut order);
    refine(points, most, &numbered, &mut order);
    let mut along = Vec::new();
    exec.extend(&mut along, order.len(), |place| numbered.number(order[place]) as u32);
    along
}

/// Orders the points of each cell that has more than `most`.
fn refine(points: &[Vec3], most: usize, numbered: &Numbered, order: &mut [u64]) {
    let in_one_cell = |a: &u64, b: &u64| numbered.cell(*a) == numbered.cell(*b);
    for run in order.chunk_by_mut(in_one_cell).filter(|run| run.len() > most) {
        let point = |of: u64| points[numbered.number(of)];
        // No cells can separate points at one place.
        if run.iter().any(|&of| point(of) != point(run[0])) {
            let cells = Cells::around(run.iter().map(|&of| point(of)), numbered);
            run.iter_mut()
                .for_each(|of| *of = numbered.with(cells.place(point(*of)), numbered.number(*of)));
            run.sort_unstable();
            refine(points, most, numbered, run);
        }
    }
}

/// A cell and the number of a point in one integer, the cell in the upper bits, because one integer
/// sorts faster than two.
struct Numbered {
    /// Bits of a number.
    bits: u32,
}

impl Numbered {
    /// The format for this many numbers.
    fn upto(count: usize) -> Self {
        Self { bits: usize::BITS - count.leading_zeros() }
    }

    /// How many cells there are along the widest axis: as many as the bits left for three axes
    /// allow.
    fn cells(&self) -> u64 {
        1 << ((u64::BITS - self.bits) / 3)
    }

    fn with(&self, cell: u64, number: usize) -> u64 {
        cell << self.bits | number as u64
    }

    fn cell(&self, of: u64) -> u64 {
        of >> self.bits
    }

    fn number(&self, of: u64) -> usize {
        (of & ((1 << self.bits) - 1)) as usize
    }
}

/// The cells of a box.
struct Cells {
    low: DVec3,
    /// How many cells there are along the widest axis.
    count: u64,
    scale: f64,
}

impl Cells {
    /// The cells of the box around some points.
    fn around(points: impl Iterator<Item = Vec3>, numbered: &Numbered) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for point in points {
            // One instruction each; `Vec3::min` also handles NaN.
            for axis in 0..3 {
                low[axis] = low[axis].at_most(point[axis]);
                high[axis] = high[axis].at_least(point[axis]);
            }
        }
        let low = low.as_dvec3();
        let size = (high.as_dvec3() - low).max_element();
        let count = numbered.cells();
        // Points that are all at one place have one cell.
        Self { low, count, scale: if size > 0.0 { count as f64 / size } else { 0.0 } }
    }

    /// The position of a point's cell along the curve.
    fn place(&self, point: Vec3) -> u64 {
        let at = self.scale * (point.as_dvec3() - self.low);
        interleaved(at.to_array().map_inline(|at| (at as u64).min(self.count - 1)))
    }
}

/// The place along the curve of a cell with numbers of at most 21 bits: x gives the lowest bit.
pub(crate) fn interleaved([x, y, z]: [u64; 3]) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// Spreads 21 bits, which are all that there are, so that two zeros follow each.
fn spread(bits: u64) -> u64 {
    let steps = [
        (32, 0x001F_0000_0000_FFFF),
        (16, 0x001F_0000_FF00_00FF),
        (8, 0x100F_00F0_0F00_F00F),
        (4, 0x10C3_0C30_C30C_30C3),
        (2, 0x1249_2492_4924_9249),
    ];
    steps.into_iter().fold(bits, |bits, (shift, keep)| (bits | bits << shift) & keep)
}
