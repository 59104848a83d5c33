//! Whether the decisions that may be either way lean to one side.
//!
//! A limit that is a little off turns no decision that is certain. Of those beside the limit it turns
//! some, all to one side, where roundings turn about as many to either. One picture has too few of
//! them; the sums of several are added ([`Shift::add`]).
//!
//! Of every undecided decision that the client's numbers tell, let x be its distance from the limit
//! and r the radius of that distance, both as shares of the limit; x is positive where the midpoint
//! passes. A client whose limit is off by the share s is taken to pass it with the probability
//!
//! ```text
//! p = 1 / (1 + exp(-a (x + s))),  a = 1.702 / (0.15 r)
//! ```
//!
//! which is nearly that of a normal error with a deviation of 0.15 r, what a prototype measured of `f32`
//! clients in radii of `ieee`; of the wider radii of `gpu` the errors are smaller parts. The score is the sum of a (y - p) at s = 0, y being 1 of what passed and 0 of what did not;
//! the information the sum of a^2 p (1 - p). The errors of one surfel's decisions go together. So the
//! variance is the sum over surfels of the square of the sum over a surfel's decisions of a (y - p).
//! z is score / sqrt(variance), the estimate of s score / information.

use super::doubt::Doubt;
use std::collections::BTreeMap;

/// How many radii a decision is off, one standard deviation.
const DEVIATION: f64 = 0.15;
/// The slope of a logistic function that is nearly the normal distribution's.
const NORMAL: f64 = 1.702;

/// What the undecided decisions at one limit say of it, of a picture or of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// How many there are whose outcome the client's numbers tell.
    pub decisions: u64,
    /// The score.
    pub score: f64,
    /// Its information.
    pub information: f64,
    /// Its variance.
    pub variance: f64,
}

impl Shift {
    /// The |z| from which a picture leans visibly: a remark: a normal z does so in one
    /// of 370 pictures.
    pub const REMARK: f64 = 3.0;
    /// The |z| from which pictures together are wrong, if operations round to nearest.
    pub const ALARM: f64 = 4.5;
    /// The estimate up to which nothing is wrong: a limit that is itself rounded, and a little more.
    pub const LAWFUL: f64 = 4.0 / 16_777_216.0;

    /// Adds what another picture says.
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

    /// By what share of itself the limit seems to be too large; too small if negative.
    #[must_use]
    pub fn estimate(&self) -> f64 {
        if self.information > 0.0 { self.score / self.information } else { 0.0 }
    }

    /// Whether operations that round to nearest do not lean like this.
    #[must_use]
    pub fn alarms(&self) -> bool {
        self.z().abs() >= Self::ALARM && self.estimate().abs() > Self::LAWFUL
    }
}

/// The limits that are asked: their doubts, in the order of [`Shifts`].
pub const LIMITS: [Doubt; 2] = [Doubt::CutOff, Doubt::Epsilon];

/// The places of the cut-off and of epsilon among [`LIMITS`].
pub(crate) const CUT_OFF: usize = 0;
pub(crate) const EPSILON: usize = 1;

/// What a picture says of each of [`LIMITS`].
pub type Shifts = [Shift; LIMITS.len()];

/// An undecided decision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenDecision {
    pub(crate) surfel: u32,
    /// Which of [`LIMITS`]; none if another decision on the fragment is undecided too.
    pub(crate) limit: Option<usize>,
    /// The distance from the limit, as a share of it: positive where the midpoint passes.
    pub(crate) distance: f64,
    /// The radius of that.
    pub(crate) radius: f64,
}

/// The decisions of a part of a picture that the client's numbers tell: those of each surfel together.
#[derive(Debug, Default)]
pub(crate) struct ShiftSums {
    surfels: [BTreeMap<u32, f64>; LIMITS.len()],
    shifts: Shifts,
}

impl ShiftSums {
    /// One more decision, and how the client took it.
    pub(crate) fn take(&mut self, open: &OpenDecision, passed: bool) {
        let Some(limit) = open.limit else { return };
        let slope = NORMAL / (DEVIATION * open.radius);
        let likely = 1.0 / (1.0 + libm::exp(-slope * open.distance));
        let score = slope * (f64::from(u8::from(passed)) - likely);
        let information = slope * slope * likely * (1.0 - likely);
        if !(score.is_finite() && information.is_finite()) {
            return;
        }
        let shift = &mut self.shifts[limit];
        shift.decisions += 1;
        shift.score += score;
        shift.information += information;
        *self.surfels[limit].entry(open.surfel).or_default() += score;
    }

    /// The decisions of a pixel: decision i was passed if bit i of `taken` is set.
    pub(crate) fn take_all(&mut self, open: &[OpenDecision], taken: usize) {
        for (bit, open) in open.iter().enumerate() {
            self.take(open, taken >> bit & 1 == 1);
        }
    }

    /// Those of another part.
    pub(crate) fn add(&mut self, other: Self) {
        for (own, other) in self.shifts.iter_mut().zip(&other.shifts) {
            own.add(other);
        }
        for (own, other) in self.surfels.iter_mut().zip(other.surfels) {
            other.into_iter().for_each(|(surfel, score)| *own.entry(surfel).or_default() += score);
        }
    }

    /// What all of them say.
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

    /// Decisions by a limit that is off by so many radii, whose errors are the sums of uniform ones.
    fn simulated(off: f64, seed: u64) -> Shift {
        let mut index = 0;
        let mut between = |low: f64, high: f64| {
            index += 1;
            low + (high - low) * f64::from(random::unit(seed, index))
        };
        let mut told = ShiftSums::default();
        for surfel in 0..400 {
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
            // Of radii of 0.5e-6 to 2e-6, the sharper ones weigh more.
            assert!((0.1e-6..0.6e-6).contains(&off.estimate()), "{}", off.estimate());
            let other = simulated(-0.3, seed);
            assert!(other.alarms() && other.z() < -5.0, "{other:?}");
            // Twice the decisions, a root of two times the z.
            let mut both = off;
            both.add(&off);
            assert!((both.z() / off.z() - 2.0_f64.sqrt()).abs() < 1e-12);
        }
    }
}
