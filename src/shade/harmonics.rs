//! Colours that depend on the direction: real spherical harmonics up to degree 3.
//!
//! The order of the coefficients and their signs are those of 3D Gaussian splats, with the
//! Condon-Shortley sign: within a degree the order rises from -degree to +degree, and odd orders are
//! negative. For a unit direction (x, y, z), with all constants rounded to `f32`:
//!
//! ```text
//!   degree 0    b0  = 0.282094792
//!   degree 1    b1  = -c1 y        b2 = c1 z       b3 = -c1 x                      c1 = 0.48860251
//!   degree 2    b4  = c2 (x y)     b5 = -c2 (y z)  b6 = c20 ((2 (z z) - x x) - y y)
//!               b7  = -c2 (x z)    b8 = c22 (x x - y y)
//!               c2 = 1.09254843    c20 = 0.31539157    c22 = 0.54627422
//!   degree 3    b9  = -c33 (y (3 (x x) - y y))      b10 = c32 ((x y) z)
//!               b11 = -c31 (y ((4 (z z) - x x) - y y))
//!               b12 = c30 (z ((2 (z z) - 3 (x x)) - 3 (y y)))
//!               b13 = -c31 (x ((4 (z z) - x x) - y y))
//!               b14 = c3 (z (x x - y y))            b15 = -c33 (x (x x - 3 (y y)))
//!               c33 = 0.59004359   c32 = 2.8906114     c31 = 0.45704580
//!               c30 = 0.37317633   c3 = 1.4453057
//! ```

pub mod rotation;

use crate::number::{MapInline, Real, Vector3};
use crate::scene::gaussians;

/// The greatest number of coefficients: those of degree 3.
pub const MAX_COEFFICIENTS: usize = 16;

/// The values of the first (degree + 1)^2 functions in a unit direction; the others are 0.
///
/// The products are computed as the [module](self) writes them.
#[inline(always)]
pub fn basis<R: Real>(degree: u32, direction: Vector3<R>) -> [R; MAX_COEFFICIENTS] {
    let mut b = [R::ZERO; MAX_COEFFICIENTS];
    let c = R::from_f32;
    let Vector3 { x, y, z } = direction;
    b[0] = c(0.282_094_8);
    if degree >= 1 {
        let c1 = c(0.488_602_51);
        b[1] = -(c1 * y);
        b[2] = c1 * z;
        b[3] = -(c1 * x);
    }
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let two = c(2.0);
    if degree >= 2 {
        let c2 = c(1.092_548_5);
        b[4] = c2 * (x * y);
        b[5] = -(c2 * (y * z));
        b[6] = c(0.315_391_57) * ((two * zz - xx) - yy);
        b[7] = -(c2 * (x * z));
        b[8] = c(0.546_274_22) * (xx - yy);
    }
    if degree >= 3 {
        let (three, four) = (c(3.0), c(4.0));
        let (c33, c31) = (c(0.590_043_6), c(0.457_045_8));
        let ring = (four * zz - xx) - yy;
        b[9] = -(c33 * (y * (three * xx - yy)));
        b[10] = c(2.890_611_4) * ((x * y) * z);
        b[11] = -(c31 * (y * ring));
        b[12] = c(0.373_176_33) * (z * ((two * zz - three * xx) - three * yy));
        b[13] = -(c31 * (x * ring));
        b[14] = c(1.445_305_7) * (z * (xx - yy));
        b[15] = -(c33 * (x * (xx - three * yy)));
    }
    b
}

/// A colour in a direction: the sum of coefficients times functions in ascending order, plus 1/2.
///
/// `coefficients` are those of one colour; those beyond `degree` are not read.
#[inline(always)]
pub fn color<R: Real>(degree: u32, coefficients: &[glam::Vec3], direction: Vector3<R>) -> [R; 3] {
    let basis = basis(degree, direction);
    let count = gaussians::coefficients(degree);
    let [mut red, mut green, mut blue] = [R::ZERO; 3];
    for (function, own) in basis.iter().zip(coefficients).take(count) {
        red = red + *function * R::from_f32(own.x);
        green = green + *function * R::from_f32(own.y);
        blue = blue + *function * R::from_f32(own.z);
    }
    [red, green, blue].map_inline(|sum| sum + R::from_f32(0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary;
    use crate::number::random::unit;

    fn direction(seed: u64) -> Vector3<f64> {
        // The height is uniform on a sphere.
        let (z, angle) = (
            2.0 * f64::from(unit(seed, 0)) - 1.0,
            std::f64::consts::TAU * f64::from(unit(seed, 1)),
        );
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * elementary::cos(angle), r * elementary::sin(angle), z)
    }

    /// The functions are orthonormal: the law that no table of constants shares. Gauss-Legendre in
    /// the height and equal angles integrate polynomials of degree 6 exactly.
    #[test]
    fn the_functions_are_orthonormal() {
        let heights = [
            (0.238_619_186_083_196_9, 0.467_913_934_572_691),
            (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
            (0.932_469_514_203_152, 0.171_324_492_379_170_3),
        ];
        let mut products = [[0.0; 16]; 16];
        for (height, weight) in heights.into_iter().flat_map(|(h, w)| [(h, w), (-h, w)]) {
            for i in 0..8 {
                let angle = std::f64::consts::TAU * f64::from(i) / 8.0;
                let r = (1.0_f64 - height * height).sqrt();
                let b = basis(
                    3,
                    Vector3::new(r * elementary::cos(angle), r * elementary::sin(angle), height),
                );
                for (row, a) in products.iter_mut().zip(b) {
                    for (product, b) in row.iter_mut().zip(b) {
                        *product += weight * std::f64::consts::TAU / 8.0 * a * b;
                    }
                }
            }
        }
        for (i, row) in products.iter().enumerate() {
            for (j, product) in row.iter().enumerate() {
                let wanted = if i == j { 1.0 } else { 0.0 };
                // The constants have 24 bits.
                assert!((product - wanted).abs() < 4e-7, "{i} {j}: {product}");
            }
        }
    }

    /// Signs that orthonormality leaves open, in directions where one function is largest.
    #[test]
    fn signs_are_those_of_the_files() {
        let at = |x: f64, y: f64, z: f64| basis(3, Vector3::new(x, y, z).normalized());
        let signs: [(usize, [f64; 3], f64); 15] = [
            (1, [0.0, 1.0, 0.0], -1.0),
            (2, [0.0, 0.0, 1.0], 1.0),
            (3, [1.0, 0.0, 0.0], -1.0),
            (4, [1.0, 1.0, 0.0], 1.0),
            (5, [0.0, 1.0, 1.0], -1.0),
            (6, [0.0, 0.0, 1.0], 1.0),
            (7, [1.0, 0.0, 1.0], -1.0),
            (8, [1.0, 0.0, 0.0], 1.0),
            (9, [1.0, 1.0, 0.0], -1.0),
            (10, [1.0, 1.0, 1.0], 1.0),
            (11, [0.0, 1.0, 1.0], -1.0),
            (12, [0.0, 0.0, 1.0], 1.0),
            (13, [1.0, 0.0, 1.0], -1.0),
            (14, [1.0, 0.0, 1.0], 1.0),
            (15, [1.0, 0.0, 0.0], -1.0),
        ];
        for (index, [x, y, z], sign) in signs {
            assert!(at(x, y, z)[index] * sign > 0.1, "{index}");
        }
    }

    #[test]
    fn a_lower_degree_is_a_prefix() {
        let all = basis(3, direction(7));
        for degree in 0..3 {
            let some = basis(degree, direction(7));
            let count = gaussians::coefficients(degree);
            assert_eq!(some[..count], all[..count]);
            assert!(some[count..].iter().all(|&value| value == 0.0));
        }
    }

    #[test]
    fn coefficients_beyond_the_degree_are_not_read() {
        let given = [glam::Vec3::ONE; 16];
        let grey = color(0, &given, direction(1));
        assert_eq!(grey, [f64::from(0.282_094_8_f32) + 0.5; 3]);
    }
}
