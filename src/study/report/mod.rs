//! A study as files: a table, a chart and a page.
//!
//! - [`csv`]: a row a candidate.
//! - [`mod@chart`]: time against error, with the front.
//! - [`page`]: the chart, where a click on a point shows its picture beside the truth.

pub mod chart;
pub mod csv;
pub mod page;
#[cfg(test)]
mod tests;
