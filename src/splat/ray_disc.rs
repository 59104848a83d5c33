//! Meet a disc with the rays of pixels: the specification of a 2D Gaussian splat (2DGS).
//!
//! A projected Gaussian is an ellipse in the picture, which is linearized at its centre. A ray that
//! meets the plane of a disc needs no such approximation. [`DiscRule`] chooses. The notation is the one
//! of [`mod@super::gaussian`].
//!
//! **Axes** A and B, each one standard deviation long, in the world:
//!
//! ```text
//!   Gaussian               A_i = R_i0 s_0, B_i = R_i1 s_1; the third scale is not used
//!   elliptical surfel      its tangents divided by k
//!   round surfel           s = radius / k, (x, y, z) = normal / its length
//!     g = 1 if z >= 0, else -1      a = -1 / (g + z)      b = (x y) a
//!     A = ((1 + (g (x x)) a) s, (g b) s, -(g x) s)      B = (b s, (g + (y y) a) s, -y s)
//! ```
//!
//! **Images.** a = W A and b = W B in the camera frame, where the centre is (x, y, t). (X, Y) is the
//! projected centre. A point at u A + v B from the centre is seen at
//!
//! ```text
//!   (X, Y) + (u ai + v bi) / (w + u az + v bz)      at the depth t + (u a.z + v b.z)
//!   perspective    ai = (fx (a.x - (x/t) a.z), fy (a.y - (y/t) a.z)), az = a.z, w = t; likewise b
//!   orthographic   ai = (fx a.x, fy a.y), az = 0, w = 1; likewise b
//! ```
//!
//! **Ray** of the pixel (i, j), by Cramer's rule:
//!
//! ```text
//!   dx = (i + 1/2) - X              dy = (j + 1/2) - Y
//!   k = (ai.x - dx az, bi.x - dx bz)      l = (ai.y - dy az, bi.y - dy bz)
//!   D = k0 l1 - k1 l0
//!   u = (w (dx l1 - dy k1)) / D           v = (w (dy k0 - dx l0)) / D
//!   rho3d = u u + v v                     z = t + (u a.z + v b.z)
//!   rho2d = (ex ex + ey ey) / h           ex = F.x - (i + 1/2), ey = F.y - (j + 1/2)
//! ```
//!
//! h is [`GaussianKernel::low_pass`], the variance of the low-pass filter about F. With h = 0 there is
//! no filter, and rho2d = +inf. near is [`GaussianKernel::near`], or the camera's near plane where that is 0.
//!
//! | | [`DiscRule::Ray`] | [`DiscRule::RayBox`] |
//! |---|---|---|
//! | F | (X, Y) | the middle M of the box of k standard deviations |
//! | the disc shows | where z >= near and rho3d <= rho2d | where rho3d <= rho2d |
//! | rho | rho3d where the disc shows, else rho2d | likewise |
//! | depth | z where the disc shows, else t | z |
//! | no fragment | where the disc does not show and h = 0 | unless z >= near and D is not 0 |
//!
//! A comparison with NaN is false. `Decided:` with `Ray` a disc seen edge-on is a blurred line, at the
//! depth of its centre. With `RayBox`, the rule of the authors' program, most of its pixels have
//! no fragment, because their rays meet the plane too near to the camera or behind it.
//!
//! **Box** of r standard deviations, without the filter: its middle M, and the squares E of its half
//! sides.
//!
//! ```text
//!   d = (r r) (az az + bz bz) - w w       c = (r r) / d
//!   ox = c (ai.x az + bi.x bz)            M.x = X + ox
//!   Ex = ox ox - c (ai.x ai.x + bi.x bi.x)            likewise y
//! ```
//!
//! If not d < 0, the disc of r standard deviations reaches the plane of the camera, and has no box.
//!
//! **Fate.** `Behind` as every Gaussian. `Degenerate`: a number of the images, F, w or a depth is not
//! finite.
//!
//! Source: \[HYCGG24\], and the authors' program.

use super::gaussian::{GaussianKernel, GaussianProjector, rotation};
use crate::number::{MapInline, Real, Vector2, Vector3};
use crate::scene::{Gaussians, Surfels};
use crate::setting::Words;

/// How a surfel, or the first two axes of a Gaussian, become a splat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscRule {
    /// As an ellipse, like every Gaussian: all three axes count.
    Projected,
    /// By the rays of the pixels, as in the paper: the filter is about the projected centre.
    Ray,
    /// By the rays of the pixels, as in the authors' program: the filter is about the middle of the
    /// box of k standard deviations, and each fragment is as deep as its ray.
    RayBox,
}

impl Words for DiscRule {
    const WORDS: &'static [(&'static str, Self)] =
        &[("projected", Self::Projected), ("ray", Self::Ray), ("ray-box", Self::RayBox)];
}

/// The two axes of a disc in the world, one standard deviation long.
pub type DiscAxes<R> = [Vector3<R>; 2];

/// The axes of Gaussian `i`.
#[inline]
#[must_use]
pub fn axes_of_gaussian<R: Real>(gaussians: &Gaussians, i: usize) -> DiscAxes<R> {
    let rows = rotation(gaussians.rotation()[i].map_inline(R::from_f32));
    let scale = gaussians.scale()[i];
    let axis = |j: usize, s: f32| {
        let s = R::from_f32(s);
        Vector3::new(rows[0][j] * s, rows[1][j] * s, rows[2][j] * s)
    };
    [axis(0, scale.x), axis(1, scale.y)]
}

/// The axes of surfel `i`, which is k standard deviations wide.
#[inline]
#[must_use]
pub fn axes_of_surfel<R: Real>(surfels: &Surfels, i: usize, k: f32) -> DiscAxes<R> {
    let k = R::from_f32(k);
    if let Some(tangents) = surfels.tangents() {
        let divided = |v: glam::Vec3| Vector3::from_glam(v).map(|part: R| part / k);
        return tangents[i].map_inline(divided);
    }
    let s = R::from_f32(surfels.radius()[i]) / k;
    let Vector3 { x, y, z } = Vector3::<R>::from_glam(surfels.normal()[i]).normalized();
    let g = R::select(z.ge(R::ZERO), R::ONE, -R::ONE);
    let a = -R::ONE / (g + z);
    let b = (x * y) * a;
    [
        Vector3::new((R::ONE + (g * (x * x)) * a) * s, (g * b) * s, (-(g * x)) * s),
        Vector3::new(b * s, (g + (y * y) * a) * s, -y * s),
    ]
}

/// What all discs of a picture share.
#[derive(Clone, Copy, Debug)]
pub struct RayRules<R> {
    /// h, if there is a filter.
    low_pass: Option<R>,
    near: R,
    /// Whether the rule is [`DiscRule::RayBox`].
    boxed: bool,
}

impl<R: Real> RayRules<R> {
    pub(super) fn new(kernel: &GaussianKernel, near: R) -> Self {
        Self {
            low_pass: (kernel.low_pass > 0.0).then(|| R::from_f32(kernel.low_pass)),
            near,
            boxed: kernel.disc == DiscRule::RayBox,
        }
    }
}

/// A disc before the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDisc<R> {
    /// (X, Y), the projected centre, in px.
    pub center: Vector2<R>,
    /// F, the centre of the filter, in px.
    pub filter: Vector2<R>,
    /// ai and bi.
    pub images: [Vector2<R>; 2],
    /// az and bz, by which the divisor changes.
    pub bend: [R; 2],
    /// a.z and b.z, by which the depth changes.
    pub slopes: [R; 2],
    /// w, the divisor at the centre.
    pub divisor: R,
    /// t, the depth of the centre.
    pub depth: R,
}

/// The box of a disc.
#[derive(Clone, Copy, Debug)]
pub struct DiscBox<R> {
    /// d: the box exists if it is below 0.
    pub d: R,
    /// M.
    pub middle: [R; 2],
    /// E, the squares of the half sides.
    pub squares: [R; 2],
}

/// Where the ray of a pixel meets the plane of a disc, before the division by D.
#[derive(Clone, Copy, Debug)]
pub struct RayMeeting<R> {
    /// u D and v D.
    pub above: [R; 2],
    /// D.
    pub below: R,
    /// rho2d.
    pub rho2d: R,
}

/// A disc at a pixel, with every number on the way.
#[derive(Clone, Copy, Debug)]
pub struct RayFragment<R: Real> {
    /// u and v.
    pub at: [R; 2],
    /// rho3d.
    pub rho3d: R,
    /// rho2d.
    pub rho2d: R,
    /// rho.
    pub rho: R,
    /// The depth of the fragment.
    pub depth: R,
    /// Whether there is a fragment.
    pub met: R::Truth,
}

impl<R: Real> GaussianProjector<R> {
    /// A disc before the camera, whose box has k standard deviations.
    #[inline]
    #[must_use]
    pub fn ray_disc(&self, position: Vector3<R>, axes: &DiscAxes<R>, k: f32) -> RayDisc<R> {
        let Vector3 { x, y, z: t } = self.place(position);
        let (fx, fy, cx, cy) = (self.view.fx, self.view.fy, self.view.cx, self.view.cy);
        let [a, b] = [self.direction(axes[0]), self.direction(axes[1])];
        let slopes = [a.z, b.z];
        let mut disc = if self.view.perspective {
            let (u, v) = (x / t, y / t);
            let image = |a: Vector3<R>| Vector2::new(fx * (a.x - u * a.z), fy * (a.y - v * a.z));
            let center = Vector2::new(cx + fx * u, cy + fy * v);
            let (images, bend) = ([image(a), image(b)], slopes);
            RayDisc { center, filter: center, images, bend, slopes, divisor: t, depth: t }
        } else {
            let image = |a: Vector3<R>| Vector2::new(fx * a.x, fy * a.y);
            let center = Vector2::new(cx + fx * x, cy + fy * y);
            let (images, bend) = ([image(a), image(b)], [R::ZERO; 2]);
            RayDisc { center, filter: center, images, bend, slopes, divisor: R::ONE, depth: t }
        };
        if self.rays.boxed {
            let [x, y] = disc.boxed(R::from_f32(k)).middle;
            disc.filter = Vector2::new(x, y);
        }
        disc
    }
}

impl<R: Real> RayDisc<R> {
    /// Whether the disc has a number that is not finite.
    #[inline(always)]
    pub fn degenerate(&self) -> R::Truth {
        let [a, b] = self.images;
        let [az, bz] = self.slopes;
        let numbers = [a.x, a.y, b.x, b.y, az, bz, self.center.x, self.center.y, self.filter.x];
        let finite = |all: R::Truth, number: R| all & number.is_finite();
        let last = self.filter.y.is_finite() & self.divisor.is_finite() & self.depth.is_finite();
        !numbers.into_iter().fold(last, finite)
    }

    /// The same in another number type.
    #[inline(always)]
    #[must_use]
    pub(crate) fn map<S: Copy>(&self, f: impl Fn(R) -> S + Copy) -> RayDisc<S> {
        let [a, b] = self.images;
        RayDisc {
            center: self.center.map(f),
            filter: self.filter.map(f),
            images: [a.map(f), b.map(f)],
            bend: self.bend.map_inline(f),
            slopes: self.slopes.map_inline(f),
            divisor: f(self.divisor),
            depth: f(self.depth),
        }
    }

    /// The box of r standard deviations.
    #[inline]
    #[must_use]
    pub fn boxed(&self, r: R) -> DiscBox<R> {
        let ([a, b], [az, bz]) = (self.images, self.bend);
        let square = r * r;
        let d = square * (az * az + bz * bz) - self.divisor * self.divisor;
        let c = square / d;
        let side = |center: R, a: R, b: R| {
            let off = c * (a * az + b * bz);
            (center + off, off * off - c * (a * a + b * b))
        };
        let (x, xx) = side(self.center.x, a.x, b.x);
        let (y, yy) = side(self.center.y, a.y, b.y);
        DiscBox { d, middle: [x, y], squares: [xx, yy] }
    }

    /// Meets the ray of a pixel.
    #[inline(always)]
    #[must_use]
    pub fn meet(&self, rules: &RayRules<R>, (i, j): (u32, u32)) -> RayMeeting<R> {
        let ([a, b], [az, bz]) = (self.images, self.bend);
        let (x, y) = (R::from_f32(i as f32 + 0.5), R::from_f32(j as f32 + 0.5));
        let (dx, dy) = (x - self.center.x, y - self.center.y);
        let k = [a.x - dx * az, b.x - dx * bz];
        let l = [a.y - dy * az, b.y - dy * bz];
        let (ex, ey) = (self.filter.x - x, self.filter.y - y);
        RayMeeting {
            above: [self.divisor * (dx * l[1] - dy * k[1]), self.divisor * (dy * k[0] - dx * l[0])],
            below: k[0] * l[1] - k[1] * l[0],
            rho2d: rules.low_pass.map_or(R::INFINITY, |h| (ex * ex + ey * ey) / h),
        }
    }

    /// The disc at a pixel.
    #[inline(always)]
    #[must_use]
    pub fn fragment(&self, rules: &RayRules<R>, pixel: (u32, u32)) -> RayFragment<R> {
        let RayMeeting { above: [above_u, above_v], below, rho2d } = self.meet(rules, pixel);
        let (u, v) = (above_u / below, above_v / below);
        let rho3d = u * u + v * v;
        let less = rho3d.le(rho2d);
        self.decided(rules, [u, v], [rho3d, rho2d], below, less)
    }

    /// The fragment with these u, v, rho3d, rho2d and D, where rho3d is the `less` of both or not.
    #[inline(always)]
    #[must_use]
    pub(crate) fn decided(
        &self,
        rules: &RayRules<R>,
        [u, v]: [R; 2],
        [rho3d, rho2d]: [R; 2],
        below: R,
        less: R::Truth,
    ) -> RayFragment<R> {
        let z = self.depth + (u * self.slopes[0] + v * self.slopes[1]);
        let before = z.ge(rules.near);
        let (shows, depth, met) = if rules.boxed {
            (less, z, before & (below.lt(R::ZERO) | below.gt(R::ZERO)))
        } else {
            let shows = less & before;
            let met = if rules.low_pass.is_some() { true.into() } else { shows };
            (shows, R::select(shows, z, self.depth), met)
        };
        RayFragment { at: [u, v], rho3d, rho2d, rho: R::select(shows, rho3d, rho2d), depth, met }
    }
}
