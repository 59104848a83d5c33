//! Test whether the undecided decisions lean to one side, over a suite of scenes.
//!
//! A limit that is slightly off changes no decision that is certain. It changes some decisions
//! close to the limit, all to one side, while rounding changes about as many to either side. One
//! picture has too few such decisions. Therefore the sums of several pictures are added
//! ([`Shift::add`]).
//!
//! Take every undecided decision whose outcome the client's numbers tell. Let x be its distance
//! from the limit and r the radius of that distance, both as fractions of the limit. x is positive
//! where the midpoint passes. If the client's limit is off by the fraction s, the decision passes
//! with the probability
//!
//! ```text
//! p = 1 / (1 + exp(-a (x + s))),  a = 1.702 / (0.15 r)
//! ```
//!
//! This is nearly a normal error with a deviation of 0.15 r. A prototype measured this deviation on
//! `f32` clients, in radii of `ieee`. The radii of `gpu` are wider, so there the errors are smaller
//! fractions of them. From these probabilities:
//!
//! - The score is the sum of a (y - p) at s = 0. y is 1 for a decision that passed and 0 for one
//!   that did not.
//! - The information is the sum of a^2 p (1 - p).
//! - The variance is the sum over surfels of the square of the sum over a surfel's decisions of a
//!   (y - p). Decisions are added by surfel because the errors of one surfel's decisions go
//!   together.
//! - z is score / sqrt(variance), and the estimate of s is score / information.
//!
//! # When the pooled decisions alarm
//!
//! [`Shift::alarms`] under every promise, if three things hold:
//!
//! - |z| is at least [`Shift::ALARM`]. Errors that go to both sides alike reach it in fewer than one
//!   of 10^5 limits. `suite` tests two limits for each promise, so fewer than one of 10^4 suites
//!   alarms falsely. A test of this module simulates it. (z is a sum divided by the root of its own
//!   squares, so its tails are lighter than a normal distribution's.)
//! - |s| exceeds [`Shift::LAWFUL`], because a limit may be a rounded number.
//! - |s| exceeds the fraction [`Shift::ONE_SIDED`] of the typical radius r, because rounding may be
//!   one-sided: towards zero, for example. The typical radius follows from the information. With
//!   distances spread evenly over \[-r, r\], a decision has the information 5.67 / r^2 on average.
//!
//! A decision at a distance of exactly 0 tells nothing: a scene of round numbers has such ties, and
//! the rule decides them, not rounding.

use super::doubt::Doubt;
use std::collections::BTreeMap;

/// The standard deviation of a decision's error, in radii.
const DEVIATION: f64 = 0.15;
/// The slope of a logistic function that nearly equals the normal distribution's.
const NORMAL: f64 = 1.702;
/// The information of a decision times the square of its radius, on average over distances that are
/// spread evenly over the radius: NORMAL / (2 DEVIATION).
const EVENLY: f64 = NORMAL / (2.0 * DEVIATION);

/// The evidence that the undecided decisions give about one limit, from one picture or several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Number of undecided decisions whose outcome the client's numbers tell.
    pub decisions: u64,
    /// The score.
    pub score: f64,
    /// The information of the score.
    pub information: f64,
    /// The variance of the score.
    pub variance: f64,
}

impl Shift {
    /// The |z| from which a picture visibly leans, which gets a remark. A normal z reaches it in
    /// one of 370 pictures.
    pub const REMARK: f64 = 3.0;
    /// The |z| from which several pictures together are wrong.
    pub const ALARM: f64 = 4.5;
    /// The estimate, as a fraction of the typical radius, up to which one-sided rounding is lawful.
    /// `Decided:` less than the deviation of one error, because one-sided rounding moves all errors
    /// by less than they differ among themselves.
    /// The tests' client leans by 0.025 at the cut-off if it rounds every result towards zero.
    pub const ONE_SIDED: f64 = 0.1;
    /// The estimate up to which nothing is wrong: a rounded limit, and a little more.
    pub const LAWFUL: f64 = 4.0 / 16_777_216.0;

    /// Adds the evidence of another picture.
    pub fn add(&mut self, other: &Self) {
        self.decisions += other.decisions;
        self.score += other.score;
        self.information += other.information;
        self.variance += other.variance;
    }

    /// The score in standard deviations; 0 if there are no decisions.
    #[must_use]
    pub fn z(&self) -> f64 {
        if self.variance > 0.0 { self.score / self.variance.sqrt() } else { 0.0 }
    }

    /// The fraction by which the limit seems too large; too small if negative.
    #[must_use]
    pub fn estimate(&self) -> f64 {
        if self.information > 0.0 { self.score / self.information } else { 0.0 }
    }

    /// The typical radius of a decision's distance, as a fraction of the limit; 0 if there are no
    /// decisions.
    #[must_use]
    pub fn radius(&self) -> f64 {
        let each = self.information / self.decisions as f64;
        if each > 0.0 { (EVENLY / each).sqrt() } else { 0.0 }
    }

    /// Whether this lean cannot come from rounding, whatever the client promises.
    #[must_use]
    pub fn alarms(&self) -> bool {
        let estimate = self.estimate().abs();
        let lawful = estimate <= Self::LAWFUL || estimate <= Self::ONE_SIDED * self.radius();
        self.z().abs() >= Self::ALARM && !lawful
    }
}

/// The limits that are tested: their doubts, in the order of [`Shifts`].
pub const LIMITS: [Doubt; 2] = [Doubt::CutOff, Doubt::Epsilon];

/// The indices of the cut-off and of epsilon in [`LIMITS`].
pub(crate) const CUT_OFF: usize = 0;
pub(crate) const EPSILON: usize = 1;

/// The evidence of a picture about each of [`LIMITS`].
pub type Shifts = [Shift; LIMITS.len()];

/// An undecided decision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenDecision {
    pub(crate) surfel: u32,
    /// The index in [`LIMITS`]; none if another decision on the fragment is undecided too.
    pub(crate) limit: Option<usize>,
    /// The distance from the limit, as a fraction of it; positive where the midpoint passes.
    pub(crate) distance: f64,
    /// The radius of the distance.
    pub(crate) radius: f64,
}

/// The decisions of a part of a picture whose outcome the client's numbers tell, added for each
/// surfel.
#[derive(Debug, Default)]
pub(crate) struct ShiftSums {
    surfels: [BTreeMap<u32, f64>; LIMITS.len()],
    shifts: Shifts,
}

impl ShiftSums {
    /// Adds one decision, and the way the client took it.
    pub(crate) fn take(&mut self, open: &OpenDecision, passed: bool) {
        // A distance of exactly 0 is a tie of round numbers, which the rule decides.
        let Some(limit) = open.limit.filter(|_| open.distance != 0.0) else { return };
        let slope = NORMAL / (DEVIATION * open.radius);
        let likely = 1.0 / (1.0 + libm::exp(-slope * open.distance));
        let score = slope * (f64::from(u8::from(passed)) - likely);
        let information = slope * slope * likely * (1.0 - likely);
        // A radius of 0 or infinity says nothing about the limit.
        if !(score.is_finite() && information.is_finite()) {
            return;
        }
        let shift = &mut self.shifts[limit];
        shift.decisions += 1;
        shift.score += score;
        shift.information += information;
        *self.surfels[limit].entry(open.surfel).or_default() += score;
    }

    /// Adds the decisions of a pixel. Decision i passed if bit i of `taken` is set.
    pub(crate) fn take_all(&mut self, open: &[OpenDecision], taken: usize) {
        for (bit, open) in open.iter().enumerate() {
            self.take(open, taken >> bit & 1 == 1);
        }
    }

    /// Adds the decisions of another part.
    pub(crate) fn add(&mut self, other: Self) {
        for (own, other) in self.shifts.iter_mut().zip(&other.shifts) {
            own.add(other);
        }
        for (own, other) in self.surfels.iter_mut().zip(other.surfels) {
            other.into_iter().for_each(|(surfel, score)| *own.entry(surfel).or_default() += score);
        }
    }

    /// The evidence of all decisions together.
    pub(crate) fn sums(self) -> Shifts {
        let mut shifts = self.shifts;
        for (shift, surfels) in shifts.iter_mut().zip(self.surfels) {
            shift.variance = surfels.into_values().map(|score| score * score).sum();
        }
        shifts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random;

    /// Decisions with a limit that is off by this many radii. Their errors are sums of uniform
    /// ones.
    fn simulated(off: f64, seed: u64) -> Shift {
        simulated_surfels(400, off, seed)
    }

    fn simulated_surfels(surfels: u32, off: f64, seed: u64) -> Shift {
        let mut index = 0;
        let mut between = |low: f64, high: f64| {
            index += 1;
            low + (high - low) * f64::from(random::unit(seed, index))
        };
        let mut told = ShiftSums::default();
        for surfel in 0..surfels {
            let radius = 1e-6 * between(0.5, 2.0);
            for _ in 0..3 {
                let distance = radius * between(-1.0, 1.0);
                let sum: f64 = (0..12).map(|_| between(-0.5, 0.5)).sum();
                let open = OpenDecision { surfel, limit: Some(0), distance, radius };
                told.take(&open, distance + radius * (DEVIATION * sum + off) >= 0.0);
            }
        }
        told.sums()[0]
    }

    #[test]
    fn a_limit_that_is_off_is_seen_and_errors_are_not() {
        for seed in 0..20 {
            let lawful = simulated(0.0, seed);
            assert!(lawful.z().abs() < Shift::ALARM && !lawful.alarms(), "{lawful:?}");
            let off = simulated(0.3, seed);
            assert!(off.alarms() && off.z() > 5.0, "{off:?}");
            // The radii are 0.5e-6 to 2e-6; the sharper decisions weigh more.
            assert!((0.1e-6..0.6e-6).contains(&off.estimate()), "{}", off.estimate());
            let other = simulated(-0.3, seed);
            assert!(other.alarms() && other.z() < -5.0, "{other:?}");
            // Twice the decisions give the square root of two times the z.
            let mut both = off;
            both.add(&off);
            assert!((both.z() / off.z() - 2.0_f64.sqrt()).abs() < 1e-12);
            // The radii are 0.5e-6 to 2e-6.
            assert!((0.7e-6..1.1e-6).contains(&off.radius()), "{}", off.radius());
        }
    }

    /// At most one suite of 10^4 alarms falsely: the tails of z are no heavier than the normal
    /// distribution's, which reaches 4.5 in one of 147,000 limits, and no suite has six of them.
    #[test]
    fn errors_to_both_sides_hardly_ever_alarm() {
        let limits: u32 = 6_000;
        for surfels in [4, 25] {
            let all: Vec<f64> = (0..limits)
                .map(|seed| simulated_surfels(surfels, 0.0, seed.into()).z().abs())
                .collect();
            let beyond = |z: f64| all.iter().filter(|own| **own >= z).count() as f64;
            // The normal distribution's tails: 4.6 %, 0.27 %, 0.0063 %; and three deviations more.
            for (z, tail) in [(2.0, 0.0455), (3.0, 0.0027), (4.0, 0.000_063)] {
                let normal = tail * f64::from(limits);
                assert!(beyond(z) <= normal + 3.0 * normal.sqrt() + 1.0, "{surfels}: {z}");
            }
            assert_eq!(beyond(Shift::ALARM), 0.0);
        }
        // A rounding that is one-sided by less than a tenth of the radii is lawful, however often it
        // is seen.
        let one_sided = simulated_surfels(4_000, 0.05, 1);
        assert!(one_sided.z() > Shift::ALARM && !one_sided.alarms(), "{one_sided:?}");
        let off = simulated_surfels(4_000, 0.4, 1);
        assert!(off.alarms(), "{off:?}");
    }

    #[test]
    fn an_exact_tie_tells_nothing() {
        let mut told = ShiftSums::default();
        for surfel in 0..100 {
            let open = OpenDecision { surfel, limit: Some(0), distance: 0.0, radius: 1e-6 };
            told.take(&open, true);
        }
        assert_eq!(told.sums(), Shifts::default());
    }
}
