//! Figures as losses.

use super::record::Record;

/// What is up in a chart: a figure as a loss, of which less is better.
#[derive(Clone, Debug)]
pub struct Loss {
    /// What it is called, with its unit.
    pub title: String,
    /// The name of the figure.
    pub figure: &'static str,
    /// The loss of a value of it.
    pub of: fn(f64) -> f64,
}

impl Loss {
    /// The loss of a candidate, if its figure is known.
    #[must_use]
    pub fn value(&self, record: &Record) -> Option<f64> {
        record.figure(self.figure).map(self.of)
    }
}
