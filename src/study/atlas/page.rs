//! The page of the atlas, its charts and its pictures.

use super::{Curve, Failure};
use crate::frame::Plane;
use crate::study::chart::Drawing;
use crate::study::chart::curve::{Series, Sweep};
use std::fmt::Write;

/// The folder of charts and pictures beside the page.
pub const PICTURES: &str = "atlas";

/// The files of the page.
#[derive(Clone, Debug)]
pub struct Files {
    /// The page in Markdown.
    pub text: String,
    /// A chart for each failure, by its name.
    pub charts: Vec<(&'static str, Drawing)>,
    /// Pictures side by side, linear RGB, of each failure that has some.
    pub pictures: Vec<(&'static str, Plane<[f32; 3]>)>,
}

const INTRODUCTION: &str = "\
# The atlas of failures

This page shows where each method breaks, and what cures it. Every entry sweeps one parameter of a scene, and
measures an error. The entry breaks at the first value whose error exceeds the limit. The row *cured* shows the same
sweep with the cure. The pictures show the last value before the break, the broken value, and the broken value with
the cure. The truth is the exact surface at 8 x 8 samples a pixel, unless the entry names another truth.

The command `splatref study failures -o docs` writes this page. Its errors are the same on every machine, and a test
compares the page with them. The cost of a cure was measured on the machine that wrote the page,
at the value where the entry breaks.

Each number belongs to its scene. Another scene breaks elsewhere; `splatref study SCENE` shows where.
";

/// How lines begin whose numbers are of one machine.
const COST: &str = "The cure there takes";

/// The page of some failures, with what the cure of each costs where it breaks.
#[must_use]
pub fn page(curves: &[(Curve, Option<f64>)]) -> Files {
    let mut text = INTRODUCTION.to_owned();
    text.push_str("\n| failure | what is seen | swept | breaks at |\n|---|---|---|---|\n");
    for (curve, _) in curves {
        let Failure { id, title, swept, .. } = curve.of;
        let _ = writeln!(text, "| [{id}](#{id}) | {title} | {swept} | {} |", breaking(curve));
    }
    for (curve, cost) in curves {
        entry(&mut text, curve, *cost);
    }
    let charts = curves.iter().map(|(curve, _)| (curve.of.id, chart(curve))).collect();
    let pictures =
        curves.iter().filter_map(|(curve, _)| Some((curve.of.id, beside(&curve.pictures)?)));
    Files { text, charts, pictures: pictures.collect() }
}

fn breaking(curve: &Curve) -> String {
    curve.breaks.map_or_else(|| "-".into(), |at| curve.of.values[at].to_string())
}

fn entry(text: &mut String, curve: &Curve, cost: Option<f64>) {
    let Failure { id, title, why, swept, values, error, limit, cure, .. } = curve.of;
    let cells = |name: &str, cells: &mut dyn Iterator<Item = String>| {
        format!("| {name} | {} |\n", cells.collect::<Vec<_>>().join(" | "))
    };
    let _ = write!(text, "\n## {id}\n\n**{title}.** {why}\n\n");
    text.push_str(&cells(swept, &mut values.iter().map(ToString::to_string)));
    let _ = writeln!(text, "|---|{}", "---|".repeat(values.len()));
    text.push_str(&cells(error, &mut curve.plain.iter().map(|error| short(*error))));
    text.push_str(&cells("cured", &mut curve.cured.iter().map(|error| short(*error))));
    let _ = write!(text, "\nLimit: {limit}. Breaks at: {}.\nCure: {cure}.\n", breaking(curve));
    if let Some(cost) = cost {
        let _ = writeln!(text, "{COST} {cost:.1} times as long.");
    }
    let _ = writeln!(text, "\n![{title}: the error over the sweep]({PICTURES}/{id}.svg)");
    let shown = if curve.breaks.is_some() { "before, broken, cured" } else { "the last, cured" };
    let _ = writeln!(text, "\n![{title}: {shown}]({PICTURES}/{id}.png)");
}

/// A number with three digits that count.
pub(in crate::study) fn short(value: f64) -> String {
    format!("{value:.2e}").parse::<f64>().map_or_else(|_| value.to_string(), |v| v.to_string())
}

fn chart(curve: &Curve) -> Drawing {
    let Failure { title, swept, values, error, limit, .. } = curve.of;
    let series = |name: &str, errors: &[f64]| Series { name: name.into(), values: errors.to_vec() };
    let sweep = Sweep {
        title: (*title).into(),
        axes: [(*swept).into(), (*error).into()],
        at: values.iter().map(ToString::to_string).collect(),
        series: vec![series("as it is", &curve.plain), series("cured", &curve.cured)],
        limit: *limit,
    };
    sweep.draw()
}

/// Joins pictures side by side with a white gap; `None` without pictures.
#[must_use]
pub fn beside(pictures: &[Plane<[f32; 3]>]) -> Option<Plane<[f32; 3]>> {
    const GAP: u32 = 6;
    let high = pictures.iter().map(Plane::height).max()?;
    let wide: u32 = pictures.iter().map(|picture| picture.width() + GAP).sum::<u32>() - GAP;
    let mut all = Plane::filled(wide, high, [1.0; 3]);
    let mut left = 0;
    for picture in pictures {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        for y in 0..height {
            let to = y * wide as usize + left;
            all.values_mut()[to..to + width]
                .copy_from_slice(&picture.values()[y * width..(y + 1) * width]);
        }
        left += width + GAP as usize;
    }
    Some(all)
}

/// The page without the lines that differ between machines.
#[cfg(test)]
pub(super) fn lasting(page: &str) -> String {
    page.lines().filter(|line| !line.starts_with(COST)).collect::<Vec<_>>().join("\n")
}
