//! The colour of a splat: spherical harmonics, bounds, and the space of blending.

use super::{Bug, Habit, Shared};
use splatref::method::gaussians::ColorBounds;
use splatref::scene::gaussians::Encoding;

impl Shared<'_> {
    /// The colour in the space of blending.
    pub(super) fn color(&self, i: usize, from_eye: [f32; 3]) -> [f32; 3] {
        let toward = if self.perspective() {
            self.unit(from_eye)
        } else {
            let [a, b, c, _] = self.frame[2];
            [a, b, c]
        };
        let frame = self.frame.map(|[a, b, c, _]| self.dot([a, b, c], toward));
        let direction = match self.how.bug {
            Some(Bug::DirectionReversed) => toward.map(|part| -part),
            Some(Bug::DirectionOfCamera) => frame,
            Some(Bug::DirectionOfView) => [frame[0], -frame[1], -frame[2]],
            _ => toward,
        };
        let color = self.harmonics(i, direction).map(|part| match self.settings.bounds {
            ColorBounds::None => part,
            ColorBounds::Zero => bounded(part, 0.0, f32::INFINITY),
            ColorBounds::Unit => bounded(part, 0.0, 1.0),
        });
        match (self.gaussians.encoding(), self.space) {
            (Encoding::Srgb, Encoding::Linear) => color.map(decoded),
            (Encoding::Linear, Encoding::Srgb) => color.map(encoded),
            _ => color,
        }
    }

    fn unit(&self, v: [f32; 3]) -> [f32; 3] {
        let square = self.dot(v, v);
        if self.how.habit == Habit::InverseSqrt {
            let inverse = 1.0 / square.sqrt();
            return v.map(|part| part * inverse);
        }
        let length = square.sqrt();
        v.map(|part| part / length)
    }

    /// Coefficient `k` of a splat, as a reader leaves it.
    fn coefficient(&self, i: usize, k: usize) -> [f32; 3] {
        let all = self.gaussians.harmonics(i);
        let rest = all.len() - 1;
        if self.how.has(Bug::RestByCoefficient) && k > 0 {
            // Of the list of all reds, greens and blues.
            let at = |place: usize| all[1 + place % rest].to_array()[place / rest];
            return [at(3 * (k - 1)), at(3 * (k - 1) + 1), at(3 * (k - 1) + 2)];
        }
        all[k].to_array()
    }

    /// The harmonics in a direction, plus 1/2.
    fn harmonics(&self, i: usize, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let degree = self.settings.degree.min(self.gaussians.degree());
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let mut basis = vec![0.282_094_8];
        if degree > 0 {
            basis.extend([-0.488_602_51 * y, 0.488_602_51 * z, -0.488_602_51 * x]);
        }
        if degree > 1 {
            basis.extend([
                1.092_548_5 * (x * y),
                -1.092_548_5 * (y * z),
                0.315_391_57 * (2.0 * zz - xx - yy),
                -1.092_548_5 * (x * z),
                0.546_274_22 * (xx - yy),
            ]);
        }
        if degree > 2 {
            basis.extend([
                -0.590_043_6 * (y * (3.0 * xx - yy)),
                2.890_611_4 * (x * y * z),
                -0.457_045_8 * (y * (4.0 * zz - xx - yy)),
                0.373_176_33 * (z * (2.0 * zz - 3.0 * xx - 3.0 * yy)),
                -0.457_045_8 * (x * (4.0 * zz - xx - yy)),
                1.445_305_7 * (z * (xx - yy)),
                -0.590_043_6 * (x * (xx - 3.0 * yy)),
            ]);
        }
        let order: Vec<usize> = match self.how.habit {
            Habit::Reassociated => (0..basis.len()).rev().collect(),
            _ => (0..basis.len()).collect(),
        };
        let mut sum = [0.0; 3];
        for k in order {
            let own = self.coefficient(i, k);
            sum = [0, 1, 2].map(|c| self.add_product(sum[c], basis[k], own[c]));
        }
        if self.how.has(Bug::HalfMissing) { sum } else { sum.map(|part| part + 0.5) }
    }
}

/// A number, bounded from below and from above.
pub(super) fn bounded(value: f32, least: f32, most: f32) -> f32 {
    let value = if value < least { least } else { value };
    if value > most { most } else { value }
}

/// The linear value of an sRGB value.
pub(super) fn decoded(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { core_math::powf((c + 0.055) / 1.055, 2.4) }
}

/// The sRGB value of a linear value.
pub(super) fn encoded(c: f32) -> f32 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * core_math::powf(c, 1.0 / 2.4) - 0.055 }
}
