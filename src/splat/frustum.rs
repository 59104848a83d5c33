//! The sides of the view.

use super::{Kernel, View};
use crate::number::{Real, Vector3};

/// The four sides of the visible region, moved out by the reach of the low-pass filter.
#[derive(Clone, Copy, Debug)]
pub struct Frustum<R> {
    sides: [FrustumSide<R>; 4],
    /// k sqrt(h), in px.
    skirt: R,
    perspective: bool,
}

/// A side of the view: a point (x, y) at depth t is `along x + across y + past t` px t inside.
#[derive(Clone, Copy, Debug)]
struct FrustumSide<R> {
    along: R,
    across: R,
    past: R,
    /// How much that value changes per world unit towards the outside.
    slope: R,
}

impl<R: Real> Frustum<R> {
    /// Computes the sides for a camera and a kernel.
    #[must_use]
    pub fn new(view: &View<R>, kernel: &Kernel) -> Self {
        let side = |along: R, across: R, past: R| {
            let scale = along + across;
            let slope =
                if view.perspective { (scale * scale + past * past).sqrt() } else { scale.abs() };
            FrustumSide { along, across, past, slope }
        };
        let (o, &View { fx, fy, cx, cy, .. }) = (R::ZERO, view);
        let sides = [
            side(fx, o, cx),
            side(-fx, o, view.width - cx),
            side(o, -fy, cy),
            side(o, fy, view.height - cy),
        ];
        Self {
            sides,
            skirt: R::from_f32(kernel.cutoff) * R::from_f32(kernel.low_pass).sqrt(),
            perspective: view.perspective,
        }
    }

    /// Whether a sphere about a point p of view space, at depth t, reaches into the view: the
    /// condition of [`mod@super::project`], reason `outside`.
    #[inline(always)]
    pub fn touches(&self, p: Vector3<R>, t: R, radius: R) -> R::Truth {
        let t = if self.perspective { t } else { R::ONE };
        let (p, skirt) = ([p.x, p.y, t], self.skirt * t);
        let [left, right, top, bottom] = &self.sides;
        left.holds(p, radius, skirt)
            & right.holds(p, radius, skirt)
            & top.holds(p, radius, skirt)
            & bottom.holds(p, radius, skirt)
    }
}

impl<R: Real> FrustumSide<R> {
    /// Whether a sphere reaches over this side to the inside.
    #[inline(always)]
    fn holds(&self, [x, y, t]: [R; 3], radius: R, skirt: R) -> R::Truth {
        let distance = (self.along * x + self.across * y) + self.past * t;
        distance.ge(-(radius * self.slope + skirt))
    }
}
