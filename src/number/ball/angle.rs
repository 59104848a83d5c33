//! The angle of a point.

use super::{Ball, Profile, SLACK};
use crate::number::elementary;
use std::f64::consts::TAU;

impl<P: Profile> Ball<P> {
    /// The angle of the point (x, `self`) from the x axis, see [`crate::number::Exact::atan2`]. The
    /// angle is defined up to whole turns: if the ball's points lie on both sides of the negative x
    /// axis, the ball continues beyond pi.
    ///
    /// Let d be the distance of the midpoint from the origin and r the radius of the point. The
    /// spread is r / (d - r), which is more than the arcsine of r / d; a whole turn where the point
    /// may be the origin. An angle that is not rounded to nearest is 4096 ulp off, see
    /// [`super::Gpu`], wherever the point is.
    pub(crate) fn angle(self, x: Self) -> Self {
        let middle = elementary::atan2(self.middle, x.middle);
        let reach = (self.radius + x.radius) * SLACK;
        let distance = (self.middle * self.middle + x.middle * x.middle).sqrt();
        // NaN fails these comparisons.
        if !(reach < f64::INFINITY && distance < f64::INFINITY) {
            return Self::unbounded(middle, true);
        }
        let spread = if reach < distance / 2.0 { reach / (distance - reach) } else { TAU };
        let units = if P::ROUNDS_ALL_TO_NEAREST { 1.0 } else { 8192.0 };
        Self::rounded(middle, spread, units, P::TINY)
    }
}
