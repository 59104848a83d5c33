//! One HTML file that shows two pictures, their errors and the number of every pixel.
//!
//! [`Report`] says what the page shows, as plain data. [`html`] makes the page. It loads nothing
//! from outside, and its policy tells the browser so. The planes travel as compressed bytes, see
//! [`packed`], so that the page prints the numbers themselves and not the colours on the screen.

mod data;
mod packed;
#[cfg(test)]
mod tests;

use serde::Serialize;
use splatref::Result;
use splatref::frame::{Exec, Image};
use splatref::io::replace::Pending;
use splatref::study::chart::escaped;
use splatref::study::report::page::filled;
use std::io::Write;
use std::path::Path;

/// The largest page that is written, in bytes.
pub(super) const LARGEST: usize = 10_000_000;
/// How many of the worst pixels of a wrong tab are listed.
pub(super) const LISTED: usize = 20;

/// What a page shows.
pub(super) struct Report {
    pub(super) title: String,
    /// Labels and texts at the top of the page, in this order.
    pub(super) facts: Vec<(String, String)>,
    /// What the two pictures are, in a few sentences.
    pub(super) about: String,
    /// The names of the two pictures: `Client` and `Reference`.
    pub(super) sides: [&'static str; 2],
    /// The two pictures, of one size. Either may lack channels.
    pub(super) pictures: [Image; 2],
    pub(super) measure: Measure,
    pub(super) tabs: Vec<Tab>,
    /// The bits of [`Tab::doubts`] and their names.
    pub(super) doubts: Vec<(u8, &'static str)>,
    /// The likely cause of wrong pixels.
    pub(super) cause: Option<String>,
    pub(super) explained: Vec<Explained>,
}

/// What the errors of a page measure.
#[derive(Serialize)]
pub(super) struct Measure {
    /// `Error in bounds`.
    pub(super) name: &'static str,
    /// `bounds`; empty for a plain number.
    pub(super) unit: &'static str,
    /// The largest right error, if one number holds for all pixels.
    pub(super) limit: Option<f32>,
    /// What a pixel is called that is right, and one that is wrong.
    pub(super) words: [&'static str; 2],
}

/// A stage, or a plane that is compared.
pub(super) struct Tab {
    pub(super) name: String,
    /// What was found, in a sentence.
    pub(super) says: String,
    pub(super) mark: Mark,
    pub(super) planes: Vec<Shown>,
    /// The error at each pixel.
    pub(super) errors: Vec<f32>,
    /// Whether each pixel is wrong.
    pub(super) wrong: Vec<bool>,
    /// Undecided decisions at each pixel as bits; empty if there are none.
    pub(super) doubts: Vec<u8>,
    /// The listed pixels, the worst first: indices of pixels, row by row.
    pub(super) worst: Vec<usize>,
}

/// The outcome of a tab.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Mark {
    Right,
    Wrong,
    NotJudged,
}

/// A plane of a tab.
#[derive(Serialize)]
pub(super) struct Shown {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) unit: &'static str,
    /// What a value means; may be empty.
    pub(super) meaning: &'static str,
    /// The names of the channels in the pictures: one or three.
    pub(super) channels: Vec<String>,
}

/// How the values of a plane become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    Color,
    Vector,
    Normal,
    Depth,
    Scalar,
    Index,
    Count,
}

/// The decisions at a listed pixel.
#[derive(Serialize)]
pub(super) struct Explained {
    /// The index of the pixel, row by row.
    #[serde(skip)]
    pub(super) pixel: usize,
    /// The values that were checked.
    pub(super) checks: Vec<CheckRow>,
    /// The decisions in words.
    pub(super) text: String,
    /// The command that prints them.
    pub(super) replay: String,
}

/// A value and the values that are right, as texts.
#[derive(Serialize)]
pub(super) struct CheckRow {
    pub(super) stage: &'static str,
    /// `right`, `WRONG` or `open`.
    pub(super) word: &'static str,
    /// The channel, its value, and the least and the largest right value; none for a finding that
    /// has no interval.
    pub(super) interval: Option<[String; 4]>,
    /// The finding in words.
    pub(super) says: String,
    /// The error with its unit; empty if there is none.
    pub(super) error: String,
    /// The error.
    #[serde(skip)]
    pub(super) size: f64,
}

impl Kind {
    /// The kind of a plane by the names that this program gives to planes.
    pub(super) fn from_names(channels: &[String], is_index: bool) -> Self {
        let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
        let first = channels.first().map_or("", String::as_str);
        let of_vector = first.strip_suffix(".X").map(last);
        match (channels.len(), of_vector.as_deref(), last(first).as_str()) {
            (3, Some("normal"), _) if first == "normal.X" => Self::Normal,
            (3, Some(_), _) => Self::Vector,
            (3, None, _) => Self::Color,
            (_, _, "count" | "stencil") if is_index => Self::Count,
            _ if is_index => Self::Index,
            (_, _, "Z") => Self::Depth,
            _ => Self::Scalar,
        }
    }
}

/// The indices of the `most` largest errors, the largest first. Pixels with the same error are
/// taken evenly from all of the picture, because the first ones lie side by side.
pub(super) fn worst(errors: &[f32], most: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > 0.0).collect();
    all.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
    if all.len() <= most {
        return all;
    }
    let last = errors[all[most - 1]];
    let before = all.partition_point(|&i| errors[i] > last);
    let ties = all.partition_point(|&i| errors[i] >= last) - before;
    let wanted = most - before;
    let spread: Vec<usize> = (0..wanted).map(|i| all[before + i * ties / wanted]).collect();
    all.truncate(before);
    all.extend(spread);
    all
}

/// Writes the page beside its place.
///
/// # Errors
/// As [`Pending::write`].
pub(super) fn pending(path: &Path, report: &Report, exec: &Exec) -> Result<Pending> {
    let text = html(report, exec)?;
    Pending::write(path, |file| file.write_all(text.as_bytes()))
}

/// Writes a page as text.
pub(super) fn html(report: &Report, exec: &Exec) -> Result<String> {
    html_within(report, LARGEST, exec)
}

/// The same, for a page of at most this many bytes, if its texts leave room.
fn html_within(report: &Report, largest: usize, exec: &Exec) -> Result<String> {
    let texts = |data: String, blobs: String| {
        let facts = report.facts.iter().map(|(label, text)| {
            format!("<dt>{}</dt><dd>{}</dd>\n", escaped(label), escaped(text))
        });
        [
            ("title", escaped(&report.title)),
            ("facts", facts.collect()),
            ("about", escaped(&report.about)),
            ("style", include_str!("page.css").to_owned()),
            (
                "script",
                concat!(include_str!("numbers.js"), "\n", include_str!("page.js")).to_owned(),
            ),
            ("data", data),
            ("blobs", blobs),
        ]
    };
    let template = include_str!("page.html");
    let page = |data, blobs| filled(template, &texts(data, blobs));
    // The room is measured with the data of a page without planes.
    let empty = page(data::json(report, &packed::Packed::none(report))?, String::new());
    let packed = packed::Packed::new(report, largest.saturating_sub(empty.len()), exec);
    Ok(page(data::json(report, &packed)?, packed.blobs()))
}
