//! The colour spaces of FLIP: opponent colours for filtering, and Lab for taking differences.

use crate::number::{Real, elementary};

/// The rows of the matrix from linear sRGB to CIE XYZ, white D65.
const XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The rows of the inverse matrix, as the reference implementation has them, nine digits after the
/// point.
const RGB: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// XYZ of the linear colour (1, 1, 1), and the reciprocals, as the reference implementation has
/// them.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];
const OVER_WHITE: [f64; 3] = [1.052_156_925, 1.0, 0.918_357_670];

/// Written out, here and below, because closures over arrays stay calls, which take longer than the
/// work.
#[inline(always)]
fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    let [p, q, r] = matrix;
    [
        p[0] * v[0] + p[1] * v[1] + p[2] * v[2],
        q[0] * v[0] + q[1] * v[1] + q[2] * v[2],
        r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
    ]
}

/// XYZ divided by white.
#[inline(always)]
fn relative(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = times(&XYZ, rgb);
    [x * OVER_WHITE[0], y * OVER_WHITE[1], z * OVER_WHITE[2]]
}

/// Clamps each component to [0, 1]; NaN stays NaN.
#[inline(always)]
pub(super) fn clamped([r, g, b]: [f64; 3]) -> [f64; 3] {
    [r.clamped(0.0, 1.0), g.clamped(0.0, 1.0), b.clamped(0.0, 1.0)]
}

/// Y in [-16, 100], Cx and Cz: luminance, red against green, blue against yellow; linear in RGB.
#[inline(always)]
pub(super) fn opponent(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The linear RGB of opponent colours, each component clamped to [0, 1].
#[inline(always)]
pub(super) fn clamped_rgb([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let (x, z) = (y + cx / 500.0, y - cz / 200.0);
    clamped(times(&RGB, [x * WHITE[0], y * WHITE[1], z * WHITE[2]]))
}

/// CIE L a b, with a and b multiplied by L / 100, because colours look paler in the dark (Hunt).
pub(super) fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative(rgb);
    let (x, y, z) = (response(x), response(y), response(z));
    let lightness = 116.0 * y - 16.0;
    let hunt = |chroma: f64| 0.01 * lightness * chroma;
    [lightness, hunt(500.0 * (x - y)), hunt(200.0 * (y - z))]
}

/// The cube root, replaced by a tangent for dark values.
fn response(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA {
        elementary::pow(t, 1.0 / 3.0)
    } else {
        t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
    }
}

/// The distance `HyAB` of two colours of [`hunt_lab`]: lightness alone, plus a and b together.
#[inline(always)]
pub(super) fn hyab(p: [f64; 3], q: [f64; 3]) -> f64 {
    let (l, a, b) = (p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    l.abs() + (a * a + b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: [f64; 3], expected: [f64; 3], within: f64) {
        let off = [0, 1, 2].map(|i| (found[i] - expected[i]).abs());
        assert!(off.iter().all(|&off| off < within), "{found:?} against {expected:?}");
    }

    #[test]
    fn white_black_and_back() {
        near(opponent([1.0; 3]), [100.0, 0.0, 0.0], 2e-5);
        near(opponent([0.0; 3]), [-16.0, 0.0, 0.0], 1e-12);
        near(hunt_lab([1.0; 3]), [100.0, 0.0, 0.0], 2e-5);
        near(hunt_lab([0.0; 3]), [0.0, 0.0, 0.0], 1e-12);
        let color = [0.25, 0.5, 0.125];
        near(clamped_rgb(opponent(color)), color, 1e-7);
        near(clamped_rgb(opponent([1.5, -0.5, 0.5])), [1.0, 0.0, 0.5], 1e-7);
    }

    /// Lab of the primaries of sRGB as in colour tables: L, a, b to two digits.
    #[test]
    fn the_primaries_have_the_lab_of_tables() {
        let tables = [
            ([1.0, 0.0, 0.0], [53.24, 80.09, 67.20]),
            ([0.0, 1.0, 0.0], [87.73, -86.18, 83.18]),
            ([0.0, 0.0, 1.0], [32.30, 79.19, -107.86]),
        ];
        for (rgb, [l, a, b]) in tables {
            near(hunt_lab(rgb), [l, a * l / 100.0, b * l / 100.0], 0.03);
        }
        assert!((hyab([1.0, 2.0, 3.0], [0.0, 5.0, 7.0]) - 6.0).abs() < 1e-15);
    }
}
