//! FLIP: how different two pictures look to somebody who flips from one to the other.
//!
//! After \[ANA+20\] (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: *FLIP: A
//! Difference Evaluator for Alternating Images*, Proc. ACM CGIT 3(2), 2020), in the form of the
//! authors' program for pictures of a display. Both pictures are linear RGB, each value cut to \[0,
//! 1\] (a NaN is 0). With p pixels a degree of the field of view:
//!
//! 1. **Opponent colours**: XYZ of D65 ([`XYZ`]), divided by the white X, Y, Z of RGB (1, 1, 1), and
//!    `Y = 116 Y' - 16, Cx = 500 (X' - Y'), Cz = 200 (Y' - Z')`.
//! 2. **What the eye resolves**: each of the three is filtered by a sum of Gaussians of the distance x in
//!    degrees, `a sqrt(pi / b) exp(-pi^2 x^2 / b)`, with (a, b) = (1, 0.0047) for Y, (1, 0.0053) for
//!    Cx, (34.1, 0.04) and (13.5, 0.025) for Cz, over offsets up to `ceil(3 sqrt(0.04 / (2 pi^2)) p)` px,
//!    divided by the sum of its weights. Back to RGB ([`RGB`]), cut to \[0, 1\] again.
//! 3. **Difference of colours**: L*, a*, b* of CIE 1976, the latter two times `0.01 L*` (Hunt effect);
//!    `d = (|dL| + sqrt(da^2 + db^2))^0.7`. With m that of green and blue, `d` is `0.95 d / (0.4 m)` below
//!    `0.4 m`, else `0.95 + 0.05 (d - 0.4 m) / (0.6 m)`.
//! 4. **Difference of features**, of `(Y + 16) / 116` of step 1: with s = 0.041 p px and g the Gaussian
//!    of s over offsets up to ceil(3 s), edges are the responses to `-x g` along each axis, points those
//!    to `(x^2 / s^2 - 1) g`, both times g across; positive and negative weights are each divided by
//!    their sum. The lengths of the two responses are compared: `f = (max(|de|, |dp|) / sqrt(2))^0.5`.
//! 5. The difference is `d^(1 - f)`, from 0 to 1.
//!
//! Beyond the border the nearest pixel continues. All in f64, sums from the lowest offset up, along x
//! first; powers from [`crate::number::elementary`].

use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::memory;
use crate::number::elementary::{exp, pow};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Pixels a degree of the field of view: 0.7 m before a display that is 0.7 m wide and has 3840
/// pixels, as the authors have it.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Rows of X, Y and Z of linear sRGB, as fractions that the authors give.
pub const XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
/// Rows of R, G and B of XYZ: the inverse.
pub const RGB: [[f64; 3]; 3] = [
    [3.241_003_232_976_358, -1.537_398_969_488_785, -0.498_615_881_996_363],
    [-0.969_224_252_202_516, 1.875_929_983_695_176, 0.041_554_226_340_085],
    [0.055_639_419_851_975, -0.204_011_206_123_910, 1.057_148_977_187_533],
];

type Colors = Vec<[f64; 3]>;

/// The difference at each pixel, from 0 to 1; its mean is the figure.
///
/// # Errors
/// As [`Seen::of`] and [`Seen::differences`].
pub fn flip(
    picture: &Plane<[f32; 3]>,
    reference: &Plane<[f32; 3]>,
    pixels_per_degree: f64,
    exec: &Exec,
) -> Result<Plane<f32>> {
    let seen = |plane| Seen::of(plane, pixels_per_degree, exec);
    seen(picture)?.differences(&seen(reference)?, exec)
}

/// The mean of the differences.
#[must_use]
pub fn mean(differences: &Plane<f32>) -> f64 {
    let values = differences.values();
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

/// What of a picture is compared: steps 1 to 4, which need no other picture.
#[derive(Clone, Debug)]
pub struct Seen {
    width: u32,
    height: u32,
    /// Step 3: L*, a* and b*.
    lab: Colors,
    /// Step 4: the responses to edges and to points.
    features: Vec<[f64; 2]>,
}

impl Seen {
    /// Of a picture that is seen at so many pixels a degree.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the process may not hold what it takes.
    pub fn of(plane: &Plane<[f32; 3]>, pixels_per_degree: f64, exec: &Exec) -> Result<Self> {
        let [width, height] = [plane.width(), plane.height()];
        memory::ask(u64::from(width) * u64::from(height) * 180, || "FLIP".into())?;
        let grid = Grid { width: width as usize, height: height as usize, exec };
        let opponent =
            grid.each(plane.values(), |rgb| opponent(xyz(rgb.map(|v| cut(f64::from(v))))));
        let filtered = resolved(&opponent, &grid, pixels_per_degree);
        let lab = grid.each(&filtered, |color| lab(rgb(color)));
        let features = features(&opponent, &grid, pixels_per_degree);
        Ok(Self { width, height, lab, features })
    }

    /// The difference at each pixel, from 0 to 1.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the pictures are not of one size.
    pub fn differences(&self, other: &Self, exec: &Exec) -> Result<Plane<f32>> {
        let (width, height) = (self.width, self.height);
        if (other.width, other.height) != (width, height) {
            return Err(Error::Invalid("FLIP compares pictures of one size".into()));
        }
        let most = hyab(lab([0.0, 1.0, 0.0]), lab([0.0, 0.0, 1.0]));
        let row = |y: usize| -> Vec<f32> {
            let pixels = y * width as usize..(y + 1) * width as usize;
            pixels.map(|i| difference(self, other, i, most) as f32 + 0.0).collect()
        };
        let rows = exec.ordered((0..height as usize).collect(), row);
        Ok(Plane::from_values(width, height, rows.concat()))
    }
}

fn difference(a: &Seen, b: &Seen, i: usize, most: f64) -> f64 {
    let of_colors = hyab(a.lab[i], b.lab[i]);
    let knee = 0.4 * most;
    let of_colors = if of_colors < knee {
        of_colors * (0.95 / knee)
    } else {
        0.95 + (of_colors - knee) / (most - knee) * 0.05
    };
    let [edges, points] = [0, 1].map(|kind| (a.features[i][kind] - b.features[i][kind]).abs());
    // Most pixels of most pictures are equal, and powers take long.
    if of_colors == 0.0 && edges == 0.0 && points == 0.0 {
        return 0.0;
    }
    let of_features = pow(FRAC_1_SQRT_2 * if edges > points { edges } else { points }, 0.5);
    pow(of_colors, 1.0 - of_features)
}

/// A value cut to [0, 1]; a NaN is 0.
fn cut(value: f64) -> f64 {
    if value > 0.0 { if value < 1.0 { value } else { 1.0 } } else { 0.0 }
}

fn transformed(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| (row[0] * v[0] + row[1] * v[1]) + row[2] * v[2])
}

/// X, Y and Z divided by those of white.
fn xyz(rgb: [f64; 3]) -> [f64; 3] {
    let (v, white) = (transformed(&XYZ, rgb), transformed(&XYZ, [1.0; 3]));
    [0, 1, 2].map(|c| v[c] / white[c])
}

fn opponent([x, y, z]: [f64; 3]) -> [f64; 3] {
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Linear RGB, cut to [0, 1], of opponent colours.
fn rgb([luminance, red, blue]: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let white = transformed(&XYZ, [1.0; 3]);
    let v = [y + red / 500.0, y, y - blue / 200.0];
    transformed(&RGB, [0, 1, 2].map(|c| v[c] * white[c])).map(cut)
}

/// L*, and a* and b* adjusted to it.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            pow(t, 1.0 / 3.0)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = xyz(rgb).map(root);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * (500.0 * (x - y)), hunt * (200.0 * (y - z))]
}

/// The difference of two adjusted colours, to the power of 0.7.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, r, g] = [0, 1, 2].map(|c| a[c] - b[c]);
    let distance = l.abs() + (r * r + g * g).sqrt();
    if distance > 0.0 { pow(distance, 0.7) } else { 0.0 }
}

/// What filters run over.
struct Grid<'e> {
    width: usize,
    height: usize,
    exec: &'e Exec,
}

impl Grid<'_> {
    /// Something of each value.
    fn each<T: Copy + Sync, U: Clone + Send>(
        &self,
        values: &[T],
        of: impl Fn(T) -> U + Sync,
    ) -> Vec<U> {
        let row = |row: &[T]| row.iter().map(|value| of(*value)).collect::<Vec<U>>();
        self.exec.ordered(values.chunks(self.width).collect(), row).concat()
    }

    /// The sums of weights times values at offsets along rows.
    fn across<const N: usize>(&self, values: &[[f64; N]], weights: &[[f64; N]]) -> Vec<[f64; N]> {
        let reach = weights.len() / 2;
        let row = |row: &[[f64; N]]| {
            // The row with its ends continued.
            let last = row.len() - 1;
            let wide = (0..row.len() + 2 * reach).map(|i| row[i.saturating_sub(reach).min(last)]);
            let wide: Vec<[f64; N]> = wide.collect();
            let mut sums = vec![[0.0; N]; row.len()];
            for (k, weights) in weights.iter().enumerate() {
                add(&mut sums, &wide[k..k + row.len()], weights);
            }
            sums
        };
        self.exec.ordered(values.chunks(self.width).collect(), row).concat()
    }

    /// The same along columns.
    fn down<const N: usize>(&self, values: &[[f64; N]], weights: &[[f64; N]]) -> Vec<[f64; N]> {
        let reach = weights.len() / 2;
        let row = |y: usize| {
            let mut sums = vec![[0.0; N]; self.width];
            for (k, weights) in weights.iter().enumerate() {
                let at = (y + k).saturating_sub(reach).min(self.height - 1);
                add(&mut sums, &values[at * self.width..(at + 1) * self.width], weights);
            }
            sums
        };
        self.exec.ordered((0..self.height).collect(), row).concat()
    }
}

/// Adds weights times values.
fn add<const N: usize>(sums: &mut [[f64; N]], values: &[[f64; N]], weights: &[f64; N]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        for c in 0..N {
            sum[c] += weights[c] * value[c];
        }
    }
}

/// The weights of a filter at the offsets from -reach to reach px.
fn weights(reach: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=2 * reach).map(|k| of(k as f64 - reach as f64)).collect()
}

/// Divided by their sum.
fn normalized(weights: Vec<f64>) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// Step 2: opponent colours as far as the eye resolves them.
fn resolved(opponent: &[[f64; 3]], grid: &Grid<'_>, pixels_per_degree: f64) -> Colors {
    let reach = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
    let gaussian = |b: f64| {
        weights(reach, |x| {
            let degrees = x / pixels_per_degree;
            exp(-PI * PI * degrees * degrees / b)
        })
    };
    let [y, cx, wide, narrow] = [0.0047, 0.0053, 0.04, 0.025].map(gaussian);
    // Each Gaussian is a product of two; the sum of the weights of both of Cz is one.
    let whole = |weights: &[f64]| weights.iter().sum::<f64>() * weights.iter().sum::<f64>();
    let amounts = [(34.1, 0.04, &wide), (13.5, 0.025, &narrow)];
    let [wide_amount, narrow_amount] = amounts.map(|(a, b, _)| a * (PI / b).sqrt());
    let sum = wide_amount * whole(&wide) + narrow_amount * whole(&narrow);
    let shares = [wide_amount * whole(&wide) / sum, narrow_amount * whole(&narrow) / sum];
    let [y, cx, wide, narrow] = [y, cx, wide, narrow].map(normalized);
    let all: Vec<[f64; 4]> = (0..y.len()).map(|k| [y[k], cx[k], wide[k], narrow[k]]).collect();
    let four: Vec<[f64; 4]> = opponent.iter().map(|&[y, cx, cz]| [y, cx, cz, cz]).collect();
    let filtered = grid.down(&grid.across(&four, &all), &all);
    filtered
        .iter()
        .map(|&[y, cx, wide, narrow]| [y, cx, shares[0] * wide + shares[1] * narrow])
        .collect()
}

/// Step 4: the responses to edges and to points.
fn features(opponent: &[[f64; 3]], grid: &Grid<'_>, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let sigma = 0.5 * 0.082 * pixels_per_degree;
    let reach = (3.0 * sigma).ceil() as usize;
    let bell = |x: f64| exp(-(x * x) / (2.0 * sigma * sigma));
    let signed = |weights: Vec<f64>| {
        let above: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
        let below: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
        let share = |weight: f64| if weight < 0.0 { weight / below } else { weight / above };
        weights.into_iter().map(share).collect::<Vec<f64>>()
    };
    let across = normalized(weights(reach, bell));
    let edge = signed(weights(reach, |x| -x * bell(x)));
    let point = signed(weights(reach, |x| (x * x / (sigma * sigma) - 1.0) * bell(x)));
    let all = |of: [&[f64]; 4]| -> Vec<[f64; 4]> {
        (0..across.len()).map(|k| of.map(|weights| weights[k])).collect()
    };
    let luminance: Vec<[f64; 4]> = opponent.iter().map(|[y, ..]| [(y + 16.0) / 116.0; 4]).collect();
    let rows = grid.across(&luminance, &all([&edge, &across, &point, &across]));
    let both = grid.down(&rows, &all([&across, &edge, &across, &point]));
    let length = |a: f64, b: f64| (a * a + b * b).sqrt();
    both.iter().map(|&[ex, ey, px, py]| [length(ex, ey), length(px, py)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn exec() -> Exec {
        Exec::new(2, 16).unwrap()
    }

    fn linear(code: u8) -> f32 {
        let v = f64::from(code) / 255.0;
        (if v <= 0.04045 { v / 12.92 } else { pow((v + 0.055) / 1.055, 2.4) }) as f32
    }

    /// A picture of 8-bit codes, which `tests/data/flip` makes too.
    fn pattern(size: [u32; 2], kind: u32) -> Plane<[f32; 3]> {
        let code = |x: u32, y: u32, c: u32| -> u8 {
            let value = match kind {
                0 => x * 4 + y * 2 + c * 40,
                1 => (x + 1) * 4 + y * 2 + c * 40,
                2 => x * x * 7 + y * 13 + x * y * 3 + c * 91,
                3 => {
                    if (x / 8 + y / 8).is_multiple_of(2) {
                        200 + c * 20
                    } else {
                        30 + c * 60
                    }
                }
                _ => {
                    if ((x + 1) / 8).is_multiple_of(2) {
                        200 - c * 70
                    } else {
                        30 + c * 60
                    }
                }
            };
            (value % 256) as u8
        };
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let colors = pixels.map(|(x, y)| [0, 1, 2].map(|c| linear(code(x, y, c))));
        Plane::from_values(size[0], size[1], colors.collect())
    }

    type Printed = ([u32; 2], [u32; 2], f64, [f64; 3]);

    /// Printed by `tests/data/flip`: size, the two pictures, pixels a degree, mean, and the differences at two pixels.
    const REFERENCES: [Printed; 6] = [
        ([64, 48], [0, 1], 67.0, [0.21887226, 0.10537856, 0.2134741]),
        ([64, 48], [0, 2], 67.0, [0.784849, 0.84564114, 0.78701365]),
        ([64, 48], [3, 4], 67.0, [0.81834465, 0.9601556, 0.79354453]),
        ([37, 12], [3, 2], 67.0, [0.7986581, 0.96765876, 0.9511888]),
        ([90, 70], [4, 0], 30.0, [0.8186485, 0.9626842, 0.9593019]),
        ([90, 70], [2, 3], 100.0, [0.6767881, 0.9064995, 0.46601447]),
    ];

    /// The authors' program, by nv-flip 0.1.2, which computes in f32.
    #[test]
    fn the_authors_program_agrees() {
        for (size, [a, b], ppd, [mean_of, first, middle]) in REFERENCES {
            let found = flip(&pattern(size, a), &pattern(size, b), ppd, &exec()).unwrap();
            let near = |found: f64, expected: f64| (found - expected).abs() < 2e-5;
            let at = |x, y| f64::from(*found.at(x, y));
            assert!(near(mean(&found), mean_of), "{size:?} {a} {b}: {} {mean_of}", mean(&found));
            assert!(near(at(0, 0), first), "{size:?} {a} {b}: {} {first}", at(0, 0));
            assert!(near(at(size[0] / 2, size[1] / 3), middle), "{size:?} {a} {b}");
        }
    }

    #[test]
    fn the_matrices_are_inverse() {
        for i in 0..3 {
            let unit = [0, 1, 2].map(|c| f64::from(u8::from(c == i)));
            let back = transformed(&RGB, transformed(&XYZ, unit));
            (0..3).for_each(|c| assert!((back[c] - unit[c]).abs() < 1e-12, "{back:?}"));
        }
    }

    #[test]
    fn nothing_differs_from_itself_and_black_from_white_most() {
        let plane = |v: f32| Plane::filled(30, 20, [v; 3]);
        let of =
            |a: &Plane<_>, b: &Plane<_>| mean(&flip(a, b, PIXELS_PER_DEGREE, &exec()).unwrap());
        let a = pattern([33, 21], 2);
        assert_eq!(of(&a, &a), 0.0);
        assert!(of(&plane(0.0), &plane(1.0)) > 0.95);
        assert_eq!(of(&plane(0.0), &plane(-3.0)), 0.0, "what is below black is black");
        assert_eq!(of(&plane(1.0), &plane(f32::INFINITY)), 0.0);
        assert_eq!(of(&plane(0.0), &plane(f32::NAN)), 0.0);
        assert!(flip(&a, &plane(0.0), 67.0, &exec()).is_err());
    }

    proptest! {
        #[test]
        fn it_is_symmetric_and_from_0_to_1(
            colors in prop::collection::vec([0.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0], 2 * 35)
        ) {
            let half = colors.len() / 2;
            let plane = |c: &[[f32; 3]]| Plane::from_values(7, 5, c.to_vec());
            let (a, b) = (plane(&colors[..half]), plane(&colors[half..]));
            let [one, other] = [(&a, &b), (&b, &a)].map(|(a, b)| flip(a, b, 67.0, &Exec::sequential()).unwrap());
            prop_assert_eq!(&one, &other);
            prop_assert!(one.values().iter().all(|v| (0.0..=1.0).contains(v)));
        }
    }
}
