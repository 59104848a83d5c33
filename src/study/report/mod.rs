//! The files of a study: a table, a chart and a page.
//!
//! - [`csv`]: a row for each candidate.
//! - [`mod@chart`]: time against error, with the front.
//! - [`page`]: the chart; a click on a point shows its picture beside the truth.

pub mod chart;
pub mod csv;
pub mod page;
#[cfg(test)]
mod tests;
