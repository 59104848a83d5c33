//! Measure how far the normal of a surface is off.

use super::percentile;
use crate::number::MapInline;
use crate::number::elementary;

/// Angles between the normals of some pixels, in degrees; see [`normal`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalError {
    /// How many pixels were compared, at least 1.
    pub pixels: u64,
    /// The mean angle.
    pub mean: f64,
    /// The angle that 99 % of the angles do not exceed: the one at ceil(0.99 n) of n in ascending
    /// order.
    pub most: f64,
}

/// Takes the angles between the normals in the pixels that `compared` names, 0 to 180 degrees.
///
/// The angle of a and b is atan2(|a x b|, a . b). This formula is as exact near 0 and 180 degrees
/// as elsewhere, and does not need unit vectors. Normals have a side: the opposite one is 180
/// degrees off.
///
/// `Decided:` a normal of the picture that is zero or not finite has no direction, and counts as 90
/// degrees. A pixel is left out where the reference's normal is zero or not finite. None if no
/// pixel is left.
///
/// # Panics
/// If the planes differ in length.
#[must_use]
pub fn normal(
    picture: &[[f32; 3]],
    reference: &[[f32; 3]],
    compared: &[bool],
) -> Option<NormalError> {
    assert!([picture.len(), compared.len()] == [reference.len(); 2], "planes of one size");
    let pairs = picture.iter().zip(reference).zip(compared).filter(|(_, compared)| **compared);
    let with_reference = pairs.map(|(pair, _)| pair).filter(|(_, expected)| points(expected));
    let mut angles: Vec<f64> = with_reference
        .map(|(found, expected)| if points(found) { angle(*found, *expected) } else { 90.0 })
        .collect();
    let sum: f64 = angles.iter().sum();
    angles.sort_unstable_by(f64::total_cmp);
    let most = percentile(&angles, 99)?;
    Some(NormalError { pixels: angles.len() as u64, mean: sum / angles.len() as f64, most })
}

/// Whether a vector has a direction.
fn points(v: &[f32; 3]) -> bool {
    v.iter().all(|c| c.is_finite()) && v.iter().any(|c| *c != 0.0)
}

fn angle(a: [f32; 3], b: [f32; 3]) -> f64 {
    let (a, b) = (a.map_inline(f64::from), b.map_inline(f64::from));
    let [x, y, z] = [1, 2, 0].map_inline(|i| {
        let (j, k) = (i, (i + 1) % 3);
        a[j] * b[k] - a[k] * b[j]
    });
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    elementary::atan2((x * x + y * y + z * z).sqrt(), dot) * (180.0 / std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary::{cos, sin};
    use std::f64::consts::PI;

    #[test]
    fn angles_of_a_turned_normal() {
        for degrees in [0.0, 0.001, 1.0, 30.0, 89.0, 90.0, 120.0, 179.9, 180.0] {
            let radians = degrees * PI / 180.0;
            let (s, c) = (sin(radians) as f32, cos(radians) as f32);
            for (a, b) in [
                ([0.0, 0.0, 1.0], [s, 0.0, c]),
                ([0.0, 0.0, 3.0], [0.0, 0.5 * s, 0.5 * c]),
                ([1.0, 0.0, 0.0], [c, s, 0.0]),
                ([0.6, 0.8, 0.0], [0.6 * c, 0.8 * c, s]),
            ] {
                let found = normal(&[a], &[b], &[true]).unwrap();
                assert!((found.mean - degrees).abs() < 1e-5, "{degrees}: {}", found.mean);
                assert_eq!(normal(&[b], &[a], &[true]), Some(found), "symmetric");
                assert_eq!((found.pixels, found.most), (1, found.mean));
            }
        }
        // Tiny angles are not lost: 1e-6 radians.
        let found = normal(&[[1e-6, 0.0, 1.0]], &[[0.0, 0.0, 1.0]], &[true]).unwrap();
        assert!((found.mean * PI / 180.0 - f64::from(1e-6_f32)).abs() < 1e-15);
    }

    #[test]
    fn what_has_no_direction() {
        let up = [0.0, 0.0, 1.0];
        let lost = [[0.0; 3], [f32::NAN, 0.0, 1.0], [f32::INFINITY, 0.0, 0.0]];
        for none in lost {
            assert_eq!(normal(&[none], &[up], &[true]).unwrap().mean, 90.0);
            assert_eq!(normal(&[up], &[none], &[true]), None);
        }
        let found = normal(&[up, [0.0; 3], up], &[up; 3], &[true, true, false]).unwrap();
        assert_eq!((found.pixels, found.mean, found.most), (2, 45.0, 90.0));
    }
}
