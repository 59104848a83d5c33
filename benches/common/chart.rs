//! A chart with two logarithmic axes, as an SVG that reads on light and dark pages.

use std::fmt::Write;

/// One line of the chart: what it is called, and its points (x, y), one a step.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
}

/// An axis: its title with the unit, and the values at its ticks, of which the first and the last
/// are its ends.
pub(crate) struct Axis {
    pub(crate) title: &'static str,
    pub(crate) ticks: Vec<f64>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
/// Left, top, right and bottom of the plot.
const PLOT: [f64; 4] = [70.0, 40.0, 570.0, 385.0];
/// Colours that differ in lightness as well as in hue, the first six of [Okabe, Ito 2008].
pub(crate) const COLORS: [&str; 10] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7b61c9",
    "#808080", "#a3a81c",
];
pub(crate) const STYLE: &str = "\
.page { fill: #ffffff } .text { fill: #24292f; font: 13px sans-serif } .grid { stroke: #d0d7de }
@media (prefers-color-scheme: dark) {
  .page { fill: #0d1117 } .text { fill: #e6edf3 } .grid { stroke: #30363d }
}";

impl Axis {
    /// An axis of round numbers around all values.
    pub(crate) fn around(title: &'static str, values: impl Iterator<Item = f64> + Clone) -> Self {
        let least = values.clone().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let greatest = values.fold(0.0, |a, b| if b > a { b } else { a });
        let steps: Vec<f64> = (-6..=6)
            .flat_map(|power| {
                ["1", "1.5", "2", "3", "5", "7"].map(|digit| format!("{digit}e{power}"))
            })
            .filter_map(|step| step.parse().ok())
            .collect();
        // Of no values, as where a pattern leaves nothing, some axis.
        let most = steps.len() - 1;
        let first = steps.partition_point(|&step| step <= least).saturating_sub(1).min(most - 1);
        let last = steps.partition_point(|&step| step < greatest).clamp(first + 1, most);
        Self { title, ticks: steps[first..=last].to_vec() }
    }

    /// Where a value lies, from 0 at the first tick to 1 at the last.
    fn at(&self, value: f64) -> f64 {
        let [first, last] = [self.ticks[0], self.ticks[self.ticks.len() - 1]];
        log(value / first) / log(last / first)
    }
}

fn log(value: f64) -> f64 {
    splatref::number::elementary::ln(value)
}

/// The chart. The marks of a series are joined in their order and grow from step to step; `steps`
/// are a title and the names of the steps. Without names all marks are of one size.
pub(crate) fn svg(
    title: &str,
    [x, y]: [&Axis; 2],
    series: &[Series],
    steps: (&str, &[&str]),
) -> String {
    let [left, top, right, bottom] = PLOT;
    let across = |v: f64| left + x.at(v) * (right - left);
    let up = |v: f64| bottom - y.at(v) * (bottom - top);
    let mut out = Svg::default();
    out.element(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\">\n\
         <title>{title}</title>\n<style>\n{STYLE}\n</style>\n\
         <rect class=\"page\" width=\"{WIDTH}\" height=\"{HEIGHT}\" rx=\"6\"/>"
    ));
    out.text(left, 22.0, "start", title);
    for &tick in &x.ticks {
        out.line([across(tick), top, across(tick), bottom]);
        out.text(across(tick), bottom + 18.0, "middle", &tick.to_string());
    }
    for &tick in &y.ticks {
        out.line([left, up(tick), right, up(tick)]);
        out.text(left - 6.0, up(tick) + 4.0, "end", &tick.to_string());
    }
    out.text((left + right) / 2.0, bottom + 42.0, "middle", x.title);
    let middle = (top + bottom) / 2.0;
    out.element(&format!(
        "<text class=\"text\" text-anchor=\"middle\" \
         transform=\"translate(16 {middle}) rotate(-90)\">{}</text>",
        y.title
    ));
    for ((index, Series { name, points }), color) in series.iter().enumerate().zip(COLORS) {
        let places: Vec<_> = points.iter().map(|&[x, y]| (across(x), up(y))).collect();
        let joined: Vec<_> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        out.element(&format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            joined.join(" ")
        ));
        for (step, (x, y)) in places.iter().enumerate() {
            out.disc(*x, *y, radius(if steps.1.is_empty() { 0 } else { step }), color);
        }
        let row = top + 8.0 + 22.0 * index as f64;
        out.disc(right + 22.0, row, 4.0, color);
        out.text(right + 36.0, row + 4.0, "start", name);
    }
    let first = top + 30.0 + 22.0 * series.len() as f64;
    out.text(right + 14.0, first, "start", steps.0);
    for (step, name) in steps.1.iter().enumerate() {
        let row = first + 22.0 * (step + 1) as f64;
        out.disc(right + 22.0, row - 4.0, radius(step), "#808080");
        out.text(right + 36.0, row, "start", name);
    }
    out.finish()
}

/// The radius of a mark, in px.
fn radius(step: usize) -> f64 {
    2.5 + 1.5 * step as f64
}

/// The elements so far, one a line.
#[derive(Default)]
pub(crate) struct Svg(String);

impl Svg {
    /// The whole file.
    pub(crate) fn finish(self) -> String {
        self.0 + "</svg>\n"
    }

    pub(crate) fn element(&mut self, text: &str) {
        self.0.push_str(text);
        self.0.push('\n');
    }

    pub(crate) fn line(&mut self, [x1, y1, x2, y2]: [f64; 4]) {
        let _ = writeln!(self.0, "<path class=\"grid\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>");
    }

    pub(crate) fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        let _ = writeln!(
            self.0,
            "<text class=\"text\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    pub(crate) fn disc(&mut self, x: f64, y: f64, r: f64, color: &str) {
        let _ =
            writeln!(self.0, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\" fill=\"{color}\"/>");
    }
}
