//! Draw one surfel as one pixel, see the page of [`super`].

use super::{PixelSample, SampleKind};
use crate::number::{Exact, Real, Vector2, Vector3};
use crate::splat::{Fate, Reasons, View, ellipse};

/// The shared numbers of a picture's surfels.
#[derive(Clone, Copy, Debug)]
pub struct PointProjector<R> {
    /// The camera.
    pub view: View<R>,
    /// f = sqrt(fx fy): pixels per world unit at depth 1.
    pub focal: R,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
}

/// A point of the scene, placed before the camera.
#[derive(Clone, Copy, Debug)]
pub struct PlacedPoint<R> {
    /// Position in view space.
    pub p: Vector3<R>,
    /// Depth.
    pub t: R,
    /// 1/t, or 1.
    pub m: R,
    /// Position in the picture.
    pub center: Vector2<R>,
}

impl<R: Real> PlacedPoint<R> {
    /// The pixel that the point is drawn into: column and row, for a point in the picture.
    #[must_use]
    pub fn pixel(&self) -> [R::Pixel; 2] {
        [self.center.x.to_pixel(), self.center.y.to_pixel()]
    }
}

impl<R: Exact> PointProjector<R> {
    /// [`PointProjector::reasons`] as a fate, without a branch, so that a loop over it vectorizes.
    /// Returns the placed surfel, g and the fate.
    #[inline(always)]
    #[must_use]
    pub fn fate(&self, position: Vector3<R>, n: Vector3<R>) -> (PlacedPoint<R>, R, Fate) {
        let (placed, g, reasons) = self.reasons(position, n);
        (placed, g, reasons.fate())
    }
}

impl<R: Real> PointProjector<R> {
    /// The shared numbers of a picture.
    #[must_use]
    pub fn new(view: View<R>, cull: bool) -> Self {
        Self { view, focal: (view.fx * view.fy).sqrt(), cull }
    }

    /// m at a depth: 1/t, or 1.
    #[inline(always)]
    #[must_use]
    pub fn scale(&self, t: R) -> R {
        if self.view.perspective { R::ONE / t } else { R::ONE }
    }

    /// Places a point in view space.
    #[inline(always)]
    #[must_use]
    pub fn place(&self, p: Vector3<R>) -> PlacedPoint<R> {
        let view = &self.view;
        let t = -p.z;
        let m = self.scale(t);
        let center = Vector2::new(view.cx + view.fx * (p.x * m), view.cy - view.fy * (p.y * m));
        PlacedPoint { p, t, m, center }
    }

    /// g, how a surface is turned: < 0 if its front is seen.
    #[inline(always)]
    #[must_use]
    pub fn facing(&self, placed: &PlacedPoint<R>, n: Vector3<R>) -> R {
        self.facing_along(Vector2::new(placed.p.x * placed.m, placed.p.y * placed.m), n)
    }

    /// [`PointProjector::facing`] of a point whose position in view space is, by its depth, `ray`.
    #[inline(always)]
    pub(crate) fn facing_along(&self, ray: Vector2<R>, n: Vector3<R>) -> R {
        if self.view.perspective { (n.x * ray.x + n.y * ray.y) - n.z } else { -n.z }
    }

    /// Places a surfel, and returns g and the reasons not to draw it; `n` is the normal in view
    /// space.
    #[inline(always)]
    #[must_use]
    pub fn reasons(&self, position: Vector3<R>, n: Vector3<R>) -> (PlacedPoint<R>, R, Reasons<R>) {
        let view = &self.view;
        let placed = self.place(view.point(position));
        let g = self.facing(&placed, n);
        let Vector2 { x, y } = placed.center;
        let inside = x.ge(R::ZERO) & x.lt(view.width) & y.ge(R::ZERO) & y.lt(view.height);
        let sound = x.is_finite() & y.is_finite() & placed.t.is_finite() & g.is_finite();
        let reasons = Reasons {
            behind: !placed.t.gt(view.near),
            degenerate: !sound,
            back_facing: R::Truth::from(self.cull) & g.ge(R::ZERO),
            outside: !inside,
        };
        (placed, g, reasons)
    }

    /// The sample of a placed surfel; n is in view space, g as in [`PointProjector::facing`].
    #[inline(always)]
    #[must_use]
    pub fn sample(
        &self,
        id: u32,
        placed: &PlacedPoint<R>,
        n: Vector3<R>,
        g: R,
        radius: R,
        color: [R; 3],
    ) -> PixelSample<R> {
        let away = g.gt(R::ZERO);
        let n = n.map(|component| R::select(away, -component, component));
        PixelSample {
            kind: SampleKind::Surface,
            id,
            // Adding 0 turns -0 into +0.
            depth: placed.t + R::ZERO,
            radius,
            extent: ellipse::radius_in_pixels(radius, self.focal, placed.m),
            center: placed.center,
            normal: Vector3::new(n.x + R::ZERO, n.y + R::ZERO, n.z + R::ZERO),
            tangent: Vector3::ZERO,
            color,
        }
    }
}
