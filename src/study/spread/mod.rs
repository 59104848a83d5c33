//! How evenly prefixes of several orders cover a surface: a table, and the violins of \[BJFM19,
//! Fig. 3\].
//!
//! [`mod@crate::source::sampler::quality`] and [`mod@crate::source::sampler::spectrum`] define the
//! measures; lengths here are the square roots in f64. [`super::chart::violin`] defines the
//! quantiles.
//!
//! The figure shows the "minimum relative point distances", but the paper does not say what they
//! are relative to. `Decided:` the unit of a prefix is the largest least distance among the orders,
//! so no two points of the best order are closer. If the exact greedy order is among them, the unit
//! is its least distance, and the text compares with that order. If the unit is 0, there are no
//! relative lengths.

mod draw;
#[cfg(test)]
mod tests;

pub use draw::{MOST_ORDERS, MOST_PREFIXES, MOST_UNITS, chart};

use super::chart::violin::quantile;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::progress::Progress;
use crate::source::sampler::{Spectrum, quality, spectrum};
use glam::Vec3;

/// Points in an order, with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordered {
    /// The name for tables and charts.
    pub name: String,
    /// The points.
    pub points: Vec<Vec3>,
}

/// How evenly the first points of an order are spread. Lengths are in world units.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The name of the order.
    pub name: String,
    /// The distance of each point to its nearest neighbour, ascending.
    pub nearest: Vec<f64>,
    /// The covering radius: the largest distance of any point to the prefix.
    pub covering: f64,
    /// The spectrum, if it was requested.
    pub spectrum: Option<Spectrum>,
}

/// The results of all orders at one prefix.
#[derive(Clone, Debug, PartialEq)]
pub struct AtPrefix {
    /// The number of points.
    pub prefix: usize,
    /// The largest least distance in world units: the unit of relative lengths.
    pub unit: f64,
    /// One result for each order.
    pub spreads: Vec<Spread>,
}

impl Spread {
    /// The least distance between two points.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.nearest.first().copied().unwrap_or(f64::INFINITY)
    }

    /// The least distance, quartile, median, quartile and the covering radius.
    #[must_use]
    pub fn five(&self) -> [f64; 5] {
        let [low, median, high] = [0.25, 0.5, 0.75].map(|share| quantile(&self.nearest, share));
        [self.least(), low, median, high, self.covering]
    }
}

/// Measures prefixes of orders. Each prefix covers its own points, or the points `of` if they are
/// given. `progress` gets the name of a step, how many prefixes are done, and how many there are.
///
/// # Errors
/// [`Error::Invalid`] if a prefix has fewer than 2 points or more than an order, and as
/// [`quality()`] and, with `spectra`, as [`spectrum()`].
pub fn measure(
    orders: &[Ordered],
    of: Option<&[Vec3]>,
    prefixes: &[usize],
    spectra: bool,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Vec<AtPrefix>> {
    for Ordered { name, points } in orders {
        for &prefix in prefixes {
            if !(2..=points.len()).contains(&prefix) {
                let n = points.len();
                let what = format!("{name}: a prefix of {prefix} of {n} points; give 2 to {n}");
                return Err(Error::Invalid(what));
            }
        }
    }
    let total = (prefixes.len() * orders.len()) as u64;
    let mut done = 0;
    let mut found = Vec::with_capacity(prefixes.len());
    for &prefix in prefixes {
        let mut spreads = Vec::with_capacity(orders.len());
        for order in orders {
            progress("distances", done, total);
            spreads.push(order.spread(of, prefix, spectra, exec)?);
            done += 1;
        }
        let unit = spreads.iter().map(Spread::least).fold(0.0, |a, b| if b > a { b } else { a });
        found.push(AtPrefix { prefix, unit, spreads });
    }
    progress("distances", done, total);
    Ok(found)
}

impl Ordered {
    fn spread(
        &self,
        of: Option<&[Vec3]>,
        prefix: usize,
        spectra: bool,
        exec: &Exec,
    ) -> Result<Spread> {
        let named = |error| match error {
            Error::Invalid(what) => Error::Invalid(format!("{}: {what}", self.name)),
            other => other,
        };
        let first = &self.points[..prefix];
        // A prefix covers itself, so its points may precede the points to cover.
        let joined = of.map(|all| [first, all].concat());
        let indices: Vec<u32> = (0..prefix as u32).collect();
        let all = joined.as_deref().unwrap_or(&self.points);
        let found = quality(all, &indices, exec).map_err(named)?;
        let root = |d2: f32| f64::from(d2).sqrt();
        let mut nearest: Vec<f64> = found.nearest.into_iter().map(root).collect();
        nearest.sort_unstable_by(f64::total_cmp);
        let spectrum = spectra.then(|| spectrum(first, exec)).transpose().map_err(named)?;
        Ok(Spread { name: self.name.clone(), nearest, covering: root(found.covering), spectrum })
    }
}
