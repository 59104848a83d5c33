//! RMSE, PSNR and SSIM of two colours at once.

use super::rmse::mean_square;
use super::{psnr, ssim};
use crate::frame::image::{Image, Values};

/// The distances between the colours of two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// The RMSE over all pixels of the three channels; at least 0.
    pub rmse: f64,
    /// The PSNR of that RMSE, in decibels; infinite if the RMSE is 0.
    pub psnr: f64,
    /// The mean SSIM of the three channels, at most 1. None if the pictures are smaller than a
    /// window.
    pub ssim: Option<f64>,
}

/// The distances between the channels `R`, `G` and `B` of two pictures.
///
/// None unless both pictures have all three channels as floats, and the same size.
#[must_use]
pub fn summary(a: &Image, b: &Image) -> Option<Summary> {
    if (a.width, a.height) != (b.width, b.height) {
        return None;
    }
    let mut distances = [(0.0, None); 3];
    for (distance, name) in distances.iter_mut().zip(["R", "G", "B"]) {
        let (Values::Float(a_values), Values::Float(b_values)) =
            (a.channel(name)?, b.channel(name)?)
        else {
            return None;
        };
        *distance = channel(a_values, b_values, a.width as usize);
    }
    Some(Summary::of_channels(&distances))
}

/// The mean squared difference and the SSIM of a channel with `width` values a row.
pub(super) fn channel(a: &[f32], b: &[f32], width: usize) -> (f64, Option<f64>) {
    (mean_square(a, b), ssim(a, b, width))
}

impl Summary {
    /// Summarizes the results of [`channel`] for the three channels.
    pub(super) fn of_channels(distances: &[(f64, Option<f64>)]) -> Self {
        let (mut squares, mut similarity) = (0.0, Some(0.0));
        for (square, one) in distances {
            squares += square;
            similarity = similarity.zip(*one).map(|(sum, one)| sum + one);
        }
        let rmse = (squares / 3.0).sqrt();
        Self { rmse, psnr: psnr(rmse), ssim: similarity.map(|sum| sum / 3.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{pattern, plane, ramp};
    use super::*;

    #[test]
    fn the_summary_is_of_the_three_colours() {
        let channel = |name: &str, values: Vec<f32>| (name.to_owned(), Values::Float(values));
        let image = |blue: Vec<f32>| Image {
            width: 16,
            height: 12,
            channels: vec![
                channel("B", blue),
                channel("G", plane(16, 12, pattern)),
                channel("R", plane(16, 12, ramp)),
            ],
            text: None,
        };
        let (a, b) = (image(vec![0.25; 192]), image(vec![0.75; 192]));
        let found = summary(&a, &b).unwrap();
        assert!((found.rmse - (0.25_f64 / 3.0).sqrt()).abs() < 1e-15, "{}", found.rmse);
        let blue = ssim(&[0.25; 192], &[0.75; 192], 16).unwrap();
        assert!((found.ssim.unwrap() - (2.0 + blue) / 3.0).abs() < 1e-15);
        let same = summary(&a, &a).unwrap();
        assert_eq!(same, Summary { rmse: 0.0, psnr: f64::INFINITY, ssim: Some(1.0) });
        let mut gray = a.clone();
        gray.channels.remove(0);
        assert_eq!(summary(&a, &gray), None);
    }
}
