//! Bound a disc that reaches the near plane, where its projection is no ellipse.
//!
//! The part at t >= near is convex. So its projection ends, in each direction of the screen, either
//! where the rim's tangent is an axis of the picture or where the rim meets the near plane. The
//! bounds are the box around these points, widened. In view space, with p the centre, n the normal
//! and r the radius:
//!
//! ```text
//!   a = (1, 0, 0) if |n.x| < |n.y|, else (0, 1, 0)         n x a divided by its length: h
//!   u = h r      v = (n x h) r                             of an ellipse: its tangents, turned
//!   x(c, s) = (p.x + u.x c) + v.x s         x0 = p.x, x1 = u.x, x2 = v.x, and so for y
//!   t(c, s) = (-p.z + -u.z c) + -v.z s      t0 = -p.z, t1 = -u.z, t2 = -v.z
//! ```
//!
//! All lengths here (p, u, v and near) are first multiplied by a power of two that brings the
//! largest of |p.x|, |p.y|, |p.z|, near and R to [1, 2): else squares of products of lengths leave
//! the range of `f32` in scenes of 1e10 or 1e-12 world units.
//!
//! The equation f0 + f1 c + f2 s = 0 has no solution (c, s) on the unit circle unless rest >= 0,
//! and otherwise two:
//!
//! ```text
//!   L = sqrt(f1 f1 + f2 f2)      a = f1 / L      b = f2 / L      d = f0 / L
//!   rest = 1 - d d               root = sqrt(rest)
//!   (-(d a) - root b, -(d b) + root a)      (-(d a) + root b, -(d b) - root a)
//! ```
//!
//! Three equations (f0, f1, f2) are solved this way, and each solution gets a depth:
//!
//! ```text
//!   (t0 - near, t1, t2)                                         depth near
//!   (x2 t1 - x1 t2, x2 t0 - x0 t2, x0 t1 - x1 t0), and of y     depth t(c, s), only if > near
//! ```
//!
//! The box goes from the least to the greatest X = cx + fx (x(c, s) / depth) and Y = cy - fy (y(c,
//! s) / depth), and is moved outwards by
//!
//! ```text
//!   e  = (R 2^-20) / near        R: r, or sqrt(U . U + V . V) of an ellipse of tangents U and V
//!   mx = ((greatest X - least X) 0.001 + fx e) + 1       my likewise with fy; 0.001 from f32
//! ```
//!
//! A point of the rim is exact to a few roundings of the radius, and the near plane magnifies these
//! by f/near: hence e. The thousandth and the pixel leave room for the roundings of q. A test has
//! discs that lose pixels without e, and without the thousandth.

use super::shape::PlacedDisc;
use super::{Disc, View};
use crate::number::{MapInline, Real, Truth, Vector2, Vector3};

/// Two half axes of a disc or ellipse in view space.
fn basis<R: Real>(view: &View<R>, placed: &PlacedDisc<R>, disc: &Disc<R>) -> [Vector3<R>; 2] {
    if let Some(tangents) = disc.tangents {
        return tangents.map_inline(|t| view.direction(t));
    }
    let n = placed.n;
    // Any axis that is not along the normal gives a basis of the plane.
    let axis = if n.x.abs().lt(n.y.abs()).certainly() {
        Vector3::new(R::ONE, R::ZERO, R::ZERO)
    } else {
        Vector3::new(R::ZERO, R::ONE, R::ZERO)
    };
    let u = n.cross(axis).normalized();
    [u * disc.radius, n.cross(u) * disc.radius]
}

/// The corners of the box around the visible part of a disc, see the module. A point that may be a
/// solution is in the box too, because bounds are a guarantee.
pub(super) fn corners<R: Real>(
    view: &View<R>,
    placed: &PlacedDisc<R>,
    disc: &Disc<R>,
) -> (Vector2<R>, Vector2<R>) {
    let (p, [u, v]) = (placed.p, basis(view, placed, disc));
    let scale = scale(p, view.near, disc);
    // x, y and depth in view space, each as a function of (c, s), stored as [constant, c, s].
    let near = view.near * scale;
    let x = [p.x, u.x, v.x].map_inline(|number| number * scale);
    let y = [p.y, u.y, v.y].map_inline(|number| number * scale);
    let t = [-p.z, -u.z, -v.z].map_inline(|number| number * scale);
    let at = |f: [R; 3], point: Vector2<R>| (f[0] + f[1] * point.x) + f[2] * point.y;

    let mut low = Vector2::new(R::INFINITY, R::INFINITY);
    let mut high = Vector2::new(-R::INFINITY, -R::INFINITY);
    let mut include = |point: Vector2<R>, depth: R| {
        let sx = view.cx + view.fx * (at(x, point) / depth);
        let sy = view.cy - view.fy * (at(y, point) / depth);
        low = Vector2::new(low.x.at_most(sx), low.y.at_most(sy));
        high = Vector2::new(high.x.at_least(sx), high.y.at_least(sy));
    };
    for point in on_circle([t[0] - near, t[1], t[2]]).iter().flatten() {
        include(*point, near);
    }
    let tangents = [on_circle(tangent(x, t)), on_circle(tangent(y, t))];
    for point in tangents.iter().flatten().flatten() {
        let depth = at(t, *point);
        if depth.gt(near).possibly() {
            include(*point, depth);
        }
    }
    let rounding = (disc.reach() * R::from_f32(1.0 / 1_048_576.0)) / view.near;
    let wider = R::from_f32(0.001);
    let mx = ((high.x - low.x) * wider + view.fx * rounding) + R::ONE;
    let my = ((high.y - low.y) * wider + view.fy * rounding) + R::ONE;
    (Vector2::new(low.x - mx, low.y - my), Vector2::new(high.x + mx, high.y + my))
}

/// The power of two that brings the largest length to about 1, so that no product of four lengths
/// exceeds what an `f32` holds, or vanishes. It changes no other bit of the corners.
fn scale<R: Real>(p: Vector3<R>, near: R, disc: &Disc<R>) -> R {
    let lengths = [p.x, p.y, p.z, near, disc.reach()];
    let largest =
        lengths.iter().fold(0.0, |most: f32, length| most.at_least(length.to_f32().abs()));
    // The exponent field alone; the ends are kept so that the reciprocal is a normal number too.
    let exponent = (largest.to_bits() >> 23).clamp(1, 253);
    R::from_f32(f32::from_bits((254 - exponent) << 23))
}

/// The equation for the points of the rim where x/t is stationary: the terms of second order
/// cancel.
fn tangent<R: Real>(x: [R; 3], t: [R; 3]) -> [R; 3] {
    [x[2] * t[1] - x[1] * t[2], x[2] * t[0] - x[0] * t[2], x[0] * t[1] - x[1] * t[0]]
}

/// The points (c, s) of the unit circle with `f[0] + f[1] c + f[2] s = 0`.
fn on_circle<R: Real>(f: [R; 3]) -> Option<[Vector2<R>; 2]> {
    let length = (f[1] * f[1] + f[2] * f[2]).sqrt();
    let (a, b, c) = (f[1] / length, f[2] / length, f[0] / length);
    let rest = R::ONE - c * c;
    // No point of the circle can solve the equation.
    if !rest.ge(R::ZERO).possibly() {
        return None;
    }
    // A ball of `rest` may reach below 0, where only a part of its values solves the equation.
    let root = rest.at_least(R::ZERO).sqrt();
    Some([
        Vector2::new(-(c * a) - root * b, -(c * b) + root * a),
        Vector2::new(-(c * a) + root * b, -(c * b) - root * a),
    ])
}
