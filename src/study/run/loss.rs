//! Figures as losses.

use super::record::Record;

/// A figure on the y axis, as a loss: smaller is better.
#[derive(Clone, Debug)]
pub struct Loss {
    /// Its title, with its unit.
    pub title: String,
    /// The name of the figure.
    pub figure: &'static str,
    /// Turns a value of the figure into a loss.
    pub of: fn(f64) -> f64,
}

impl Loss {
    /// The loss of a candidate, if its figure is known.
    #[must_use]
    pub fn value(&self, record: &Record) -> Option<f64> {
        record.figure(self.figure).map(self.of)
    }
}
