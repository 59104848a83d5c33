//! Move, turn and scale Gaussians, with the colours that they show in each direction.
//!
//! The function of a turned Gaussian in a direction is the function of the Gaussian in the direction
//! turned back. Its coefficients are integrals over the sphere, so that a coefficient j becomes
//!
//! ```text
//!   sum over k of M_jk c_k      M_jk = integral of b_j(d) b_k(R^T d) / integral of b_j(d)^2
//! ```
//!
//! for j and k of the same degree, with R the rotation and b the functions of [`super`]. Gauss-Legendre
//! in the height and 8 equal angles integrate such polynomials exactly, up to rounding in f64.

use super::{MAX_COEFFICIENTS, basis};
use crate::number::{MapInline, Vector3};
use crate::scene::Similarity;
use crate::scene::gaussians::{GaussianArrays, coefficients};
use glam::{DMat3, DQuat, DVec3, Vec3};

/// Heights of Gauss-Legendre quadrature with 4 points, and their weights.
const HEIGHTS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Matrices that turn the coefficients of each degree.
#[derive(Clone, Debug)]
pub struct HarmonicRotation {
    /// Row by row; 0 where the degrees differ.
    matrix: [[f64; MAX_COEFFICIENTS]; MAX_COEFFICIENTS],
}

impl HarmonicRotation {
    /// The matrices for a rotation.
    #[must_use]
    pub fn new(rotation: DMat3) -> Self {
        let back = rotation.transpose();
        let mut matrix = [[0.0; MAX_COEFFICIENTS]; MAX_COEFFICIENTS];
        let mut squares = [0.0; MAX_COEFFICIENTS];
        let of = |direction: DVec3| {
            let [x, y, z] = direction.to_array();
            basis::<f64>(3, Vector3::new(x, y, z))
        };
        for (direction, weight) in directions() {
            let (here, there) = (of(direction), of(back * direction));
            for (j, row) in matrix.iter_mut().enumerate() {
                squares[j] += weight * here[j] * here[j];
                for (k, value) in row.iter_mut().enumerate() {
                    *value += weight * here[j] * there[k];
                }
            }
        }
        for (j, row) in matrix.iter_mut().enumerate() {
            for (k, value) in row.iter_mut().enumerate() {
                let same = degree_of(j) == degree_of(k);
                *value = if same { whole(*value / squares[j]) } else { 0.0 };
            }
        }
        Self { matrix }
    }

    /// Turns the coefficients of one Gaussian: in f64, in ascending order, rounded once.
    pub fn apply(&self, harmonics: &mut [Vec3]) {
        let before: [DVec3; MAX_COEFFICIENTS] =
            std::array::from_fn(|k| harmonics.get(k).map_or(DVec3::ZERO, |c| c.as_dvec3()));
        for (coefficient, row) in harmonics.iter_mut().zip(&self.matrix) {
            let sum = row.iter().zip(before).fold(DVec3::ZERO, |sum, (m, c)| sum + c * *m);
            *coefficient = sum.as_vec3();
        }
    }
}

/// Directions with weights whose sums are integrals over the sphere, except for a common factor.
fn directions() -> impl Iterator<Item = (DVec3, f64)> {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const ANGLES: [(f64, f64); 8] = [
        (1.0, 0.0),
        (HALF, HALF),
        (0.0, 1.0),
        (-HALF, HALF),
        (-1.0, 0.0),
        (-HALF, -HALF),
        (0.0, -1.0),
        (HALF, -HALF),
    ];
    HEIGHTS.into_iter().flat_map(|(z, weight)| {
        let r = (1.0 - z * z).sqrt();
        ANGLES.map(|(x, y)| (DVec3::new(r * x, r * y, z), weight))
    })
}

/// The degree of the function with this index.
fn degree_of(index: usize) -> u32 {
    (0..3).take_while(|&degree| coefficients(degree) <= index).count() as u32
}

/// A multiple of 2^-44 next to a value, so that the 0 and the 1 of a quarter turn are exact.
fn whole(value: f64) -> f64 {
    const UNIT: f64 = 17_592_186_044_416.0;
    (value * UNIT + 0.5).floor() / UNIT
}

/// Applies a similarity to Gaussians: to positions, scales, rotations and coefficients.
///
/// Positions and scales are those of [`Similarity`]. A rotation q becomes the product of the
/// rotation's quaternion and q, in f64, each component rounded once.
pub fn place(arrays: &mut GaussianArrays, by: &Similarity) {
    if *by == Similarity::IDENTITY {
        return;
    }
    arrays.position.iter_mut().for_each(|p| *p = by.point(*p));
    let enlarged = |scale: f32| (f64::from(scale) * by.scale) as f32;
    arrays.scale.iter_mut().for_each(|s| *s = Vec3::from(s.to_array().map_inline(enlarged)));
    if by.rotation == DMat3::IDENTITY {
        return;
    }
    let turn = DQuat::from_mat3(&by.rotation).normalize();
    for rotation in &mut arrays.rotation {
        let own = DQuat::from_array(rotation.map_inline(f64::from));
        *rotation = (turn * own).to_array().map_inline(|part| part as f32);
    }
    let harmonics = HarmonicRotation::new(by.rotation);
    let each = coefficients(arrays.degree);
    arrays.harmonics.chunks_mut(each).for_each(|own| harmonics.apply(own));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;
    use crate::scene::transform::rotation;
    use crate::shade::harmonics::color;

    fn numbers(seed: u64) -> impl Iterator<Item = f64> {
        (0..).map(move |i| 2.0 * f64::from(unit(seed, i)) - 1.0)
    }

    fn vector(numbers: &mut impl Iterator<Item = f64>) -> DVec3 {
        DVec3::new(numbers.next().unwrap(), numbers.next().unwrap(), numbers.next().unwrap())
    }

    fn seen(degree: u32, harmonics: &[Vec3], direction: DVec3) -> DVec3 {
        let [x, y, z] = direction.to_array();
        DVec3::from_array(color::<f64>(degree, harmonics, Vector3::new(x, y, z)))
    }

    #[test]
    fn turned_coefficients_show_the_same_colour_in_the_turned_direction() {
        let mut numbers = numbers(1);
        for step in 0..40 {
            let degree = step % 4;
            let turn = rotation(vector(&mut numbers), 180.0 * numbers.next().unwrap());
            let before: Vec<Vec3> =
                (0..coefficients(degree)).map(|_| vector(&mut numbers).as_vec3()).collect();
            let mut after = before.clone();
            HarmonicRotation::new(turn).apply(&mut after);
            for _ in 0..10 {
                let direction = vector(&mut numbers).normalize();
                let off = seen(degree, &before, direction) - seen(degree, &after, turn * direction);
                assert!(off.abs().max_element() < 1e-6, "{degree}: {off}");
            }
        }
    }

    #[test]
    fn whole_turns_change_no_bit() {
        let mut numbers = numbers(2);
        let before: Vec<Vec3> = (0..16).map(|_| vector(&mut numbers).as_vec3()).collect();
        let mut after = before.clone();
        HarmonicRotation::new(DMat3::IDENTITY).apply(&mut after);
        assert_eq!(after, before);
        let half = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
        HarmonicRotation::new(half).apply(&mut after);
        let signs = |a: &Vec3, b: &Vec3| *a == *b || *a == -*b;
        assert!(after.iter().zip(&before).all(|(a, b)| signs(a, b)), "half a turn changes signs");
        HarmonicRotation::new(half).apply(&mut after);
        assert_eq!(after, before);
    }

    #[test]
    fn a_place_is_the_place_of_the_covariance() {
        let mut numbers = numbers(3);
        let own = DQuat::from_mat3(&rotation(vector(&mut numbers), 50.0));
        let mut arrays = GaussianArrays {
            position: vec![Vec3::new(1.0, 2.0, 3.0)],
            scale: vec![Vec3::new(1.0, 0.5, 0.125)],
            rotation: vec![own.to_array().map(|part| part as f32)],
            opacity: vec![0.5],
            harmonics: vec![Vec3::ONE],
            ..GaussianArrays::default()
        };
        let covariance = |arrays: &GaussianArrays| {
            let turn = DMat3::from_quat(DQuat::from_array(arrays.rotation[0].map(f64::from)));
            let stretched = turn * DMat3::from_diagonal(arrays.scale[0].as_dvec3());
            stretched * stretched.transpose()
        };
        let before = covariance(&arrays);
        let by = Similarity {
            rotation: rotation(DVec3::new(1.0, 2.0, -1.0), 75.0),
            scale: 2.0,
            translation: DVec3::new(10.0, 0.0, 0.0),
        };
        place(&mut arrays, &by);
        let wanted = by.rotation * before * by.rotation.transpose() * 4.0;
        let off = (covariance(&arrays) - wanted).to_cols_array();
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{off:?}");
        assert_eq!(arrays.position[0], by.point(Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(arrays.harmonics[0], Vec3::ONE, "degree 0 has no direction");
    }
}
