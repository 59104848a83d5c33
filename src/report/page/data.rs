//! What the script of a page reads, as JSON.

use super::packed::{Channel, Packed, TabPlanes};
use super::{Explained, Mark, Measure, Report, Shown, Tab};
use crate::error::{Error, Result};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct Data<'a> {
    size: [u32; 2],
    sides: [&'a str; 2],
    measure: &'a Measure,
    doubts: &'a [(u8, &'static str)],
    cause: Option<&'a str>,
    /// The plane of bytes that says which pixels are exact.
    exact: Option<usize>,
    /// Whether the errors of other pixels are rounded.
    rounded: bool,
    channels: &'a BTreeMap<String, Channel>,
    tabs: Vec<TabData<'a>>,
    /// By the index of the pixel.
    explained: BTreeMap<usize, &'a Explained>,
}

#[derive(Serialize)]
struct TabData<'a> {
    name: &'a str,
    says: &'a str,
    mark: Mark,
    planes: &'a [Shown],
    #[serde(flatten)]
    packed: &'a TabPlanes,
    /// Each listed pixel, its error, and what is wrong there.
    worst: Vec<(usize, String, &'a str)>,
}

/// The data of a page, where nothing looks like the end of its element.
pub(super) fn json(report: &Report, packed: &Packed) -> Result<String> {
    let [picture, _] = &report.pictures;
    let tabs = report.tabs.iter().zip(&packed.tabs);
    let data = Data {
        size: [picture.width, picture.height],
        sides: report.sides,
        measure: &report.measure,
        doubts: &report.doubts,
        cause: report.cause.as_deref(),
        exact: packed.exact,
        rounded: packed.rounded,
        channels: &packed.channels,
        tabs: tabs.map(|(tab, packed)| tab_data(report, tab, packed)).collect(),
        explained: report.explained.iter().map(|one| (one.pixel, one)).collect(),
    };
    // serde_json writes `<` nowhere but in texts.
    let text = serde_json::to_string(&data);
    let text = text.map_err(|error| Error::Invalid(error.to_string()))?;
    Ok(text.replace('<', "\\u003c"))
}

fn tab_data<'a>(report: &'a Report, tab: &'a Tab, packed: &'a TabPlanes) -> TabData<'a> {
    let worst = tab.worst.iter().map(|&pixel| {
        let at = |other: &&Explained| other.pixel == pixel;
        let checks = report.explained.iter().find(at).map_or([].as_slice(), |at| &at.checks);
        let wrong = checks.iter().filter(|check| check.word == "WRONG" && check.stage == tab.name);
        let says = wrong.reduce(|worst, other| if other.size > worst.size { other } else { worst });
        let says = says.map_or("", |check| check.says.as_str());
        (pixel, tab.errors[pixel].to_string(), says)
    });
    let worst = worst.collect();
    TabData { name: &tab.name, says: &tab.says, mark: tab.mark, planes: &tab.planes, packed, worst }
}
