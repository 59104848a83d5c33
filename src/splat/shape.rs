//! Placing and shape: the first two steps of [`mod@super::project`].

use super::Projector;
use crate::number::{Real, Vector2, Vector3};

/// A surfel in view space, and the Jacobian there.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedDisc<R> {
    /// Centre in view space.
    pub(super) p: Vector3<R>,
    /// Normal in view space.
    pub(super) n: Vector3<R>,
    /// Depth of the centre.
    pub(super) t: R,
    pub(super) m: R,
    d: Vector2<R>,
    sx: R,
    sy: R,
    pub(super) g: R,
    pub(super) center: Vector2<R>,
}

/// The covariance of a disc on the screen, without the low-pass filter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covariance<R> {
    pub(super) xx: R,
    pub(super) xy: R,
    pub(super) yy: R,
    pub(super) area: R,
    pub(super) half: R,
    pub(super) tilt: Vector2<R>,
}

/// How many numbers a [`PlacedDisc`] has, and a [`Covariance`].
pub(super) const PLACED: usize = 15;
pub(super) const COVARIANCE: usize = 7;

impl<R> PlacedDisc<R> {
    #[inline(always)]
    pub(super) fn numbers(self) -> [R; PLACED] {
        let Self { p, n, t, m, d, sx, sy, g, center } = self;
        [p.x, p.y, p.z, n.x, n.y, n.z, t, m, d.x, d.y, sx, sy, g, center.x, center.y]
    }

    /// The disc with these [`PlacedDisc::numbers`].
    #[inline(always)]
    pub(super) fn of_numbers(numbers: [R; PLACED]) -> Self {
        let [px, py, pz, nx, ny, nz, t, m, dx, dy, sx, sy, g, x, y] = numbers;
        let (p, n) = (Vector3::new(px, py, pz), Vector3::new(nx, ny, nz));
        Self { p, n, t, m, d: Vector2::new(dx, dy), sx, sy, g, center: Vector2::new(x, y) }
    }
}

impl<R> Covariance<R> {
    #[inline(always)]
    pub(super) fn numbers(self) -> [R; COVARIANCE] {
        let Self { xx, xy, yy, area, half, tilt } = self;
        [xx, xy, yy, area, half, tilt.x, tilt.y]
    }

    /// The covariance with these [`Covariance::numbers`].
    #[inline(always)]
    pub(super) fn of_numbers([xx, xy, yy, area, half, x, y]: [R; COVARIANCE]) -> Self {
        Self { xx, xy, yy, area, half, tilt: Vector2::new(x, y) }
    }
}

impl<R: Real> Projector<R> {
    /// Places a surfel in view space, with the Jacobian there.
    #[inline(always)]
    pub(super) fn place(&self, position: Vector3<R>, normal: Vector3<R>) -> PlacedDisc<R> {
        let view = &self.view;
        let p = view.point(position);
        let n = view.direction(normal);
        let t = -p.z;
        // Chooses between numbers, not between branches, because only then does a loop over balls
        // vectorize.
        let one_of =
            |perspective: R, other: R| R::select(view.perspective.into(), perspective, other);
        let m = one_of(R::ONE / t, R::ONE);
        let d = Vector2::new(one_of(p.x * m, R::ZERO), one_of(p.y * m, R::ZERO));
        let at = Vector2::new(one_of(d.x, p.x), one_of(d.y, p.y));
        PlacedDisc {
            p,
            n,
            t,
            m,
            d,
            sx: view.fx * m,
            sy: view.fy * m,
            g: (n.x * d.x + n.y * d.y) - n.z,
            center: Vector2::new(view.cx + view.fx * at.x, view.cy - view.fy * at.y),
        }
    }

    /// The covariance of a disc.
    #[inline(always)]
    pub(super) fn disc(&self, placed: &PlacedDisc<R>, radius: R) -> Covariance<R> {
        let PlacedDisc { n, m, d, sx, sy, g, .. } = *placed;
        let s = radius / self.cutoff;
        let (rx, ry) = (s * sx, s * sy);
        let c = Vector3::new(-(d.x * n.y), d.x * n.x - n.z, n.y);
        let e = Vector3::new(n.z - d.y * n.y, d.y * n.x, -n.x);
        // The z axis projected into the disc's plane, times the variance.
        let z = Vector3::new(-(n.z * n.x), -(n.z * n.y), n.x * n.x + n.y * n.y) * (s * s);
        Covariance {
            xx: (rx * rx) * c.dot(c),
            xy: -((rx * ry) * c.dot(e)),
            yy: (ry * ry) * e.dot(e),
            area: ((rx * ry) * g).abs(),
            half: radius * (n.x * n.x + n.y * n.y).root_of_squares(),
            tilt: Vector2::new((sx * (z.x + d.x * z.z)) * m, -((sy * (z.y + d.y * z.z)) * m)),
        }
    }

    /// The covariance of an ellipse.
    #[inline(always)]
    pub(super) fn ellipse(
        &self,
        placed: &PlacedDisc<R>,
        tangents: [Vector3<R>; 2],
    ) -> Covariance<R> {
        let PlacedDisc { m, d, sx, sy, .. } = *placed;
        // Not by `map`, because it is not inlined.
        let (u, v) = (self.axis(tangents[0]), self.axis(tangents[1]));
        let (ux, uy) = (sx * (u.x + d.x * u.z), -(sy * (u.y + d.y * u.z)));
        let (vx, vy) = (sx * (v.x + d.x * v.z), -(sy * (v.y + d.y * v.z)));
        let normal = u.cross(v);
        let along = (normal.x * d.x + normal.y * d.y) - normal.z;
        Covariance {
            xx: ux * ux + vx * vx,
            xy: ux * uy + vx * vy,
            yy: uy * uy + vy * vy,
            area: ((sx * sy) * along).abs(),
            half: self.cutoff * (u.z * u.z + v.z * v.z).root_of_squares(),
            tilt: Vector2::new((ux * u.z + vx * v.z) * m, (uy * u.z + vy * v.z) * m),
        }
    }

    /// A half axis of the Gaussian in view space.
    #[inline(always)]
    fn axis(&self, tangent: Vector3<R>) -> Vector3<R> {
        let t = self.view.direction(tangent);
        Vector3::new(t.x / self.cutoff, t.y / self.cutoff, t.z / self.cutoff)
    }
}
