//! The page: the chart, where a click on a point shows its picture beside the truth and the
//! difference, with zoom, blink and slider. It asks nothing of the network, and its policy says so to
//! the browser.

use super::chart::points;
use crate::study::chart::Drawing;
use crate::study::chart::escaped;
use crate::study::run::{Loss, Record, Study};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// What the script is given.
#[derive(Serialize)]
struct Data<'a> {
    size: [u32; 2],
    truth: String,
    columns: Vec<&'a str>,
    /// Which candidate is shown first.
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

/// The page of a study: of what was timed and measured, with its chart and these figures. The truth
/// and the picture of each candidate, one that is not shown may be empty, are files in PNG.
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
    // Nothing in a script may look like its end; serde_json writes no other `<`.
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

/// A PNG as the address of an image.
fn inline(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// A template with texts in the places of their names, `{{name}}`; what is put in is not looked at
/// again.
fn filled(template: &str, texts: &[(&str, String)]) -> String {
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
