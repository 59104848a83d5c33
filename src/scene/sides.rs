//! How large surfels are drawn as point primitives \[BJFM19, 4.2\].

use crate::error::{Error, Result};

/// The side of the square of each surfel, in pixels: one for each run of surfels.
///
/// A view that chooses a prefix of an order also chooses the size of its surfels. Other surfels
/// have no size here, and are drawn with their own size.
#[derive(Clone, Debug, PartialEq)]
pub struct Sides {
    /// The first surfel of each run, ascending from 0 on.
    runs: Vec<(u32, Option<f32>)>,
}

impl Sides {
    /// Makes sides from runs, each given by its first surfel: a run ends where the next begins.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless the first run begins with surfel 0 and each later run begins after
    /// the one before, or if a side is not greater than 0 and finite.
    pub fn new(runs: Vec<(u32, Option<f32>)>) -> Result<Self> {
        let ascend = runs.is_sorted_by(|a, b| a.0 < b.0);
        if runs.first().is_none_or(|run| run.0 != 0) || !ascend {
            return Err(Error::Invalid(
                "the sides of surfels must be in ascending runs that begin with surfel 0".into(),
            ));
        }
        let sides = runs.iter().filter_map(|run| run.1);
        match sides.into_iter().find(|side| !(*side > 0.0 && side.is_finite())) {
            None => Ok(Self { runs }),
            Some(side) => Err(Error::Invalid(format!(
                "a square of pixels cannot have the side {side}; give a finite number > 0"
            ))),
        }
    }

    /// The side of a surfel's square, if it has one.
    #[must_use]
    pub fn side(&self, surfel: u32) -> Option<f32> {
        let after = self.runs.partition_point(|run| run.0 <= surfel);
        self.runs[..after].last().and_then(|run| run.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_end_where_the_next_begins() {
        let sides = Sides::new(vec![(0, None), (2, Some(3.0)), (3, Some(1.5))]).unwrap();
        let found: Vec<_> = [0, 1, 2, 3, u32::MAX].map(|surfel| sides.side(surfel)).into();
        assert_eq!(found, [None, None, Some(3.0), Some(1.5), Some(1.5)]);
    }

    #[test]
    fn what_are_no_runs_is_refused() {
        let runs = [vec![], vec![(1, None)], vec![(0, None), (0, None)], vec![(0, Some(0.0))]];
        let more =
            [vec![(0, Some(f32::NAN))], vec![(0, Some(f32::INFINITY))], vec![(0, Some(-1.0))]];
        for runs in runs.into_iter().chain(more) {
            assert!(Sides::new(runs.clone()).is_err(), "{runs:?}");
        }
    }
}
