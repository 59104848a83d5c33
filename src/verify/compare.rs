//! Two pictures, plane by plane: equal bit for bit, or where, and by how much, not.

use crate::frame::image::{Image, Values};
use crate::number::real::ordered_f32;
use std::fmt;

/// What may differ on purpose. The default lets nothing differ.
///
/// A pixel passes if its bits are equal or, where both values are finite, if it is within either
/// bound that is given. Channels of indices must always be equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// At most so many representable `f32` from one value to the other; -0 and +0 are the same one.
    pub max_ulp: Option<u32>,
    /// At most this difference of the values, taken in f64; at least 0.
    pub max_abs: Option<f32>,
}

/// The outcome, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Every bit is equal; -0 is not +0, and a NaN equals one of the same bits.
    Equal,
    /// Something differs, and all of that is within the tolerance.
    Within,
    /// Something differs beyond the tolerance: values, planes, types or sizes.
    Different,
}

/// What the comparison of two pictures found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Width and height of the first and the second picture, in pixels.
    pub sizes: [(u32, u32); 2],
    /// A finding for each channel name of either, sorted; empty if the sizes differ.
    pub planes: Vec<PlaneReport>,
}

/// What was found of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneReport {
    /// The channel's name.
    pub name: String,
    /// The finding.
    pub finding: Finding,
}

/// What two channels of one name are to each other.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Only the first picture has it.
    OnlyFirst,
    /// Only the second picture has it.
    OnlySecond,
    /// One holds floats and the other indices.
    Types,
    /// Both hold the same type of values.
    Values(Differences),
}

/// How the values of two planes of one size differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Pixels in all.
    pub pixels: usize,
    /// Pixels whose bits differ.
    pub differing: usize,
    /// Pixels beyond the tolerance, of those that differ.
    pub failing: usize,
    /// Pixels where either value is NaN, whether their bits differ or not.
    pub nan: usize,
    /// The first pixel, in the order of rows, that is beyond the tolerance; where there is none,
    /// the first whose bits differ.
    pub first: Option<Difference>,
    /// The largest distance in representable numbers, NaN aside; of indices, in integers.
    pub max_ulp: u32,
    /// The largest difference of values, NaN aside.
    pub max_abs: f64,
    /// The root of the mean squared difference of values, NaN aside.
    pub rms: f64,
}

/// A pixel that differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Column, from 0.
    pub x: u32,
    /// Row, from 0 at the top.
    pub y: u32,
    /// The value in the first picture.
    pub first: Value,
    /// The value in the second picture.
    pub second: Value,
}

/// One value of a channel; shown with its bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Of a channel of floats.
    Float(f32),
    /// Of a channel of indices.
    Index(u32),
}

impl Value {
    /// The 32 bits as stored.
    #[must_use]
    pub fn bits(self) -> u32 {
        match self {
            Self::Float(value) => value.to_bits(),
            Self::Index(value) => value,
        }
    }

    /// The number, exactly.
    fn number(self) -> f64 {
        match self {
            Self::Float(value) => f64::from(value),
            Self::Index(value) => f64::from(value),
        }
    }

    /// The place in the ordered list of all values of the type; NaN, beyond the infinities, has one
    /// too.
    fn rank(self) -> i64 {
        match self {
            Self::Float(value) => ordered_f32(value),
            Self::Index(value) => i64::from(value),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(value) => write!(f, "{value:?} (0x{:08x})", value.to_bits()),
            Self::Index(value) => write!(f, "{value} (0x{value:08x})"),
        }
    }
}

impl Difference {
    /// How many values of the type lie from one to the other, at least 1 unless they are the two
    /// zeros; none if either is NaN.
    #[must_use]
    pub fn ulps(&self) -> Option<u32> {
        if self.first.number().is_nan() || self.second.number().is_nan() {
            return None;
        }
        // Less than 2^32: two infinities are 2 * 0x7F80_0000 apart.
        Some(self.first.rank().abs_diff(self.second.rank()) as u32)
    }

    /// The absolute difference of the numbers; infinite if one is, NaN if one is.
    #[must_use]
    pub fn abs(&self) -> f64 {
        (self.first.number() - self.second.number()).abs()
    }

    /// Whether `tolerance` lets it pass.
    fn passes(&self, tolerance: Tolerance) -> bool {
        let (Value::Float(first), Value::Float(second)) = (self.first, self.second) else {
            return false;
        };
        if !first.is_finite() || !second.is_finite() {
            return false;
        }
        let within_ulp =
            tolerance.max_ulp.zip(self.ulps()).is_some_and(|(most, ulps)| ulps <= most);
        within_ulp || tolerance.max_abs.is_some_and(|most| self.abs() <= f64::from(most))
    }
}

impl Differences {
    /// The verdict on this plane.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match (self.differing, self.failing) {
            (0, _) => Verdict::Equal,
            (_, 0) => Verdict::Within,
            _ => Verdict::Different,
        }
    }
}

impl PlaneReport {
    /// The verdict on this plane.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match &self.finding {
            Finding::Values(differences) => differences.verdict(),
            Finding::OnlyFirst | Finding::OnlySecond | Finding::Types => Verdict::Different,
        }
    }
}

impl Report {
    /// The verdict on the whole: the worst of its planes, and different if the sizes are.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let worst = self.planes.iter().map(PlaneReport::verdict).max();
        match self.sizes {
            [first, second] if first != second => Verdict::Different,
            _ => worst.unwrap_or(Verdict::Equal),
        }
    }

    /// The report as text: a line a plane, and a last line with the verdict.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.planes.iter().map(PlaneReport::to_string).collect();
        let [(width, height), (other_width, other_height)] = self.sizes;
        let count = self.planes.len();
        let unequal = self.planes.iter().filter(|p| p.verdict() != Verdict::Equal).count();
        lines.push(match self.verdict() {
            _ if self.sizes[0] != self.sizes[1] => format!(
                "different: {width} x {height} against {other_width} x {other_height} pixels"
            ),
            Verdict::Equal => format!("equal: all {count} planes, bit for bit"),
            Verdict::Within => format!("within tolerance: {unequal} of {count} planes differ"),
            Verdict::Different => format!("different: {unequal} of {count} planes differ"),
        });
        lines
    }
}

impl fmt::Display for PlaneReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name)?;
        match &self.finding {
            Finding::OnlyFirst => f.write_str("only in the first file"),
            Finding::OnlySecond => f.write_str("only in the second file"),
            Finding::Types => f.write_str("floats in one file, indices in the other"),
            Finding::Values(differences) => differences.fmt(f),
        }
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = &self.first else {
            f.write_str("equal")?;
            return if self.nan > 0 { write!(f, ", {} pixels with NaN", self.nan) } else { Ok(()) };
        };
        write!(f, "{} of {} pixels differ, ", self.differing, self.pixels)?;
        match self.failing {
            0 => f.write_str("all within tolerance, first ")?,
            failing if failing < self.differing => write!(f, "{failing} beyond tolerance, first ")?,
            _ => f.write_str("first ")?,
        }
        write!(f, "({}, {}): {} against {}", first.x, first.y, first.first, first.second)?;
        if let Some(ulps) = first.ulps() {
            write!(f, ", {ulps} ulp")?;
        }
        write!(f, "; at most {} ulp, {:.3e}; RMS {:.3e}", self.max_ulp, self.max_abs, self.rms)?;
        if self.nan > 0 {
            write!(f, "; {} pixels with NaN", self.nan)?;
        }
        Ok(())
    }
}

/// Compares two pictures, channel by channel in the order of names.
///
/// # Panics
/// If a channel has not one value a pixel.
#[must_use]
pub fn compare(first: &Image, second: &Image, tolerance: Tolerance) -> Report {
    let sizes = [(first.width, first.height), (second.width, second.height)];
    if sizes[0] != sizes[1] {
        return Report { sizes, planes: Vec::new() };
    }
    let names = |image: &Image| image.channels.iter().map(|c| c.0.clone()).collect::<Vec<_>>();
    let mut all = names(first);
    all.extend(names(second));
    all.sort();
    all.dedup();
    let planes = all.into_iter().map(|name| {
        let finding = match (first.channel(&name), second.channel(&name)) {
            (_, None) => Finding::OnlyFirst,
            (None, _) => Finding::OnlySecond,
            (Some(Values::Float(a)), Some(Values::Float(b))) => {
                Finding::Values(differences(a, b, first.width, Value::Float, tolerance))
            }
            (Some(Values::Index(a)), Some(Values::Index(b))) => {
                Finding::Values(differences(a, b, first.width, Value::Index, tolerance))
            }
            _ => Finding::Types,
        };
        PlaneReport { name, finding }
    });
    Report { sizes, planes: planes.collect() }
}

/// Compares two planes of one type, `width` values a row.
fn differences<T: Copy>(
    first: &[T],
    second: &[T],
    width: u32,
    value: fn(T) -> Value,
    tolerance: Tolerance,
) -> Differences {
    assert_eq!(first.len(), second.len(), "planes of one size");
    let mut found = Differences {
        pixels: first.len(),
        differing: 0,
        failing: 0,
        nan: 0,
        first: None,
        max_ulp: 0,
        max_abs: 0.0,
        rms: 0.0,
    };
    let mut squares = 0.0;
    for (i, (&a, &b)) in first.iter().zip(second).enumerate() {
        let (a, b) = (value(a), value(b));
        let nan = a.number().is_nan() || b.number().is_nan();
        found.nan += usize::from(nan);
        if a.bits() == b.bits() {
            continue;
        }
        let (x, y) = (i % width as usize, i / width as usize);
        let difference = Difference { x: x as u32, y: y as u32, first: a, second: b };
        let fails = !difference.passes(tolerance);
        if found.first.is_none() || (fails && found.failing == 0) {
            found.first = Some(difference);
        }
        found.differing += 1;
        found.failing += usize::from(fails);
        if let Some(ulps) = difference.ulps() {
            found.max_ulp = found.max_ulp.max(ulps);
            let distance = difference.abs();
            squares += distance * distance;
            if distance > found.max_abs {
                found.max_abs = distance;
            }
        }
    }
    let numbers = found.pixels - found.nan;
    if numbers > 0 {
        found.rms = (squares / numbers as f64).sqrt();
    }
    found
}

#[cfg(test)]
mod tests;
