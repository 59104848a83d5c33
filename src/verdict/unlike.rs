//! Test whether the errors of a right picture are those of a right renderer, all together.
//!
//! An interval allows each value by itself. A client whose every weight is a little off may stay in
//! all intervals, where a right renderer comes near the end of an interval only here and there. So
//! the median and the 99th percentile of a stage's errors in bounds are compared with the largest
//! that right renderers leave.
//!
//! Right renderers are simulated: `tests/lawful.rs` draws pictures by all methods in a number whose
//! operations are as inexact as the promise allows, as a coin decides or always to one side.
//!
//! A false alarm is rarer than one in 10^4 pictures. In each of these four scenes, of 48 x 36 pixels,
//! the limit of every stage lies at least six standard deviations above the mean over the pictures
//! that a coin decides (a test of `tests/lawful.rs`). A normal distribution exceeds that in 10^-9 of
//! all cases, and a picture has at most 14 limits. This says nothing about renderers whose errors are
//! not independent.
//!
//! Only errors of rounding count. Left out are pixels with an error of 0, with an error of 1, the end
//! of an interval, and with a [doubt](super::Doubt): where a decision is open, an interval is as wide
//! as the decision. Nothing is tested
//!
//! - in a stage with fewer than 100 other pixels;
//! - in a scene of at most 100 surfels, or of objects, because all pixels of a splat share the
//!   roundings of its projection;
//! - if the client stores a plane in another format than `f32`, because what the format loses fills
//!   the intervals;
//! - if the client hands in its records, because the `exp` of a software driver alone fills the
//!   bounds of its weights;
//! - under the promises `precise` and `ieee`, whose intervals are hardly wider than the errors of right
//!   renderers.

use super::client::{Client, Rounding};
use super::findings::StageVerdict;
use std::fmt::{Display, Formatter, Result};

/// A stage whose errors are larger, all together, than those of any right renderer that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unlike {
    /// The name of the stage.
    pub stage: &'static str,
    /// The fraction of the pixels with an error whose error is at most `error`.
    pub quantile: f64,
    /// The error in bounds.
    pub error: f64,
    /// The largest error at this quantile that is usual.
    pub usual: f64,
}

/// The quantiles that are tested.
const QUANTILES: [f64; 2] = [0.5, 0.99];

/// The fewest pixels whose quantiles are tested.
const FEWEST_PIXELS: usize = 100;

/// The most surfels of a scene that is not tested.
const FEW_SURFELS: usize = 100;

/// The largest usual errors in bounds of each stage under `gpu`, at each of [`QUANTILES`].
/// `Decided:` 1.5 times the largest of 12 simulated pictures of each of four scenes by each method,
/// and of all lawful variants of the second implementations in all scenes of `tests/verify`; more
/// where that is less than six standard deviations above the mean; at most 1, from where an error is
/// wrong by itself.
const USUAL: [(&str, [f64; 2]); 18] = [
    ("projection", [0.38, 0.97]),
    ("visibility", [0.26, 0.44]),
    ("indices", [0.17, 0.52]),
    ("difference", [0.1, 0.45]),
    ("attributes", [0.06, 0.31]),
    ("geometry", [0.71, 1.0]),
    ("discs", [0.09, 0.29]),
    ("layers", [0.4, 0.44]),
    ("nearest", [0.27, 0.62]),
    ("pull", [0.88, 1.0]),
    ("push", [0.43, 1.0]),
    ("reconstruction", [0.22, 0.54]),
    ("normalization", [0.47, 1.0]),
    ("compositing", [0.75, 1.0]),
    ("averaging", [0.24, 0.55]),
    ("blending", [0.37, 0.72]),
    ("shading", [0.43, 0.83]),
    // The errors of one power fill its bounds.
    ("display", [1.0, 1.0]),
];

/// The stages of a right picture of so many surfels whose errors are unlike those of right renderers.
pub(super) fn found(client: &Client, surfels: usize, stages: &[StageVerdict]) -> Vec<Unlike> {
    let tested = surfels > FEW_SURFELS
        && client.rounding == Rounding::Gpu
        && client.stores_singles()
        && !client.has_records();
    if !tested {
        return Vec::new();
    }
    let mut unlike = Vec::new();
    for stage in stages.iter().filter(|stage| stage.wrong == 0) {
        let Some(limits) = Unlike::limits(stage.stage) else { continue };
        let Some(errors) = stage.quantiles(QUANTILES) else { continue };
        let beyond = limits.into_iter().zip(errors).filter(|((_, usual), error)| error > usual);
        unlike.extend(beyond.map(|((quantile, usual), error)| Unlike {
            stage: stage.stage,
            quantile,
            error,
            usual,
        }));
    }
    unlike
}

impl Unlike {
    /// The quantiles that are tested in a stage, each with the largest error that is usual; none for
    /// a stage that is not tested.
    #[must_use]
    pub fn limits(stage: &str) -> Option<[(f64, f64); 2]> {
        let (_, [median, end]) = USUAL.iter().find(|(name, _)| *name == stage)?;
        Some([(QUANTILES[0], *median), (QUANTILES[1], *end)])
    }
}

impl StageVerdict {
    /// The errors in bounds at some quantiles of the pixels that have an error of rounding, see
    /// [`Unlike`]; none if these are fewer than 100.
    #[must_use]
    pub fn quantiles<const N: usize>(&self, quantiles: [f64; N]) -> Option<[f64; N]> {
        let all = self.errors.values().iter().zip(self.doubts.values());
        let of_rounding =
            all.filter(|(error, doubts)| **doubts == 0 && **error > 0.0 && **error < 1.0);
        let mut errors: Vec<f32> = of_rounding.map(|(error, _)| *error).collect();
        if errors.len() < FEWEST_PIXELS {
            return None;
        }
        errors.sort_unstable_by(f32::total_cmp);
        let last = (errors.len() - 1) as f64;
        Some(quantiles.map(|quantile| f64::from(errors[(quantile * last) as usize])))
    }
}

impl Display for Unlike {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { stage, quantile, error, usual } = self;
        let share = 100.0 * (1.0 - quantile);
        write!(
            f,
            "{stage}: {share:.0} % of the errors are {error:.2} bounds or more; at most {usual:.2} is usual"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Frame, Plane};
    use crate::method::Method;
    use crate::verdict::Causes;
    use crate::verdict::client::Storage;

    fn stage(stage: &'static str, error: impl Fn(u32) -> f32) -> StageVerdict {
        StageVerdict {
            stage,
            planes: vec![""],
            missing: Vec::new(),
            unjudged: Vec::new(),
            errors: Plane::from_values(20, 10, (0..200).map(error).collect()),
            doubts: Plane::filled(20, 10, 0),
            wrong: 0,
            causes: Causes::default(),
            worst: None,
        }
    }

    #[test]
    fn errors_are_compared_at_the_median_and_near_the_end() {
        let usual = USUAL.iter().find(|(name, _)| *name == "shading").unwrap().1[1];
        let client = Client::new(Frame::new(20, 10));
        let gpu = |error: &dyn Fn(u32) -> f32| found(&client, 101, &[stage("shading", error)]);
        assert_eq!(gpu(&|i| i as f32 / 200.0 * 0.4), []);
        // A few large errors are usual, and the ends of intervals are no errors of rounding.
        assert_eq!(gpu(&|i| if i == 0 { 0.9 } else { 0.1 }), []);
        assert_eq!(gpu(&|i| if i < 90 { 1.0 } else { 0.1 }), []);
        let [unlike] = gpu(&|i| if i < 4 { 0.875 } else { 0.1 })[..] else { panic!("the end") };
        assert_eq!((unlike.quantile, unlike.error, unlike.usual), (0.99, 0.875, usual));
        let [unlike] = gpu(&|_| 0.5)[..] else { panic!("the median") };
        assert_eq!((unlike.quantile, unlike.error), (0.5, 0.5));
        let halves = Client { accumulator: Storage::Half, ..client.clone() };
        assert_eq!(found(&halves, 101, &[stage("shading", |_| 0.5)]), []);
        assert_eq!(found(&client, 100, &[stage("shading", |_| 0.5)]), []);
        // So few pixels may be anything.
        assert_eq!(gpu(&|i| if i < 99 { 0.9 } else { 0.0 }), []);
    }

    #[test]
    fn every_stage_but_one_has_a_row() {
        let stages = Method::all().into_iter().flat_map(|method| method.stages());
        let drawn = stages.filter(|stage| !stage.leaves.is_empty()).map(|stage| stage.name);
        let without = drawn.filter(|drawn| USUAL.iter().all(|(name, _)| name != drawn));
        // Its levels have fewer than 100 pixels in the pictures that were tried.
        assert_eq!(without.collect::<Vec<_>>(), ["propagation"]);
    }
}
