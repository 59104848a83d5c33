//! Draws the chart: a panel of violins for each prefix and, if they were measured, the spectra
//! below.

use super::{AtPrefix, Spread};
use crate::error::{Error, Result};
use crate::source::sampler::Spectrum;
use crate::study::chart::axis::Axis;
use crate::study::chart::text::{shortened, width};
use crate::study::chart::{Anchor, COLORS, DASHES, Drawing, GRID, INK, Label, Stroke, violin};

/// The largest number of orders: one for each colour.
pub const MOST_ORDERS: usize = COLORS.len();
/// The largest number of panels side by side.
pub const MOST_PREFIXES: usize = 8;
/// The longest relative length; a longer one would squeeze the rest.
pub const MOST_UNITS: f64 = 1e4;

const LEFT: f64 = 76.0;
const RIGHT: f64 = 20.0;
/// The gap between panels.
const GAP: f64 = 24.0;
/// The least and the largest width of a violin; names choose between them.
const SLOT: [f64; 2] = [84.0, 140.0];
/// Half the width of a violin, and the distance of the covering radius from its middle.
const HALF: f64 = 28.0;
const BESIDE: f64 = 35.0;
/// The least width of a panel, with a spectrum and without.
const LEAST: [f64; 2] = [220.0, 150.0];
const TOP: f64 = 64.0;
const HEIGHT: f64 = 250.0;
/// The gap between the panels of violins and of spectra.
const BETWEEN: f64 = 120.0;
const SPECTRUM: f64 = 170.0;
/// The font size of the names of violins, and of the notes below.
const SMALL: f64 = 11.0;
const GRID_LINE: Stroke = Stroke { color: GRID, width: 1.0, dash: &[] };
const FRAME: Stroke = Stroke { color: INK, width: 1.0, dash: &[] };

/// The left and the right of a panel, and its content.
type Panel<'a> = ([f64; 2], &'a AtPrefix);

/// Draws the chart of some prefixes of the same orders.
///
/// # Errors
/// [`Error::Invalid`] if there are more than [`MOST_PREFIXES`] prefixes or [`MOST_ORDERS`] orders,
/// or none; if a unit is 0; or if a length exceeds [`MOST_UNITS`].
pub fn chart(found: &[AtPrefix]) -> Result<Drawing> {
    let orders = found.first().map_or(0, |at| at.spreads.len());
    if !(1..=MOST_PREFIXES).contains(&found.len()) || !(1..=MOST_ORDERS).contains(&orders) {
        let (n, m) = (found.len(), MOST_PREFIXES);
        return Err(Error::Invalid(format!(
            "a chart of {n} prefixes of {orders} orders; give 1 to {m} of 1 to {MOST_ORDERS}"
        )));
    }
    if let Some(at) = found.iter().find(|at| !(at.unit > 0.0)) {
        let what = "every order has two points at one place, so no distance is relative";
        return Err(Error::Invalid(format!("prefix {}: {what}", at.prefix)));
    }
    if let Some(at) = found.iter().find(|at| !(greatest(at) <= MOST_UNITS)) {
        let what = format!("a distance is over {MOST_UNITS} times the largest least distance");
        return Err(Error::Invalid(format!("prefix {}: {what}, too much for a chart", at.prefix)));
    }
    let spectra = found.iter().all(|at| at.spreads.iter().all(|s| s.spectrum.is_some()));
    let least = LEAST[usize::from(!spectra)];
    let names = found.iter().flat_map(|at| &at.spreads).map(|s| width(&s.name, SMALL) + 8.0);
    let slot = names.fold(SLOT[0], larger);
    let slot = if slot < SLOT[1] { slot } else { SLOT[1] };
    let notes = notes(spectra);
    let said = notes.iter().map(|note| width(note, SMALL)).fold(0.0, larger);
    let (n, gaps) = (found.len() as f64, GAP * (found.len() - 1) as f64);
    let wide = larger(larger(slot * orders as f64, least), (said - gaps) / n);
    let panels: Vec<Panel<'_>> = found
        .iter()
        .enumerate()
        .map(|(i, at)| {
            let left = LEFT + (wide + GAP) * i as f64;
            ([left, left + wide], at)
        })
        .collect();
    let right = LEFT + (wide + GAP) * found.len() as f64 - GAP;
    let below = TOP + HEIGHT + if spectra { BETWEEN + SPECTRUM + 54.0 } else { 40.0 };
    let size = [(right + RIGHT).ceil() as u32, (below + 16.0 * notes.len() as f64 + 4.0) as u32];
    let title = "Distance to the nearest other point of a prefix";
    let mut out = Drawing::new(size, title, &notes.join(" "));
    out.text([LEFT, 24.0], &Label { size: 15.0, ..Label::new(title, Anchor::Start) });
    violins(&mut out, &panels);
    if spectra {
        curves(&mut out, &panels);
    }
    for (i, note) in notes.iter().enumerate() {
        let label = Label { size: SMALL, ..Label::new(note, Anchor::Start) };
        out.text([LEFT, below + 16.0 * i as f64], &label);
    }
    Ok(out)
}

fn notes(spectra: bool) -> Vec<&'static str> {
    let mut notes = vec![
        "Unit: the largest least distance among the orders of a panel.",
        "Box: quartiles and median. Line: least to largest. Diamond: covering radius,",
        "the largest distance of any point to the prefix. Violins are equally wide.",
    ];
    if spectra {
        notes.push("Spectra: 1 is a sampling by chance. The unit of a frequency is the densest");
        notes.push("packing of as many points an area in a plane.");
    }
    notes
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The largest length of a prefix, in its unit.
fn greatest(at: &AtPrefix) -> f64 {
    let nearest = |s: &Spread| s.nearest.last().copied().unwrap_or(0.0);
    let lengths = at.spreads.iter().flat_map(|s| [s.covering, nearest(s)]);
    lengths.fold(0.0, larger) / at.unit
}

/// Draws the upper row.
fn violins(out: &mut Drawing, panels: &[Panel<'_>]) {
    let most = panels.iter().map(|(_, at)| greatest(at)).fold(0.0, larger);
    let axis = Axis::from_zero(most, [TOP + HEIGHT, TOP]);
    rows(out, &axis, panels, "distance / unit");
    for ([left, right], at) in panels {
        let head = format!("{} points", at.prefix);
        let middle = (left + right) / 2.0;
        out.text([middle, TOP - 10.0], &Label::new(&head, Anchor::Middle));
        let slot = (right - left) / at.spreads.len() as f64;
        for (i, (spread, color)) in at.spreads.iter().zip(COLORS).enumerate() {
            let x = left + slot * (i as f64 + 0.5);
            let relative: Vec<f64> = spread.nearest.iter().map(|d| d / at.unit).collect();
            violin::draw(out, &relative, &axis, x, HALF, color);
            let (side, y, r) = (x + BESIDE, axis.at(spread.covering / at.unit), 5.0);
            let diamond = [[side, y - r], [side + r, y], [side, y + r], [side - r, y]];
            out.surface(diamond, [255; 3], Some(Stroke::solid(color, 1.75)));
            let name = shortened(&spread.name, SMALL, slot - 6.0);
            let label = Label { size: SMALL, ..Label::new(&name, Anchor::Middle) };
            out.text([x, TOP + HEIGHT + 18.0], &label);
        }
    }
}

/// Draws the lower row, with a sample of each line above it.
fn curves(out: &mut Drawing, panels: &[Panel<'_>]) {
    let top = TOP + HEIGHT + BETWEEN;
    let spectra = |at: &AtPrefix| at.spreads.iter().filter_map(|s| s.spectrum.clone()).collect();
    let all: Vec<Vec<_>> = panels.iter().map(|(_, at)| spectra(at)).collect();
    let powers = all.iter().flatten().flat_map(|spectrum| &spectrum.power);
    let axis = Axis::from_zero(powers.fold(1.0, |a, b| larger(a, *b)), [top + SPECTRUM, top]);
    let title = "Radial power spectrum";
    let head = Label { size: 15.0, ..Label::new(title, Anchor::Start) };
    out.text([LEFT, top - 62.0], &head);
    legend(out, panels, top - 34.0);
    rows(out, &axis, panels, "power");
    for (([left, right], _), spectra) in panels.iter().zip(&all) {
        let last = Spectrum::frequencies().last().unwrap_or(1.0);
        let across = Axis { values: [0.0, last], places: [*left, *right] };
        for tick in 0..=last as u32 {
            let x = across.at(f64::from(tick));
            out.line([[x, top + SPECTRUM], [x, top + SPECTRUM + 4.0]], FRAME);
            let word = tick.to_string();
            let label = Label { size: SMALL, ..Label::new(&word, Anchor::Middle) };
            out.text([x, top + SPECTRUM + 16.0], &label);
        }
        let label = Label { size: SMALL, ..Label::new("frequency \u{d7} unit", Anchor::Middle) };
        out.text([(left + right) / 2.0, top + SPECTRUM + 32.0], &label);
        let one = axis.at(1.0);
        out.line([[*left, one], [*right, one]], Stroke::solid([0x80; 3], 1.0));
        for ((spectrum, color), dash) in spectra.iter().zip(COLORS).zip(DASHES) {
            // Values below 0 come from rounding, and from the estimate of the density.
            let at = |(f, p): (f64, &f64)| [across.at(f), axis.at(if *p < 0.0 { 0.0 } else { *p })];
            let points = Spectrum::frequencies().zip(&spectrum.power).map(at);
            out.line(points, Stroke { color, width: 1.75, dash });
        }
    }
}

/// Draws a sample of each order's line with its name, as many as fit.
fn legend(out: &mut Drawing, panels: &[Panel<'_>], y: f64) {
    let (Some((_, at)), Some(([_, right], _))) = (panels.first(), panels.last()) else { return };
    let share = (right - LEFT) / at.spreads.len() as f64;
    for (i, (spread, color)) in at.spreads.iter().zip(COLORS).enumerate() {
        let x = LEFT + share * i as f64;
        out.line(
            [[x, y - 4.0], [x + 34.0, y - 4.0]],
            Stroke { color, width: 1.75, dash: DASHES[i] },
        );
        let name = shortened(&spread.name, SMALL, share - 46.0);
        out.text([x + 40.0, y], &Label { size: SMALL, ..Label::new(&name, Anchor::Start) });
    }
}

/// Draws the grid lines through all panels of a row, their numbers and the title of the axis.
fn rows(out: &mut Drawing, axis: &Axis, panels: &[Panel<'_>], title: &str) {
    for tick in axis.ticks() {
        let y = axis.at(tick);
        for ([left, right], _) in panels {
            out.line([[*left, y], [*right, y]], if tick == 0.0 { FRAME } else { GRID_LINE });
        }
        let word = axis.word(tick);
        let label = Label { size: SMALL, ..Label::new(&word, Anchor::End) };
        out.text([LEFT - 6.0, y + 4.0], &label);
    }
    let middle = (axis.places[0] + axis.places[1]) / 2.0;
    let label = Label { size: 12.0, turned: true, ..Label::new(title, Anchor::Middle) };
    out.text([18.0, middle], &label);
}
