//! Flicker: how the error of a pixel changes over the pictures of a sequence.
//!
//! Of n pictures and their truths, each pixel has the errors `e_t`, t = 0 .. n - 1: the mean over R, G
//! and B of picture minus truth. An error that stays is none of flicker. With the discrete Fourier
//! transform of the errors,
//!
//! ```text
//!   E_k = sum over t, ascending, of e_t exp(-2 pi i k t / n)
//!   power_k = mean over the pixels of c |E_k|^2 / n^2      k = 1 .. floor(n / 2)
//! ```
//!
//! where c is 2, but 1 for k = n / 2: the power of both frequencies k and n - k. The sum of all
//! powers is then the mean over the pixels of the variance of `e_t` over time (Parseval), and
//! [`Flicker::rms`] is its root. In f64; the sum over the pixels is row by row from the top left.

use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::memory;
use crate::number::elementary::{cos, sin};

/// The most pictures.
pub const MOST: usize = 1024;

/// The errors of a sequence so far.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// Of each picture that of each pixel.
    frames: Vec<Vec<f32>>,
}

/// The flicker of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Flicker {
    /// The power at the frequencies 1 / n, 2 / n, ... of a cycle a picture, up to 1 / 2.
    pub power: Vec<f64>,
}

impl Errors {
    /// Adds a picture; errors are kept rounded to `f32`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not of the size of its truth or of those before, if there are
    /// [`MOST`] already, or if the process may not hold it.
    pub fn push(&mut self, picture: &Plane<[f32; 3]>, truth: &Plane<[f32; 3]>) -> Result<()> {
        let (found, expected) = (picture.values(), truth.values());
        let first = self.frames.first().map_or(found.len(), Vec::len);
        let is_one_size = picture.width() == truth.width() && found.len() == expected.len();
        if !is_one_size || found.len() != first || self.frames.len() == MOST {
            let what =
                format!("flicker is of at most {MOST} pictures of one size with their truths");
            return Err(Error::Invalid(what));
        }
        memory::ask(4 * found.len() as u64, || "the errors of a picture".into())?;
        let error = |(a, b): (&[f32; 3], &[f32; 3])| {
            let [r, g, b] = [0, 1, 2].map(|c| f64::from(a[c]) - f64::from(b[c]));
            ((r + g + b) / 3.0) as f32
        };
        self.frames.push(found.iter().zip(expected).map(error).collect());
        Ok(())
    }

    /// The flicker of the pictures so far; none of fewer than two.
    #[must_use]
    pub fn flicker(&self) -> Flicker {
        let n = self.frames.len();
        let pixels = self.frames.first().map_or(0, Vec::len);
        let turn = |step: usize| std::f64::consts::TAU * (step % n) as f64 / n as f64;
        let waves: Vec<[f64; 2]> = (0..n).map(|step| [cos(turn(step)), sin(turn(step))]).collect();
        let power = |k: usize| {
            let weight = if 2 * k == n { 1.0 } else { 2.0 };
            let mut sum = 0.0;
            for pixel in 0..pixels {
                let (mut real, mut imaginary) = (0.0, 0.0);
                for (t, frame) in self.frames.iter().enumerate() {
                    let [c, s] = waves[k * t % n];
                    real += f64::from(frame[pixel]) * c;
                    imaginary += f64::from(frame[pixel]) * s;
                }
                sum += real * real + imaginary * imaginary;
            }
            weight * sum / (n * n * pixels) as f64
        };
        Flicker { power: (1..=n / 2).map(power).collect() }
    }
}

impl Flicker {
    /// The root of the mean over the pixels of the variance of their error over time.
    #[must_use]
    pub fn rms(&self) -> f64 {
        self.power.iter().sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plane(values: &[f32]) -> Plane<[f32; 3]> {
        Plane::from_values(values.len() as u32, 1, values.iter().map(|v| [*v; 3]).collect())
    }

    fn of(frames: &[Vec<f32>]) -> Flicker {
        let mut errors = Errors::default();
        for frame in frames {
            errors.push(&plane(frame), &plane(&vec![0.0; frame.len()])).unwrap();
        }
        errors.flicker()
    }

    #[test]
    fn known_answers() {
        assert!(of(&[]).power.is_empty());
        assert_eq!(of(&[vec![1.0]]).rms(), 0.0);
        assert!(of(&vec![vec![0.5, -2.0]; 8]).rms() < 1e-15, "what stays is no flicker");
        // Every other picture off by 1: all power at one half.
        let blink = of(&[vec![0.0], vec![1.0], vec![0.0], vec![1.0]]);
        assert!((blink.rms() - 0.5).abs() < 1e-15);
        assert!(blink.power[0] < 1e-30 && (blink.power[1] - 0.25).abs() < 1e-15);
        // A cosine of two cycles in 8 pictures, amplitude 3.
        let wave: Vec<Vec<f32>> = (0..8).map(|t| vec![[3.0, 0.0, -3.0, 0.0][t % 4]]).collect();
        let found = of(&wave);
        assert!((found.power[1] - 4.5).abs() < 1e-14, "{found:?}");
        let mut errors = Errors::default();
        errors.push(&plane(&[1.0]), &plane(&[1.0])).unwrap();
        assert!(errors.push(&plane(&[1.0, 2.0]), &plane(&[1.0, 2.0])).is_err());
        assert!(errors.push(&plane(&[1.0]), &plane(&[1.0, 2.0])).is_err());
    }

    proptest! {
        #[test]
        fn the_powers_sum_up_to_the_variance(
            frames in (2_usize..12, 1_usize..6).prop_flat_map(|(n, pixels)| {
                prop::collection::vec(prop::collection::vec(-2.0_f32..2.0, pixels), n)
            })
        ) {
            let (n, pixels) = (frames.len() as f64, frames[0].len());
            let variance = |pixel: usize| {
                let mean = frames.iter().map(|f| f64::from(f[pixel])).sum::<f64>() / n;
                let square = |v: f64| v * v;
                frames.iter().map(|f| square(f64::from(f[pixel]) - mean)).sum::<f64>() / n
            };
            let expected = ((0..pixels).map(variance).sum::<f64>() / pixels as f64).sqrt();
            prop_assert!((of(&frames).rms() - expected).abs() < 1e-6);
        }
    }
}
