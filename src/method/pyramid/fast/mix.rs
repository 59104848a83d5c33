//! Which of four cells take part, and their averages, in lanes: the formulas of the definition.

use super::level::TUBE;
use crate::composite::mean::Mean;
use crate::method::projection::fast::{LANES, Lanes};
use crate::number::Vector3;
use crate::splat::Ellipse;

/// The numbers of four cells for [`LANES`] new ones that decide who takes part.
pub(super) struct Four {
    pub(super) kind: [Lanes; 4],
    pub(super) front: [Lanes; 4],
    pub(super) back: [Lanes; 4],
    pub(super) radius: [Lanes; 4],
    /// From the new cell's centre to that of the ellipse.
    pub(super) place: [[Lanes; 2]; 4],
    pub(super) normal: [[Lanes; 3]; 4],
}

/// The weights of four cells, 0 for one that takes no part, and the kind of the new one.
pub(super) struct Mix {
    pub(super) weights: [Lanes; 4],
    pub(super) kind: Lanes,
}

impl Four {
    /// See [`super::super::Cell::foremost`]; `TUBES` false promises that there are none.
    #[inline(always)]
    pub(super) fn mix<const GAUSSIAN: bool, const TUBES: bool>(&self) -> Mix {
        let mut front = [[0.0; LANES]; 4];
        let mut distance = [[0.0; LANES]; 4];
        for j in 0..4 {
            for i in 0..LANES {
                let n = &self.normal[j];
                let normal = Vector3::new(n[0][i], n[1][i], n[2][i]);
                let ellipse = Ellipse::new(normal, self.radius[j][i]);
                let form = ellipse.form(self.place[j][0][i], self.place[j][1][i]);
                let candidate = ellipse.holds(form) & (self.kind[j][i] > 0.0);
                // NaN fails every comparison.
                front[j][i] = if candidate { self.front[j][i] } else { f32::NAN };
                distance[j][i] = form / ellipse.square;
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
                    let weight = gaussian(distance[j][i]);
                    weights[j][i] = if weights[j][i] > 0.0 { weight } else { 0.0 };
                }
            }
        }
        Mix { weights, kind }
    }
}

/// exp(-2 d^2), as the definition has it for d <= 1; any number for other d.
#[inline(always)]
fn gaussian(square: f32) -> f32 {
    crate::number::elementary::exp_f32_in_range(-2.0 * square)
}

impl Mix {
    /// The average of a number.
    #[inline(always)]
    pub(super) fn of(&self, a: &[Lanes; 4]) -> Lanes {
        let mut average = [0.0; LANES];
        for i in 0..LANES {
            average[i] = self.mean(i).of([a[0][i], a[1][i], a[2][i], a[3][i]]);
        }
        average
    }

    /// The least and the greatest.
    #[inline(always)]
    pub(super) fn hull(&self, least: &[Lanes; 4], greatest: &[Lanes; 4]) -> [Lanes; 2] {
        let mut hull = [[0.0; LANES]; 2];
        for i in 0..LANES {
            let mean = self.mean(i);
            hull[0][i] = mean.least([least[0][i], least[1][i], least[2][i], least[3][i]]);
            let a = greatest;
            hull[1][i] = mean.greatest([a[0][i], a[1][i], a[2][i], a[3][i]]);
        }
        hull
    }

    #[inline(always)]
    fn mean(&self, i: usize) -> Mean<f32> {
        let w = [0, 1, 2, 3].map(|j| self.weights[j][i]);
        Mean::new(w.map(|w| w > 0.0), w)
    }
}
