//! The mean structural similarity \[WBSS04\].

use crate::number::elementary;

/// The side of the window of \[WBSS04\], in pixels.
const WINDOW: usize = 11;
/// Its standard deviation, in pixels.
const SIGMA: f64 = 1.5;
/// (K1 L)^2, with L = 1 the range of values.
pub(super) const C1: f64 = 0.01 * 0.01;
/// (K2 L)^2.
const C2: f64 = 0.03 * 0.03;

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
