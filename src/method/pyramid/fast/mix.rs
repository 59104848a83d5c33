//! Decide which of four cells take part, and average them, in lanes: the formulas of the
//! definition.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::level::TUBE;
use crate::method::projection::fast::MeanLanes;
use crate::number::Vector2;
use crate::number::lanes::{LANES, Lanes, any_above_0, each, vector};
use crate::splat::Ellipse;

/// The numbers of four cells that decide which take part, for [`LANES`] new cells.
pub(super) struct FourCells {
    pub(super) kind: [Lanes; 4],
    pub(super) front: [Lanes; 4],
    pub(super) back: [Lanes; 4],
    pub(super) radius: [Lanes; 4],
    /// The displacements.
    pub(super) displacement: [[Lanes; 2]; 4],
    /// From the new cell's centre to the centres of the cells; plus the displacement, to the centre
    /// of the ellipse.
    pub(super) shift: [[f32; 2]; 4],
    /// The tilts of the ellipses.
    pub(super) tilt: [[Lanes; 2]; 4],
}

/// The average of four cells, and the kind of the new cell.
pub(super) struct Mix {
    pub(super) mean: MeanLanes,
    pub(super) kind: Lanes,
    /// The index of the foremost cell, as a number; only for tubes.
    first: Lanes,
}

impl FourCells {
    /// The decisions of [`super::super::Cell::foremost`]; `TUBES` false promises that there are no
    /// tubes.
    ///
    /// Written as one long loop, because LLVM unrolls short loops before it looks for vectors, and
    /// then finds few.
    #[inline(always)]
    pub(super) fn mix<const GAUSSIAN: bool, const TUBES: bool>(&self) -> Mix {
        let mut weights = [[0.0; LANES]; 4];
        let mut distances = [[0.0; LANES]; 4];
        let (mut kinds, mut firsts) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            // -- Which ellipses hold the centre of the new cell
            let mut fronts = [0.0; 4];
            for j in 0..4 {
                let tilt = Vector2::new(self.tilt[j][0][i], self.tilt[j][1][i]);
                let ellipse = Ellipse::tilted(tilt, self.radius[j][i]);
                let x = self.displacement[j][0][i] + self.shift[j][0];
                let y = self.displacement[j][1][i] + self.shift[j][1];
                let form = ellipse.form(x, y);
                let candidate = ellipse.holds(form) & (self.kind[j][i] > 0.0);
                // NaN fails every comparison.
                fronts[j] = if candidate { self.front[j][i] } else { f32::NAN };
                distances[j][i] = if GAUSSIAN { form / ellipse.square } else { 0.0 };
            }
            // -- The foremost of them, and where its interval ends
            let (mut nearest, mut end) = (f32::INFINITY, f32::NEG_INFINITY);
            let (mut kind, mut first) = (0.0, 0.0);
            for j in 0..4 {
                let nearer = fronts[j] < nearest;
                nearest = if nearer { fronts[j] } else { nearest };
                end = if nearer { self.back[j][i] } else { end };
                kind = if nearer { self.kind[j][i] } else { kind };
                first = if TUBES & nearer { j as f32 } else { first };
            }
            (kinds[i], firsts[i]) = (kind, first);
            // -- Those that begin before that end
            for j in 0..4 {
                let alike = !TUBES | ((self.kind[j][i] == TUBE) == (kind == TUBE));
                weights[j][i] = if (fronts[j] <= end) & alike { 1.0 } else { 0.0 };
            }
        }
        // -- Their weights
        if GAUSSIAN {
            for j in 0..4 {
                if any_above_0(&weights[j]) {
                    let takes = weights[j];
                    let weight = |i: usize| gaussian(distances[j][i]);
                    weights[j] = each(|i| if takes[i] > 0.0 { weight(i) } else { 0.0 });
                }
            }
        }
        Mix { mean: MeanLanes::new(weights), kind: kinds, first: firsts }
    }

    /// From the new cell's centre to the centres of the ellipses, along an axis.
    #[inline(always)]
    pub(super) fn place(&self, axis: usize) -> [Lanes; 4] {
        let place = |j: usize| each(|i| self.displacement[j][axis][i] + self.shift[j][axis]);
        [place(0), place(1), place(2), place(3)]
    }
}

/// Two numbers of four cells, cell by cell.
#[inline(always)]
pub(super) fn pairs(x: &[Lanes; 4], y: &[Lanes; 4]) -> [[Lanes; 2]; 4] {
    [[x[0], y[0]], [x[1], y[1]], [x[2], y[2]], [x[3], y[3]]]
}

/// The tilts of ellipses from their normals.
#[inline(always)]
pub(super) fn tilts(normal: &[Lanes; 3]) -> [Lanes; 2] {
    let mut tilts = [[0.0; LANES]; 2];
    for i in 0..LANES {
        let ellipse = Ellipse::new(vector(normal, i), 0.0);
        (tilts[0][i], tilts[1][i]) = (ellipse.tilt.x, ellipse.tilt.y);
    }
    tilts
}

/// exp(-2 d^2), as in the definition for d <= 1; an arbitrary number for other d.
#[inline(always)]
fn gaussian(square: f32) -> f32 {
    crate::number::elementary::exp_f32_in_range::<false>(-2.0 * square)
}

impl Mix {
    /// Tangents of the four cells, by axis, turned to the side of the foremost tangent; see
    /// [`super::super::Cell::average`].
    #[inline(always)]
    pub(super) fn aligned(&self, tangent: [[Lanes; 4]; 3]) -> [[Lanes; 4]; 3] {
        let mut aligned = tangent;
        for i in 0..LANES {
            let mut front = [0.0; 3];
            for axis in 0..3 {
                for j in 0..4 {
                    let own = tangent[axis][j][i];
                    front[axis] = if self.first[i] == j as f32 { own } else { front[axis] };
                }
            }
            for j in 0..4 {
                let [x, y, z] = [tangent[0][j][i], tangent[1][j][i], tangent[2][j][i]];
                let opposite = (x * front[0] + y * front[1]) + z * front[2] < 0.0;
                aligned[0][j][i] = if opposite { -x } else { x };
                aligned[1][j][i] = if opposite { -y } else { y };
                aligned[2][j][i] = if opposite { -z } else { z };
            }
        }
        aligned
    }
}
