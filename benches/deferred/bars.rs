//! Stacked bars, as an SVG that reads on light and dark pages.

use crate::common::chart::{COLORS, STYLE, Svg};

/// A bar: what it is called, and its parts from left to right.
pub(crate) struct Bar {
    pub(crate) name: String,
    pub(crate) parts: Vec<f64>,
}

const WIDTH: f64 = 760.0;
/// Left and right of the plot, and where the first bar is.
const PLOT: [f64; 3] = [260.0, 730.0, 84.0];
/// From a bar to the next, and how thick it is.
const STEP: f64 = 26.0;
const THICK: f64 = 18.0;

/// The chart; `parts` are the names of the parts.
pub(crate) fn svg(title: &str, unit: &str, parts: &[&str], bars: &[Bar]) -> String {
    let [left, right, top] = PLOT;
    let bottom = top + STEP * bars.len() as f64;
    let sum = |bar: &Bar| bar.parts.iter().sum::<f64>();
    let most = bars.iter().map(sum).fold(0.0, |most, sum| if sum > most { sum } else { most });
    let step = round(most / 6.0);
    let across = |value: f64| left + value / most * (right - left);
    let mut out = Svg::default();
    let height = bottom + 60.0;
    out.element(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\">\n\
         <title>{title}</title>\n<style>\n{STYLE}\n</style>\n\
         <rect class=\"page\" width=\"{WIDTH}\" height=\"{height}\" rx=\"6\"/>"
    ));
    out.text(20.0, 22.0, "start", title);
    for (i, name) in parts.iter().enumerate() {
        let x = 24.0 + 120.0 * i as f64;
        out.disc(x, 48.0, 5.0, COLORS[i % COLORS.len()]);
        out.text(x + 12.0, 52.0, "start", name);
    }
    let ticks = (0..).map(|i| step * f64::from(i)).take_while(|&tick| tick <= most);
    for tick in ticks {
        out.line([across(tick), top - 8.0, across(tick), bottom]);
        out.text(across(tick), bottom + 18.0, "middle", &format!("{tick}"));
    }
    out.text(f64::midpoint(left, right), bottom + 42.0, "middle", unit);
    for (row, Bar { name, parts }) in bars.iter().enumerate() {
        let y = top + STEP * row as f64;
        out.text(left - 8.0, y + 14.0, "end", name);
        let mut from = 0.0;
        for (i, part) in parts.iter().enumerate() {
            let (x, width) = (across(from), across(part + from) - across(from));
            let color = COLORS[i % COLORS.len()];
            out.element(&format!(
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{THICK}\" \
                 fill=\"{color}\"/>"
            ));
            from += part;
        }
    }
    out.finish()
}

/// The least of 1, 2 and 5 times a power of ten that is not less.
fn round(value: f64) -> f64 {
    let steps = (-3..5).flat_map(|power| ["1", "2", "5"].map(|digit| format!("{digit}e{power}")));
    let steps = steps.filter_map(|step| step.parse::<f64>().ok());
    steps
        .filter(|&step| step >= value)
        .fold(1e5, |least, step| if step < least { step } else { least })
}
