//! Project one surfel: the specification of its [`Footprint`].
//!
//! **Placing.** p and n are the centre and the normal in view space, t = -p.z. Under a perspective
//! camera m = 1/t and the ray through the centre is d = (p.x m, p.y m, -1); under an orthographic
//! one m = 1 and d = (0, 0, -1). The rows of the projection's Jacobian, in px per world unit, are
//!
//! ```text
//!   a = dX/dp = sx (1, 0, d.x)       sx = fx m
//!   b = dY/dp = -sy (0, 1, d.y)      sy = fy m
//!   X = cx + fx d.x  (p.x if orthographic)      Y = cy - fy d.y  (p.y)
//!   g = (n.x d.x + n.y d.y) - n.z               < 0: the front is seen
//! ```
//!
//! **Covariance.** V0 is the covariance of the disc on the screen, in px^2; the disc is a Gaussian
//! of standard deviation s = r/k on its plane. No tangent basis is needed. With c = (1, 0, d.x) x
//! n, e = (0, 1, d.y) x n, rx = s sx, ry = s sy:
//!
//! ```text
//!   xx = (rx rx) c.c      xy = -((rx ry) c.e)      yy = (ry ry) e.e      area = |(rx ry) g|
//!   half = r sqrt(n.x n.x + n.y n.y)               half the disc's range of depth
//!   tilt = (a.z', b.z') m,  z' = s s (z - n.z n)   how nearness grows over V0
//! ```
//!
//! and `area` is sqrt(det V0). In order of evaluation:
//!
//! ```text
//!   c  = (-(d.x n.y), (d.x n.x) - n.z, n.y)        e = (n.z - (d.y n.y), d.y n.x, -n.x)
//!   z' = (-(n.z n.x), -(n.z n.y), n.x n.x + n.y n.y), each times (s s)
//!   a.z' = sx (z'.x + d.x z'.z)                    b.z' = -(sy (z'.y + d.y z'.z))
//! ```
//!
//! An ellipse has half axes k U and k V (its tangents, with any angle between them). Each tangent
//! is first turned to view space, then each of its components is divided by k.
//!
//! ```text
//!   a.U = sx (U.x + d.x U.z)   b.U = -(sy (U.y + d.y U.z))        and so for V
//!   xx = (a.U)^2 + (a.V)^2     xy = (a.U) (b.U) + (a.V) (b.V)     yy = (b.U)^2 + (b.V)^2
//!   N = U x V                  area = |(sx sy) ((N.x d.x + N.y d.y) - N.z)|
//!   half = k sqrt(U.z U.z + V.z V.z)
//!   tilt = (((a.U) U.z + (a.V) V.z) m, ((b.U) U.z + (b.V) V.z) m)
//! ```
//!
//! Its plane and its facing follow from the surfel's normal, not from U x V. n is not made a unit
//! vector again in view space.
//!
//! **Nearness** of the plane: w0 = 1/t or -t at the centre, wx = m n.x / (fx g), wy = -m n.y / (fy
//! g) per pixel, the ray-plane intersection relative to the centre. `Decided:` a fragment in the
//! skirt of the low-pass filter, outside the disc, has no meaningful intersection. Its nearness is
//! clamped to the nearness of the depths [t - half, t + half], the nearer not nearer than the near
//! plane.
//!
//! **Outline.** `Affine`, the projection linearized at the centre \[ZPvBG01\]: V = V0 + h I,
//!
//! ```text
//!   det = (area area + h (xx + yy)) + h h      xx' = xx + h      yy' = yy + h
//!   ux = sqrt(yy' / det)    uy = -((xy / yy') ux)    vy = 1 / sqrt(yy')
//!   amplitude = area / sqrt(det)
//! ```
//!
//! `Departs:` the amplitude is the amplitude of \[ZPvBG01\], whose Gaussians are normalized, times
//! 2 pi s s (for an ellipse 2 pi |U x V|). So without the filter every splat has the weight 1 at
//! its centre. Normalization removes the factor where the radii of neighbours are equal. Where they
//! differ, a larger splat counts more than in \[ZPvBG01\], in proportion to its area. Bounds: k
//! sqrt(xx') and k sqrt(yy') about the centre, by [`super::bounds::around`] with the stretch ux
//! sqrt(xx').
//!
//! `Perspective`, the exact ellipse of the projected disc \[ZRB+04\], then the low-pass filter.
//! `Decided:` \[ZRB+04\] gives the outline as a conic. Here its centre and covariance follow from
//! V0 by a rank-one update, without cancellation. With rest = ((t - half)/t) ((t + half)/t) and
//! factor = (k k) / rest, before the formulas of `Affine`:
//!
//! ```text
//!   centre += factor tilt        w0 = m / rest       area := (area / rest) / sqrt(rest)
//!   xx := (xx + factor (tilt.x tilt.x)) / rest       and so for xy, yy
//! ```
//!
//! A disc with t - half <= near has no ellipse and is drawn `Affine`. Under an orthographic camera
//! the affine outline is exact.
//!
//! `RayCast`, the disc itself with the low-pass filter beside it \[BHZK05\]. The form of V0 alone,
//! times w0 w0 under a perspective camera (scale = w0, else 1), is the squared distance from the
//! centre in the disc's plane, in standard deviations, once divided by w w:
//!
//! ```text
//!   ux = (scale sqrt(yy)) / area     uy = -((xy / yy) ux)     vy = scale / sqrt(yy)
//!   amplitude = 1, or 0 if area is 0
//! ```
//!
//! Bounds: they contain both the exact outline and the filter's circle of radius k sqrt(h). A disc
//! that reaches the near plane has the bounds of its visible part ([`mod@super::crossing`]) instead
//! of the outline's. The outline's bounds are k sqrt(xx) and k sqrt(yy) about its centre, each
//! times 1 + (stretch ratio) 2^-18. Here stretch = (sqrt(xx) sqrt(yy)) / area and ratio = t / (t -
//! half) (1 under an orthographic camera). At the end all bounds are moved outwards by 1/128 px.
//!
//! **Fate** is the first of the [`Reasons`] that holds in this arithmetic; `f32` and `f64` may
//! differ. In this order:
//!
//! 1. `Behind`: the centre is not farther than the near plane.
//! 2. `Degenerate`: the amplitude is below 2^-96, the gradient of nearness exceeds 2^96 a pixel, or
//!    any number is not finite. Such a surfel is seen edge-on, or is astronomically large or small.
//! 3. `BackFacing`: with culling, g >= 0. (At 0 the surfel has no area, and is `Degenerate`
//!    already.)
//! 4. `Outside`: the surfel cannot be seen. Either no pixel of the picture is in its bounds, or its
//!    bounding sphere lies beyond a side of the view. Beyond means by more than the reach of the
//!    low-pass filter, k sqrt(h) px. The sphere has its centre at p and the radius r or, for an
//!    ellipse, sqrt(k U . k U + k V . k V). For the left side the condition is
//!
//! ```text
//!   fx p.x + cx t < -(r sqrt(fx fx + cx cx) + (k sqrt(h)) t)      orthographic: t = 1, and fx r
//! ```
//!
//! and so for the others with width - cx and -p.x, cy and -p.y, height - cy and p.y. (`Decided:`
//! beside the camera, the ellipse of a disc out of sight, linearized at its centre, would reach
//! across the picture. A disc that is partly in sight is drawn.)
//!
//! Source: \[ZPvBG01, sections 3 and 4\]; `Departs:` the determinant is a sum of terms >= 0,
//! because the textbook xx yy - xy xy cancels.

use super::fate::reasons;
use super::shape::{Covariance, PlacedDisc};
use super::{Disc, Footprint, Outline, Projector, Reasons, Splat, bounds, crossing};
use crate::frame::Rect;
use crate::number::{Exact, Real, Truth, Vector2};

/// Projects one surfel; see the module page. The splat is meaningless if there is any reason not to
/// draw it.
#[must_use]
pub fn project<R: Exact>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
) -> (Splat<R>, Reasons<R>) {
    let (placed, shape) = projector.shape(disc);
    let crosses = projector.reaches_near_plane(&placed, &shape);
    projector.splat(disc, &placed, &shape, crosses, surfel)
}

/// [`project`] where `crosses` says whether the surfel reaches the near plane. A number that cannot
/// decide [`Projector::crosses`] calls this twice.
#[inline(never)]
#[must_use]
pub fn project_as<R: Real>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
    crosses: bool,
) -> (Splat<R>, Reasons<R>) {
    let placed = projector.placed(disc);
    let unseen = projector.unseen_if_placed(&placed, disc);
    let shape = projector.shape_if_placed(&placed, disc);
    let (footprint, bounds, reasons) =
        projector.footprint_of_shape(disc, &placed, &shape, unseen, crosses);
    (Splat { footprint, bounds, surfel, back: placed.g.gt(R::ZERO) }, reasons)
}

/// Calls `each` for every outline that a surfel may have: with the splat, the reasons not to draw
/// it, and whether it reaches the near plane. That is [`project_as`] once, or twice where the near
/// plane is undecided. It does not call `each` at all if the place alone shows that the surfel is
/// certainly not drawn; then no shape is computed.
#[inline(always)]
pub(crate) fn project_each<R: Real>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
    mut each: impl FnMut(Splat<R>, Reasons<R>, R::Truth),
) {
    let placed = projector.placed(disc);
    if projector.turned_away(&placed).certainly() {
        return;
    }
    let unseen = projector.unseen_if_placed(&placed, disc);
    if unseen.any().certainly() {
        return;
    }
    let shape = projector.shape_if_placed(&placed, disc);
    let crosses = projector.reaches_near_plane(&placed, &shape);
    for alternative in [false, true] {
        // Each outcome of the near-plane test that is possible gives an outline.
        let possible = if alternative { crosses.possibly() } else { !crosses.certainly() };
        if possible {
            let (footprint, bounds, reasons) =
                projector.footprint_of_shape(disc, &placed, &shape, unseen, alternative);
            let back = placed.g.gt(R::ZERO);
            each(Splat { footprint, bounds, surfel, back }, reasons, crosses);
        }
    }
}

/// The steps of [`project_as`] and [`project_each`]. Each step is compiled once, because in balls a step is 10 to
/// 60 kB of code.
impl<R: Real> Projector<R> {
    #[inline(never)]
    fn placed(&self, disc: &Disc<R>) -> PlacedDisc<R> {
        self.place(disc.position, disc.normal)
    }

    #[inline(never)]
    fn unseen_if_placed(&self, placed: &PlacedDisc<R>, disc: &Disc<R>) -> Reasons<R> {
        self.unseen(placed, disc.reach())
    }

    #[inline(never)]
    fn shape_if_placed(&self, placed: &PlacedDisc<R>, disc: &Disc<R>) -> Covariance<R> {
        self.covariance(placed, disc)
    }

    #[inline(never)]
    fn footprint_of_shape(
        &self,
        disc: &Disc<R>,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        unseen: Reasons<R>,
        crosses: bool,
    ) -> (Footprint<R>, Rect, Reasons<R>) {
        let (footprint, bounds) = self.footprint(disc, placed, shape, crosses);
        (footprint, bounds, reasons(unseen, &footprint, &bounds))
    }
}

impl<R: Real> Projector<R> {
    /// Whether a disc reaches the near plane of a perspective camera, t - half <= near, so that its
    /// outline is no ellipse.
    #[must_use]
    pub fn crosses(&self, disc: &Disc<R>) -> R::Truth {
        let (placed, shape) = self.shape(disc);
        self.reaches_near_plane(&placed, &shape)
    }

    /// The area of V0.
    pub(crate) fn area(&self, disc: &Disc<R>) -> R {
        self.shape(disc).1.area
    }

    /// See [`Projector::crosses`].
    #[inline(always)]
    fn reaches_near_plane(&self, placed: &PlacedDisc<R>, shape: &Covariance<R>) -> R::Truth {
        R::Truth::from(self.view.perspective) & !(placed.t - shape.half).gt(self.view.near)
    }

    /// The splat with the outline of the picture, and the reasons not to draw it.
    #[inline(always)]
    fn splat(
        &self,
        disc: &Disc<R>,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        crosses: bool,
        surfel: u32,
    ) -> (Splat<R>, Reasons<R>) {
        let (footprint, bounds) = self.footprint(disc, placed, shape, crosses);
        let reasons = reasons(self.unseen(placed, disc.reach()), &footprint, &bounds);
        (Splat { footprint, bounds, surfel, back: placed.g.gt(R::ZERO) }, reasons)
    }

    /// The footprint with the outline of the picture, and the pixels that may be inside.
    #[inline(always)]
    fn footprint(
        &self,
        disc: &Disc<R>,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        crosses: bool,
    ) -> (Footprint<R>, Rect) {
        if self.outline == Outline::RayCast {
            return self.ray_cast(placed, shape, disc, crosses);
        }
        // One call, because it is compiled in line.
        let exact = self.outline == Outline::Perspective && self.view.perspective && !crosses;
        let (shape, center, w0) = if exact {
            let (shape, center, rest) = self.outline(placed, shape);
            (shape, center, placed.m / rest)
        } else {
            (*shape, placed.center, self.view.nearness(placed.t))
        };
        self.gaussian(placed, &shape, center, w0)
    }

    /// Computes a surfel in view space, and its covariance.
    #[inline(always)]
    fn shape(&self, disc: &Disc<R>) -> (PlacedDisc<R>, Covariance<R>) {
        let placed = self.place(disc.position, disc.normal);
        (placed, self.covariance(&placed, disc))
    }

    #[inline(always)]
    pub(super) fn covariance(&self, placed: &PlacedDisc<R>, disc: &Disc<R>) -> Covariance<R> {
        match disc.tangents {
            None => self.disc(placed, disc.radius),
            Some(tangents) => self.ellipse(placed, tangents),
        }
    }

    /// Projects an affine disc without a branch, so that a loop over discs, or over ellipses,
    /// vectorizes. Returns the footprint, the bounds, whether its back is seen and whether it
    /// reaches the near plane, and the reasons not to draw it.
    #[inline(always)]
    pub(super) fn affine_disc(
        &self,
        disc: &Disc<R>,
    ) -> (Footprint<R>, Rect, [R::Truth; 2], Reasons<R>) {
        let (placed, shape) = self.shape(disc);
        self.affine_shape(&placed, &shape, disc.reach())
    }

    /// [`Projector::affine_disc`] for a shape whose bounding sphere has the radius `reach`.
    #[inline(always)]
    pub(super) fn affine_shape(
        &self,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        reach: R,
    ) -> (Footprint<R>, Rect, [R::Truth; 2], Reasons<R>) {
        let (footprint, bounds) = self.affine(placed, shape);
        let reasons = reasons(self.unseen(placed, reach), &footprint, &bounds);
        let crosses = self.reaches_near_plane(placed, shape);
        (footprint, bounds, [placed.g.gt(R::ZERO), crosses], reasons)
    }

    /// The projection linearized at the centre.
    #[inline(always)]
    fn affine(&self, placed: &PlacedDisc<R>, shape: &Covariance<R>) -> (Footprint<R>, Rect) {
        self.gaussian(placed, shape, placed.center, self.view.nearness(placed.t))
    }

    /// The covariance and the centre of the exact outline, and `rest`.
    fn outline(
        &self,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
    ) -> (Covariance<R>, Vector2<R>, R) {
        let Covariance { half, tilt, .. } = *shape;
        let t = placed.t;
        let rest = ((t - half) / t) * ((t + half) / t);
        let factor = (self.cutoff * self.cutoff) / rest;
        let exact = Covariance {
            xx: (shape.xx + factor * (tilt.x * tilt.x)) / rest,
            xy: (shape.xy + factor * (tilt.x * tilt.y)) / rest,
            yy: (shape.yy + factor * (tilt.y * tilt.y)) / rest,
            area: (shape.area / rest) / rest.sqrt(),
            ..*shape
        };
        let c = placed.center;
        (exact, Vector2::new(c.x + factor * tilt.x, c.y + factor * tilt.y), rest)
    }

    /// The disc by ray casting, with the low-pass filter beside it.
    fn ray_cast(
        &self,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        disc: &Disc<R>,
        crosses: bool,
    ) -> (Footprint<R>, Rect) {
        let view = &self.view;
        let w0 = view.nearness(placed.t);
        let mut footprint = self.nearness(placed, shape, placed.center, w0);
        let scale = if view.perspective { w0 } else { R::ONE };
        footprint.ux = (scale * shape.yy.sqrt()) / shape.area;
        footprint.uy = -((shape.xy / shape.yy) * footprint.ux);
        footprint.vy = scale / shape.yy.sqrt();
        footprint.amplitude = R::select(shape.area.gt(R::ZERO), R::ONE, R::ZERO);

        // A disc that reaches the near plane has no outline; its visible part has bounds.
        let (low, high) = if crosses {
            crossing::corners(view, placed, disc)
        } else {
            let (exact, center) = if view.perspective {
                let (exact, center, _) = self.outline(placed, shape);
                (exact, center)
            } else {
                (*shape, placed.center)
            };
            let stretch = (exact.xx.sqrt() * exact.yy.sqrt()) / exact.area;
            let ratio = if view.perspective { placed.t / (placed.t - shape.half) } else { R::ONE };
            let grow = R::ONE + (stretch * ratio) * R::from_f32(1.0 / 262_144.0);
            let ex = (self.cutoff * exact.xx.sqrt()) * grow;
            let ey = (self.cutoff * exact.yy.sqrt()) * grow;
            (Vector2::new(center.x - ex, center.y - ey), Vector2::new(center.x + ex, center.y + ey))
        };
        let circle = self.cutoff * self.low_pass.sqrt();
        let slack = R::from_f32(1.0 / 128.0);
        let c = placed.center;
        let low =
            Vector2::new(low.x.at_most(c.x - circle) - slack, low.y.at_most(c.y - circle) - slack);
        let high = Vector2::new(
            high.x.at_least(c.x + circle) + slack,
            high.y.at_least(c.y + circle) + slack,
        );
        (footprint, bounds::between(view, low, high))
    }

    /// A Gaussian of covariance V0 + h I about `center`.
    #[inline(always)]
    fn gaussian(
        &self,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        center: Vector2<R>,
        w0: R,
    ) -> (Footprint<R>, Rect) {
        let h = self.low_pass;
        let det = (shape.area * shape.area + h * (shape.xx + shape.yy)) + h * h;
        let (xx, yy) = (shape.xx + h, shape.yy + h);
        let mut footprint = self.nearness(placed, shape, center, w0);
        footprint.ux = (yy / det).sqrt();
        footprint.uy = -((shape.xy / yy) * footprint.ux);
        footprint.vy = R::ONE / yy.sqrt();
        footprint.amplitude = shape.area / det.sqrt();
        let extent = Vector2::new(self.cutoff * xx.sqrt(), self.cutoff * yy.sqrt());
        let bounds = bounds::around(&self.view, center, extent, footprint.ux * xx.sqrt());
        (footprint, bounds)
    }

    /// Sets the plane and the range of nearness; the other fields are 0.
    #[inline(always)]
    fn nearness(
        &self,
        placed: &PlacedDisc<R>,
        shape: &Covariance<R>,
        center: Vector2<R>,
        w0: R,
    ) -> Footprint<R> {
        let view = &self.view;
        let PlacedDisc { n, t, m, g, .. } = *placed;
        let near = (t - shape.half).at_least(view.near);
        Footprint {
            center,
            ux: R::ZERO,
            uy: R::ZERO,
            vy: R::ZERO,
            w0,
            wx: (m * n.x) / (view.fx * g),
            wy: -((m * n.y) / (view.fy * g)),
            w_far: view.nearness(t + shape.half),
            w_near: view.nearness(near),
            amplitude: R::ZERO,
        }
    }
}
