//! The table of a study: comma-separated values (RFC 4180), a row for each candidate.

use crate::study::run::{Record, Study};
use std::fmt::Write;

/// The table of a study, with a column for each figure of these names. Unknown values are empty.
///
/// The first columns are `options`, `method`, `surfels`, `prepare_ms` (groups and order, once),
/// `pictures` (how many were timed), and `quartile1_ms`, `median_ms`, `quartile3_ms` of a picture.
#[must_use]
pub fn csv(study: &Study, figures: &[&str]) -> String {
    let head = [
        "options",
        "method",
        "surfels",
        "prepare_ms",
        "pictures",
        "quartile1_ms",
        "median_ms",
        "quartile3_ms",
    ];
    let head: Vec<&str> = head.into_iter().chain(figures.iter().copied()).collect();
    let mut out = head.join(",") + "\r\n";
    for record in &study.candidates {
        let cells: Vec<String> = cells(record, figures).iter().map(|cell| quoted(cell)).collect();
        let _ = write!(out, "{}\r\n", cells.join(","));
    }
    out
}

fn cells(record: &Record, figures: &[&str]) -> Vec<String> {
    let known = |value: Option<String>| value.unwrap_or_default();
    let measured = record.measured.as_ref();
    let mut cells = vec![
        record.options.clone(),
        record.method.clone(),
        known(measured.map(|measured| measured.surfels.to_string())),
        known(measured.map(|measured| measured.prepared.to_string())),
        record.times.len().to_string(),
    ];
    let quartiles = record.quartiles();
    cells.extend((0..3).map(|i| known(quartiles.map(|quartiles| quartiles[i].to_string()))));
    cells.extend(
        figures.iter().map(|name| known(record.figure(name).map(|value| value.to_string()))),
    );
    cells
}

/// A cell, quoted if its text needs it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}
