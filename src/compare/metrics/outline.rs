//! Measure the length of the silhouette.

/// The length of the outline of the covered pixels, in pixels. The plane has `width` values a row.
///
/// A pixel is covered if its value is > 0; a NaN is not. The outline separates covered pixels from
/// others, around holes too. The border of the picture is no outline.
///
/// Count the pairs of neighbouring pixels with exactly one covered: `h` side by side, `v` one above
/// the other, and `d` at a corner, in both diagonals. The formula of Cauchy and Crofton, with lines
/// in the directions 0, 45, 90 and 135 degrees, is
///
/// ```text
/// length = pi/8 (h + v + d / sqrt 2)
/// ```
///
/// Lines along pixels are 1 px apart, diagonal ones 1/sqrt 2, and each counts for 45 degrees. For a
/// long straight edge the mean over all directions is its length, so the length of a large disc is
/// right. An edge whose direction is theta is measured as pi/8 (|sin theta| + |cos theta| +
/// |sin(theta - 45)| + |cos(theta - 45)|) of its length: from 0.948 along rows, columns and
/// diagonals to 1.026 halfway between. A single pixel measures 2.68.
///
/// A rough outline is longer. The ratio to the outline of the truth shows this, and most of the
/// dependence on direction cancels.
///
/// # Panics
/// If the length of the plane is no multiple of `width`.
#[must_use]
pub fn outline(coverage: &[f32], width: usize) -> f64 {
    let height = coverage.len().checked_div(width).unwrap_or(0);
    assert_eq!(coverage.len(), width * height, "whole rows");
    let covered = |x: usize, y: usize| coverage[y * width + x] > 0.0;
    let (mut straight, mut diagonal) = (0_u64, 0_u64);
    for y in 0..height {
        for x in 0..width {
            let here = covered(x, y);
            let (right, below) = (x + 1 < width, y + 1 < height);
            straight += u64::from(right && covered(x + 1, y) != here);
            if below {
                straight += u64::from(covered(x, y + 1) != here);
                diagonal += u64::from(right && covered(x + 1, y + 1) != here);
                diagonal += u64::from(x > 0 && covered(x - 1, y + 1) != here);
            }
        }
    }
    let lines = straight as f64 + diagonal as f64 * std::f64::consts::FRAC_1_SQRT_2;
    std::f64::consts::FRAC_PI_8 * lines
}

#[cfg(test)]
mod tests {
    use super::super::tests::plane;
    use super::*;
    use crate::number::elementary::{cos, sin};
    use std::f64::consts::PI;

    fn inside(width: usize, height: usize, of: impl Fn(f64, f64) -> bool) -> Vec<f32> {
        plane(width, height, |x, y| f32::from(u8::from(of(x as f64 + 0.5, y as f64 + 0.5))))
    }

    /// Printed by `tests/data/outline.py`: scikit-image 0.26.0.
    #[test]
    fn the_published_implementation_agrees() {
        type Covered = fn(usize, usize) -> bool;
        let covered: [(Covered, f64); 3] = [
            (|x, y| x.abs_diff(30).pow(2) + y.abs_diff(22).pow(2) < 300, 109.40318743026135),
            (|x, y| (x * x * 7 + y * 13 + x * y * 3) % 256 < 100, 2001.647624908828),
            (|x, y| 3 * x + 7 * y < 200, 154.5452501635095),
        ];
        for (covered, expected) in covered {
            let inside = |x, y| x > 0 && y > 0 && x < 63 && y < 47 && covered(x, y);
            let found = outline(&plane(64, 48, |x, y| f32::from(u8::from(inside(x, y)))), 64);
            assert!((found - expected).abs() < 1e-9, "{found} against {expected}");
        }
    }

    #[test]
    fn discs_measure_their_circumference() {
        for (radius, within) in [(5.0, 0.02), (12.3, 0.01), (40.0, 0.004), (123.4, 0.002)] {
            let side = (2.0 * radius) as usize + 6;
            let mut sum = 0.0;
            for i in 0..10_u8 {
                let (x, y) = (0.1 * f64::from(i), f64::from(i * 3 % 10) * 0.1);
                let (x, y) = (radius + 2.0 + x, radius + 2.0 + y);
                let disc = inside(side, side, |u, v| {
                    (u - x) * (u - x) + (v - y) * (v - y) <= radius * radius
                });
                sum += outline(&disc, side);
            }
            let ratio = sum / 10.0 / (2.0 * PI * radius);
            assert!((ratio - 1.0).abs() < within, "{radius}: {ratio}");
        }
    }

    #[test]
    fn straight_edges_have_the_stated_bias() {
        for degrees in [0, 5, 10, 22, 23, 37, 45, 60, 90, 101, 135, 160] {
            let theta = f64::from(degrees) * PI / 180.0;
            // Along the window's middle, so that the edge leaves through two of its sides.
            let (s, c) = (sin(theta), cos(theta));
            let side = 800_u16;
            let half = f64::from(side) / 2.0 + 0.21;
            let edge = inside(side.into(), side.into(), |x, y| {
                (y - half - 0.13) * c - (x - half) * s > 0.0
            });
            let longer = if s.abs() > c.abs() { s.abs() } else { c.abs() };
            let length = f64::from(side) / longer;
            let ratio = outline(&edge, side.into()) / length;
            let (s2, c2) = (sin(theta - PI / 4.0), cos(theta - PI / 4.0));
            let expected = PI / 8.0 * (s.abs() + c.abs() + s2.abs() + c2.abs());
            assert!((ratio - expected).abs() < 0.004, "{degrees}: {ratio} against {expected}");
        }
    }

    #[test]
    fn known_answers() {
        let one = plane(5, 5, |x, y| f32::from(u8::from(x == 2 && y == 2)));
        let expected = PI / 8.0 * (4.0 + 4.0 / 2.0_f64.sqrt());
        assert!((outline(&one, 5) - expected).abs() < 1e-12 && (expected - 2.68).abs() < 0.005);
        let hole: Vec<f32> = one.iter().map(|v| 1.0 - v).collect();
        assert_eq!(outline(&hole, 5), outline(&one, 5), "a hole has an outline");
        assert_eq!(outline(&[1.0; 25], 5), 0.0, "the border has none");
        assert_eq!(outline(&[f32::NAN, -1.0, 0.0], 3), 0.0);
        assert_eq!(outline(&[], 0), 0.0);
        // Its mirror images and its transpose measure the same.
        let shape = |x: usize, y: usize| f32::from(u8::from((x * x * 7 + y * 13 + x * y) % 3 < 1));
        let length = outline(&plane(12, 9, shape), 12);
        assert_eq!(outline(&plane(12, 9, |x, y| shape(11 - x, y)), 12), length);
        assert_eq!(outline(&plane(12, 9, |x, y| shape(x, 8 - y)), 12), length);
        assert_eq!(outline(&plane(9, 12, |x, y| shape(y, x)), 9), length);
    }
}
