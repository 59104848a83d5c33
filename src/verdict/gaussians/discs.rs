//! A disc at a pixel in balls, with the choice between rho3d and rho2d kept open.

use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Real, Truth};
use crate::splat::ray_disc::{RayDisc, RayFragment, RayMeeting, RayRules};

/// What the square of a half side of a box may be off, as a share of the square of its middle, in
/// pixels from the corner of the picture.
///
/// The authors' program finds the square as the difference of two numbers that are nearly the square
/// of the middle. Each takes up to eight operations, which round by 2^-24.
pub(super) const SLACK: f64 = 16.0 / 16_777_216.0;

/// The disc at a pixel.
///
/// A disc that is nearly edge-on has a D that may be 0, so that u and v are unbounded. But the squares
/// of their numerators by the greatest square of D bound rho3d from below, mostly by more than rho2d.
/// What a client's division and squares round is below 2^-20.
pub(super) fn fragment<P: Profile>(
    disc: &RayDisc<Ball<P>>,
    rules: &RayRules<Ball<P>>,
    pixel: (u32, u32),
) -> RayFragment<Ball<P>> {
    let RayMeeting { above: [above_u, above_v], below, rho2d } = disc.meet(rules, pixel);
    let (u, v) = (above_u / below, above_v / below);
    let rho3d = u * u + v * v;
    let above = (above_u * above_u + above_v * above_v).ends()[0];
    let [low, high] = below.ends();
    let below_most = (-low).at_least(high);
    let least = above / (below_most * below_most) * (1.0 - 1.0 / 1_048_576.0);
    let [rho2d_least, rho2d_most] = rho2d.ends();
    // With an axis of length 0, D is 0 whatever rounds, and rho3d is not a finite number.
    let less = if least > rho2d_most || below_most == 0.0 {
        false.into()
    } else if rho3d.radius.is_finite() {
        rho3d.le(rho2d)
    } else {
        Three::new([false, rho3d.middle <= rho2d.middle, true])
    };
    let own = disc.decided(rules, [u, v], [rho3d, rho2d], below, less);
    if less.certainly() || !less.possibly() || !rho2d_most.is_finite() {
        return own;
    }
    // The lesser of both is at most rho2d, even where rho3d is unbounded.
    let known = if rho3d.radius.is_finite() { rho3d.ends()[0] } else { 0.0 };
    let ends = [known.at_least(least).at_least(0.0).at_most(rho2d_least), rho2d_most];
    RayFragment { rho: between(ends), ..own }
}

/// Every number between two.
fn between<P: Profile>([least, most]: [f64; 2]) -> Ball<P> {
    let radius = 0.5 * (most - least);
    Ball::new(least + radius, radius * (1.0 + 1e-9) + 1e-30)
}
