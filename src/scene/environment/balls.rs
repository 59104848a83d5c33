//! Light in balls: all values that a correct implementation may compute for a direction.

use super::{Environment, Map, scaled, sky};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Vector3};
use std::f64::consts::PI;

/// The most columns or rows over which a direction's possible places are followed.
const MOST: i64 = 8;

impl Environment {
    /// [`Environment::radiance`] in balls; unbounded where the direction is not known well enough.
    pub(crate) fn enclosure<P: Profile>(&self, direction: Vector3<Ball<P>>) -> [Ball<P>; 3] {
        let direction = scaled(direction);
        match self {
            Self::Sky => sky::radiance(direction),
            Self::Map(map) => map.enclosure(direction),
        }
    }
}

impl Map {
    /// Interpolates bilinearly in each square of four pixel centres that the direction may lie in,
    /// and returns a ball that holds all the results. The squares meet without a jump, across the
    /// seam too. The ball is unbounded beside a pole, or where there are more than 8 squares in a
    /// row or a column.
    fn enclosure<P: Profile>(&self, direction: Vector3<Ball<P>>) -> [Ball<P>; 3] {
        // pi rounded to nearest in `f32` is a constant that every implementation shares.
        let pi = Ball::new(PI, PI / 16_777_216.0);
        let [s, t] = self.place(direction, pi, Ball::angle);
        let (Some([left, right]), Some([upper, lower])) = (ends(s), ends(t)) else {
            return [Ball::new(0.0, f64::NAN); 3];
        };
        let (width, last) = (i64::from(self.pixels().width()), self.pixels().height() - 1);
        let column = |i: i64| i.rem_euclid(width) as u32;
        let square = |i: i64, j: i64| {
            let row = u32::try_from(j).unwrap_or(0).min(last);
            self.between([column(i), column(i + 1)], row, [beyond(s, i), beyond(t, j)])
        };
        let first = square(s.middle.floor() as i64, t.middle.floor() as i64);
        let places = (upper.max(0)..=lower).flat_map(|j| (left..=right).map(move |i| (i, j)));
        places.fold(first, |all, (i, j)| Ball::either_of(all, square(i, j)))
    }
}

/// The least and the greatest integer part of a number; none if there are too many between them.
fn ends<P: Profile>(x: Ball<P>) -> Option<[i64; 2]> {
    // A little more than the radius, as in the comparisons of balls.
    let reach = x.radius * (1.0 + f64::from(f32::EPSILON));
    // NaN fails this comparison.
    if !(2.0 * reach < MOST as f64 - 1.0) {
        return None;
    }
    Some([x.middle - reach, x.middle + reach].map_inline(|end| end.floor() as i64))
}

/// How far a number is above this integer, if this is its integer part. The result is in [0, 1],
/// plus the rounding of a sum that is computed in another order than for the integer part.
fn beyond<P: Profile>(x: Ball<P>, integer: i64) -> Ball<P> {
    let part = x - Ball::exact(integer as f64);
    part.clamped(Ball::exact(-part.radius), Ball::exact(1.0 + part.radius))
}
