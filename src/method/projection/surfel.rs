//! One surfel as one pixel, see the page of [`super`].

use super::{Kind, Sample};
use crate::number::{Exact, Vector2, Vector3};
use crate::splat::{Fate, View, ellipse};

/// What the projection of a picture's surfels shares.
#[derive(Clone, Copy, Debug)]
pub struct Lens<R> {
    /// The camera.
    pub view: View<R>,
    /// f = sqrt(fx fy): pixels per world unit at depth 1.
    pub focal: R,
    /// Whether what is seen from behind is dropped.
    pub cull: bool,
}

/// A point of the scene before the camera.
#[derive(Clone, Copy, Debug)]
pub struct Placed<R> {
    /// In view space.
    pub p: Vector3<R>,
    /// Depth.
    pub t: R,
    /// 1/t, or 1.
    pub m: R,
    /// In the picture.
    pub center: Vector2<R>,
}

impl<R: Exact> Lens<R> {
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

    /// Where a point in view space is.
    #[inline(always)]
    #[must_use]
    pub fn place(&self, p: Vector3<R>) -> Placed<R> {
        let view = &self.view;
        let t = -p.z;
        let m = self.scale(t);
        let center = Vector2::new(view.cx + view.fx * (p.x * m), view.cy - view.fy * (p.y * m));
        Placed { p, t, m, center }
    }

    /// How a surface turns: < 0 if its front is seen.
    #[inline(always)]
    #[must_use]
    pub fn facing(&self, placed: &Placed<R>, n: Vector3<R>) -> R {
        if self.view.perspective {
            (n.x * (placed.p.x * placed.m) + n.y * (placed.p.y * placed.m)) - n.z
        } else {
            -n.z
        }
    }

    /// The fate of a surfel without a branch, so that a loop over it vectorizes: where it is, g,
    /// fate.
    #[inline(always)]
    #[must_use]
    pub fn fate(&self, position: Vector3<R>, n: Vector3<R>) -> (Placed<R>, R, Fate) {
        let view = &self.view;
        let placed = self.place(view.point(position));
        let g = self.facing(&placed, n);
        let Vector2 { x, y } = placed.center;
        let inside = (x >= R::ZERO) & (x < view.width) & (y >= R::ZERO) & (y < view.height);
        let sound = x.is_finite() & y.is_finite() & placed.t.is_finite() & g.is_finite();
        let fate = if inside { Fate::Visible } else { Fate::Outside };
        let fate = if self.cull & (g >= R::ZERO) { Fate::BackFacing } else { fate };
        let fate = if sound { fate } else { Fate::Degenerate };
        let fate = if placed.t > view.near { fate } else { Fate::Behind };
        (placed, g, fate)
    }

    /// The sample of a surfel at a place; n in view space, g as [`Lens::facing`].
    #[inline(always)]
    #[must_use]
    pub fn sample(
        &self,
        placed: &Placed<R>,
        (n, g): (Vector3<R>, R),
        radius: R,
        (id, color): (u32, [R; 3]),
    ) -> Sample<R> {
        let n = if g > R::ZERO { -n } else { n };
        Sample {
            kind: Kind::Surface,
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
