//! One HTML file that shows two pictures, their errors and the number of every pixel.
//!
//! [`Report`] says what the page shows, as plain data. [`html`] makes the page. It loads nothing
//! from outside, and its policy tells the browser so. The planes travel as compressed bytes, see
//! `packed`, so that the page prints the numbers themselves and not the colours on the screen.

mod data;
mod packed;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::{Exec, Image};
use crate::io::replace::Pending;
use crate::study::chart::escaped;
use crate::study::report::page::filled;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// The colours of all pages, by day and by night, as a style sheet.
pub const PALETTE: &str = include_str!("palette.css");
/// The largest page that is written, in bytes.
pub const LARGEST: usize = 10_000_000;
/// How many of the worst pixels of a wrong tab are listed.
pub const LISTED: usize = 20;

/// What a page shows.
#[derive(Debug)]
pub struct Report {
    /// The title of the page.
    pub title: String,
    /// Labels and texts at the top of the page, in this order.
    pub facts: Vec<(String, String)>,
    /// What the two pictures are, in a few sentences.
    pub about: String,
    /// The names of the two pictures: `Client` and `Reference`.
    pub sides: [&'static str; 2],
    /// The two pictures, of one size. Either may lack channels.
    pub pictures: [Image; 2],
    /// What the errors measure.
    pub measure: Measure,
    /// The stages or planes, in their order.
    pub tabs: Vec<Tab>,
    /// The bits of [`Tab::doubts`] and their names.
    pub doubts: Vec<(u8, &'static str)>,
    /// The likely cause of wrong pixels.
    pub cause: Option<String>,
    /// The decisions at the listed pixels.
    pub explained: Vec<Explained>,
}

/// What the errors of a page measure.
#[derive(Debug, Serialize)]
pub struct Measure {
    /// `Error in bounds`.
    pub name: &'static str,
    /// `bounds`; empty for a plain number.
    pub unit: &'static str,
    /// The largest right error, if one number holds for all pixels.
    pub limit: Option<f32>,
    /// What a pixel is called that is right, and one that is wrong.
    pub words: [&'static str; 2],
}

/// A stage, or a plane that is compared.
#[derive(Debug)]
pub struct Tab {
    /// The name of the stage or plane.
    pub name: String,
    /// What was found, in a sentence.
    pub says: String,
    /// The outcome.
    pub mark: Mark,
    /// The planes to show.
    pub planes: Vec<Shown>,
    /// The error at each pixel.
    pub errors: Vec<f32>,
    /// Whether each pixel is wrong.
    pub wrong: Vec<bool>,
    /// Undecided decisions at each pixel as bits; empty if there are none.
    pub doubts: Vec<u8>,
    /// The listed pixels, the worst first: indices of pixels, row by row.
    pub worst: Vec<usize>,
}

/// The outcome of a tab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// Every pixel is right.
    Right,
    /// A pixel is wrong.
    Wrong,
    /// Nothing was judged.
    NotJudged,
}

/// A plane of a tab.
#[derive(Debug, Serialize)]
pub struct Shown {
    /// The name of the plane.
    pub name: String,
    /// How its values become colours.
    pub kind: Kind,
    /// The unit of its values; empty if it has none.
    pub unit: &'static str,
    /// What a value means; may be empty.
    pub meaning: &'static str,
    /// The names of the channels in the pictures: one or three.
    pub channels: Vec<String>,
}

/// How the values of a plane become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Linear RGB.
    Color,
    /// A vector of any length.
    Vector,
    /// A unit vector.
    Normal,
    /// A depth, +inf where nothing is.
    Depth,
    /// A number.
    Scalar,
    /// The index of a surfel.
    Index,
    /// A small whole number.
    Count,
}

/// The decisions at a listed pixel.
#[derive(Debug, Serialize)]
pub struct Explained {
    /// The index of the pixel, row by row.
    #[serde(skip)]
    pub pixel: usize,
    /// The values that were checked.
    pub checks: Vec<CheckRow>,
    /// The decisions in words.
    pub text: String,
    /// The command that prints them.
    pub replay: String,
}

/// A value and the values that are right, as texts.
#[derive(Debug, Serialize)]
pub struct CheckRow {
    /// The name of the stage.
    pub stage: &'static str,
    /// `right`, `WRONG` or `open`.
    pub word: &'static str,
    /// The channel, its value, and the least and the largest right value; none for a finding that
    /// has no interval.
    pub interval: Option<[String; 4]>,
    /// The finding in words.
    pub says: String,
    /// The error with its unit; empty if there is none.
    pub error: String,
    /// The error.
    #[serde(skip)]
    pub size: f64,
}

impl Kind {
    /// The kind of a plane by the names that this program gives to planes.
    #[must_use]
    pub fn from_names(channels: &[String], is_index: bool) -> Self {
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
#[must_use]
pub fn worst(errors: &[f32], most: usize) -> Vec<usize> {
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
pub fn pending(path: &Path, report: &Report, exec: &Exec) -> Result<Pending> {
    let text = html(report, exec)?;
    Pending::write(path, |file| file.write_all(text.as_bytes()))
}

/// Writes a page as text.
///
/// # Errors
/// [`crate::Error::Invalid`] if the data cannot be written as JSON.
pub fn html(report: &Report, exec: &Exec) -> Result<String> {
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
            ("style", [PALETTE, include_str!("page.css")].concat()),
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
