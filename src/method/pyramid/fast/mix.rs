//! Which of four cells take part, and their averages, in lanes: the formulas of the definition.

use super::level::TUBE;
use crate::method::projection::fast::{LANES, Lanes};
use crate::number::{Real, Vector2, Vector3};
use crate::splat::Ellipse;

/// The numbers of four cells for [`LANES`] new ones that decide who takes part.
pub(super) struct Four {
    pub(super) kind: [Lanes; 4],
    pub(super) front: [Lanes; 4],
    pub(super) back: [Lanes; 4],
    pub(super) radius: [Lanes; 4],
    /// From the new cell's centre to that of the ellipse.
    pub(super) place: [[Lanes; 2]; 4],
    /// The tilts of the ellipses.
    pub(super) tilt: [[Lanes; 2]; 4],
}

/// The weights of four cells, 0 for one that takes no part, and the kind of the new one.
pub(super) struct Mix {
    weights: [Lanes; 4],
    /// 1 divided by the sum of the weights.
    scale: Lanes,
    pub(super) kind: Lanes,
}

impl Four {
    /// See [`super::super::Cell::foremost`]; `TUBES` false promises that there are none.
    #[inline(always)]
    pub(super) fn mix<const GAUSSIAN: bool, const TUBES: bool>(&self) -> Mix {
        let mut front = [[0.0; LANES]; 4];
        let (mut form_of, mut square) = ([[0.0; LANES]; 4], [[0.0; LANES]; 4]);
        for j in 0..4 {
            for i in 0..LANES {
                let tilt = Vector2::new(self.tilt[j][0][i], self.tilt[j][1][i]);
                let ellipse = Ellipse::tilted(tilt, self.radius[j][i]);
                let form = ellipse.form(self.place[j][0][i], self.place[j][1][i]);
                let candidate = ellipse.holds(form) & (self.kind[j][i] > 0.0);
                // NaN fails every comparison.
                front[j][i] = if candidate { self.front[j][i] } else { f32::NAN };
                form_of[j][i] = form;
                square[j][i] = ellipse.square;
            }
        }
        let mut nearest = [f32::INFINITY; LANES];
        let mut end = [f32::NEG_INFINITY; LANES];
        let mut kind = [0.0; LANES];
        for j in 0..4 {
            for i in 0..LANES {
                let nearer = front[j][i] < nearest[i];
                nearest[i] = if nearer { front[j][i] } else { nearest[i] };
                end[i] = if nearer { self.back[j][i] } else { end[i] };
                kind[i] = if nearer { self.kind[j][i] } else { kind[i] };
            }
        }
        let mut weights = [[0.0; LANES]; 4];
        for j in 0..4 {
            for i in 0..LANES {
                let alike = !TUBES | ((self.kind[j][i] == TUBE) == (kind[i] == TUBE));
                let takes = (front[j][i] <= end[i]) & alike;
                weights[j][i] = if takes { 1.0 } else { 0.0 };
            }
            if GAUSSIAN && weights[j].iter().any(|&weight| weight > 0.0) {
                for i in 0..LANES {
                    let weight = gaussian(form_of[j][i] / square[j][i]);
                    weights[j][i] = if weights[j][i] > 0.0 { weight } else { 0.0 };
                }
            }
        }
        let mut scale = [0.0; LANES];
        for i in 0..LANES {
            scale[i] = 1.0 / ((weights[0][i] + weights[1][i]) + (weights[2][i] + weights[3][i]));
        }
        Mix { weights, scale, kind }
    }
}

/// The tilts of ellipses from their normals.
#[inline(always)]
pub(super) fn tilts(normal: &[Lanes; 3]) -> [Lanes; 2] {
    let mut tilts = [[0.0; LANES]; 2];
    for i in 0..LANES {
        let normal = Vector3::new(normal[0][i], normal[1][i], normal[2][i]);
        let ellipse = Ellipse::new(normal, 0.0);
        (tilts[0][i], tilts[1][i]) = (ellipse.tilt.x, ellipse.tilt.y);
    }
    tilts
}

/// exp(-2 d^2), as the definition has it for d <= 1; any number for other d.
#[inline(always)]
fn gaussian(square: f32) -> f32 {
    crate::number::elementary::exp_f32_in_range(-2.0 * square)
}

impl Mix {
    /// The average of a number: [`Mean::of`] in lanes, a step at a time, which is what becomes vectors.
    ///
    /// [`Mean::of`]: crate::composite::mean::Mean::of
    #[inline(always)]
    pub(super) fn of(&self, a: &[Lanes; 4]) -> Lanes {
        let mut terms = [[0.0; LANES]; 4];
        for j in 0..4 {
            let weights = self.weights[j];
            for i in 0..LANES {
                terms[j][i] = if weights[i] > 0.0 { weights[i] * a[j][i] } else { 0.0 };
            }
        }
        let [least, greatest] = self.hull(a, a);
        let mut average = [0.0; LANES];
        for i in 0..LANES {
            let sum = (terms[0][i] + terms[1][i]) + (terms[2][i] + terms[3][i]);
            average[i] = (sum * self.scale[i]).at_least(least[i]).at_most(greatest[i]) + 0.0;
        }
        average
    }

    /// The least of one number and the greatest of another.
    #[inline(always)]
    pub(super) fn hull(&self, low: &[Lanes; 4], high: &[Lanes; 4]) -> [Lanes; 2] {
        let mut lows = [[f32::INFINITY; LANES]; 4];
        let mut highs = [[f32::NEG_INFINITY; LANES]; 4];
        for j in 0..4 {
            let weights = self.weights[j];
            for i in 0..LANES {
                lows[j][i] = if weights[i] > 0.0 { low[j][i] } else { f32::INFINITY };
                highs[j][i] = if weights[i] > 0.0 { high[j][i] } else { f32::NEG_INFINITY };
            }
        }
        let mut hull = [[0.0; LANES]; 2];
        for i in 0..LANES {
            let (a, b) = (lows[0][i].at_most(lows[1][i]), lows[2][i].at_most(lows[3][i]));
            hull[0][i] = a.at_most(b);
            let (a, b) = (highs[0][i].at_least(highs[1][i]), highs[2][i].at_least(highs[3][i]));
            hull[1][i] = a.at_least(b);
        }
        hull
    }
}
