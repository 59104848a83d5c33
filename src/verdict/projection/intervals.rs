//! A triangle whose corners are intervals on the grid: which pixels it covers, and the values it
//! has there.

use crate::frame::Rect;
use crate::frame::raster::Snap;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real};
use crate::verdict::checks::anything;

/// A bound on the rounding of a sum over three corners, as a fraction of the largest. No
/// implementation rounds more.
pub(super) const ROUNDINGS: f64 = 64.0 / 16_777_216.0;

/// The intervals of a triangle's corners, as midpoints and deviations in units of fixed point.
pub(super) struct Intervals {
    middle: [[f64; 2]; 3],
    deviation: [[f64; 2]; 3],
    /// The size of a pixel in units of fixed point.
    scale: f64,
    /// Twice the area: midpoint and deviation. Its sign tells which way the corners run.
    cross: [f64; 2],
}

/// More than the rounding of `f64` in a product of two differences.
const OF_DOUBLES: f64 = 1e-12;

impl Intervals {
    pub(super) fn new(snap: &Snap, places: &[[[i64; 2]; 2]; 3]) -> Self {
        let middle = places.map_inline(|at| at.map_inline(|[a, b]| 0.5 * (a + b) as f64));
        let deviation = places.map_inline(|at| at.map_inline(|[a, b]| 0.5 * (b - a) as f64));
        let mut all = Self { middle, deviation, scale: f64::from(snap.scale()), cross: [0.0; 2] };
        all.cross = all.edge(0, 1, middle[2], deviation[2]);
        all
    }

    /// The edge function from corner i to corner k at a point: midpoint and deviation.
    fn edge(&self, i: usize, k: usize, p: [f64; 2], off: [f64; 2]) -> [f64; 2] {
        let part = |a: usize, b: usize| {
            let along = self.middle[k][a] - self.middle[i][a];
            let along_off = self.deviation[k][a] + self.deviation[i][a];
            let beside = p[b] - self.middle[i][b];
            let beside_off = off[b] + self.deviation[i][b];
            let product = along * beside;
            let deviation = along.abs() * beside_off + along_off * (beside.abs() + beside_off);
            [product, deviation + OF_DOUBLES * (product.abs() + deviation)]
        };
        let ([a, a_off], [b, b_off]) = (part(0, 1), part(1, 0));
        [a - b, a_off + b_off]
    }

    /// Whether it is certain which way the corners run.
    pub(super) fn is_turned(&self) -> bool {
        self.cross[0].abs() > self.cross[1]
    }

    /// The pixels that may be covered.
    pub(super) fn bounds(&self, size: [u32; 2]) -> Rect {
        let [x, y] = [0, 1].map_inline(|axis| {
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for (middle, deviation) in self.middle.iter().zip(&self.deviation) {
                least = least.at_most(middle[axis] - deviation[axis]);
                most = most.at_least(middle[axis] + deviation[axis]);
            }
            let pixel = |at: f64| (at / self.scale - 0.5).floor();
            let held = |at: f64| at.at_least(0.0).at_most(f64::from(size[axis])) as u32;
            [held(pixel(least)), held(pixel(most) + 1.0)]
        });
        Rect { x0: x[0], y0: y[0], x1: x[1], y1: y[1] }
    }

    /// The edge functions at a pixel, for corners that run in this sense.
    fn edges(&self, (x, y): (u32, u32), sense: f64) -> [[f64; 2]; 3] {
        let center = [x, y].map_inline(|i| (f64::from(i) + 0.5) * self.scale);
        [[1, 2], [2, 0], [0, 1]].map_inline(|[i, k]| {
            let [middle, deviation] = self.edge(i, k, center, [0.0; 2]);
            [sense * middle, deviation]
        })
    }

    /// Whether a pixel may be covered, whichever way the corners run.
    pub(super) fn may_reach(&self, at: (u32, u32)) -> bool {
        let inside = |[middle, deviation]: &[f64; 2]| middle + deviation >= 0.0;
        [-1.0, 1.0].into_iter().any(|sense| self.edges(at, sense).iter().all(inside))
    }

    /// How a pixel may be covered; none if it certainly is not.
    fn at(&self, at: (u32, u32)) -> Option<Cover> {
        let edges = self.edges(at, self.cross[0].signum());
        if edges.iter().any(|[middle, deviation]| middle + deviation < 0.0) {
            return None;
        }
        let [area, off] = [self.cross[0].abs(), self.cross[1]];
        let middle = edges.map_inline(|[middle, _]| middle / area);
        let most = edges
            .map_inline(|[middle, deviation]| ((middle + deviation) / (area - off)).at_most(1.0));
        let lies = edges.iter().all(|[middle, deviation]| middle > deviation);
        Some(Cover { middle, most, lies })
    }

    /// A quantity that is linear on the screen and has these values at the corners: its midpoint at
    /// a pixel, and how far off it may be.
    fn linear(&self, values: [f64; 3], cover: &Cover) -> [f64; 2] {
        let mut slope = [0.0; 2];
        for (value, [i, k]) in values.into_iter().zip([[1, 2], [2, 0], [0, 1]]) {
            slope[0] -= value * (self.middle[k][1] - self.middle[i][1]) / self.cross[0];
            slope[1] += value * (self.middle[k][0] - self.middle[i][0]) / self.cross[0];
        }
        let (mut middle, mut off) = (0.0, 0.0);
        for (i, value) in values.into_iter().enumerate() {
            middle += cover.middle[i] * value;
            let [x, y] = self.deviation[i];
            let moved = slope[0].abs() * x + slope[1].abs() * y;
            off += cover.most[i] * moved + OF_DOUBLES * value.abs();
        }
        [middle, off]
    }
}

/// A pixel that may be covered.
struct Cover {
    /// The weights of the corners at their midpoints, as fractions of the area.
    middle: [f64; 3],
    /// The greatest possible weights.
    most: [f64; 3],
    /// Whether the pixel certainly is covered.
    lies: bool,
}

/// The perspective weights of a piece.
pub(super) struct Depths {
    intervals: Intervals,
    /// m of each corner, and its possible error as a fraction of m.
    m: [f64; 3],
    m_off: f64,
    /// The weights of the triangle's corners at the corners of the piece, and how far off they may
    /// be.
    weights: [[f64; 3]; 3],
    weights_off: f64,
}

impl Depths {
    pub(super) fn new<P: Profile>(
        intervals: Intervals,
        m: [Ball<P>; 3],
        weights: &[[Ball<P>; 3]; 3],
    ) -> Self {
        let part = |off: f64, m: &Ball<P>| off.at_least(m.radius / m.middle);
        let all = weights.iter().flatten();
        Self {
            intervals,
            m: m.map_inline(|m| m.middle),
            m_off: m.iter().fold(0.0, part),
            weights: weights.map_inline(|of| of.map_inline(|weight| weight.middle)),
            weights_off: all.fold(0.0, |off, weight| off.at_least(weight.radius)),
        }
    }

    /// c at a pixel, and whether the pixel certainly is covered. None if it certainly is not.
    ///
    /// Let the places of the corners be off by e, and let w be the corners' weights. Then a
    /// quantity that is linear on the screen is off by `slope . (w0 e0 + w1 e1 + w2 e2)`. The sums
    /// of c have no negative terms, so their rounding is a fraction of the sums.
    pub(super) fn weights<P: Profile>(&self, at: (u32, u32)) -> Option<([Ball<P>; 3], bool)> {
        let cover = self.intervals.at(at)?;
        let [whole, whole_off] = self.intervals.linear(self.m, &cover);
        let least = whole - whole_off;
        let rounded = ROUNDINGS + 4.0 * self.m_off;
        let weights = [0, 1, 2].map_inline(|k| {
            let values = [0, 1, 2].map_inline(|i| self.m[i] * self.weights[i][k]);
            let [part, off] = self.intervals.linear(values, &cover);
            let middle = part / whole;
            let off = (off + middle.abs() * whole_off) / least;
            let off = off + rounded * (middle.abs() + off) + self.weights_off + f64::MIN_POSITIVE;
            // If the divisor may be 0, the weight has no bound.
            if least > 0.0 { Ball::new(middle, off * (1.0 + ROUNDINGS)) } else { anything() }
        });
        Some((weights, cover.lies))
    }
}
