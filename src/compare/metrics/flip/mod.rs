//! FLIP: measure the difference that an observer sees who flips between two pictures \[ANA+20\].
//!
//! Both pictures are linear RGB, clamped to [0, 1] as a display clips them: -inf is 0, +inf is 1.
//! The published input is sRGB, which the first step makes linear. There are p pixels to a degree
//! of the visual angle. The steps, pixel by pixel:
//!
//! 1. *Opponent colours.* XYZ of linear sRGB in parts of white, then Y = 116 Y - 16,
//!    Cx = 500 (X - Y), Cz = 200 (Y - Z).
//! 2. *What the eye resolves.* The contrast sensitivity function of each channel filters it: a
//!    Gaussian a sqrt(pi/b) exp(-pi^2 x^2/b) of x degrees, and two for Cz. The filters end at 3
//!    sqrt(0.04/(2 pi^2)) p pixels, rounded up. The result is made RGB again and clamped to [0, 1].
//! 3. *Colour.* In CIE Lab, with a and b multiplied by L/100 (Hunt), the distance `HyAB` of the two
//!    pictures is |dL| + sqrt(da^2 + db^2). d is this distance to the power 0.7. m is the same
//!    number for green and blue, the two colours farthest apart. The colour difference is 0.95
//!    d/(0.4 m) where d < 0.4 m, else 0.95 + 0.05 (d - 0.4 m)/(m - 0.4 m).
//! 4. *Features.* (Y + 16)/116 of step 1 is filtered by the first (edges) and second (points)
//!    derivatives of a Gaussian of 0.041 p pixels, ended at three times that. This gives the length
//!    of the gradient, and of the vector of second derivatives. Take the difference of either
//!    length between the pictures. f is the greater difference, divided by sqrt 2, to the power
//!    0.5.
//! 5. FLIP is the colour difference to the power 1 - f: 0 where nothing is seen, at most 1.
//!
//! Beyond the border, the pixel at the border is repeated. The colour difference is not clamped
//! again, so rounding may make it a little more than 1.
//!
//! `Decided:` the form is the authors' reference implementation, version 1.7, evaluated in f64
//! where theirs is f32. It takes over the digits of the matrices, separable filters with sum 1, and
//! separate sums of positive and negative weights for derivatives. It takes floats, so that nothing
//! is quantized. `ppd` is 67 by default as in the reference, 0.7 m from a display 0.7 m wide of
//! 3840 pixels. The same picture twice gives exactly 0, and either picture may be called the
//! reference.
//!
//! [ANA+20]: https://doi.org/10.1145/3406183

mod color;
mod filter;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::memory;
use crate::number::MapInline;
use crate::number::elementary;
use filter::{Eye, Feature, along_column, along_row};
use std::ops::Range;

/// The default number of pixels to a degree of the visual angle.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Rows that are filtered together. Neighbouring bands filter their shared rows along x again.
const BAND: usize = 64;

/// The visible difference of two pictures, see the [page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean over the pixels, in [0, 1], of the numbers before they are rounded. NaN if a colour
    /// is NaN, or if there is no pixel.
    pub mean: f64,
    /// FLIP of each pixel, in [0, 1]. NaN if a colour within reach of a filter is NaN.
    pub map: Plane<f32>,
}

/// Computes FLIP of two pictures in linear RGB.
///
/// # Errors
/// [`Error::Invalid`] if the pictures differ in size, if `pixels_per_degree` is not in [1, 1000], or
/// if there is not enough memory.
pub fn flip(
    picture: &Plane<[f32; 3]>,
    reference: &Plane<[f32; 3]>,
    pixels_per_degree: f64,
    exec: &Exec,
) -> Result<Flip> {
    super::same_size(picture, reference)?;
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        return Err(Error::Invalid(format!(
            "FLIP at {pixels_per_degree} pixels per degree; give a number from 1 to 1000"
        )));
    }
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let observer = Observer::new(pixels_per_degree);
    let of_a_band = (BAND + 2 * observer.reach) * width * 2 * 7 * size_of::<f64>();
    let bytes = of_a_band * exec.threads() + width * height * size_of::<f32>();
    memory::ask(bytes as u64, || format!("FLIP of {width} x {height} pixels"))?;
    let mut map = Plane::filled(picture.width(), picture.height(), 0.0_f32);
    let bands = map.values_mut().chunks_mut((width * BAND).max(1)).enumerate();
    let sums = exec.ordered(bands.collect(), |(band, pixels): (usize, &mut [f32])| {
        let rows = band * BAND..height.min((band + 1) * BAND);
        observer.band([picture, reference], rows, pixels)
    });
    let sum: f64 = sums.iter().flatten().sum();
    Ok(Flip { mean: sum / (width * height) as f64, map })
}

/// The parts that do not depend on the pictures.
struct Observer {
    eye: Eye,
    feature: Feature,
    /// Pixels that a filter reaches to either side.
    reach: usize,
    /// The colour difference of green and blue, to the power of [`Self::COLOR`].
    greatest: f64,
}

/// The opponent colours of some rows of a picture, filtered along x.
struct Rows {
    /// The number of the first row.
    first: usize,
    rows: Vec<FilteredRow>,
}

struct FilteredRow {
    eye: [Vec<f64>; 4],
    feature: [Vec<f64>; 3],
}

impl Observer {
    /// The exponents of colour and feature differences.
    const COLOR: f64 = 0.7;
    const FEATURE: f64 = 0.5;
    /// This part of the greatest colour difference is mapped to ...
    const KNEE: f64 = 0.4;
    /// ... this colour difference.
    const AT_KNEE: f64 = 0.95;

    fn new(pixels_per_degree: f64) -> Self {
        let (eye, feature) = (Eye::new(pixels_per_degree), Feature::new(pixels_per_degree));
        let reach = (eye.0[0].len() / 2).max(feature.0[0].len() / 2);
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map_inline(color::hunt_lab);
        let greatest = elementary::pow(color::hyab(green, blue), Self::COLOR);
        Self { eye, feature, reach, greatest }
    }

    /// Writes FLIP of some rows, and returns the sum of each row.
    fn band(
        &self,
        pictures: [&Plane<[f32; 3]>; 2],
        rows: Range<usize>,
        out: &mut [f32],
    ) -> Vec<f64> {
        let width = pictures[0].width() as usize;
        let height = pictures[0].height() as usize;
        let near = rows.start.saturating_sub(self.reach)..height.min(rows.end + self.reach);
        let filtered = pictures.map(|picture| Rows {
            first: near.start,
            rows: near.clone().map(|y| self.row(picture, y)).collect(),
        });
        let sums = rows.zip(out.chunks_exact_mut(width)).map(|(y, out)| {
            let [p, q] = filtered.each_ref().map(|rows| self.seen(rows, y, width));
            let mut sum = 0.0;
            for (x, value) in out.iter_mut().enumerate() {
                let of = self.difference([p.lab[x], q.lab[x]], [p.features[x], q.features[x]]);
                sum += of;
                *value = of as f32;
            }
            sum
        });
        sums.collect()
    }

    /// Filters the opponent colours of a row along x.
    fn row(&self, picture: &Plane<[f32; 3]>, y: usize) -> FilteredRow {
        let width = picture.width() as usize;
        let colors = &picture.values()[y * width..(y + 1) * width];
        let opponents: Vec<[f64; 3]> = colors
            .iter()
            .map(|&[r, g, b]| color::opponent(color::clamped([r.into(), g.into(), b.into()])))
            .collect();
        let longer = |of: &dyn Fn([f64; 3]) -> f64| -> Vec<f64> {
            let inside = |x: usize| x.saturating_sub(self.reach).min(width - 1);
            (0..width + 2 * self.reach).map(|x| of(opponents[inside(x)])).collect()
        };
        let [y, cx, cz, gray] = [
            longer(&|[y, _, _]| y),
            longer(&|[_, cx, _]| cx),
            longer(&|[_, _, cz]| cz),
            longer(&|[y, _, _]| (y + 16.0) / 116.0),
        ];
        let eye = [(&y, 0), (&cx, 1), (&cz, 2), (&cz, 3)];
        FilteredRow {
            eye: eye.map(|(row, i)| along_row(row, &self.eye.0[i], width)),
            feature: [0, 1, 2].map(|i| along_row(&gray, &self.feature.0[i], width)),
        }
    }

    /// Filters along y, and returns the quantities of one row to compare.
    fn seen(&self, rows: &Rows, y: usize, width: usize) -> Seen {
        let last = rows.rows.len() - 1;
        let under = |weights: &[f64], of: &dyn Fn(&FilteredRow) -> &Vec<f64>| {
            let radius = weights.len() / 2;
            let near = (0..weights.len()).map(|k| {
                // The rows end at the border of the picture, or beyond the filter's reach.
                let at = (y + k).saturating_sub(rows.first + radius).min(last);
                of(&rows.rows[at]).as_slice()
            });
            along_column(near, weights, width)
        };
        let eye = |i: usize| under(&self.eye.0[i], &|row| &row.eye[i]);
        let (lightness, cx, first, second) = (eye(0), eye(1), eye(2), eye(3));
        let [gauss, edge, point] = &self.feature.0;
        let (dx, ddx) =
            (under(gauss, &|row| &row.feature[1]), under(gauss, &|row| &row.feature[2]));
        let (dy, ddy) = (under(edge, &|row| &row.feature[0]), under(point, &|row| &row.feature[0]));
        let length = |a: f64, b: f64| (a * a + b * b).sqrt();
        let lab = |x: usize| {
            let opponent = [lightness[x], cx[x], first[x] + second[x]];
            color::hunt_lab(color::clamped_rgb(opponent))
        };
        Seen {
            lab: (0..width).map(lab).collect(),
            features: (0..width).map(|x| [length(dx[x], dy[x]), length(ddx[x], ddy[x])]).collect(),
        }
    }

    /// FLIP of one pixel.
    fn difference(&self, [p, q]: [[f64; 3]; 2], features: [[f64; 2]; 2]) -> f64 {
        let (greatest, knee) = (self.greatest, Self::KNEE * self.greatest);
        let distance = elementary::pow(color::hyab(p, q), Self::COLOR);
        let color = if distance < knee {
            Self::AT_KNEE * distance / knee
        } else {
            Self::AT_KNEE + (1.0 - Self::AT_KNEE) * (distance - knee) / (greatest - knee)
        };
        let edge = (features[0][0] - features[1][0]).abs();
        let point = (features[0][1] - features[1][1]).abs();
        let greater = if point > edge { point } else { edge };
        let feature = elementary::pow(greater * std::f64::consts::FRAC_1_SQRT_2, Self::FEATURE);
        elementary::pow(color, 1.0 - feature)
    }
}

/// The quantities of one row of a picture that are compared.
struct Seen {
    /// The colours that the eye resolves.
    lab: Vec<[f64; 3]>,
    /// The strength of edges and of points.
    features: Vec<[f64; 2]>,
}
