//! Measure flicker: the part of a sequence's error that is not constant, and how fast it changes.
//!
//! A sequence has n frames, each with its truth. The error of a pixel at frame t is the difference
//! of luminances,
//!
//! ```text
//! e_t = 0.2126 dR + 0.7152 dG + 0.0722 dB,    d = picture - truth
//! ```
//!
//! of linear colours, not clipped. The mean of the error over the frames, m, does not flicker. The
//! rest is a sum of waves of k/n cycles a frame, k = 1 to n/2 rounded down. The power of a wave is
//!
//! ```text
//! P_k = w_k |1/n sum_t (e_t - m) exp(-2 pi i k t/n)|^2,    w_k = 1 if 2 k = n, else 2
//! ```
//!
//! as a mean over the pixels. By Parseval's theorem the sum of all `P_k` is the mean over the
//! pixels of the variance of `e_t` over the frames. The *flicker* is the root of this sum: 0 for an
//! error that stays, however large. The root of the mean of m^2 is the *constant* error. Both make
//! up the RMSE of the whole sequence: `constant^2 + flicker^2 = mean e_t^2`.
//!
//! The frames follow a path of the camera, or show one scene shifted by parts of a pixel. They are
//! taken as they are: no window tapers them. So an error that drifts from the first frame to the
//! last shows at all frequencies, with a power that falls as 1/k^2. The sequence is a period only
//! if the path closes, or the shifts go through a whole pixel.
//!
//! `Decided:` a pixel is a pixel of the picture; the motion of the surface is not followed. A pixel
//! that flickers only in colour, at equal luminance, does not count. A NaN or an infinity in a
//! colour makes the numbers NaN.

use super::same_size;
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::memory;
use crate::number::MapInline;
use crate::number::elementary;
use std::f64::consts::PI;

/// The weights of linear red, green and blue in the luminance (Rec. 709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The errors of a sequence, added frame by frame. Each pixel of each frame takes an `f32`.
#[derive(Clone, Debug)]
pub struct Flicker {
    width: u32,
    height: u32,
    frames: Vec<Plane<f32>>,
}

/// The flicker of a sequence, see the [page](self). Numbers are luminances; white is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Number of frames.
    pub frames: usize,
    /// The root of the mean square of the mean errors, at least 0.
    pub constant: f64,
    /// The root of the sum of [`Spectrum::power`], at least 0.
    pub flicker: f64,
    /// The power of each frequency, `P_1`, `P_2` ...; [`Spectrum::frequency`] gives the frequency.
    pub power: Vec<f64>,
}

impl Spectrum {
    /// The frequency of an entry of [`Spectrum::power`] in cycles a frame, in (0, 1/2].
    #[must_use]
    pub fn frequency(&self, place: usize) -> f64 {
        (place + 1) as f64 / self.frames as f64
    }
}

impl Flicker {
    /// Starts a sequence of at most `frames` frames.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is not enough memory.
    pub fn new(width: u32, height: u32, frames: usize) -> Result<Self> {
        let values = u64::from(width) * u64::from(height);
        let bytes = values.saturating_mul(frames as u64).saturating_mul(4);
        memory::ask(bytes, || format!("the errors of {frames} frames of {width} x {height}"))?;
        Ok(Self { width, height, frames: Vec::new() })
    }

    /// Adds a frame: a picture and its truth, linear RGB.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the picture or the truth does not have the size of the sequence.
    pub fn push(&mut self, picture: &Plane<[f32; 3]>, truth: &Plane<[f32; 3]>) -> Result<()> {
        same_size(picture, truth)?;
        if (picture.width(), picture.height()) != (self.width, self.height) {
            return Err(Error::Invalid(format!(
                "a frame of {} x {} pixels in a sequence of {} x {}; give frames of one size",
                picture.width(),
                picture.height(),
                self.width,
                self.height
            )));
        }
        let errors = picture.values().iter().zip(truth.values()).map(|(p, q)| {
            let [r, g, b] =
                [0, 1, 2].map_inline(|c| LUMINANCE[c] * (f64::from(p[c]) - f64::from(q[c])));
            (r + g + b) as f32
        });
        self.frames.push(Plane::from_values(self.width, self.height, errors.collect()));
        Ok(())
    }

    /// The spectrum of the frames that you added.
    ///
    /// Each frequency is summed directly from the formula, in n^2 additions a pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no frame.
    pub fn spectrum(&self, exec: &Exec) -> Result<Spectrum> {
        let n = self.frames.len();
        if n == 0 {
            return Err(Error::Invalid("the spectrum of no frame; add frames before".into()));
        }
        let circle: Vec<[f64; 2]> = (0..n)
            .map(|i| 2.0 * PI * i as f64 / n as f64)
            .map(|angle| [elementary::cos(angle), elementary::sin(angle)])
            .collect();
        let rows = exec.ordered((0..self.height as usize).collect(), |y| self.row(y, &circle));
        let mut sums = vec![0.0; n / 2 + 1];
        for row in rows {
            sums.iter_mut().zip(row).for_each(|(sum, of_row)| *sum += of_row);
        }
        let pixels = f64::from(self.width) * f64::from(self.height);
        let mean = |sum: &f64| sum / pixels;
        let constant = mean(&sums[0]).sqrt();
        let power: Vec<f64> = sums[1..].iter().map(mean).collect();
        let flicker = power.iter().sum::<f64>().sqrt();
        // Adding +0 because an empty sum of floats is -0.
        Ok(Spectrum { frames: n, constant, flicker: flicker + 0.0, power })
    }

    /// The sums along a row of m^2 and of each P, in the order of frequencies.
    fn row(&self, y: usize, circle: &[[f64; 2]]) -> Vec<f64> {
        let (width, n) = (self.width as usize, self.frames.len());
        let mut errors: Vec<Vec<f64>> = self
            .frames
            .iter()
            .map(|frame| {
                frame.values()[y * width..(y + 1) * width].iter().map(|&e| e.into()).collect()
            })
            .collect();
        let mut means = vec![0.0; width];
        for frame in &errors {
            means.iter_mut().zip(frame).for_each(|(mean, error)| *mean += error);
        }
        means.iter_mut().for_each(|mean| *mean /= n as f64);
        for frame in &mut errors {
            frame.iter_mut().zip(&means).for_each(|(error, mean)| *error -= mean);
        }
        let constant = means.iter().map(|mean| mean * mean).sum();
        let powers = (1..=n / 2).map(|k| {
            let (mut real, mut imaginary) = (vec![0.0; width], vec![0.0; width]);
            for (t, frame) in errors.iter().enumerate() {
                let [c, s] = circle[k * t % n];
                for ((re, im), error) in real.iter_mut().zip(&mut imaginary).zip(frame) {
                    *re += c * error;
                    *im += s * error;
                }
            }
            // All waves but the fastest stand for two conjugate frequencies, k and n - k.
            let weight = if 2 * k == n { 1.0 } else { 2.0 };
            let squares: f64 = real.iter().zip(&imaginary).map(|(re, im)| re * re + im * im).sum();
            weight * squares / (n * n) as f64
        });
        [constant].into_iter().chain(powers).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;

    /// The spectrum of gray pictures, with errors given by frame and pixel.
    fn spectrum(frames: usize, error: impl Fn(usize, usize) -> f32) -> Spectrum {
        let (width, height) = (7, 5);
        let truth = Plane::filled(width, height, [0.5; 3]);
        let mut flicker = Flicker::new(width, height, frames).unwrap();
        for t in 0..frames {
            let values = (0..35).map(|i| [0.5 + error(t, i); 3]).collect();
            flicker.push(&Plane::from_values(width, height, values), &truth).unwrap();
        }
        let found = flicker.spectrum(&Exec::sequential()).unwrap();
        assert_eq!(flicker.spectrum(&Exec::new(3, 8).unwrap()).unwrap(), found, "threads");
        assert_eq!((found.power.len(), found.frames), (frames / 2, frames));
        found
    }

    #[test]
    fn a_constant_error_does_not_flicker() {
        let found = spectrum(8, |_, i| if i % 2 == 0 { 0.25 } else { -0.25 });
        assert!((found.constant - 0.25).abs() < 1e-7 && found.flicker == 0.0, "{found:?}");
        let one = spectrum(1, |_, _| 0.25);
        assert_eq!((one.flicker.to_bits(), one.power), (0, vec![]));
    }

    /// A wave of amplitude a has the variance a^2/2 at any phase, all at its frequency. The fastest
    /// wave, +a -a, has a^2.
    #[test]
    fn a_wave_has_its_power_at_its_frequency() {
        for n in [4, 9, 16, 33] {
            for k in 1..=n / 2 {
                let found = spectrum(n, |t, i| {
                    let phase = if 2 * k == n { 0.0 } else { i as f64 };
                    let angle = 2.0 * PI * (k * t) as f64 / n as f64 + phase;
                    (0.1 * elementary::cos(angle) + 0.2) as f32
                });
                let expected = if 2 * k == n { 0.01 } else { 0.005 };
                for (place, power) in found.power.iter().enumerate() {
                    let here = if place + 1 == k { expected } else { 0.0 };
                    assert!((power - here).abs() < 1e-7, "{n} {k} {place}: {power}");
                }
                assert!((found.frequency(k - 1) - k as f64 / n as f64).abs() < 1e-15);
                assert!((found.constant - 0.2).abs() < 1e-6);
            }
        }
    }

    /// An error of a t at frame t has the transform a n/(exp(-2 pi i k/n) - 1), whose square is
    /// a^2 n^2/(4 sin^2(pi k/n)).
    #[test]
    fn a_drift_shows_at_all_frequencies() {
        for n in [5, 8, 32] {
            let found = spectrum(n, |t, _| t as f32 / 256.0);
            for (place, power) in found.power.iter().enumerate() {
                let k = place + 1;
                let half = elementary::sin(PI * k as f64 / n as f64);
                let weight = if 2 * k == n { 1.0 } else { 2.0 };
                let expected = weight / (256.0 * 256.0) / (4.0 * half * half);
                assert!((power / expected - 1.0).abs() < 1e-6, "{n} {k}: {power}, {expected}");
            }
        }
    }

    /// Parseval: the flicker is the standard deviation over time. Flicker and constant error make
    /// up the whole.
    #[test]
    fn the_flicker_is_the_deviation_over_time() {
        for n in [2, 3, 8, 17, 64] {
            // Multiples of 2^-10 are exact in f32 beside 0.5.
            let error = |t: usize, i: usize| {
                let random = unit(7, (t * 35 + i) as u64);
                ((random - 0.3) * 512.0).floor() / 1024.0 * (1.0 + (i % 3) as f32)
            };
            let found = spectrum(n, error);
            let (mut variance, mut square) = (0.0, 0.0);
            for i in 0..35 {
                let of: Vec<f64> = (0..n).map(|t| error(t, i).into()).collect();
                let mean = of.iter().sum::<f64>() / n as f64;
                variance += of.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / n as f64;
                square += of.iter().map(|e| e * e).sum::<f64>() / n as f64;
            }
            let (variance, square) = (variance / 35.0, square / 35.0);
            let whole = found.constant * found.constant + found.flicker * found.flicker;
            assert!((found.flicker * found.flicker - variance).abs() < 1e-7, "{n}: {found:?}");
            assert!((whole - square).abs() < 1e-7, "{n}: {whole} against {square}");
            // The sequence played backwards gives the same.
            let back = spectrum(n, |t, i| error(n - 1 - t, i));
            let off = back.power.iter().zip(&found.power).map(|(a, b)| (a - b).abs());
            assert!(off.into_iter().all(|off| off < 1e-12));
        }
    }

    #[test]
    fn the_error_is_of_luminance() {
        let (truth, mut flicker) = (Plane::filled(2, 1, [0.0; 3]), Flicker::new(2, 1, 2).unwrap());
        let red = Plane::from_values(2, 1, vec![[1.0, 0.0, 0.0], [0.0; 3]]);
        flicker.push(&red, &truth).unwrap();
        flicker.push(&truth, &truth).unwrap();
        let found = flicker.spectrum(&Exec::sequential()).unwrap();
        // One of two pixels, half of the frames: variance 0.2126^2/4 in one, 0 in the other.
        assert!((found.flicker - 0.2126 / 8.0_f64.sqrt()).abs() < 1e-8, "{found:?}");
        assert!(Flicker::new(2, 1, 0).unwrap().spectrum(&Exec::sequential()).is_err());
        let small = Plane::filled(1, 1, [0.0; 3]);
        assert!(flicker.push(&small, &truth).is_err());
        let said = flicker.push(&small, &small).unwrap_err().to_string();
        assert!(said.contains("1 x 1 pixels in a sequence of 2 x 1"), "{said}");
    }
}
