//! Report on verdicts to people and programs: in about ten lines, as JSON, and as a page for a
//! browser.
//!
//! - [`VerdictReport`]: a verdict of [`Session::verify`](crate::method::Session::verify) as text,
//!   as JSON and as a page.
//! - [`page`]: one HTML file that shows two pictures and their errors.

pub mod page;
pub mod verdict;

pub use verdict::VerdictReport;

/// Rounds a number to five digits; small numbers have a power of ten.
#[must_use]
pub fn short(value: f64) -> String {
    let rounded = format!("{value:.4e}").parse().unwrap_or(value);
    match rounded {
        // -0 is printed as 0.
        0.0 => "0".into(),
        small if small.abs() < 1e-4 => format!("{small:e}"),
        other => format!("{other}"),
    }
}
