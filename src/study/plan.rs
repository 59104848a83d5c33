//! The cheapest method and settings within a budget, of candidates that were measured.
//!
//! [`choose`] draws every candidate at the full size; `Decided:` no small version first, as holes come and go
//! with the size of a picture. Those within the budget are then timed by turns, but for those whose first time is
//! more than [`HOPELESS`] times that of the fastest, or the budget.

use super::report::chart::Loss;
use super::run::measure::picture_errors;
use super::run::{Bench, Record, time};
use super::sweep::Candidate;
use super::truth::Truth;
use crate::error::Result;
use crate::frame::Exec;
use crate::verify::metrics::METRICS;

/// A first time may be too long by so much. It is never too short by so much.
pub const HOPELESS: f64 = 2.0;

/// Measures candidates against the true picture, and times those that may be the best within a budget.
///
/// # Errors
/// As [`Bench::visit`] and of the drawing.
pub fn choose(
    bench: &mut Bench<'_>,
    (candidates, truth): (&[Candidate], &Truth),
    (budget, loss): (Budget, &Loss),
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Vec<Known>> {
    let metric = METRICS.iter().find(|metric| metric.name == loss.figure);
    let mut known = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        progress("measuring", i as u64, candidates.len() as u64);
        let (errors, time) = picture_errors(bench, candidate, truth, exec)?;
        let value = metric.and_then(|metric| (metric.of)(&errors));
        known.push(Known { time, loss: value.map_or(f64::NAN, loss.of) });
    }
    let left = budget.hopeful(&known);
    let mut records: Vec<Record> = left.iter().map(|&i| Record::of(&candidates[i])).collect();
    for round in 0..time::ROUNDS {
        for (done, i) in time::order(round, left.len()).into_iter().enumerate() {
            let count = left.len() as u64;
            progress("timing", round * count + done as u64, time::ROUNDS * count);
            time::turn(bench, &candidates[left[i]], round, &mut records[i].times)?;
        }
    }
    for (&i, record) in left.iter().zip(&records) {
        if let Some([_, median, _]) = record.quartiles() {
            known[i].time = median;
        }
    }
    Ok(known)
}

/// What may not be exceeded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// A loss: the fastest candidate whose loss is at most this is chosen.
    Error(f64),
    /// A time of a picture in ms: the candidate with the least loss whose median time is at most
    /// this is chosen.
    Time(f64),
}

/// What is known of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The median time of a picture in ms.
    pub time: f64,
    /// How far it is from the truth: the less, the better.
    pub loss: f64,
}

impl Budget {
    /// Whether a candidate is within the budget; with a NaN it is not.
    #[must_use]
    pub fn allows(&self, known: &Known) -> bool {
        match *self {
            Self::Error(most) => known.loss <= most,
            Self::Time(most) => known.time <= most,
        }
    }

    /// Those that may be the best, by first times.
    fn hopeful(&self, all: &[Known]) -> Vec<usize> {
        let may = |known: &Known| match *self {
            Self::Error(_) => self.allows(known),
            Self::Time(most) => known.time <= HOPELESS * most,
        };
        let times = all.iter().filter(|known| may(known)).map(|known| known.time);
        let fastest =
            times.fold(f64::INFINITY, |least, time| if time < least { time } else { least });
        let far = |known: &Known| matches!(self, Self::Error(_)) && known.time > HOPELESS * fastest;
        (0..all.len()).filter(|&i| may(&all[i]) && !far(&all[i])).collect()
    }

    /// The candidates within the budget, the best first: by time, then loss, where an error is
    /// given, by loss, then time, where a time is; ties to the lower index.
    #[must_use]
    pub fn ranked(&self, all: &[Known]) -> Vec<usize> {
        let mut allowed: Vec<usize> = (0..all.len()).filter(|&i| self.allows(&all[i])).collect();
        let key = |i: usize| match self {
            Self::Error(_) => [all[i].time, all[i].loss],
            Self::Time(_) => [all[i].loss, all[i].time],
        };
        allowed.sort_by(|&a, &b| {
            let ([first, second], [other, next]) = (key(a), key(b));
            first.total_cmp(&other).then(second.total_cmp(&next)).then(a.cmp(&b))
        });
        allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_within_the_budget_is_first() {
        let known = [[4.0, 0.1], [2.0, 0.3], [2.0, 0.2], [1.0, 0.5], [9.0, 0.1], [0.5, f64::NAN]];
        let all = known.map(|[time, loss]| Known { time, loss });
        assert_eq!(Budget::Error(0.3).ranked(&all), [2, 1, 0, 4]);
        assert_eq!(Budget::Error(0.05).ranked(&all), Vec::<usize>::new());
        assert_eq!(Budget::Time(2.0).ranked(&all[..5]), [2, 1, 3]);
        assert_eq!(Budget::Time(f64::INFINITY).ranked(&all[..5])[..2], [0, 4]);
        assert!(!Budget::Error(1.0).allows(&all[5]));
        assert_eq!(Budget::Error(0.3).hopeful(&all), [0, 1, 2], "9 is more than twice 2");
        assert_eq!(Budget::Time(2.0).hopeful(&all[..5]), [0, 1, 2, 3]);
    }
}
