//! Logarithmic axes.

use crate::number::elementary::ln;

/// A logarithmic axis: the values at its ends, and the places of the ends in px.
#[derive(Clone, Debug, PartialEq)]
pub struct LogAxis {
    /// 1, 2 or 5 times powers of ten, ascending; the first and the last are the ends of the axis.
    ticks: Vec<f64>,
    places: [f64; 2],
}

impl LogAxis {
    /// The shortest axis of whole steps of 1, 2 and 5 around all values that are positive and
    /// finite; 1 to 10 if there are none. Values beyond 1e-12 and 1e12 lie beyond the ends.
    #[must_use]
    pub fn around(values: impl Iterator<Item = f64>, places: [f64; 2]) -> Self {
        let values: Vec<f64> = values.filter(|v| *v > 0.0 && v.is_finite()).collect();
        let (Some(least), Some(greatest)) =
            (values.iter().copied().reduce(lesser), values.iter().copied().reduce(greater))
        else {
            return Self { ticks: vec![1.0, 2.0, 5.0, 10.0], places };
        };
        let steps = steps();
        let most = steps.len() - 1;
        let first = steps.partition_point(|&step| step <= least).saturating_sub(1).min(most - 1);
        let last = steps.partition_point(|&step| step < greatest).clamp(first + 1, most);
        Self { ticks: steps[first..=last].to_vec(), places }
    }

    /// The place of a positive value.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        let [first, last] = [self.ticks[0], self.ticks[self.ticks.len() - 1]];
        let [from, to] = self.places;
        from + ln(value / first) / ln(last / first) * (to - from)
    }

    /// The values of the grid lines, from end to end.
    #[must_use]
    pub fn ticks(&self) -> &[f64] {
        &self.ticks
    }

    /// The text of a tick. If there are few, all have one; otherwise only powers of ten and the
    /// ends.
    #[must_use]
    pub fn word(&self, tick: f64) -> Option<String> {
        let is_end = tick == self.ticks[0] || tick == self.ticks[self.ticks.len() - 1];
        (self.ticks.len() <= 8 || is_end || digit(tick) == 1).then(|| short(tick))
    }
}

/// A value in its most readable form: `0.002`, `50`, `1e6`.
fn short(value: f64) -> String {
    if (1e-4..1e5).contains(&value) { value.to_string() } else { format!("{value:e}") }
}

/// The first digit of a value.
fn digit(value: f64) -> u32 {
    format!("{value:e}").chars().next().and_then(|c| c.to_digit(10)).unwrap_or(0)
}

/// 1, 2 and 5 times powers of ten, as the decimals that are printed.
fn steps() -> Vec<f64> {
    let all = (-12..=12).flat_map(|power| [1, 2, 5].map(|digit| format!("{digit}e{power}")));
    all.filter_map(|step| step.parse().ok()).collect()
}

fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_around_its_values() {
        let axis =
            LogAxis::around([3.0, 40.0, 0.0, f64::NAN, f64::INFINITY].into_iter(), [10.0, 110.0]);
        assert_eq!(axis.ticks(), [2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!([axis.at(2.0), axis.at(50.0)], [10.0, 110.0]);
        assert!((axis.at(10.0) - 60.0).abs() < 1e-9, "the geometric mean is in the middle");
        assert_eq!(axis.word(5.0).as_deref(), Some("5"));
        assert_eq!(LogAxis::around([].into_iter(), [0.0, 1.0]).ticks().len(), 4);
        assert_eq!(LogAxis::around([7.0].into_iter(), [0.0, 1.0]).ticks(), [5.0, 10.0]);
        assert_eq!(LogAxis::around([5.0].into_iter(), [0.0, 1.0]).ticks(), [5.0, 10.0]);
        let far = LogAxis::around([1e-300, 1e300].into_iter(), [0.0, 1.0]);
        assert_eq!([far.ticks()[0], *far.ticks().last().unwrap()], [1e-12, 5e12]);
    }

    #[test]
    fn long_axes_name_decades() {
        let axis = LogAxis::around([0.0002, 3000.0].into_iter(), [0.0, 100.0]);
        let words: Vec<_> = axis.ticks().iter().filter_map(|&tick| axis.word(tick)).collect();
        assert_eq!(words, ["0.0002", "0.001", "0.01", "0.1", "1", "10", "100", "1000", "5000"]);
    }
}
