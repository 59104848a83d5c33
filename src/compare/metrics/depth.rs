//! Measure how far the depth of a surface is off.

use super::percentile;

/// Errors of the depths of some pixels, in world units; see [`depth`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthError {
    /// How many pixels were compared, at least 1.
    pub pixels: u64,
    /// The root of the mean squared error.
    pub rms: f64,
    /// The error that 99 % of the errors do not exceed: the one at ceil(0.99 n) of n in ascending
    /// order.
    pub most: f64,
    /// The largest error.
    pub max: f64,
    /// `rms` divided by the mean depth of the reference in these pixels.
    pub relative: f64,
}

/// Takes the errors |Z - `Z_true`| of the depths in the pixels that `compared` names.
///
/// A pixel where either depth is not finite is left out too, because an empty pixel has no depth.
/// None if no pixel is left.
///
/// # Panics
/// If the planes differ in length.
#[must_use]
pub fn depth(picture: &[f32], reference: &[f32], compared: &[bool]) -> Option<DepthError> {
    assert!([picture.len(), compared.len()] == [reference.len(); 2], "planes of one size");
    let (mut squares, mut depths, mut errors) = (0.0, 0.0, Vec::new());
    for ((&found, &expected), _) in picture.iter().zip(reference).zip(compared).filter(|(_, c)| **c)
    {
        if found.is_finite() && expected.is_finite() {
            let error = (f64::from(found) - f64::from(expected)).abs();
            squares += error * error;
            depths += f64::from(expected);
            errors.push(error);
        }
    }
    errors.sort_unstable_by(f64::total_cmp);
    let (most, max) = (percentile(&errors, 99)?, percentile(&errors, 100)?);
    let n = errors.len() as f64;
    let rms = (squares / n).sqrt();
    Some(DepthError { pixels: errors.len() as u64, rms, most, max, relative: rms * n / depths })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_that_is_tilted_away_is_off_by_a_ramp() {
        // Errors 0, 1/64 ... 199/64 on depths of 8: the mean square is (n - 1)(2 n - 1)/6/64^2.
        let n = 200;
        let reference = vec![8.0; n];
        for sign in [1.0, -1.0] {
            let picture: Vec<f32> = (0..n).map(|i| 8.0 + sign * i as f32 / 64.0).collect();
            let found = depth(&picture, &reference, &vec![true; n]).unwrap();
            let rms = (199.0 * 399.0 / 6.0_f64).sqrt() / 64.0;
            assert!((found.rms - rms).abs() < 1e-14 && (found.relative - rms / 8.0).abs() < 1e-14);
            assert_eq!((found.pixels, found.most, found.max), (200, 197.0 / 64.0, 199.0 / 64.0));
        }
    }

    #[test]
    fn only_what_is_to_be_compared_and_has_a_depth_counts() {
        let reference = [1.0, 2.0, 3.0, f32::INFINITY, 5.0];
        let picture = [1.0, 2.5, f32::INFINITY, 4.0, 9.0];
        let found = depth(&picture, &reference, &[true, true, true, true, false]).unwrap();
        assert_eq!((found.pixels, found.most, found.max), (2, 0.5, 0.5));
        assert!((found.rms - 0.125_f64.sqrt()).abs() < 1e-15);
        assert!((found.relative - 0.125_f64.sqrt() / 1.5).abs() < 1e-15);
        assert_eq!(depth(&picture, &reference, &[false; 5]), None);
        let same = depth(&reference, &reference, &[true; 5]).unwrap();
        assert_eq!((same.pixels, same.rms, same.max, same.relative), (4, 0.0, 0.0, 0.0));
    }
}
