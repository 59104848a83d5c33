//! SSIM, the structural similarity of two planes \[WBSS04\].

use crate::number::MapInline;
use crate::number::elementary;

/// The side of the window of \[WBSS04\], in pixels.
const WINDOW: usize = 11;
/// The standard deviation of the window, in pixels.
const SIGMA: f64 = 1.5;
/// (K1 L)^2, with L = 1 the range of values.
const C1: f64 = 0.01 * 0.01;
/// (K2 L)^2.
const C2: f64 = 0.03 * 0.03;

/// The mean structural similarity of two planes with `width` values a row, as \[WBSS04\] defines
/// it.
///
/// The formula is evaluated at each position of the 11 x 11 Gaussian window g (standard deviation
/// 1.5, sum 1) inside the plane. It uses the weighted means m = sum g x, the variances v = sum g
/// x^2 - m^2 (population, not sample) and the covariance c = sum g x y - `m_x` `m_y`:
///
/// ```text
/// SSIM = (2 m_x m_y + C1) (2 c + C2) / ((m_x^2 + m_y^2 + C1) (v_x + v_y + C2))
/// ```
///
/// with C1 = 0.01^2 and C2 = 0.03^2. The result is the mean over the positions. There is no
/// padding. As in the paper's equations and unlike in the authors' later script, there is no
/// downsampling. For a colour, take the mean over its channels. `None` if the window does not fit.
///
/// # Panics
/// If the planes differ in length, or their length is no multiple of `width`.
///
/// [WBSS04]: https://doi.org/10.1109/TIP.2003.819861
#[must_use]
pub fn ssim(a: &[f32], b: &[f32], width: usize) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    each_similarity(a, b, width, |one| {
        sum += one;
        count += 1;
    });
    (count > 0).then(|| sum / count as f64)
}

/// The similarity at each position of the window; [`ssim`] is the mean of this map.
///
/// The map has `width - 10` values a row and ten rows less than the planes have. Its first value
/// belongs to the window whose centre is the pixel (5, 5).
///
/// # Panics
/// As [`ssim`].
#[must_use]
pub fn ssim_map(a: &[f32], b: &[f32], width: usize) -> Option<Vec<f64>> {
    let mut map = Vec::new();
    each_similarity(a, b, width, |one| map.push(one));
    (!map.is_empty()).then_some(map)
}

/// The least number of pixels of a halved picture for [`hierarchical_ssim`], which it must exceed.
const LEAST_HALVED: usize = 64 * 64;

/// The mean of [`ssim`] over two planes and their halved copies.
///
/// \[BJFM19\] 5.3 measures image quality by a "hierarchical SSIM", and defines no hierarchy. One level
/// weighs differences of single pixels; the halved levels weigh what an observer sees from afar.
///
/// Decided: as in the image comparison of the authors' program (`PADrend`), planes are halved while
/// width and height are even and the halved plane has more than 64 x 64 pixels. All levels weigh
/// the same. A pixel of a halved plane is the mean of four: `((a + b) + (c + d)) / 4` in `f32`, with
/// a and b in the upper row. Departs: that program also blurs a plane before it halves it.
///
/// `None` if the window does not fit.
///
/// # Panics
/// As [`ssim`].
#[must_use]
pub fn hierarchical_ssim(a: &[f32], b: &[f32], width: usize) -> Option<f64> {
    let (mut sum, mut levels) = (ssim(a, b, width)?, 1_u32);
    let (mut width, mut height) = (width, a.len() / width);
    let (mut a, mut b) = (a.to_vec(), b.to_vec());
    while width % 2 == 0 && height % 2 == 0 && width / 2 * (height / 2) > LEAST_HALVED {
        (a, b) = (halved(&a, width), halved(&b, width));
        (width, height) = (width / 2, height / 2);
        sum += ssim(&a, &b, width)?;
        levels += 1;
    }
    Some(sum / f64::from(levels))
}

/// A plane of half the width and height, see [`hierarchical_ssim`].
fn halved(plane: &[f32], width: usize) -> Vec<f32> {
    let rows = plane.chunks_exact(2 * width).map(|pair| pair.split_at(width));
    let pixel =
        |(upper, lower): (&[f32], &[f32])| ((upper[0] + upper[1]) + (lower[0] + lower[1])) / 4.0;
    rows.flat_map(|(upper, lower)| upper.chunks_exact(2).zip(lower.chunks_exact(2)).map(pixel))
        .collect()
}

/// Runs `visit` for the similarity at each position of the window, row by row. If the window does
/// not fit, it never runs.
fn each_similarity(a: &[f32], b: &[f32], width: usize, mut visit: impl FnMut(f64)) {
    assert_eq!(a.len(), b.len(), "planes of one size");
    let Some(height) = a.len().checked_div(width) else { return };
    assert_eq!(a.len(), width * height, "whole rows");
    if width < WINDOW || height < WINDOW {
        return;
    }
    let weights = gaussian();
    let columns = width + 1 - WINDOW;
    // The window is a product of two Gaussians: rows are blurred along x once, and the last 11 of
    // them along y.
    let mut blurred = vec![[const { Vec::<f64>::new() }; 5]; WINDOW];
    for (y, (row_a, row_b)) in a.chunks_exact(width).zip(b.chunks_exact(width)).enumerate() {
        blurred[y % WINDOW] = moments(row_a, row_b).map(|row| blur_row(&row, &weights));
        if y + 1 >= WINDOW {
            let top = y + 1 - WINDOW;
            let rows: [&[Vec<f64>; 5]; WINDOW] =
                std::array::from_fn(|k| &blurred[(top + k) % WINDOW]);
            let [m_a, m_b, m_aa, m_bb, m_ab] = std::array::from_fn(|moment| {
                blur_columns(rows.map_inline(|row| row[moment].as_slice()), &weights)
            });
            for x in 0..columns {
                visit(similarity([m_a[x], m_b[x], m_aa[x], m_bb[x], m_ab[x]]));
            }
        }
    }
}

/// The weights of one axis of the window; their sum is 1.
fn gaussian() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] = std::array::from_fn(|i| {
        let offset = i as f64 - (WINDOW / 2) as f64;
        elementary::exp(-offset * offset / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = weights.iter().sum();
    weights.map_inline(|weight| weight / sum)
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

/// The formula of [`ssim`] for the blurred a, b, a^2, b^2 and a b.
fn similarity([m_a, m_b, m_aa, m_bb, m_ab]: [f64; 5]) -> f64 {
    let (v_a, v_b, c) = (m_aa - m_a * m_a, m_bb - m_b * m_b, m_ab - m_a * m_b);
    (2.0 * m_a * m_b + C1) * (2.0 * c + C2) / ((m_a * m_a + m_b * m_b + C1) * (v_a + v_b + C2))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{noisy, pattern, plane, ramp};
    use super::super::{psnr, rmse};
    use super::*;

    /// Against a pyramid that is built pixel by pixel. 160 x 128 is halved once: 40 x 32 is too
    /// small. 161 is odd.
    #[test]
    fn the_hierarchy_halves_while_sides_are_even() {
        let [a, b] = [plane(160, 128, pattern), plane(160, 128, noisy)];
        let half = |plane: &[f32]| -> Vec<f32> {
            let at = |x: usize, y: usize| plane[y * 160 + x];
            let pixels = (0..64).flat_map(|y| (0..80).map(move |x| (2 * x, 2 * y)));
            let four =
                |(x, y)| ((at(x, y) + at(x + 1, y)) + (at(x, y + 1) + at(x + 1, y + 1))) / 4.0;
            pixels.map(four).collect()
        };
        let levels = [ssim(&a, &b, 160), ssim(&half(&a), &half(&b), 80)].map(Option::unwrap);
        assert_eq!(hierarchical_ssim(&a, &b, 160), Some((levels[0] + levels[1]) / 2.0));
        let [a, b] = [&a[..161 * 100], &b[..161 * 100]];
        assert_eq!(hierarchical_ssim(a, b, 161), ssim(a, b, 161));
        assert_eq!(hierarchical_ssim(&a[..100], &b[..100], 10), None);
    }

    /// Printed by `tests/data/ssim.py`: scikit-image 0.26.0, which the script first compares with
    /// the definition. RMSE, PSNR, SSIM of shifted, noisy and other patterns.
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
        // For two constants the second factor is C2 / C2.
        let (p, q) = (0.25_f64, 0.75_f64);
        let found = ssim(&[0.25; 169], &[0.75; 169], 13).unwrap();
        assert!((found - (2.0 * p * q + C1) / (p * p + q * q + C1)).abs() < 1e-12);
        assert_eq!(rmse(&[0.25; 169], &[0.75; 169]), 0.5);
        // Only windows that hold the changed pixel are less similar. The pixel is in the corner of
        // the first window.
        let mut b = a.clone();
        b[0] += 0.5;
        let map = ssim_map(&a, &b, 20).unwrap();
        assert_eq!(map.len(), 10 * 5);
        assert!(map[0] < 1.0 && map[1..].iter().all(|&one| one == 1.0), "{map:?}");
        // Too small in one direction, or empty.
        assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 10), None);
        assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 11), None);
        assert_eq!(ssim(&[], &[], 0), None);
        assert_eq!(ssim_map(&[0.0; 110], &[0.0; 110], 10), None);
        assert!(rmse(&[1.0, f32::NAN], &[1.0, 1.0]).is_nan());
    }
}
