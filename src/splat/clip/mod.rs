//! Clip triangles and segments in view space, so that they can be projected and snapped.
//!
//! Clipping keeps what is in front of the near plane and within the guard band of the screen: |X|
//! and
//! |Y| at most G = [`GUARD_BAND`] = 2^17 px. These conditions are linear in view space. With t = -z,
//! and s = t under a perspective camera, s = 1 under an orthographic one, a point is inside if none
//! of its five distances is negative:
//!
//! ```text
//!   near     -z - near                   t >= near
//!   left     fx x + (G + cx) s           X = cx + fx x/s >= -G
//!   right   -fx x + (G - cx) s           X <= G
//!   top     -fy y + (G + cy) s           Y = cy - fy y/s >= -G
//!   bottom   fy y + (G - cy) s           Y <= G
//! ```
//!
//! A point at t = near is kept, unlike the centre of a surfel, because edges are cut there. Under a
//! perspective camera near > 0, so everything that is kept has t > 0.
//!
//! **Cutting**, if any corner is outside: by one plane after the other in this order, with the
//! algorithm of Sutherland and Hodgman. A polygon keeps its order. Where its outline crosses a
//! plane, between a vertex inside with the distance d and one outside with the distance e < 0, the
//! polygon gets a new vertex
//!
//! ```text
//!   f = -e / (d - e)     g = d / (d - e)     inside f + outside g
//! ```
//!
//! for the weights and, component by component, for the position. Both factors are at least 0, so
//! no digits are lost where one end is much farther than the other. A t that rounding made less
//! than near is set to near. Then the coordinate that the plane bounds is put on the plane:
//!
//! ```text
//!   near   z = -near     left    x = -((G + cx) s) / fx     top      y = (G + cy) s / fy
//!                        right   x = (G - cx) s / fx        bottom   y = -((G - cy) s) / fy
//! ```
//!
//! So a vertex on the guard band misses it by some roundings of 2^17 px, less than 1/16 px in
//! `f32`, however far away the ends are. [`crate::frame::raster::Snap::fixed`] then holds the
//! vertex there.
//!
//! The result depends on the two ends and not on the direction, so triangles that share an edge get
//! the same vertices on it. The same holds for a segment.
//!
//! The **weights** of a vertex say how much of each original corner is in it: any quantity that is
//! linear in space is the sum of weights times corners. A corner that is inside keeps its position
//! and its weight 1, exactly.
//!
//! A primitive gives nothing if a corner is not finite, or if a corner is so far away that a
//! distance overflows where the primitive is cut.

#[cfg(test)]
mod tests;

use super::View;
use crate::frame::raster::GUARD_BAND;
use crate::number::MapInline;
use crate::number::{Exact, Real, Truth, Vector3};

/// The planes that clip triangles and segments for one view.
#[derive(Clone, Debug)]
pub struct Clip<R> {
    /// The planes in the order of the cuts.
    planes: [ClipPlane<R>; 5],
    near: R,
}

/// The distance `(scale c + past t) + one`, in units of its own; c is the coordinate that the plane
/// bounds.
#[derive(Clone, Copy, Debug)]
struct ClipPlane<R> {
    axis: Axis,
    scale: R,
    past: R,
    one: R,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
}

/// A vertex of the remaining part of a primitive with `N` corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clipped<R, const N: usize> {
    /// The position in view space.
    pub position: Vector3<R>,
    /// How much of each original corner is in the vertex: at least 0, their sum 1 up to rounding.
    pub weights: [R; N],
}

/// A vertex, and its distance to a plane.
#[derive(Clone, Copy)]
struct Measured<R, const N: usize> {
    vertex: Clipped<R, N>,
    distance: R,
}

impl<R: Real> ClipPlane<R> {
    fn distance(&self, p: &Vector3<R>) -> R {
        let coordinate = match self.axis {
            Axis::X => p.x,
            Axis::Y => p.y,
            Axis::Z => p.z,
        };
        (self.scale * coordinate + self.past * -p.z) + self.one
    }

    /// Puts the coordinate on the plane: `-(past t + one) / scale`.
    fn put(&self, p: &mut Vector3<R>) {
        let border = -(self.past * -p.z + self.one) / self.scale;
        match self.axis {
            Axis::X => p.x = border,
            Axis::Y => p.y = border,
            Axis::Z => p.z = border,
        }
    }
}

impl<R: Real> Clip<R> {
    /// Makes the planes of a camera.
    #[must_use]
    pub fn new(view: &View<R>) -> Self {
        let guard = R::from_f32(GUARD_BAND as f32);
        let side = |axis: Axis, scale: R, reach: R| {
            let (past, one) = if view.perspective { (reach, R::ZERO) } else { (R::ZERO, reach) };
            ClipPlane { axis, scale, past, one }
        };
        let planes = [
            ClipPlane { axis: Axis::Z, scale: -R::ONE, past: R::ZERO, one: -view.near },
            side(Axis::X, view.fx, guard + view.cx),
            side(Axis::X, -view.fx, guard - view.cx),
            side(Axis::Y, -view.fy, guard + view.cy),
            side(Axis::Y, view.fy, guard - view.cy),
        ];
        Self { planes, near: view.near }
    }

    /// Whether all corners are inside, so that nothing is cut.
    #[must_use]
    pub fn keeps(&self, corners: &[Vector3<R>]) -> R::Truth {
        let yes = R::Truth::from(true);
        let inside = |p: &Vector3<R>| {
            self.planes.iter().fold(yes, |all, plane| all & plane.distance(p).ge(R::ZERO))
        };
        corners.iter().fold(yes, |all, p| all & inside(p))
    }

    /// Whether all corners are beyond one of the planes, so that nothing remains.
    #[must_use]
    pub fn drops(&self, corners: &[Vector3<R>]) -> R::Truth {
        let beyond = |plane: &ClipPlane<R>| {
            let outside = |p| plane.distance(p).lt(R::ZERO);
            corners.iter().fold(R::Truth::from(true), |all, p| all & outside(p))
        };
        self.planes.iter().fold(R::Truth::from(false), |any, plane| any | beyond(plane))
    }

    /// The remaining polygon of a triangle, as [`Clip::triangle`] gives it; none if it is not
    /// certain.
    pub(crate) fn certain(&self, corners: [Vector3<R>; 3]) -> Option<Vec<Clipped<R, 3>>> {
        if !corners.iter().all(|p| is_finite(p).certainly()) {
            return None;
        }
        if self.drops(&corners).certainly() {
            return Some(Vec::new());
        }
        let polygon = whole(corners).to_vec();
        if self.keeps(&corners).certainly() { Some(polygon) } else { self.polygon(polygon) }
    }

    /// Clips a polygon by all planes; `None` also if a distance overflows, or if it is not certain
    /// on which side of a plane a corner is.
    fn polygon(&self, mut polygon: Vec<Clipped<R, 3>>) -> Option<Vec<Clipped<R, 3>>> {
        for plane in &self.planes {
            let measured = |vertex: &Clipped<R, 3>| Measured {
                vertex: *vertex,
                distance: plane.distance(&vertex.position),
            };
            let certain = |measured: &Measured<R, 3>| {
                let inside = measured.distance.ge(R::ZERO);
                (inside.certainly() == inside.possibly()).then_some(inside.certainly())
            };
            let mut before = measured(polygon.last()?);
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for here in polygon.iter().map(measured) {
                // Each edge adds its crossing with the plane, if it has one, and then its end, if
                // that is inside.
                match [certain(&before)?, certain(&here)?] {
                    [true, true] => kept.push(here.vertex),
                    [true, false] => kept.push(self.cut(plane, before, here)?),
                    [false, true] => kept.extend([self.cut(plane, here, before)?, here.vertex]),
                    [false, false] => {}
                }
                before = here;
            }
            polygon = kept;
        }
        Some(polygon)
    }

    /// Cuts between a vertex inside and a vertex outside, each with its distance to the plane;
    /// `None` if the result is not finite.
    fn cut<const N: usize>(
        &self,
        plane: &ClipPlane<R>,
        Measured { vertex: inside, distance: d }: Measured<R, N>,
        Measured { vertex: outside, distance: e }: Measured<R, N>,
    ) -> Option<Clipped<R, N>> {
        let (f, g) = (-e / (d - e), d / (d - e));
        let mut position = inside.position * f + outside.position * g;
        // Rounding may have made t less than near.
        position.z = position.z.at_most(-self.near);
        plane.put(&mut position);
        let weights = std::array::from_fn(|i| inside.weights[i] * f + outside.weights[i] * g);
        ((d - e).is_finite() & is_finite(&position))
            .certainly()
            .then_some(Clipped { position, weights })
    }
}

impl<R: Exact> Clip<R> {
    /// Clips a triangle. Returns the corners of a convex polygon in the order of the triangle, to
    /// be drawn as a fan around the first; none, or 3 to 8 corners. At each plane, the crossing of
    /// the edge that ends at a corner comes before that corner, beginning with the edge that ends
    /// at the first corner.
    ///
    /// Vertices may coincide. Where an edge lies within a rounding of a plane there can be more
    /// vertices.
    #[must_use]
    pub fn triangle(&self, corners: [Vector3<R>; 3]) -> Vec<Clipped<R, 3>> {
        if !corners.iter().all(is_finite) {
            return Vec::new();
        }
        let polygon = whole(corners).to_vec();
        if self.keeps(&corners) { polygon } else { self.polygon(polygon).unwrap_or_default() }
    }

    /// Calls `draw` for each triangle of the fan around the first corner of the polygon that
    /// [`Clip::triangle`] returns.
    #[inline]
    pub(crate) fn fan(&self, corners: [Vector3<R>; 3], mut draw: impl FnMut([&Clipped<R, 3>; 3])) {
        if corners.iter().all(is_finite) && self.keeps(&corners) {
            let [a, b, c] = &whole(corners);
            return draw([a, b, c]);
        }
        let polygon = self.triangle(corners);
        for i in 2..polygon.len() {
            draw([&polygon[0], &polygon[i - 1], &polygon[i]]);
        }
    }

    /// Clips a segment and returns its new ends, in order.
    #[must_use]
    pub fn segment(&self, corners: [Vector3<R>; 2]) -> Option<[Clipped<R, 2>; 2]> {
        if !corners.iter().all(is_finite) {
            return None;
        }
        let mut ends = whole(corners);
        if self.keeps(&corners) {
            return Some(ends);
        }
        for plane in &self.planes {
            let [a, b] = [0, 1].map_inline(|i| Measured {
                vertex: ends[i],
                distance: plane.distance(&ends[i].position),
            });
            match [a, b].map_inline(|end| end.distance >= R::ZERO) {
                [true, true] => {}
                [true, false] => ends[1] = self.cut(plane, a, b)?,
                [false, true] => ends[0] = self.cut(plane, b, a)?,
                [false, false] => return None,
            }
        }
        Some(ends)
    }
}

/// The unclipped corners, each with only its own weight.
pub(crate) fn whole<R: Real, const N: usize>(corners: [Vector3<R>; N]) -> [Clipped<R, N>; N] {
    std::array::from_fn(|i| {
        let weights = std::array::from_fn(|k| if k == i { R::ONE } else { R::ZERO });
        Clipped { position: corners[i], weights }
    })
}

fn is_finite<R: Real>(p: &Vector3<R>) -> R::Truth {
    p.x.is_finite() & p.y.is_finite() & p.z.is_finite()
}
