//! Compare two pictures plane by plane: are they equal bit for bit, and if not, where and by how
//! much?
//!
//! [`compare`] compares every plane, or the planes that you name, and allows the differences that
//! you state. [`mod@metrics`] gives numbers that rank methods, e.g. RMSE, SSIM and FLIP.
//! [`mod@digest`] hashes many pictures into one line.
//!
//! ```
//! use splatref::frame::{Frame, Image, Plane, Samples};
//! use splatref::compare::{Criteria, Tolerance, Verdict, compare};
//!
//! let depth = |last| Samples::Scalar(Plane::from_values(2, 1, vec![1.0_f32, last]));
//! let reference = Image::from(&Frame::new(2, 1).with("Z", depth(2.0))?);
//! let picture = Image::from(&Frame::new(2, 1).with("Z", depth(2.0 + f32::EPSILON * 2.0))?);
//!
//! let exact = compare(&reference, &picture, &Criteria::default())?;
//! assert_eq!(exact.verdict(), Verdict::Different);
//! println!("{}", exact.lines().join("\n")); // Z: 1 of 2 pixels differ, first (1, 0): ...
//!
//! let ulp = Tolerance { max_ulp: Some(4), ..Tolerance::default() };
//! let criteria = Criteria { named: vec![("Z".into(), ulp)], ..Criteria::default() };
//! assert_eq!(compare(&reference, &picture, &criteria)?.verdict(), Verdict::Within);
//! # Ok::<(), splatref::Error>(())
//! ```

mod criteria;
pub mod digest;
pub mod metrics;
mod report;
#[cfg(test)]
mod tests;
mod value;

pub use criteria::{Criteria, Tolerance, is_observation};
pub use value::{ChannelValue, Difference};

use crate::error::Result;
use crate::frame::image::{Image, Values};

/// The outcome, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Every bit is equal; -0 is not +0, and a NaN equals one of the same bits.
    Equal,
    /// Something differs, but all differences are within the tolerance.
    Within,
    /// Something differs beyond the tolerance: values, planes, types or sizes.
    Different,
}

/// The result of comparing two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Width and height of the first and the second picture, in pixels.
    pub sizes: [(u32, u32); 2],
    /// One entry for each chosen channel of either picture, sorted by name. Empty if the sizes
    /// differ.
    pub channels: Vec<ChannelComparison>,
}

/// The result for one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelComparison {
    /// The channel's name.
    pub name: String,
    /// How the two channels of this name relate.
    pub relation: Relation,
}

/// How two channels of one name relate to each other.
#[derive(Clone, Debug, PartialEq)]
pub enum Relation {
    /// Only the first picture has this channel. It is an observation, so nothing was compared.
    Observation,
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
    /// All pixels of the plane.
    pub pixels: usize,
    /// Pixels whose bits differ.
    pub differing: usize,
    /// Pixels that differ and lie beyond both bounds of the tolerance.
    pub failing: usize,
    /// Number of failing pixels that the tolerance allows.
    pub allowed: usize,
    /// Pixels where either value is NaN, whether their bits differ or not.
    pub nan: usize,
    /// The first failing pixel in the order of rows. If no pixel fails, the first pixel whose bits
    /// differ.
    pub first: Option<Difference>,
    /// The pixel with the largest difference of values, among the failing pixels, or among all that
    /// differ if none fails. A NaN counts as an infinite difference. On a tie, the first pixel.
    pub worst: Option<Difference>,
    /// The largest distance in representable numbers, ignoring NaN. For indices, the distance in
    /// integers.
    pub max_ulp: u32,
    /// The largest difference of values, ignoring NaN.
    pub max_abs: f64,
    /// The root of the mean squared difference of values, ignoring NaN.
    pub rms: f64,
}

impl Differences {
    /// The verdict on this channel.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.differing == 0 {
            Verdict::Equal
        } else if self.failing <= self.allowed {
            Verdict::Within
        } else {
            Verdict::Different
        }
    }
}

impl ChannelComparison {
    /// The verdict on this channel, or none if the channel was not compared.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        match &self.relation {
            Relation::Observation => None,
            Relation::Values(differences) => Some(differences.verdict()),
            Relation::OnlyFirst | Relation::OnlySecond | Relation::Types => {
                Some(Verdict::Different)
            }
        }
    }
}

impl Comparison {
    /// The verdict on both pictures: the worst verdict of any channel, and `Different` if the sizes
    /// differ.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let worst = self.channels.iter().filter_map(ChannelComparison::verdict).max();
        match self.sizes {
            [first, second] if first != second => Verdict::Different,
            _ => worst.unwrap_or(Verdict::Equal),
        }
    }
}

/// Compares a picture with a reference, channel by channel in the order of names.
///
/// # Errors
/// [`crate::Error::Invalid`] if the criteria name a plane that is not there.
///
/// # Panics
/// If the number of values of a channel is not the number of pixels.
pub fn compare(reference: &Image, picture: &Image, criteria: &Criteria) -> Result<Comparison> {
    let mut all: Vec<String> = Vec::new();
    all.extend([reference, picture].iter().flat_map(|i| &i.channels).map(|(name, _)| name.clone()));
    all.sort();
    all.dedup();
    let chosen = criteria.chosen(reference, &all)?;
    let sizes = [(reference.width, reference.height), (picture.width, picture.height)];
    // Pixels of two sizes cannot be paired, so no plane is compared.
    if sizes[0] != sizes[1] {
        return Ok(Comparison { sizes, channels: Vec::new() });
    }
    let channels = chosen.into_iter().map(|name| {
        let (a, b) = (reference.channel(&name), picture.channel(&name));
        let relation = if b.is_none() && criteria.skip_observations && is_observation(&name) {
            Relation::Observation
        } else {
            relation(a, b, reference.width, criteria.tolerance_of(&name, &all))
        };
        ChannelComparison { name, relation }
    });
    Ok(Comparison { sizes, channels: channels.collect() })
}

/// Relates two channels, each with `width` values a row.
fn relation(
    first: Option<&Values>,
    second: Option<&Values>,
    width: u32,
    tolerance: Tolerance,
) -> Relation {
    match (first, second) {
        (_, None) => Relation::OnlyFirst,
        (None, _) => Relation::OnlySecond,
        (Some(Values::Float(a)), Some(Values::Float(b))) => {
            Relation::Values(differences(a, b, width, ChannelValue::Float, tolerance))
        }
        (Some(Values::Index(a)), Some(Values::Index(b))) => {
            Relation::Values(differences(a, b, width, ChannelValue::Index, tolerance))
        }
        _ => Relation::Types,
    }
}

/// Compares two channels of one type, each with `width` values a row.
fn differences<T: Copy>(
    first: &[T],
    second: &[T],
    width: u32,
    value: fn(T) -> ChannelValue,
    tolerance: Tolerance,
) -> Differences {
    assert_eq!(first.len(), second.len(), "planes of one size");
    let mut found = Differences {
        pixels: first.len(),
        differing: 0,
        failing: 0,
        allowed: tolerance.pixels,
        nan: 0,
        first: None,
        worst: None,
        max_ulp: 0,
        max_abs: 0.0,
        rms: 0.0,
    };
    let mut squares = 0.0;
    for (i, (&a, &b)) in first.iter().zip(second).enumerate() {
        let (a, b) = (value(a), value(b));
        found.nan += usize::from(a.is_nan() || b.is_nan());
        if a.bits() == b.bits() {
            continue;
        }
        let (x, y) = (i % width as usize, i / width as usize);
        let difference = Difference { x: x as u32, y: y as u32, first: a, second: b };
        found.count(difference, tolerance);
        if difference.ulps().is_some() {
            squares += difference.abs() * difference.abs();
        }
    }
    // Where every pixel has a NaN, the RMS stays 0.
    let numbers = found.pixels - found.nan;
    if numbers > 0 {
        found.rms = (squares / numbers as f64).sqrt();
    }
    found
}

impl Differences {
    /// Counts a pixel whose bits differ.
    fn count(&mut self, difference: Difference, tolerance: Tolerance) {
        let fails = !difference.passes(tolerance);
        if fails && self.failing == 0 {
            // Once a pixel fails, the pixels that pass no longer matter.
            (self.first, self.worst) = (None, None);
        }
        if fails || self.failing == 0 {
            self.first = self.first.or(Some(difference));
            if self.worst.is_none_or(|worst| difference.weight() > worst.weight()) {
                self.worst = Some(difference);
            }
        }
        self.differing += 1;
        self.failing += usize::from(fails);
        if let Some(ulps) = difference.ulps() {
            self.max_ulp = self.max_ulp.max(ulps);
            if difference.abs() > self.max_abs {
                self.max_abs = difference.abs();
            }
        }
    }
}
