//! Balls side by side.

use super::{Ball, Profile};
use crate::number::lanes::LANES;

/// A ball for each lane; each part of the balls is a vector.
#[derive(Clone, Copy)]
pub(crate) struct BallLanes<P: Profile> {
    middle: [f64; LANES],
    radius: [f64; LANES],
    terms: P::TermLanes,
}

impl<P: Profile> BallLanes<P> {
    /// Zeros.
    pub(crate) const ZERO: Self =
        Self { middle: [0.0; LANES], radius: [0.0; LANES], terms: P::NO_SUMS };

    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, ball: Ball<P>) {
        self.middle[lane] = ball.middle;
        self.radius[lane] = ball.radius;
        P::put_terms(&mut self.terms, lane, ball.terms);
    }

    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Ball<P> {
        let terms = P::terms_of(&self.terms, lane);
        Ball { middle: self.middle[lane], radius: self.radius[lane], terms }
    }
}
