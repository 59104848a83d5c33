//! Projection of one surfel: the specification of its [`Footprint`].
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
//! **Covariance.** V0 in px^2 of the disc, a Gaussian of standard deviation s = r/k on its plane,
//! needs no tangent basis: with c = (1, 0, d.x) x n, e = (0, 1, d.y) x n, rx = s sx, ry = s sy
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
//! For an ellipse with half axes k U and k V (its tangents, of any angle between them): each tangent
//! is turned to view space first, then each of its components is divided by k.
//!
//! ```text
//!   a.U = sx (U.x + d.x U.z)   b.U = -(sy (U.y + d.y U.z))        and so for V
//!   xx = (a.U)^2 + (a.V)^2     xy = (a.U) (b.U) + (a.V) (b.V)     yy = (b.U)^2 + (b.V)^2
//!   N = U x V                  area = |(sx sy) ((N.x d.x + N.y d.y) - N.z)|
//!   half = k sqrt(U.z U.z + V.z V.z)
//!   tilt = (((a.U) U.z + (a.V) V.z) m, ((b.U) U.z + (b.V) V.z) m)
//! ```
//!
//! Its plane and its facing are those of the surfel's normal, not of U x V. n is not made a unit
//! vector again in view space.
//!
//! **Nearness** of the plane: w0 = 1/t or -t at the centre, wx = m n.x / (fx g), wy = -m n.y / (fy
//! g) per pixel, the ray-plane intersection relative to the centre. `Decided:` a fragment in the
//! skirt of the low-pass filter, outside the disc, has no meaningful intersection; its nearness is
//! clamped to that of the depths [t - half, t + half], the nearer not nearer than the near plane.
//!
//! **Outline.** `Affine`, the projection linearized at the centre \[ZPvBG01\]: V = V0 + h I,
//!
//! ```text
//!   det = (area area + h (xx + yy)) + h h      xx' = xx + h      yy' = yy + h
//!   ux = sqrt(yy' / det)    uy = -((xy / yy') ux)    vy = 1 / sqrt(yy')
//!   amplitude = area / sqrt(det)
//! ```
//!
//! `Departs:` the amplitude is that of \[ZPvBG01\], whose Gaussians are normalized, times 2 pi s s
//! (of an ellipse 2 pi |U x V|): without the filter every splat has the weight 1 at its centre.
//! Normalization removes the factor where the radii of neighbours are equal; where they differ, a
//! larger splat counts more than there, in proportion to its area. Bounds: k sqrt(xx') and
//! k sqrt(yy') about the centre, by [`super::bounds::around`] with the stretch ux sqrt(xx').
//!
//! `Perspective`, the exact ellipse of the projected disc \[ZRB+04\], then the low-pass filter.
//! `Decided:` \[ZRB+04\] gives the outline as a conic; here its centre and covariance follow from
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
//! `RayCast`, the disc itself with the low-pass filter beside it \[BHZK05\]: the form of V0 alone,
//! times w0 w0 under a perspective camera (scale = w0, else 1), is the squared distance from the
//! centre in the disc's plane, in standard deviations, once divided by w w:
//!
//! ```text
//!   ux = (scale sqrt(yy)) / area     uy = -((xy / yy) ux)     vy = scale / sqrt(yy)
//!   amplitude = 1, or 0 if area is 0
//! ```
//!
//! Bounds: those of the exact outline and of the filter's circle of radius k sqrt(h), both; a disc
//! that reaches the near plane has those of its visible part ([`mod@super::crossing`]). The outline's are k sqrt(xx) and
//! k sqrt(yy) about its centre, each times 1 + (stretch ratio) 2^-18 with stretch = (sqrt(xx)
//! sqrt(yy)) / area and ratio = t / (t - half) (1 under an orthographic camera), and at the end all
//! are moved outwards by 1/128 px.
//!
//! **Fate**, the first of the [`Reasons`] in this arithmetic: `f32` and `f64` may differ. In this
//! order: a surfel whose centre is not farther than the near plane is `Behind`; one whose amplitude
//! is below 2^-96, whose gradient of nearness exceeds 2^96 a pixel, or of which any number is not
//! finite is `Degenerate` (seen edge-on, or astronomically large or small); with culling, one with
//! g >= 0 is `BackFacing` (at 0 it has no area, and is `Degenerate` already); one that cannot be
//! seen is `Outside`: no pixel of the picture is in its bounds, or the sphere about p that holds it,
//! of radius r or, for an ellipse, sqrt(k U . k U + k V . k V), lies beyond a side of the view by
//! more than the reach of the low-pass filter, k sqrt(h) px. For the left side that is
//!
//! ```text
//!   fx p.x + cx t < -(r sqrt(fx fx + cx cx) + (k sqrt(h)) t)      orthographic: t = 1, and fx r
//! ```
//!
//! and so for the others with width - cx and -p.x, cy and -p.y, height - cy and p.y. (`Decided:`
//! beside the camera the ellipse of a disc that is out of sight, linearized at its centre, would
//! reach across the picture. A disc that is partly in sight is drawn.)
//!
//! Source: \[ZPvBG01, sections 3 and 4\]; `Departs:` the determinant is a sum of terms >= 0, where
//! the textbook xx yy - xy xy cancels.

use super::fate::reasons;
use super::frustum::Frustum;
use super::shape::{Covariance, PlacedDisc};
use super::{Disc, Footprint, Kernel, Outline, Reasons, Splat, View, bounds, crossing};
use crate::frame::Rect;
use crate::number::{Exact, Real, Truth, Vector2};

/// All that the projection of a picture's surfels shares.
#[derive(Clone, Copy, Debug)]
pub struct Projector<R> {
    /// The camera.
    pub view: View<R>,
    /// k, the cut-off.
    pub cutoff: R,
    /// h, the variance of the low-pass filter in px^2.
    pub low_pass: R,
    /// How a disc becomes a shape.
    pub outline: Outline,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
    /// The sides of the view.
    pub(super) frustum: Frustum<R>,
}

/// Projects one surfel; see the module page. The splat is meaningless unless there is no reason not
/// to draw it.
#[must_use]
pub fn project<R: Exact>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
) -> (Splat<R>, Reasons<R>) {
    let (placed, shape) = projector.shape(disc);
    let crosses = projector.reaches_near_plane(&placed, &shape);
    projector.splat(disc, (&placed, &shape), crosses, surfel)
}

/// [`project`] of a surfel that reaches the near plane, or does not, as `crosses` says: what a
/// number that cannot decide [`Projector::crosses`] asks for twice.
#[inline(never)]
#[must_use]
pub fn project_as<R: Real>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
    crosses: bool,
) -> (Splat<R>, Reasons<R>) {
    let (placed, shape) = projector.shape(disc);
    projector.splat(disc, (&placed, &shape), crosses, surfel)
}

/// Runs `each` for the outlines that a surfel may have: splat, the reasons not to draw it, and
/// whether it reaches the near plane. That is [`project_as`] once, or twice where the latter is
/// undecided; not at all of a surfel that certainly is not drawn, as its place alone says: only
/// what is left has its shape computed.
#[inline(always)]
pub(crate) fn project_each<R: Real>(
    projector: &Projector<R>,
    disc: &Disc<R>,
    surfel: u32,
    mut each: impl FnMut(Splat<R>, Reasons<R>, R::Truth),
) {
    let placed = projector.place(disc.position, disc.normal);
    if projector.turned_away(&placed).certainly() {
        return;
    }
    let unseen = projector.unseen(&placed, disc.reach());
    if unseen.any().certainly() {
        return;
    }
    let shape = projector.covariance(&placed, disc);
    let crosses = projector.reaches_near_plane(&placed, &shape);
    for alternative in [false, true] {
        let possible = if alternative { crosses.possibly() } else { !crosses.certainly() };
        if possible {
            let (footprint, bounds) = projector.footprint(disc, (&placed, &shape), alternative);
            let back = placed.g.gt(R::ZERO);
            let reasons = reasons(unseen, &footprint, &bounds);
            each(Splat { footprint, bounds, surfel, back }, reasons, crosses);
        }
    }
}

impl<R: Real> Projector<R> {
    /// The shared numbers of a picture.
    #[must_use]
    pub fn new(view: View<R>, kernel: &Kernel, cull: bool) -> Self {
        Self {
            frustum: Frustum::new(&view, kernel),
            view,
            cutoff: R::from_f32(kernel.cutoff),
            low_pass: R::from_f32(kernel.low_pass),
            outline: kernel.outline,
            cull,
        }
    }

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

    /// The splat by the outline of the picture, and the reasons not to draw it.
    #[inline(always)]
    fn splat(
        &self,
        disc: &Disc<R>,
        (placed, shape): (&PlacedDisc<R>, &Covariance<R>),
        crosses: bool,
        surfel: u32,
    ) -> (Splat<R>, Reasons<R>) {
        let (footprint, bounds) = self.footprint(disc, (placed, shape), crosses);
        let reasons = reasons(self.unseen(placed, disc.reach()), &footprint, &bounds);
        (Splat { footprint, bounds, surfel, back: placed.g.gt(R::ZERO) }, reasons)
    }

    /// The footprint by the outline of the picture, and the pixels that can be inside.
    #[inline(always)]
    fn footprint(
        &self,
        disc: &Disc<R>,
        (placed, shape): (&PlacedDisc<R>, &Covariance<R>),
        crosses: bool,
    ) -> (Footprint<R>, Rect) {
        match self.outline {
            Outline::Perspective if self.view.perspective && !crosses => {
                self.perspective(placed, shape)
            }
            Outline::Affine | Outline::Perspective => self.affine(placed, shape),
            Outline::RayCast => self.ray_cast(placed, shape, disc, crosses),
        }
    }

    /// A surfel in view space, and its covariance.
    #[inline(always)]
    fn shape(&self, disc: &Disc<R>) -> (PlacedDisc<R>, Covariance<R>) {
        let placed = self.place(disc.position, disc.normal);
        (placed, self.covariance(&placed, disc))
    }

    #[inline(always)]
    fn covariance(&self, placed: &PlacedDisc<R>, disc: &Disc<R>) -> Covariance<R> {
        match disc.tangents {
            None => self.disc(placed, disc.radius),
            Some(tangents) => self.ellipse(placed, tangents),
        }
    }

    /// An affine disc without a branch, so that a loop over discs, or over ellipses, vectorizes:
    /// footprint, bounds, whether its back is seen and whether it reaches the near plane, and the
    /// reasons not to draw it.
    #[inline(always)]
    pub(super) fn affine_disc(
        &self,
        disc: &Disc<R>,
    ) -> (Footprint<R>, Rect, [R::Truth; 2], Reasons<R>) {
        let (placed, shape) = self.shape(disc);
        let (footprint, bounds) = self.affine(&placed, &shape);
        let reasons = reasons(self.unseen(&placed, disc.reach()), &footprint, &bounds);
        let crosses = self.reaches_near_plane(&placed, &shape);
        (footprint, bounds, [placed.g.gt(R::ZERO), crosses], reasons)
    }

    /// The projection linearized at the centre.
    #[inline(always)]
    fn affine(&self, placed: &PlacedDisc<R>, shape: &Covariance<R>) -> (Footprint<R>, Rect) {
        self.gaussian(placed, shape, placed.center, self.view.nearness(placed.t))
    }

    /// The exact ellipse of the projected disc, convolved with the low-pass filter.
    fn perspective(&self, placed: &PlacedDisc<R>, shape: &Covariance<R>) -> (Footprint<R>, Rect) {
        let (shape, center, rest) = self.outline(placed, shape);
        self.gaussian(placed, &shape, center, placed.m / rest)
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

    /// The disc by ray casting, the low-pass filter beside it.
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

    /// The plane and the range of nearness; the other fields are 0.
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
