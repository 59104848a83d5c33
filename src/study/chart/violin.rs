//! Violins: the width of a surface shows the density of values; a box inside shows the quartiles.
//!
//! Of n ascending values x, in f64:
//!
//! ```text
//!   quantile(t) = x[min(floor(t n), n - 1)]          t = 1/4, 1/2, 3/4
//!   s           = sqrt(sum of (x - mean)^2 / n)      sums in ascending order
//!   r           = (quantile(3/4) - quantile(1/4)) / 1.34
//!   h           = 0.9 min(s, r) n^(-1/5), of s alone where r is 0    [Silverman 1986, 3.31]
//!   density(v)  = sum over |x - v| <= 5 h of exp(-((x - v) / h)^2 / 2)
//! ```
//!
//! The density is taken at 129 places from the least to the greatest value, so that a violin ends where the
//! values end, and is drawn as wide as it is, divided by the greatest. All are equally wide then, however
//! many values they have. Equal values have no density but a line.

use super::{Drawing, Rgb, Stroke, axis::Axis, tint};
use crate::number::elementary::{exp, pow};

/// Places at which a density is taken.
const PLACES: usize = 129;

/// The quantile of ascending values; see the [module](self).
///
/// # Panics
/// If there is no value.
#[must_use]
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    let rank = (share * ascending.len() as f64) as usize;
    ascending[rank.min(ascending.len() - 1)]
}

/// The values and their densities; the largest density is 1. Empty for equal values, or for none.
#[must_use]
pub fn density(ascending: &[f64]) -> Vec<[f64; 2]> {
    let ([least, .., greatest], n) = (ascending, ascending.len() as f64) else {
        return Vec::new();
    };
    if !(least < greatest) {
        return Vec::new();
    }
    let mean = ascending.iter().sum::<f64>() / n;
    let squares: f64 = ascending.iter().map(|x| (x - mean) * (x - mean)).sum();
    let s = (squares / n).sqrt();
    let r = (quantile(ascending, 0.75) - quantile(ascending, 0.25)) / 1.34;
    let h = 0.9 * if r > 0.0 && r < s { r } else { s } * pow(n, -0.2);
    let at = |i: usize| {
        let v = least + (greatest - least) * i as f64 / (PLACES - 1) as f64;
        let from = ascending.partition_point(|x| *x < v - 5.0 * h);
        let to = ascending.partition_point(|x| *x <= v + 5.0 * h);
        let part = |x: &f64| exp(-((x - v) / h) * ((x - v) / h) / 2.0);
        [v, ascending[from..to].iter().map(part).sum()]
    };
    let found: Vec<[f64; 2]> = (0..PLACES).map(at).collect();
    let most = found.iter().fold(0.0, |most, [_, d]| if *d > most { *d } else { most });
    found.into_iter().map(|[v, d]| [v, d / most]).collect()
}

/// Draws a violin around x, at most `half` px to each side: a surface, a line from the least to the
/// largest value, a box between the quartiles, and the median as a white line.
pub fn draw(out: &mut Drawing, ascending: &[f64], y: &Axis, x: f64, half: f64, color: Rgb) {
    let (Some(&least), Some(&greatest)) = (ascending.first(), ascending.last()) else { return };
    let edge = Stroke::solid(color, 1.25);
    let density = density(ascending);
    let side = |sign: f64| move |&[v, d]: &[f64; 2]| [x + sign * half * d, y.at(v)];
    let right = density.iter().map(side(1.0));
    let left = density.iter().rev().map(side(-1.0));
    if density.is_empty() {
        out.line([[x - half, y.at(least)], [x + half, y.at(least)]], Stroke::solid(color, 3.0));
        return;
    }
    out.surface(right.chain(left), tint(color, 0.3), Some(edge));
    out.line([[x, y.at(least)], [x, y.at(greatest)]], edge);
    let [low, median, high] = [0.25, 0.5, 0.75].map(|share| y.at(quantile(ascending, share)));
    let width = 6.0;
    out.surface(
        [[x - width, low], [x + width, low], [x + width, high], [x - width, high]],
        color,
        None,
    );
    let across = [[x - width, median], [x + width, median]];
    out.line(across, Stroke::solid([255; 3], 2.5));
}
