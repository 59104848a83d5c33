//! The atlas of failures: where each method breaks, measured.
//!
//! A [`Failure`] sweeps one parameter of a scene, and measures an error against the truth. Its
//! [`Curve`] holds the error at each value, without the cure and with it. The entry *breaks* at the
//! first value whose error exceeds [`Failure::limit`]. The values go from those that work to those
//! that do not.
//!
//! The truth is [`mod@crate::study::truth`] if a surface is known. Layers have no surface, so
//! entries about layers compare with depth peeling. Entries about arithmetic compare with the same
//! formula in f64. Entries about Gaussians say what they compare with, mostly the greatest density
//! along each ray. Errors depend on the scene alone, and are the same on every machine. Times are
//! not, and no test checks them.
//!
//! `splatref study failures -o docs` writes the page, `docs/atlas.md`.

mod case;
mod conics;
mod footprints;
mod gaussians;
mod groups;
mod layers;
mod moving;
mod numbers;
pub mod orders;
mod page;
mod prefixes;
mod reconstruction;
#[cfg(test)]
mod tests;

pub(super) use case::checked;
pub(super) use page::short;
pub use page::{Files, PICTURES, beside, page};

use crate::error::Result;
use crate::frame::{Exec, Plane};
use std::time::Duration;

/// An entry of the atlas.
#[derive(Clone, Copy, Debug)]
pub struct Failure {
    /// Its short name.
    pub id: &'static str,
    /// What you see in the picture.
    pub title: &'static str,
    /// What is drawn, why it fails, and which paper says so.
    pub why: &'static str,
    /// The parameter that is swept, with its unit.
    pub swept: &'static str,
    /// The values, from those that work to those that do not.
    pub values: &'static [f64],
    /// The error that is measured, with its unit.
    pub error: &'static str,
    /// An error above this is a failure.
    pub limit: f64,
    /// What cures it.
    pub cure: &'static str,
    /// Measures a value, without the cure and with it.
    pub at: fn(f64, &Exec) -> Result<[Found; 2]>,
}

/// The result at one value.
#[derive(Clone, Debug)]
pub struct Found {
    /// The error.
    pub error: f64,
    /// The picture in linear RGB: the scene, or a drawing of the error.
    pub picture: Plane<[f32; 3]>,
    /// How long a picture of the scene took; `None` if the error does not come from a method's
    /// picture.
    pub time: Option<Duration>,
}

/// A measured failure.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The failure.
    pub of: &'static Failure,
    /// The error at each value, without the cure.
    pub plain: Vec<f64>,
    /// The error at each value, with the cure.
    pub cured: Vec<f64>,
    /// The index of the first broken value; `None` if it never breaks.
    pub breaks: Option<usize>,
    /// Pictures before it breaks, where it is broken, and there with the cure. If it never breaks:
    /// the last value without and with the cure.
    pub pictures: Vec<Plane<[f32; 3]>>,
}

/// Every failure.
#[must_use]
pub fn failures() -> Vec<&'static Failure> {
    let rooms: [&[Failure]; 10] = [
        &footprints::FAILURES,
        &numbers::FAILURES,
        &conics::FAILURES,
        &layers::FAILURES,
        &groups::FAILURES,
        &moving::FAILURES,
        &reconstruction::FAILURES,
        &prefixes::FAILURES,
        &gaussians::footprints::FAILURES,
        &gaussians::blending::FAILURES,
    ];
    rooms.into_iter().flatten().collect()
}

impl Failure {
    /// Measures every value. `progress` gets how many values are done, and how many there are.
    ///
    /// # Errors
    /// As drawing the scenes.
    pub fn curve(&'static self, exec: &Exec, progress: &dyn Fn(u64, u64)) -> Result<Curve> {
        let count = self.values.len() as u64;
        let (mut plain, mut cured) = (Vec::new(), Vec::new());
        for (done, &value) in (0..).zip(self.values) {
            progress(done, count);
            let [as_it_is, with_cure] = (self.at)(value, exec)?;
            plain.push(as_it_is);
            cured.push(with_cure);
        }
        let breaks = plain.iter().position(|found| found.error > self.limit);
        let shown = match breaks {
            Some(at) => [at.checked_sub(1).map(|i| &plain[i]), Some(&plain[at]), Some(&cured[at])],
            None => [plain.last(), cured.last(), None],
        };
        let pictures = shown.into_iter().flatten().map(|found| found.picture.clone());
        Ok(Curve {
            of: self,
            breaks,
            pictures: pictures.collect(),
            plain: plain.iter().map(|found| found.error).collect(),
            cured: cured.iter().map(|found| found.error).collect(),
        })
    }

    /// The time of a picture with the cure divided by the time without it, where the entry breaks.
    /// Both are medians of five, taken by turns. `None` if no picture is drawn.
    ///
    /// # Errors
    /// As drawing the scenes.
    pub fn cost(&self, at: usize, exec: &Exec) -> Result<Option<f64>> {
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..5 {
            for (times, found) in times.iter_mut().zip((self.at)(self.values[at], exec)?) {
                times.extend(found.time);
            }
            // Entries without a method's picture have no time, so they are not measured again.
            if times[0].is_empty() {
                return Ok(None);
            }
        }
        let medians = times.map(|mut times| {
            times.sort();
            times.get(times.len() / 2).map(Duration::as_secs_f64)
        });
        Ok(match medians {
            [Some(plain), Some(cured)] if plain > 0.0 => Some(cured / plain),
            _ => None,
        })
    }
}
