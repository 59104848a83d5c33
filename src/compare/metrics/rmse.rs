//! RMSE and PSNR of two planes.

use crate::number::elementary;

/// The root of the mean squared difference of two planes of one size; NaN if they are empty.
///
/// # Panics
/// If the planes differ in length.
#[must_use]
pub fn rmse(a: &[f32], b: &[f32]) -> f64 {
    mean_square(a, b).sqrt()
}

/// The mean squared difference.
pub(super) fn mean_square(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len(), "planes of one size");
    let mut sum = 0.0;
    for (&a, &b) in a.iter().zip(b) {
        let difference = f64::from(a) - f64::from(b);
        sum += difference * difference;
    }
    sum / a.len() as f64
}

/// The peak signal-to-noise ratio of an RMSE in decibels, `-20 log10(rmse)`; infinite for 0.
#[must_use]
pub fn psnr(rmse: f64) -> f64 {
    -20.0 * elementary::ln(rmse) / std::f64::consts::LN_10
}
