//! The atlas of failures: where each method breaks, measured.
//!
//! A [`Failure`] is a scene, one parameter that is swept, and an error against the truth. Its [`Curve`] is
//! the error at each value, as the method is by default or as the entry says, and again with the cure. It
//! *breaks* at the first value whose error is above [`Failure::limit`]; values are in the order from
//! where it works to where it does not.
//!
//! The truth is that of [`mod@crate::study::truth`] where a surface is known. Where the entry is about layers, which
//! have no surface, it is the picture of depth peeling; where about arithmetic, the same in f64. Errors
//! are functions of the scene alone: the same on every machine. Times are not, and no test looks at them.
//!
//! The page of the atlas is `docs/atlas.md`, made by `splatref study failures -o docs`.

mod case;
mod conics;
mod footprints;
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
    /// How it is called.
    pub id: &'static str,
    /// What is seen.
    pub title: &'static str,
    /// What is drawn, why it fails, and who says so.
    pub why: &'static str,
    /// What is swept, with its unit.
    pub swept: &'static str,
    /// Its values, from where it works to where it does not.
    pub values: &'static [f64],
    /// What is measured, with its unit.
    pub error: &'static str,
    /// An error above this is a failure.
    pub limit: f64,
    /// What cures it.
    pub cure: &'static str,
    /// Measures a value: as it is, and with the cure.
    pub at: fn(f64, &Exec) -> Result<[Found; 2]>,
}

/// What is found at a value.
#[derive(Clone, Debug)]
pub struct Found {
    /// The error.
    pub error: f64,
    /// The picture, linear RGB: of the scene, or of what goes wrong.
    pub picture: Plane<[f32; 3]>,
    /// How long a picture of the scene took; none where the error is of no method's picture.
    pub time: Option<Duration>,
}

/// A failure, measured.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Of which failure.
    pub of: &'static Failure,
    /// Of each value, as it is.
    pub plain: Vec<f64>,
    /// Of each value, with the cure.
    pub cured: Vec<f64>,
    /// The index of the first value at which it is broken; none if it never is.
    pub breaks: Option<usize>,
    /// Pictures just before it breaks, where it is broken, and there with the cure; if it never is, the last
    /// as it is and with the cure.
    pub pictures: Vec<Plane<[f32; 3]>>,
}

/// Every failure.
#[must_use]
pub fn failures() -> Vec<&'static Failure> {
    let rooms: [&[Failure]; 8] = [
        &footprints::FAILURES,
        &numbers::FAILURES,
        &conics::FAILURES,
        &layers::FAILURES,
        &groups::FAILURES,
        &moving::FAILURES,
        &reconstruction::FAILURES,
        &prefixes::FAILURES,
    ];
    rooms.into_iter().flatten().collect()
}

impl Failure {
    /// Measures every value. `progress` is told how many of how many values are done.
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

    /// How many times as long a picture takes with the cure, where it breaks: the ratio of medians of
    /// five by turns; none where no picture is drawn.
    ///
    /// # Errors
    /// As drawing the scenes.
    pub fn cost(&self, at: usize, exec: &Exec) -> Result<Option<f64>> {
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..5 {
            for (times, found) in times.iter_mut().zip((self.at)(self.values[at], exec)?) {
                times.extend(found.time);
            }
            // What is of no method's picture is not measured again.
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
