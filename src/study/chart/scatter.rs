//! Scatter charts: points on two logarithmic axes with their spread, a front, and a list of all
//! names.
//!
//! On both axes less is better. The marks of a series share a shape and a colour. Marks on the
//! front are filled, and joined by steps. A point on the front has its name beside it, and other
//! points their number if there is room. The list at the right shows the number, mark, name and
//! values of every point. A value without a place on a logarithmic axis, such as an error of 0,
//! appears only in the list.

use super::label::{self, Placed, Segment, Wanted};
use super::log::LogAxis;
use super::mark;
use super::text::{shortened, width};
use super::{Anchor, Drawing, GRID, INK, Label, Stroke};
use crate::study::front::front;

/// A point of a [`Scatter`].
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its name in the list.
    pub name: String,
    /// Its name beside its mark.
    pub short: String,
    /// The index of its series.
    pub series: usize,
    /// Its values on the x and the y axis.
    pub at: [f64; 2],
    /// The range of the x value.
    pub spread: [f64; 2],
}

/// The content of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// The title above the chart.
    pub title: String,
    /// The notes below it, line by line.
    pub notes: Vec<String>,
    /// The labels of the x and the y axis, with units.
    pub axes: [String; 2],
    /// The points, in the order of the list.
    pub points: Vec<Point>,
}

/// The left, top and right of the plot.
const PLOT: [f64; 3] = [76.0, 48.0, 676.0];
/// The least and the largest height of the plot; the list chooses between them.
const HEIGHT: [f64; 2] = [480.0, 720.0];
/// The distance from the plot to the notes below it.
const BELOW: f64 = 62.0;
const NOTE: f64 = 16.0;
const SMALL: f64 = 10.0;
/// The height of a row in the list.
const ROW: f64 = 14.0;
/// The radius in which a point answers the pointer.
const SPOT: f64 = 8.0;
/// The places of the numbers, marks and names in the list, from the right edge of the plot.
const COLUMNS: [f64; 3] = [44.0, 58.0, 70.0];
/// The largest width of a name, and the width of each value behind it.
const NAME: f64 = 330.0;
const VALUE: f64 = 64.0;
const GRID_LINE: Stroke = Stroke { color: GRID, width: 1.0, dash: &[] };
const FRAME: Stroke = Stroke { color: INK, width: 1.0, dash: &[] };
const FRONT: Stroke = Stroke { color: INK, width: 1.0, dash: &[5.0, 3.0] };

impl Scatter {
    /// Draws the chart.
    #[must_use]
    pub fn draw(&self) -> Drawing {
        let [left, top, right, bottom] = self.plot();
        let name = self.points.iter().map(|point| width(&point.name, SMALL)).fold(60.0, greater);
        let name = if name < NAME { name } else { NAME };
        let wide = right + COLUMNS[2] + name + 2.0 * VALUE + 24.0;
        let notes = bottom + BELOW;
        let high = greater(notes + NOTE * self.notes.len() as f64, self.list_end() + NOTE);
        let about = self.notes.join(" ");
        let mut out =
            Drawing::new([wide, high].map(|side| side.ceil() as u32), &self.title, &about);
        out.text([left, 26.0], &Label { size: 15.0, ..Label::new(&self.title, Anchor::Start) });
        let across = self.points.iter().flat_map(|point| point.spread);
        let axes = [
            LogAxis::around(across, [left, right]),
            LogAxis::around(self.points.iter().map(|point| point.at[1]), [bottom, top]),
        ];
        self.grid(&mut out, &axes);
        self.marks(&mut out, &axes);
        self.list(&mut out, name);
        for (i, note) in self.notes.iter().enumerate() {
            let label = Label { size: SMALL + 1.0, ..Label::new(note, Anchor::Start) };
            out.text([left, notes + NOTE * i as f64], &label);
        }
        out
    }

    /// The indices of the points on the front, by ascending x value.
    #[must_use]
    pub fn front(&self) -> Vec<usize> {
        front(&self.points.iter().map(|point| point.at).collect::<Vec<_>>())
    }

    /// The left, top, right and bottom of the plot; its height keeps the notes beside the list.
    fn plot(&self) -> [f64; 4] {
        let ([left, top, right], [least, most]) = (PLOT, HEIGHT);
        let room = self.list_end() - top - BELOW - NOTE * self.notes.len() as f64;
        let high = greater(room, least);
        [left, top, right, top + if high < most { high } else { most }]
    }

    /// The bottom of the list.
    fn list_end(&self) -> f64 {
        PLOT[1] + ROW * (self.points.len() + 1) as f64
    }

    fn grid(&self, out: &mut Drawing, axes: &[LogAxis; 2]) {
        let [left, top, right, bottom] = self.plot();
        for &tick in axes[0].ticks() {
            let x = axes[0].at(tick);
            out.line([[x, top], [x, bottom]], GRID_LINE);
            if let Some(word) = axes[0].word(tick) {
                out.text([x, bottom + 17.0], &small(&word, Anchor::Middle));
            }
        }
        for &tick in axes[1].ticks() {
            let y = axes[1].at(tick);
            out.line([[left, y], [right, y]], GRID_LINE);
            if let Some(word) = axes[1].word(tick) {
                out.text([left - 7.0, y + 4.0], &small(&word, Anchor::End));
            }
        }
        out.line([[left, top], [left, bottom], [right, bottom]], FRAME);
        out.text(
            [f64::midpoint(left, right), bottom + 38.0],
            &Label::new(&self.axes[0], Anchor::Middle),
        );
        let label = Label { turned: true, ..Label::new(&self.axes[1], Anchor::Middle) };
        out.text([20.0, f64::midpoint(top, bottom)], &label);
    }

    fn marks(&self, out: &mut Drawing, axes: &[LogAxis; 2]) {
        let [left, top, right, bottom] = self.plot();
        let has_place = |point: &Point| {
            let drawn = |value: f64, axis: &LogAxis| {
                let ticks = axis.ticks();
                value >= ticks[0] && value <= ticks[ticks.len() - 1]
            };
            (0..2).all(|axis| drawn(point.at[axis], &axes[axis]))
        };
        let place = |at: [f64; 2]| [0, 1].map(|axis: usize| axes[axis].at(at[axis]));
        let shown: Vec<usize> =
            (0..self.points.len()).filter(|&i| has_place(&self.points[i])).collect();
        let points: Vec<[f64; 2]> = shown.iter().map(|&i| place(self.points[i].at)).collect();
        let front: Vec<usize> =
            self.front().into_iter().filter_map(|i| shown.iter().position(|s| *s == i)).collect();
        let steps: Vec<[f64; 2]> = front
            .windows(2)
            .flat_map(|two| [points[two[0]], [points[two[1]][0], points[two[0]][1]]])
            .chain(front.last().map(|&last| points[last]))
            .collect();
        let mut lines: Vec<Segment> = steps.windows(2).map(|two| [two[0], two[1]]).collect();
        out.line(steps, FRONT);
        for (&i, &[x, y]) in shown.iter().zip(&points) {
            let Point { spread, series, .. } = &self.points[i];
            let bar = spread.map(|value| [axes[0].at(value), y]);
            if bar[1][0] > bar[0][0] {
                out.line(bar, Stroke::solid(mark::color(*series), 1.0));
                lines.push(bar);
            }
            let on_front = front.iter().any(|&f| shown[f] == i);
            mark::draw(out, [x, y], *series, on_front);
            out.spot([x, y], SPOT, i, &self.points[i].name);
        }
        let others = (0..shown.len()).filter(|i| !front.contains(i));
        let named = front.iter().map(|&i| {
            let names = vec![self.points[shown[i]].short.clone(), number(shown[i])];
            Wanted { point: i, texts: names }
        });
        let numbered = others.map(|i| Wanted { point: i, texts: vec![number(shown[i])] });
        let wanted: Vec<Wanted> = named.chain(numbered).collect();
        let placed = label::place(&wanted, SMALL, &points, &lines, [left, top, right, bottom]);
        for Placed { area, text, leader } in placed.into_iter().flatten() {
            if let Some(leader) = leader {
                out.line(leader, GRID_LINE);
            }
            out.text([area[0], area[1] + 0.8 * SMALL], &small(&text, Anchor::Start));
        }
    }

    fn list(&self, out: &mut Drawing, name: f64) {
        let [_, top, right] = PLOT;
        let columns = COLUMNS.map(|column| right + column);
        let values = [1.0, 2.0].map(|i| columns[2] + name + VALUE * i);
        for (axis, x) in self.axes.iter().zip(values) {
            let unit = shortened(axis.split([',', ' ']).next().unwrap_or(axis), SMALL, VALUE - 4.0);
            out.text([x, top], &small(&unit, Anchor::End));
        }
        let front = self.front();
        for (i, point) in self.points.iter().enumerate() {
            let y = top + ROW * (i + 1) as f64;
            out.text([columns[0], y], &small(&number(i), Anchor::End));
            mark::draw(out, [columns[1], y - 3.5], point.series, front.contains(&i));
            out.spot([columns[1], y - 3.5], ROW / 2.0, i, &point.name);
            out.text([columns[2], y], &small(&shortened(&point.name, SMALL, name), Anchor::Start));
            for (value, x) in point.at.into_iter().zip(values) {
                out.text([x, y], &small(&three(value), Anchor::End));
            }
        }
    }
}

fn small(text: &str, anchor: Anchor) -> Label<'_> {
    Label { size: SMALL, ..Label::new(text, anchor) }
}

/// The name of a point beside its mark.
fn number(index: usize) -> String {
    (index + 1).to_string()
}

/// A value with three digits.
fn three(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1000.0..1e6).contains(&value) {
        return format!("{value:.0}");
    }
    if !(1e-4..1e6).contains(&value) {
        return format!("{value:.2e}");
    }
    let digits = (0..7).find(|&digits| value >= [100.0, 10.0, 1.0, 0.1, 0.01, 0.001, 0.0][digits]);
    let digits = digits.unwrap_or(6);
    format!("{value:.digits$}")
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;

    /// As many points as a study has, as crowded as there.
    fn crowd(count: usize) -> Scatter {
        let random = |stream: u64, i: usize| f64::from(unit(stream, i as u64));
        let point = |i: usize| {
            let ms = 5.0 + 300.0 * random(1, i) * random(2, i) * random(3, i);
            let error = 0.01 + 0.04 * random(4, i);
            Point {
                name: format!("--method {} --setting {}", i % 9, i),
                short: format!("{} --setting {}", i % 9, i),
                series: i % 9,
                at: [ms, error],
                spread: [0.95 * ms, 1.1 * ms],
            }
        };
        Scatter {
            title: "crowd".into(),
            notes: vec!["a note".into(), "another".into()],
            axes: ["ms a picture".into(), "RMSE, linear RGB".into()],
            points: (0..count).map(point).collect(),
        }
    }

    #[test]
    fn a_crowd_is_readable() {
        for count in [0, 1, 2, 30, 70] {
            let chart = crowd(count);
            let drawing = chart.draw();
            drawing.assert_readable();
            let texts: Vec<&str> = drawing.boxes().iter().map(|(text, _)| *text).collect();
            for point in &chart.points {
                assert!(texts.contains(&point.name.as_str()), "{}", point.name);
            }
            for i in chart.front() {
                let found = texts.iter().filter(|text| **text == number(i)).count();
                assert!(
                    found == 2 || texts.contains(&chart.points[i].short.as_str()),
                    "{count} {i}"
                );
            }
        }
    }

    #[test]
    fn what_has_no_place_is_listed() {
        let mut chart = crowd(5);
        chart.points[1].at[1] = 0.0;
        chart.points[2].at[1] = f64::NAN;
        let drawing = chart.draw();
        drawing.assert_readable();
        let texts: Vec<&str> = drawing.boxes().iter().map(|(text, _)| *text).collect();
        assert!(texts.contains(&"NaN"));
        assert_eq!(texts.iter().filter(|text| **text == "2").count(), 1, "no mark");
        assert!(!drawing.svg().contains("NaN,") && !drawing.svg().contains("inf"));
    }

    #[test]
    fn three_digits() {
        let found = [0.0, 12.345, 1.2345, 0.012345, 0.0, 123.4, 12345.6, 0.00001234].map(three);
        assert_eq!(found, ["0", "12.3", "1.23", "0.0123", "0", "123", "12346", "1.23e-5"]);
    }
}
