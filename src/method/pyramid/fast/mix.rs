//! Decide which of four cells take part, and average them, in lanes: the formulas of the
//! definition.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::level::TUBE;
use crate::number::lanes::{LANES, Lanes, any_above_0, each, vector};
use crate::number::{Real, Vector2};
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

/// The weights of four cells, 0 for a cell that takes no part, and the kind of the new cell.
pub(super) struct Mix {
    weights: [Lanes; 4],
    /// 1 divided by the sum of the weights.
    scale: Lanes,
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
        let [a, b, c, d] = &weights;
        let scale = each(|i| 1.0 / ((a[i] + b[i]) + (c[i] + d[i])));
        Mix { weights, scale, kind: kinds, first: firsts }
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
    /// The average of a number: [`Mean::average`] in lanes, spelled out in one long loop.
    ///
    /// [`Mean::average`]: crate::composite::mean::Mean::average
    #[inline(always)]
    pub(super) fn average(&self, a: &[Lanes; 4]) -> Lanes {
        let mut average = [0.0; LANES];
        for i in 0..LANES {
            let (w, a, takes) = self.lane(i, a);
            let term = [
                if takes[0] { w[0] * a[0] } else { 0.0 },
                if takes[1] { w[1] * a[1] } else { 0.0 },
                if takes[2] { w[2] * a[2] } else { 0.0 },
                if takes[3] { w[3] * a[3] } else { 0.0 },
            ];
            let sum = (term[0] + term[1]) + (term[2] + term[3]);
            let (least, greatest) = (least(takes, a), greatest(takes, a));
            average[i] = (sum * self.scale[i]).at_least(least).at_most(greatest) + 0.0;
        }
        average
    }

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

    /// The least of a number.
    #[inline(always)]
    pub(super) fn least(&self, a: &[Lanes; 4]) -> Lanes {
        each(|i| {
            let (_, a, takes) = self.lane(i, a);
            least(takes, a)
        })
    }

    /// The greatest of a number.
    #[inline(always)]
    pub(super) fn greatest(&self, a: &[Lanes; 4]) -> Lanes {
        each(|i| {
            let (_, a, takes) = self.lane(i, a);
            greatest(takes, a)
        })
    }

    /// Weights and numbers of the four cells of a lane, and which of them take part.
    #[inline(always)]
    fn lane(&self, i: usize, a: &[Lanes; 4]) -> ([f32; 4], [f32; 4], [bool; 4]) {
        let w = [self.weights[0][i], self.weights[1][i], self.weights[2][i], self.weights[3][i]];
        let takes = [w[0] > 0.0, w[1] > 0.0, w[2] > 0.0, w[3] > 0.0];
        (w, [a[0][i], a[1][i], a[2][i], a[3][i]], takes)
    }
}

/// [`Mean::least`](crate::composite::mean::Mean::least).
#[inline(always)]
fn least(takes: [bool; 4], a: [f32; 4]) -> f32 {
    let a = [
        if takes[0] { a[0] } else { f32::INFINITY },
        if takes[1] { a[1] } else { f32::INFINITY },
        if takes[2] { a[2] } else { f32::INFINITY },
        if takes[3] { a[3] } else { f32::INFINITY },
    ];
    (a[0].at_most(a[1])).at_most(a[2].at_most(a[3]))
}

/// [`Mean::greatest`](crate::composite::mean::Mean::greatest).
#[inline(always)]
fn greatest(takes: [bool; 4], a: [f32; 4]) -> f32 {
    let a = [
        if takes[0] { a[0] } else { f32::NEG_INFINITY },
        if takes[1] { a[1] } else { f32::NEG_INFINITY },
        if takes[2] { a[2] } else { f32::NEG_INFINITY },
        if takes[3] { a[3] } else { f32::NEG_INFINITY },
    ];
    (a[0].at_least(a[1])).at_least(a[2].at_least(a[3]))
}
