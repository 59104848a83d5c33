//! Points along a space-filling curve, so that those near each other stand near each other.

use crate::frame::Exec;
use crate::number::Real;
use glam::{DVec3, Vec3};

/// Cells along the widest axis: as many as three axes leave bits in 64.
const CELLS: f64 = (1 << 21) as f64;

/// The numbers 0, 1, 2 ... of some points, in the order of their cells along the curve of Morton;
/// of one cell the smaller number first.
///
/// If more than `most` points share a cell, they are ordered by cells of their own box, and so on:
/// a point far away from all others does not put those into one cell.
pub(super) fn along(points: &[Vec3], most: usize, exec: &Exec) -> Vec<u32> {
    let cells = Cells::around(points.iter().copied());
    let mut order = Vec::new();
    exec.extend(&mut order, points.len(), |i| (cells.place(points[i]), i as u32));
    exec.sort(&mut order);
    refine(points, most, &mut order);
    let mut along = Vec::new();
    exec.extend(&mut along, order.len(), |place| order[place].1);
    along
}

/// Orders the points of each cell that has more than `most`.
fn refine(points: &[Vec3], most: usize, order: &mut [(u64, u32)]) {
    for run in order.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > most) {
        let first = points[run[0].1 as usize];
        if run.iter().any(|&(_, i)| points[i as usize] != first) {
            let cells = Cells::around(run.iter().map(|&(_, i)| points[i as usize]));
            run.iter_mut().for_each(|(key, i)| *key = cells.place(points[*i as usize]));
            run.sort_unstable();
            refine(points, most, run);
        }
    }
}

/// The cells of a box.
struct Cells {
    low: DVec3,
    scale: f64,
}

impl Cells {
    /// Of the box around some points.
    fn around(points: impl Iterator<Item = Vec3>) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for point in points {
            // One instruction each; `Vec3::min` asks for NaN, too.
            for axis in 0..3 {
                low[axis] = low[axis].at_most(point[axis]);
                high[axis] = high[axis].at_least(point[axis]);
            }
        }
        let low = low.as_dvec3();
        let size = (high.as_dvec3() - low).max_element();
        // Points that are all at one place have one cell.
        Self { low, scale: if size > 0.0 { CELLS / size } else { 0.0 } }
    }

    /// The place along the curve of the cell of a point.
    fn place(&self, point: Vec3) -> u64 {
        let at = self.scale * (point.as_dvec3() - self.low);
        let [x, y, z] =
            at.to_array().map(|at| if at < CELLS { at as u64 } else { CELLS as u64 - 1 });
        spread(x) | spread(y) << 1 | spread(z) << 2
    }
}

/// 21 bits, two zeros after each.
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
