//! Charts of a sweep: one line for each series, with values at equal distances in their order.

use super::axis::Axis;
use super::{Anchor, COLORS, DASHES, Drawing, GRID, INK, Label, Stroke};

/// A chart of a sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The title.
    pub title: String,
    /// The swept parameter and the measured error, each with its unit.
    pub axes: [String; 2],
    /// The swept values, as text.
    pub at: Vec<String>,
    /// The lines, at most one for each of [`COLORS`].
    pub series: Vec<Series>,
    /// The limit; values above it are failures.
    pub limit: f64,
}

/// A line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// One value for each swept value.
    pub values: Vec<f64>,
}

/// The width and height, and the left, top, right and bottom of the plot.
const SIZE: [u32; 2] = [640, 320];
const PLOT: [f64; 4] = [84.0, 66.0, 620.0, 256.0];
const SMALL: f64 = 11.0;
const KEY: f64 = 150.0;

impl Sweep {
    /// Draws the chart. Values that are not finite are drawn at the top.
    #[must_use]
    pub fn draw(&self) -> Drawing {
        let [left, top, right, bottom] = PLOT;
        let mut out = Drawing::new(SIZE, &self.title, &self.axes.join(" against "));
        let most = self.series.iter().flat_map(|series| &series.values).chain([&self.limit]);
        let most = most.filter(|v| v.is_finite()).fold(0.0, |a, b| if *b > a { *b } else { a });
        let y = Axis::from_zero(most, [bottom, top]);
        let step = (right - left) / self.at.len() as f64;
        let x = |i: usize| left + (i as f64 + 0.5) * step;
        out.text([left, 22.0], &Label { size: 15.0, ..Label::new(&self.title, Anchor::Start) });
        let line = |from, to, stroke, out: &mut Drawing| out.line([from, to], stroke);
        for tick in y.ticks() {
            let at = y.at(tick);
            line([left, at], [right, at], Stroke::solid(GRID, 1.0), &mut out);
            out.text([left - 7.0, at + 4.0], &small(&y.word(tick), Anchor::End));
        }
        let limit = y.at(self.limit);
        let dashed = Stroke { color: INK, width: 1.0, dash: &[3.0, 3.0] };
        line([left, limit], [right, limit], dashed, &mut out);
        for (i, word) in self.at.iter().enumerate() {
            out.text([x(i), bottom + 17.0], &small(word, Anchor::Middle));
        }
        out.line([[left, top], [left, bottom], [right, bottom]], Stroke::solid(INK, 1.0));
        let middle = [f64::midpoint(left, right), f64::midpoint(top, bottom)];
        out.text([middle[0], bottom + 42.0], &small(&self.axes[0], Anchor::Middle));
        let turned = Label { turned: true, ..small(&self.axes[1], Anchor::Middle) };
        out.text([18.0, middle[1]], &turned);
        for (k, series) in self.series.iter().enumerate() {
            let stroke = Stroke { color: COLORS[k % 6], width: 2.0, dash: DASHES[k % 6] };
            let place = |(i, v): (usize, &f64)| [x(i), if v.is_finite() { y.at(*v) } else { top }];
            out.line(series.values.iter().enumerate().map(place), stroke);
            let key = left + KEY * k as f64;
            line([key, 42.0], [key + 28.0, 42.0], stroke, &mut out);
            out.text([key + 34.0, 46.0], &small(&series.name, Anchor::Start));
        }
        let key = left + KEY * self.series.len() as f64;
        line([key, 42.0], [key + 28.0, 42.0], dashed, &mut out);
        out.text([key + 34.0, 46.0], &small("limit", Anchor::Start));
        out
    }
}

fn small(text: &str, anchor: Anchor) -> Label<'_> {
    Label { size: SMALL, ..Label::new(text, anchor) }
}
