//! The cheapest method and settings within a budget, of candidates that were measured.

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
    }
}
