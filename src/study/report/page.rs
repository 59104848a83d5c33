//! The page of a study: a click on a point of the chart shows its picture beside the truth and the
//! difference, with zoom, blink and slider. The page loads nothing from the network, and its policy
//! tells the browser so.

use super::chart::points;
use crate::study::chart::Drawing;
use crate::study::chart::escaped;
use crate::study::run::{Loss, Record, Study};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// The data of the script.
#[derive(Serialize)]
struct Data<'a> {
    size: [u32; 2],
    truth: String,
    columns: Vec<&'a str>,
    /// The index of the candidate to show first.
    first: usize,
    candidates: Vec<CandidateRow<'a>>,
}

#[derive(Serialize)]
struct CandidateRow<'a> {
    options: &'a str,
    front: bool,
    values: Vec<Option<f64>>,
    picture: String,
}

/// Writes the page of a study: its chart and these figures of all candidates that were timed and
/// measured. The truth and the picture of each candidate are PNG files; the picture of a candidate
/// that is not shown may be empty.
#[must_use]
pub fn page(
    study: &Study,
    chart: &Drawing,
    loss: &Loss,
    figures: &[&str],
    truth: &[u8],
    pictures: &[Vec<u8>],
) -> String {
    let front = study.front(|record| loss.value(record));
    let shown: Vec<usize> = points(study, loss).into_iter().map(|(i, _)| i).collect();
    let candidate = |&i: &usize| {
        let record = &study.candidates[i];
        CandidateRow {
            options: &record.options,
            front: front.contains(&i),
            values: values(record, figures),
            picture: inline(&pictures[i]),
        }
    };
    let data = Data {
        size: study.of.size,
        truth: inline(truth),
        columns: ["ms"].into_iter().chain(figures.iter().copied()).collect(),
        first: front.first().and_then(|i| shown.iter().position(|s| s == i)).unwrap_or(0),
        candidates: shown.iter().map(candidate).collect(),
    };
    // Nothing in the script may look like its end tag; serde_json writes no other `<`.
    let data = serde_json::to_string(&data).unwrap_or_default().replace('<', "\\u003c");
    let title = format!("{}: speed against accuracy", study.of.scene);
    let about = format!("Truth: {}. Times: {}.", study.of.truth, study.machine);
    let texts = [
        ("title", escaped(&title)),
        ("about", escaped(&about)),
        ("chart", chart.svg()),
        ("data", data),
        ("script", include_str!("page.js").to_owned()),
    ];
    filled(include_str!("page.html"), &texts)
}

fn values(record: &Record, figures: &[&str]) -> Vec<Option<f64>> {
    let median = record.quartiles().map(|[_, median, _]| median);
    [median].into_iter().chain(figures.iter().map(|name| record.figure(name))).collect()
}

/// A PNG as a data URL.
#[must_use]
pub fn inline(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// Fills in a template: `{{name}}` becomes the text of that name. Inserted text is not searched
/// again.
#[must_use]
pub fn filled(template: &str, texts: &[(&str, String)]) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or(("", part));
        let text = texts.iter().find(|(known, _)| *known == name);
        out.push_str(text.map_or("", |(_, text)| text));
        out.push_str(rest);
    }
    out
}
