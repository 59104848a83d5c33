//! Linear axes: where values lie on the page.

/// A linear axis: the values at its ends, and the places of the ends in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// The value at the first end, and the value at the last, which is greater.
    pub values: [f64; 2],
    /// The places of the ends.
    pub places: [f64; 2],
}

impl Axis {
    /// An axis from 0 that includes a value; its end is a [tick](Self::ticks).
    #[must_use]
    pub fn from_zero(most: f64, places: [f64; 2]) -> Self {
        let step = step(most);
        let last = step * (most / step).ceil();
        Self { values: [0.0, if last > 0.0 && last.is_finite() { last } else { 1.0 }], places }
    }

    /// The place of a value.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        let ([first, last], [from, to]) = (self.values, self.places);
        from + (value - first) / (last - first) * (to - from)
    }

    /// Round numbers from end to end, 4 to 11 of them: multiples of 1, 2 or 5 times a power of ten.
    #[must_use]
    pub fn ticks(&self) -> Vec<f64> {
        let [first, last] = self.values;
        let step = step(last - first);
        let (low, high) = ((first / step).ceil() as i64, (last / step + 1e-9).floor() as i64);
        (low..=high).map(|i| i as f64 * step).collect()
    }

    /// The text of a tick, with as many digits as the distance between ticks needs.
    #[must_use]
    pub fn word(&self, tick: f64) -> String {
        let mut step = step(self.values[1] - self.values[0]);
        let mut digits = 0;
        while step < 0.99 && digits < 9 {
            step *= 10.0;
            digits += 1;
        }
        format!("{tick:.digits$}")
    }
}

/// The smallest of 1, 2 and 5 times a power of ten, from 1e-9 to 5e12, that fits at most 10 times
/// into a length; a tenth of a longer length.
fn step(length: f64) -> f64 {
    let steps = (-9..=12).flat_map(|power| [1, 2, 5].map(|digit| format!("{digit}e{power}")));
    let mut steps = steps.filter_map(|step| step.parse::<f64>().ok());
    steps.find(|step| length <= 10.0 * step).unwrap_or(length / 10.0)
}
