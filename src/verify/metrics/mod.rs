//! How far a picture is from another, or from the truth.
//!
//! - [`rmse`], [`psnr`], [`ssim()`] and [`summary`]: in one number each.
//! - [`mod@flip`]: how different two pictures look when one flips to the other \[ANA+20\].
//! - [`coverage()`]: holes and spill, how far they agree on what is covered; [`mod@outline`]: how long
//!   the outline is.
//! - [`errors`]: these and those of depth and normals against the truth, together.
//! - [`flicker`]: how the errors of a sequence change from picture to picture.
//!
//! `Decided:` all but FLIP are taken of the values as stored, for pictures linear and not
//! clipped, with a peak of 1: a value that a display would clip counts in full. They serve to rank
//! methods; whether a picture is right is for [`super::compare`] to say. A NaN or an infinity in a
//! plane makes RMSE, PSNR and SSIM NaN or infinite. Everything is f64, summed row by row from the top
//! left.

mod coverage;
pub mod errors;
pub mod flicker;
pub mod flip;
pub mod outline;
mod ssim;
#[cfg(test)]
mod tests;

pub use coverage::{Coverage, Region, coverage, regions};
pub use errors::Errors;
pub use flicker::Flicker;
pub use ssim::ssim;

use crate::frame::image::{Image, Values};
use crate::number::elementary;

/// The distances between the colours of two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Over all pixels of the three channels; at least 0.
    pub rmse: f64,
    /// Of that RMSE, in decibels; infinite if it is 0.
    pub psnr: f64,
    /// The mean of the three channels' SSIM, at most 1; none for pictures that no window fits into.
    pub ssim: Option<f64>,
}

/// The distances between the channels `R`, `G` and `B` of two pictures.
///
/// None unless both have all three as floats, and one size.
#[must_use]
pub fn summary(a: &Image, b: &Image) -> Option<Summary> {
    if (a.width, a.height) != (b.width, b.height) {
        return None;
    }
    let (mut squares, mut similarity) = (0.0, Some(0.0));
    for name in ["R", "G", "B"] {
        let (Values::Float(a_values), Values::Float(b_values)) =
            (a.channel(name)?, b.channel(name)?)
        else {
            return None;
        };
        squares += mean_square(a_values, b_values);
        let channel = ssim(a_values, b_values, a.width as usize);
        similarity = similarity.zip(channel).map(|(sum, one)| sum + one);
    }
    let rmse = (squares / 3.0).sqrt();
    Some(Summary { rmse, psnr: psnr(rmse), ssim: similarity.map(|sum| sum / 3.0) })
}

/// The root of the mean squared difference of two planes of one size; NaN if they have no value.
///
/// # Panics
/// If the planes differ in length.
#[must_use]
pub fn rmse(a: &[f32], b: &[f32]) -> f64 {
    mean_square(a, b).sqrt()
}

/// The mean squared difference.
fn mean_square(a: &[f32], b: &[f32]) -> f64 {
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
