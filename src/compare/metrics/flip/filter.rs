//! The filters of FLIP: the detail that an eye resolves at a distance, and the edges and points
//! that it sees.
//!
//! A filter is a list of an odd number of weights, its middle at the pixel. Each filter is used
//! along x and along y.

use crate::number::MapInline;
use crate::number::elementary;
use std::f64::consts::PI;

/// The filters of Y and of Cx, and the two filters whose sum filters Cz; all of one length.
pub(super) struct Eye(pub(super) [Vec<f64>; 4]);

/// A Gaussian, and its first and second derivatives; all of one length.
pub(super) struct Feature(pub(super) [Vec<f64>; 3]);

/// The a and b in `a sqrt(pi/b) exp(-pi^2 x^2 / b)`, x in degrees, of each filter of [`Eye`]. They
/// are the contrast sensitivity functions of FLIP, Table 1.
const SENSITIVITY: [[f64; 2]; 4] = [[1.0, 0.0047], [1.0, 0.0053], [34.1, 0.04], [13.5, 0.025]];

/// Twice the standard deviation of [`Feature`] in degrees: the width of a feature.
const WIDTH: f64 = 0.082;

impl Eye {
    /// The filters at this number of pixels a degree. They end three standard deviations of the
    /// widest away.
    ///
    /// The first two are Gaussians of sum 1. The third and fourth are Gaussians too: each is
    /// applied along x and along y, and the results are added. A product of two passes carries a
    /// sqrt(pi/b), so each pass carries its root. The common scale makes the sum of both products
    /// 1.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let deviation = (SENSITIVITY[2][1] / (2.0 * PI * PI)).sqrt();
        let radius = (3.0 * deviation * pixels_per_degree).ceil() as i32;
        let mut filters = SENSITIVITY.map(|[a, b]| {
            let scale = (a * (PI / b).sqrt()).sqrt();
            taps(radius, |x| {
                let degrees = x / pixels_per_degree;
                scale * elementary::exp(-(PI * PI) * (degrees * degrees) / b)
            })
        });
        let [y, cx, first, second] = [0, 1, 2, 3].map_inline(|i| filters[i].iter().sum::<f64>());
        let both = (first * first + second * second).sqrt();
        for (filter, sum) in filters.iter_mut().zip([y, cx, both, both]) {
            filter.iter_mut().for_each(|weight| *weight /= sum);
        }
        Self(filters)
    }
}

impl Feature {
    /// The filters at this number of pixels a degree. They end three standard deviations away.
    ///
    /// g = exp(-x^2/(2 s^2)) has the sum 1. In -x g and (x^2/s^2 - 1) g the positive weights are
    /// divided by their sum, and the negative weights by theirs.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let deviation = 0.5 * WIDTH * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as i32;
        let gaussian = |x: f64| elementary::exp(-(x * x) / (2.0 * deviation * deviation));
        let derivative = |x: f64| -x * gaussian(x);
        let second = |x: f64| (x * x / (deviation * deviation) - 1.0) * gaussian(x);
        Self([
            balanced(taps(radius, gaussian)),
            balanced(taps(radius, derivative)),
            balanced(taps(radius, second)),
        ])
    }
}

fn taps(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Scales weights so that the positive ones have the sum 1 and the negative ones -1.
fn balanced(mut weights: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| weights.iter().map(|w| w * sign).filter(|w| *w > 0.0).sum::<f64>();
    let (above, below) = (sum(1.0), sum(-1.0));
    for weight in &mut weights {
        if *weight > 0.0 {
            *weight /= above;
        } else if *weight < 0.0 {
            *weight /= below;
        }
    }
    weights
}

/// Filters a row. The caller has lengthened the row at either end by half of the filter or more.
/// The result has the `width` values in its middle.
pub(super) fn along_row(row: &[f64], weights: &[f64], width: usize) -> Vec<f64> {
    let first = (row.len() - width) / 2 - weights.len() / 2;
    let mut sums = vec![0.0; width];
    for (k, weight) in weights.iter().enumerate() {
        add(&mut sums, &row[first + k..][..width], *weight);
    }
    sums
}

/// Filters several rows into their middle row.
pub(super) fn along_column<'a>(
    rows: impl Iterator<Item = &'a [f64]>,
    weights: &[f64],
    width: usize,
) -> Vec<f64> {
    let mut sums = vec![0.0; width];
    rows.zip(weights).for_each(|(row, weight)| add(&mut sums, row, *weight));
    sums
}

fn add(sums: &mut [f64], values: &[f64], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filters_leave_a_plain_colour_and_see_no_feature_in_it() {
        for pixels_per_degree in [5.0, 20.0, 67.0, 100.5] {
            let Eye([y, cx, first, second]) = Eye::new(pixels_per_degree);
            let sum = |filter: &[f64]| filter.iter().sum::<f64>();
            assert!((sum(&y) - 1.0).abs() < 1e-14 && (sum(&cx) - 1.0).abs() < 1e-14);
            let (first, second) = (sum(&first), sum(&second));
            assert!((first * first + second * second - 1.0).abs() < 1e-14);
            // The two parts of a sum of Gaussians relate as their integrals, a sqrt(b).
            if pixels_per_degree > 50.0 {
                let ratio = first * first / (second * second);
                assert!((ratio - 34.1 * 0.04_f64.sqrt() / (13.5 * 0.025_f64.sqrt())).abs() < 0.02);
            }
            let Feature([g, edge, point]) = Feature::new(pixels_per_degree);
            assert!((sum(&g) - 1.0).abs() < 1e-14);
            assert!(sum(&edge).abs() < 1e-14 && sum(&point).abs() < 1e-14);
            let size = |filter: &[f64]| filter.iter().map(|w| w.abs()).sum::<f64>();
            assert!((size(&edge) - 2.0).abs() < 1e-14 && (size(&point) - 2.0).abs() < 1e-14);
        }
        // 3 sqrt(0.04/(2 pi^2)) 67 = 9.05 and 1.5 0.082 67 = 8.24.
        assert_eq!(Eye::new(67.0).0[0].len(), 21);
        assert_eq!(Feature::new(67.0).0[0].len(), 19);
    }

    #[test]
    fn rows_and_columns_are_weighted_sums() {
        let row = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
        assert_eq!(along_row(&row, &[0.5, 1.0, -1.0], 4), [-1.5, -3.0, -6.0, -12.0]);
        assert_eq!(along_row(&row, &[0.5, 1.0, -1.0], 2), [-3.0, -6.0]);
        let rows = [&row[..2], &row[2..4], &row[4..]];
        assert_eq!(along_column(rows.into_iter(), &[1.0, 0.25, -1.0], 2), [-14.0, -28.0]);
    }
}
