//! Find the distance to the nearest of a growing set of points, with a grid of lists.
//!
//! The distances are the samplers' distances, in `f32`. The grid is in f64, and only decides which
//! cells to skip.

use super::greedy::squared_distance;
use crate::number::MapInline;
use glam::{DVec3, Vec3};

/// Initial number of cells along the longest side of the box.
const FIRST: usize = 4;
/// The most cells for each point that will come, because a surface leaves most cells empty; or
const CELLS: usize = 16;
/// this many in all, if that is more.
const FEW: usize = 1 << 21;
/// The end of a list.
const NONE: u32 = u32::MAX;

/// Points in the cells of a grid.
pub(super) struct Nearest {
    low: DVec3,
    extent: DVec3,
    points: Vec<Vec3>,
    /// Cells along the longest side. The number of cells is at most its cube,
    fine: usize,
    /// which is at most this.
    most: usize,
    side: f64,
    cells: [usize; 3],
    /// The last point of each cell; and for each point, the one before it in its cell.
    last: Vec<u32>,
    before: Vec<u32>,
}

impl Nearest {
    /// No points yet; all later ones must be among `all`.
    pub(super) fn within(all: &[Vec3]) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in all {
            (low, high) = (low.min(point.as_dvec3()), high.max(point.as_dvec3()));
        }
        let mut none = Self {
            low,
            extent: high - low,
            points: Vec::new(),
            fine: FIRST,
            most: FEW.max(CELLS * all.len()),
            side: 1.0,
            cells: [1; 3],
            last: Vec::new(),
            before: Vec::new(),
        };
        none.divide();
        none
    }

    /// Adds a point, which must lie in the box.
    pub(super) fn add(&mut self, point: Vec3) {
        self.points.push(point);
        // Keep about one point in each occupied cell of a surface.
        let finer = 2 * self.fine;
        if 2 * self.points.len() > finer * finer && finer.pow(3) <= self.most {
            self.fine = finer;
            self.divide();
        } else {
            self.link(self.points.len() - 1);
        }
    }

    /// The least squared distance to a point; +inf without points.
    pub(super) fn distance(&self, to: Vec3) -> f32 {
        let (cell, inside) = self.place(to);
        // A lower bound of the distance to the border of the own cell.
        let edge = inside.min(DVec3::splat(self.side) - inside).min_element();
        let edge = if edge > 0.0 { edge } else { 0.0 };
        let mut least = f32::INFINITY;
        for ring in 0..self.fine + 1 {
            if ring > 0 {
                let reach = edge + (ring - 1) as f64 * self.side;
                // Squares in f32 are off by up to 2^-21 of themselves, and 3e-45.
                if reach * reach * (1.0 - 1e-5) > f64::from(least) + 1e-44 {
                    break;
                }
            }
            self.ring(cell, ring, |point| {
                let distance = squared_distance(to, point);
                if distance < least {
                    least = distance;
                }
            });
        }
        least
    }

    /// Visits all points of the cells that are `ring` cells away along one axis, and no farther
    /// along any.
    fn ring(&self, [x, y, z]: [usize; 3], ring: usize, mut visit: impl FnMut(Vec3)) {
        let range = |at: usize, count: usize| at.saturating_sub(ring)..(at + ring + 1).min(count);
        let [columns, rows, layers] = self.cells;
        for k in range(z, layers) {
            for j in range(y, rows) {
                let shell = k.abs_diff(z) == ring || j.abs_diff(y) == ring;
                let step = if shell || ring == 0 { 1 } else { 2 * ring };
                let first = if shell { x.saturating_sub(ring) } else { x.wrapping_sub(ring) };
                let mut i = first;
                // A row inside the shell contributes only its two ends.
                for _ in 0..=2 * ring / step {
                    if i < columns && i.abs_diff(x) <= ring {
                        let mut at = self.last[(k * rows + j) * columns + i];
                        while at != NONE {
                            visit(self.points[at as usize]);
                            at = self.before[at as usize];
                        }
                    }
                    i = i.wrapping_add(step);
                }
            }
        }
    }

    /// The cell of a point, and the position of the point in it.
    fn place(&self, point: Vec3) -> ([usize; 3], DVec3) {
        let from = point.as_dvec3() - self.low;
        let mut inside = from;
        let mut cell = [0; 3];
        for axis in 0..3 {
            // The cast turns negative numbers into 0.
            cell[axis] = ((from[axis] / self.side) as usize).min(self.cells[axis] - 1);
            inside[axis] -= cell[axis] as f64 * self.side;
        }
        (cell, inside)
    }

    /// Builds the grid again with the current cell size.
    fn divide(&mut self) {
        let longest = self.extent.max_element();
        self.side = if longest > 0.0 { longest / self.fine as f64 } else { 1.0 };
        let count = |extent: f64| ((extent / self.side) as usize + 1).min(self.fine);
        self.cells = self.extent.to_array().map_inline(count);
        self.last = vec![NONE; self.cells.iter().product()];
        self.before.clear();
        (0..self.points.len()).for_each(|point| self.link(point));
    }

    fn link(&mut self, point: usize) {
        let ([x, y, z], _) = self.place(self.points[point]);
        let [columns, rows, _] = self.cells;
        let last = &mut self.last[(z * rows + y) * columns + x];
        self.before.push(*last);
        *last = point as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_is_that_of_all(
            points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 2..400),
            scale in prop::sample::select(vec![
                [1.0_f32, 1.0, 1.0], [1.0, 1e-3, 1.0], [0.0, 0.0, 3.0], [0.0; 3], [2e-23; 3],
                [3e37, 1e38, 1.0], [1e-20, 1.0, 1e19],
            ]),
            lattice: bool,
        ) {
            let at = |p: [f32; 3]| {
                let p = if lattice { p.map(|x| (x * 6.0).floor()) } else { p };
                Vec3::from_array(p) * Vec3::from_array(scale)
            };
            let points: Vec<Vec3> = points.into_iter().map(at).collect();
            let mut grid = Nearest::within(&points);
            for (i, point) in points.iter().enumerate() {
                let brute = points[..i].iter().map(|other| squared_distance(*point, *other));
                let brute = brute.fold(f32::INFINITY, |a, b| if b < a { b } else { a });
                prop_assert_eq!(grid.distance(*point), brute);
                grid.add(*point);
            }
        }
    }
}
