//! A disc by orthogonal projection: the ellipse of image-space reconstruction.
//!
//! A disc of radius rho pixels and normal n = (nx, ny, nz), given in view space and of any length,
//! is projected along the view axis \[MKC08, section 3.2\], \[MOC08, section 3.1\]. Its major axis
//! is perpendicular to (nx, ny) and 2 rho long. Its minor axis is the major axis times |nz|, for
//! |n| = 1. At the offset (x, y) from its centre, in pixels, x right and y down, in this order of
//! operations:
//!
//! ```text
//!   tilt = (nx / nz, ny / nz)             square = rho rho
//!   e    = tilt.x x - tilt.y y            how far the disc's plane lies behind the offset
//!   form = (x x + y y) + e e              the squared distance from the centre in that plane
//!   inside   square > 0 and form <= square
//! ```
//!
//! so that d = sqrt(form / square) is the elliptical distance, 1 on the rim. The axes are never
//! needed. A sum of squares has no cancellation, and the length of n does not enter, so averages of
//! normals need not be made unit vectors.
//!
//! (Both papers project along the view axis, because radii are small. But the error is in the angle
//! between the axis and the ray, not in the size of the disc. A wall that a wide camera sees at its
//! side is edge-on to the axis, and vanishes.)
//!
//! A disc contains nothing, not even its centre, if it is seen edge-on (nz = 0), has no normal, or
//! has rho = 0: the form is then infinite or NaN, or the square is not > 0.

use crate::composite::decide;
use crate::number::{Real, Vector2, Vector3};

/// The largest radius in pixels, 2^48; a larger radius counts as 2^48, whose square is finite in
/// `f32`.
pub const LARGEST_RADIUS: f32 = 281_474_976_710_656.0;

/// The ellipse of a disc, see the module page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse<R> {
    /// Slope of the disc's plane.
    pub tilt: Vector2<R>,
    /// rho^2 in px^2.
    pub square: R,
}

impl<R> Ellipse<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Ellipse<S> {
        Ellipse { tilt: self.tilt.map(&f), square: f(self.square) }
    }
}

impl<R: Real> Ellipse<R> {
    /// The ellipse of a disc of radius `radius` pixels.
    #[inline(always)]
    #[must_use]
    pub fn new(normal: Vector3<R>, radius: R) -> Self {
        Self::tilted(Vector2::new(normal.x / normal.z, normal.y / normal.z), radius)
    }

    /// The same ellipse from the tilt.
    #[inline(always)]
    #[must_use]
    pub fn tilted(tilt: Vector2<R>, radius: R) -> Self {
        Self { tilt, square: radius * radius }
    }

    /// The form at an offset from the centre; the same at the opposite offset.
    #[inline(always)]
    #[must_use]
    pub fn form(&self, x: R, y: R) -> R {
        let e = self.tilt.x * x - self.tilt.y * y;
        (x * x + y * y) + e * e
    }

    /// Whether an offset with this form is inside, see [`decide::holds`].
    #[inline(always)]
    #[must_use]
    pub fn holds(&self, form: R) -> R::Truth {
        decide::holds(form, self.square)
    }
}

/// The radius in pixels of a disc of radius `radius` world units: `(radius (focal m))`, at most
/// [`LARGEST_RADIUS`]; m is 1/t under a perspective camera, else 1.
#[inline(always)]
pub(crate) fn radius_in_pixels<R: Real>(radius: R, focal: R, m: R) -> R {
    (radius * (focal * m)).at_most(R::from_f32(LARGEST_RADIUS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;

    /// A direction that is not edge-on.
    fn direction(i: u64) -> [f32; 3] {
        let [x, y, z] = [0, 1, 2].map(|k| unit(7, 3 * i + k) - 0.5);
        [x, y, if z.abs() < 0.01 { 0.25 } else { z }]
    }

    /// As the papers word it: axes along and across the projected normal, the minor one shortened.
    fn by_axes(n: [f64; 3], rho: f64, x: f64, y: f64) -> f64 {
        let flat = (n[0] * n[0] + n[1] * n[1]).sqrt();
        let length = (flat * flat + n[2] * n[2]).sqrt();
        // On the screen y points down.
        let along = if flat > 0.0 { (n[0] * x - n[1] * y) / flat } else { x };
        let across = if flat > 0.0 { (n[1] * x + n[0] * y) / flat } else { y };
        let minor = rho * (n[2] / length).abs();
        (along / minor) * (along / minor) + (across / rho) * (across / rho)
    }

    #[test]
    fn the_form_is_that_of_the_paper_s_axes() {
        for i in 0..2000_u64 {
            let n = direction(i).map(f64::from);
            let scale = 0.25 + (i % 7) as f64;
            let (x, y) = ((i % 13) as f64 - 6.0, (i % 11) as f64 - 5.0);
            let rho = 0.5 + (i % 5) as f64;
            let ellipse = Ellipse::new(Vector3::new(n[0] * scale, n[1] * scale, n[2] * scale), rho);
            let (ours, theirs) = (ellipse.form(x, y) / ellipse.square, by_axes(n, rho, x, y));
            // Both round about a dozen times; 1/nz is the condition number of either.
            assert!((ours - theirs).abs() <= 1e-13 * theirs / (n[2] * n[2]), "{ours} {theirs}");
        }
    }

    #[test]
    fn edge_on_and_empty_discs_contain_nothing() {
        let edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [0.0; 3]];
        for [x, y, z] in edges {
            let ellipse = Ellipse::<f32>::new(Vector3::new(x, y, z), 4.0);
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.8, 0.6), (-3.0, 4.0)] {
                assert!(!ellipse.holds(ellipse.form(x, y)));
            }
        }
        let front = Vector3::new(0.0, 0.0, 1.0);
        for radius in [0.0, 1e-30] {
            let point = Ellipse::<f32>::new(front, radius);
            assert!(!point.holds(point.form(0.0, 0.0)), "rho^2 is 0");
        }
        let huge = Ellipse::<f32>::new(front, radius_in_pixels(1e38, 1e3, 1.0));
        assert!(huge.holds(huge.form(-65_536.0, 65_536.0)) && huge.square.is_finite());
    }
}
