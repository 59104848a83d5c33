//! How evenly prefixes of several orders are spread: a table, and the violins of \[BJFM19, Fig. 3\].
//!
//! What is measured is defined by [`mod@crate::source::sampler::quality`] and
//! [`mod@crate::source::sampler::spectrum`]; lengths here are the square roots in f64. Quantiles are those of
//! [`super::chart::violin`].
//!
//! The figure has the "minimum relative point distances"; to what they are relative is not said. `Decided:` the
//! unit of a prefix is the largest least distance that one of the orders has there. So it is the distance that no
//! two points of the best order are below: of the exact greedy order, if that is among them, which is what the
//! text compares with. Where the unit is 0 there are no relative lengths.

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

/// Points in an order, and what they are called.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordered {
    /// A word for tables and charts.
    pub name: String,
    /// The points.
    pub points: Vec<Vec3>,
}

/// How the first points of an order are spread. Lengths are in world units.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// What the order is called.
    pub name: String,
    /// The distance of each point to the nearest other, ascending.
    pub nearest: Vec<f64>,
    /// The largest distance of any point to the nearest of the prefix.
    pub covering: f64,
    /// The spectrum, if it was asked for.
    pub spectrum: Option<Spectrum>,
}

/// The spreads of all orders at a prefix.
#[derive(Clone, Debug, PartialEq)]
pub struct AtPrefix {
    /// How many points it has.
    pub prefix: usize,
    /// The largest least distance, in world units: the unit of what is relative.
    pub unit: f64,
    /// One for each order.
    pub spreads: Vec<Spread>,
}

impl Spread {
    /// The least distance of two points.
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

/// Measures prefixes of orders. Each covers its own points, or those `of` which all were chosen.
/// `progress` is told the name of a step, how many prefixes of orders are done, and of how many.
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
        // A prefix covers itself, so that its points may stand before those that it is to cover.
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
