//! RMSE, PSNR and SSIM: how far two pictures are apart, in one number each; and holes and spill,
//! how far they agree on what is covered ([`coverage`]).
//!
//! `Decided:` the first three are taken of the values as stored, for pictures linear and not
//! clipped, with a peak of 1: a value that a display would clip counts in full. They serve to rank
//! methods; whether a picture is right is for [`super::compare`] to say. A NaN or an infinity in a
//! plane makes each number NaN or infinite. Everything is f64, summed row by row from the top left.

use crate::frame::image::{Image, Values};
use crate::number::elementary;

/// The side of the window of \[WBSS04\], in pixels.
const WINDOW: usize = 11;
/// Its standard deviation, in pixels.
const SIGMA: f64 = 1.5;
/// (K1 L)^2, with L = 1 the range of values.
const C1: f64 = 0.01 * 0.01;
/// (K2 L)^2.
const C2: f64 = 0.03 * 0.03;

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

/// The mean structural similarity of two planes, `width` values a row, as \[WBSS04\] defines it.
///
/// At each position of the 11 x 11 Gaussian window g (standard deviation 1.5, sum 1) inside the
/// plane, with the weighted means m = sum g x, variances v = sum g x^2 - m^2 (population, not
/// sample) and covariance c = sum g x y - `m_x` `m_y`,
///
/// ```text
/// SSIM = (2 m_x m_y + C1) (2 c + C2) / ((m_x^2 + m_y^2 + C1) (v_x + v_y + C2))
/// ```
///
/// with C1 = 0.01^2 and C2 = 0.03^2, and the result is the mean over the positions. There is no
/// padding and, as in the paper's equations and unlike in the authors' later script, no
/// downsampling. For a colour, take the mean over its channels. `None` if the window does not fit.
///
/// # Panics
/// If the planes differ in length, or it is no multiple of `width`.
///
/// [WBSS04]: https://doi.org/10.1109/TIP.2003.819861
#[must_use]
pub fn ssim(a: &[f32], b: &[f32], width: usize) -> Option<f64> {
    assert_eq!(a.len(), b.len(), "planes of one size");
    let height = a.len().checked_div(width)?;
    assert_eq!(a.len(), width * height, "whole rows");
    if width < WINDOW || height < WINDOW {
        return None;
    }
    let weights = gaussian();
    let columns = width + 1 - WINDOW;
    // The window is a product: rows are blurred along x once, and the last 11 of them along y.
    let mut blurred = vec![[const { Vec::<f64>::new() }; 5]; WINDOW];
    let mut sum = 0.0;
    for (y, (row_a, row_b)) in a.chunks_exact(width).zip(b.chunks_exact(width)).enumerate() {
        blurred[y % WINDOW] = moments(row_a, row_b).map(|row| blur_row(&row, &weights));
        if y + 1 >= WINDOW {
            let top = y + 1 - WINDOW;
            let rows: [&[Vec<f64>; 5]; WINDOW] =
                std::array::from_fn(|k| &blurred[(top + k) % WINDOW]);
            let [m_a, m_b, m_aa, m_bb, m_ab] = std::array::from_fn(|moment| {
                blur_columns(rows.map(|row| row[moment].as_slice()), &weights)
            });
            for x in 0..columns {
                sum += similarity([m_a[x], m_b[x], m_aa[x], m_bb[x], m_ab[x]]);
            }
        }
    }
    Some(sum / (columns * (height + 1 - WINDOW)) as f64)
}

/// The weights of one axis of the window; their sum is 1.
fn gaussian() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] = std::array::from_fn(|i| {
        let offset = i as f64 - (WINDOW / 2) as f64;
        elementary::exp(-offset * offset / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// a, b, a^2, b^2, a b along a row.
fn moments(a: &[f32], b: &[f32]) -> [Vec<f64>; 5] {
    let row = |of: fn(f64, f64) -> f64| {
        a.iter().zip(b).map(|(&a, &b)| of(f64::from(a), f64::from(b))).collect()
    };
    [row(|a, _| a), row(|_, b| b), row(|a, _| a * a), row(|_, b| b * b), row(|a, b| a * b)]
}

/// The weighted sums at the positions where the window fits into a row.
fn blur_row(row: &[f64], weights: &[f64; WINDOW]) -> Vec<f64> {
    let columns = row.len() + 1 - WINDOW;
    blur_columns(std::array::from_fn(|k| &row[k..k + columns]), weights)
}

/// The weighted sum of eleven rows, from the first to the last.
fn blur_columns(rows: [&[f64]; WINDOW], weights: &[f64; WINDOW]) -> Vec<f64> {
    let mut sums = vec![0.0; rows[0].len()];
    for (row, weight) in rows.into_iter().zip(weights) {
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
    }
    sums
}

/// The formula of [`ssim`], of the blurred a, b, a^2, b^2 and a b.
fn similarity([m_a, m_b, m_aa, m_bb, m_ab]: [f64; 5]) -> f64 {
    let (v_a, v_b, c) = (m_aa - m_a * m_a, m_bb - m_b * m_b, m_ab - m_a * m_b);
    (2.0 * m_a * m_b + C1) * (2.0 * c + C2) / ((m_a * m_a + m_b * m_b + C1) * (v_a + v_b + C2))
}

/// Where a pixel lies in what a picture covers, see [`regions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Covered, and so are all its neighbours.
    Interior,
    /// The silhouette: neither of the others. It is two pixels wide, one on either side.
    Edge,
    /// Not covered, and neither is any of its neighbours.
    Exterior,
}

/// The region of each pixel of a plane of coverage, `width` values a row.
///
/// A pixel is covered if its value is > 0; a NaN is not. Its neighbours are those of the eight
/// pixels around it that are in the plane, so that the border of the picture is no silhouette.
///
/// # Panics
/// If the plane is no multiple of `width`.
#[must_use]
pub fn regions(coverage: &[f32], width: usize) -> Vec<Region> {
    let height = coverage.len().checked_div(width).unwrap_or(0);
    assert_eq!(coverage.len(), width * height, "whole rows");
    let around = |at: usize, end: usize| at.saturating_sub(1)..end.min(at + 2);
    let region = |x: usize, y: usize| {
        let cells = around(y, height).flat_map(|y| around(x, width).map(move |x| y * width + x));
        let (mut full, mut empty) = (true, true);
        for covered in cells.map(|i| coverage[i] > 0.0) {
            full &= covered;
            empty &= !covered;
        }
        match (full, empty) {
            (true, _) => Region::Interior,
            (_, true) => Region::Exterior,
            _ => Region::Edge,
        }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| region(x, y)).collect()
}

/// How far a picture covers what a reference does, in pixels; see [`coverage`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// That the reference covers.
    pub covered: u64,
    /// In the reference's interior.
    pub interior: u64,
    /// Of those, that the picture leaves empty.
    pub holes: u64,
    /// In the reference's exterior that the picture covers.
    pub spill: u64,
    /// On the reference's edge.
    pub edge: u64,
    /// Of those, that one covers and the other does not.
    pub mismatch: u64,
}

/// Holes and spill of a plane of coverage against that of a reference, `width` values a row.
///
/// Pixels are counted by their [`regions`] in the reference. So a silhouette that is off by a pixel
/// counts in `mismatch` alone.
///
/// # Panics
/// If the planes differ in length, or it is no multiple of `width`.
#[must_use]
pub fn coverage(picture: &[f32], reference: &[f32], width: usize) -> Coverage {
    assert_eq!(picture.len(), reference.len(), "planes of one size");
    let mut counts = Coverage::default();
    let pixels = picture.iter().zip(reference).map(|(a, b)| (*a > 0.0, *b > 0.0));
    for ((found, expected), region) in pixels.zip(regions(reference, width)) {
        counts.covered += u64::from(expected);
        match region {
            Region::Interior => {
                counts.interior += 1;
                counts.holes += u64::from(!found);
            }
            Region::Edge => {
                counts.edge += 1;
                counts.mismatch += u64::from(found != expected);
            }
            Region::Exterior => counts.spill += u64::from(found),
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(width: usize, height: usize, of: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect()
    }

    fn pattern(x: usize, y: usize) -> f32 {
        ((x * x * 7 + y * 13 + x * y * 3) % 256) as f32 / 256.0
    }

    fn ramp(x: usize, y: usize) -> f32 {
        ((x * 4 + y * 2) % 256) as f32 / 256.0
    }

    fn noisy(x: usize, y: usize) -> f32 {
        0.75 * ramp(x, y) + ((x * 31 + y * 17) % 64) as f32 / 256.0
    }

    /// Printed by `tests/data/ssim.py`: scikit-image 0.26.0, which it first holds against the
    /// definition; RMSE, PSNR, SSIM of shifted, noisy and other patterns.
    #[test]
    fn the_published_implementation_agrees() {
        let references = [
            (64, 48, 0, [0.12401959270615269, 18.130193985141926, 0.8939135771776123]),
            (64, 48, 1, [0.10200910919004928, 19.827220899206058, 0.3467302549767385]),
            (64, 48, 2, [0.4047306700550418, 7.856677679849904, 0.006799754254667338]),
            (11, 11, 0, [0.015625, 36.12359947967774, 0.9922426258401237]),
            (11, 11, 1, [0.11809263799334681, 18.555543517420446, 0.2673579220730217]),
            (11, 11, 2, [0.43176283778303237, 7.295094810221422, -0.0034520839930268993]),
            (37, 12, 0, [0.015625, 36.12359947967774, 0.9981501638224874]),
            (37, 12, 1, [0.09377941323150962, 20.557849778523632, 0.2643361860724498]),
            (37, 12, 2, [0.35852509711643926, 8.909608757653997, 0.010594669017081988]),
        ];
        for (width, height, pair, [expected_rmse, expected_psnr, expected_ssim]) in references {
            let (a, b) = match pair {
                0 => (plane(width, height, ramp), plane(width, height, |x, y| ramp(x + 1, y))),
                1 => (plane(width, height, ramp), plane(width, height, noisy)),
                _ => (plane(width, height, pattern), plane(width, height, ramp)),
            };
            let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
            let found = rmse(&a, &b);
            assert!(near(found, expected_rmse), "{width} {pair}: {found}");
            assert!(near(psnr(found), expected_psnr), "{width} {pair}: {}", psnr(found));
            let found = ssim(&a, &b, width).unwrap();
            assert!(near(found, expected_ssim), "{width} {pair}: {found}");
            assert_eq!(ssim(&b, &a, width), Some(found), "symmetric");
        }
    }

    #[test]
    fn known_answers() {
        let a = plane(20, 15, pattern);
        assert_eq!(ssim(&a, &a, 20), Some(1.0), "with itself");
        assert_eq!(rmse(&a, &a), 0.0);
        assert_eq!(psnr(0.0), f64::INFINITY);
        assert!((psnr(0.1) - 20.0).abs() < 1e-12);
        // Of two constants the second factor is C2 / C2.
        let (p, q) = (0.25_f64, 0.75_f64);
        let found = ssim(&[0.25; 169], &[0.75; 169], 13).unwrap();
        assert!((found - (2.0 * p * q + C1) / (p * p + q * q + C1)).abs() < 1e-12);
        assert_eq!(rmse(&[0.25; 169], &[0.75; 169]), 0.5);
        // Too small in one direction, or empty.
        assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 10), None);
        assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 11), None);
        assert_eq!(ssim(&[], &[], 0), None);
        assert!(rmse(&[1.0, f32::NAN], &[1.0, 1.0]).is_nan());
    }

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

    #[test]
    fn regions_of_a_drawing() {
        let drawing = ["......", ".###..", ".###..", ".###.#", "....##"];
        // i interior, e edge, x exterior; the corner has no neighbours beyond the picture.
        let expected = ["eeeeex", "eeeeex", "eeieee", "eeeeee", "eeeeee"];
        let plane: Vec<f32> =
            drawing.concat().bytes().map(|c| if c == b'#' { 0.25 } else { 0.0 }).collect();
        let letter = |region| match region {
            Region::Interior => 'i',
            Region::Edge => 'e',
            Region::Exterior => 'x',
        };
        let found: String = regions(&plane, 6).into_iter().map(letter).collect();
        assert_eq!(found, expected.concat());
        assert_eq!(regions(&[1.0; 6], 3), [Region::Interior; 6], "no silhouette at the border");
        assert_eq!(regions(&[f32::NAN, -1.0], 1), [Region::Exterior; 2]);
        assert!(regions(&[], 0).is_empty());
    }

    #[test]
    fn a_hole_a_spill_and_a_shifted_silhouette() {
        let reference = plane(16, 9, |x, _| f32::from(u8::from(x < 8)));
        let whole = Coverage { covered: 72, interior: 63, edge: 18, ..Coverage::default() };
        assert_eq!(coverage(&reference, &reference, 16), whole);
        let shifted = plane(16, 9, |x, _| f32::from(u8::from(x < 9)));
        assert_eq!(coverage(&shifted, &reference, 16), Coverage { mismatch: 9, ..whole });
        let mut picture = reference.clone();
        (picture[3 * 16 + 6], picture[3 * 16 + 7], picture[3 * 16 + 9]) = (0.0, 0.0, 0.5);
        let found = coverage(&picture, &reference, 16);
        assert_eq!(found, Coverage { holes: 1, spill: 1, mismatch: 1, ..whole });
        let swapped = coverage(&plane(16, 9, |_, _| 0.0), &reference, 16);
        assert_eq!(swapped, Coverage { holes: 63, mismatch: 9, ..whole });
    }
}
