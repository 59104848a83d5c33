//! Project one Gaussian: the specification of its ellipse on the screen.
//!
//! All programs that draw 3D Gaussians share these formulas; what they do differently is a
//! [`GaussianKernel`]. Programs that draw 2D Gaussians meet discs with rays: [`mod@super::ray_disc`]. A symmetric matrix is written by its upper triangle, row by row: (xx, xy, xz,
//! yy, yz, zz). Products associate as the parentheses say; where there are none, from the left.
//!
//! **Shape**, in the world. Of a Gaussian with the unit quaternion (x, y, z, w) and the standard
//! deviations s:
//!
//! ```text
//!   R = | 1 - 2 (y y + z z)    2 (x y - w z)        2 (x z + w y)     |
//!       | 2 (x y + w z)        1 - 2 (x x + z z)    2 (y z - w x)     |
//!       | 2 (x z - w y)        2 (y z + w x)        1 - 2 (x x + y y) |
//!   M_ij = R_ij s_j            S = M M^T, each element (M_i0 M_j0 + M_i1 M_j1) + M_i2 M_j2
//!   m = the largest of s       b = ((s_1/m) (s_2/m), (s_0/m) (s_2/m), (s_0/m) (s_1/m)); 0 if m = 0
//!   N_ij = R_ij b_j            B = N N^T        the adjugate of S, up to a factor > 0
//! ```
//!
//! Of a surfel, which is a Gaussian without extent along its normal n, with s = radius / k: S = (s
//! s) (I - n n^T), whose diagonal is (s s) (n.y n.y + n.z n.z) and so on, and whose other elements
//! are -((s s) (n.x n.y)) and so on; B = n n^T. Of an elliptical surfel with the tangents divided by
//! k, U and V: S = U U^T + V V^T and B = N N^T with N = U x V.
//!
//! **Camera frame**: x right, y down, z into the picture, so that t = z is the depth. W has the rows
//! (r0, -r1, -r2) of the view matrix, and (x, y, t) = (p.x, -p.y, -p.z) with p the centre in view
//! space.
//!
//! ```text
//!   S'_ij = W_i . (S W_j)      B' = W B W^T likewise, for the order of a pixel alone
//! ```
//!
//! **Jacobian** of the projection at the centre. Perspective, with (u, v) = (x/t, y/t), each clamped
//! as [`Clamp`] says:
//!
//! ```text
//!   jx = fx/t    jxz = -(fx u)/t    jy = fy/t    jyz = -(fy v)/t
//!   X = cx + fx (x/t)               Y = cy + fy (y/t)             not clamped
//! ```
//!
//! The constants 1.3 and 0.3 of [`Clamp`] and those of [`Compensation`] are rounded to `f32`.
//! Orthographic: jx = fx, jy = fy, jxz = jyz = 0, X = cx + fx x, Y = cy + fy y.
//!
//! **Ellipse**, in px^2:
//!
//! ```text
//!   a = jx S'xx + jxz S'xz    b = jx S'xy + jxz S'yz    c = jx S'xz + jxz S'zz
//!   d = jy S'yy + jyz S'yz    e = jy S'yz + jyz S'zz
//!   V0xx = a jx + c jxz       Vxy = b jy + c jyz        V0yy = d jy + e jyz
//!   Vxx = V0xx + h            Vyy = V0yy + h            h = GaussianKernel::low_pass
//!   det0 = V0xx V0yy - Vxy Vxy                          det = Vxx Vyy - Vxy Vxy
//!   conic = (Vyy (1/det), -(Vxy (1/det)), Vxx (1/det))
//! ```
//!
//! The opacity is multiplied by the factor of [`Compensation`].
//!
//! **Fate.** `Behind`: not t > [`GaussianKernel::near`], or the camera's near plane where that is 0.
//! `Degenerate`: not det > 0, or det, a number of the conic, X or Y is not finite. (`Departs:` the
//! original program draws a det < 0, which only rounding makes; its splat then has a hyperbola for a
//! rim.) `Outside`: no pixel of the picture is in the bounds, see [`crate::method::gaussians`].
//!
//! Source: \[ZPvBG01, section 4\] with volumetric kernels; Kerbl et al., *3D Gaussian Splatting for
//! Real-Time Radiance Field Rendering*, 2023.

use super::View;
use super::ray_disc::{DiscRule, RayRules};
use crate::number::{MapInline, Real, Vector2, Vector3};
use crate::scene::{Gaussians, Surfels};
use crate::setting::Words;

/// How x/t and y/t are bounded in the Jacobian, and only there: far off the axis the linearized
/// ellipse would grow without bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clamp {
    /// Not at all.
    None,
    /// To +-1.3 ((width / 2) / fx), and so for y, whatever the principal point: the original program.
    Fov,
    /// To the edges of the picture and 0.3 ((width / 2) / fx) beyond, and so for y: gsplat. The edges
    /// are -cx / fx and (width - cx) / fx.
    Edges,
}

/// What the opacity is multiplied by, so that the low-pass filter adds no light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compensation {
    /// 1: a small splat becomes brighter.
    None,
    /// sqrt(max(0, det0 / det)).
    Ratio,
    /// sqrt(max(0.000025, det0 / det)): the original program since 2024, if it is asked for antialiasing.
    Floor,
    /// sqrt(det0 / (det + 0.000001) + 0.000001), and 0 unless det0 > 0.000001 and det > 0.000001:
    /// Mip-Splatting.
    Mip,
}

impl Words for Clamp {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("fov", Self::Fov), ("edges", Self::Edges)];
}

impl Words for Compensation {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("ratio", Self::Ratio), ("floor", Self::Floor), ("mip", Self::Mip)];
}

/// What programs do differently when they project a Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianKernel {
    /// Whether discs are ellipses, or meet the rays of the pixels.
    pub disc: DiscRule,
    /// The depth up to which nothing is seen, in world units; 0: the camera's near plane.
    pub near: f32,
    /// See [`Clamp`].
    pub clamp: Clamp,
    /// The variance h of the low-pass filter, in px^2.
    pub low_pass: f32,
    /// See [`Compensation`].
    pub compensation: Compensation,
}

/// A symmetric matrix: (xx, xy, xz, yy, yz, zz).
pub type Symmetric<R> = [R; 6];

/// A Gaussian in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianShape<R> {
    /// The centre.
    pub position: Vector3<R>,
    /// S, the covariance.
    pub covariance: Symmetric<R>,
    /// B, the adjugate of S up to a factor > 0.
    pub adjugate: Symmetric<R>,
}

impl<R: Real> GaussianShape<R> {
    /// The shape of Gaussian `i`.
    #[inline(always)]
    #[must_use]
    pub fn of_gaussian(gaussians: &Gaussians, i: usize) -> Self {
        let axes = rotation(gaussians.rotation()[i].map_inline(R::from_f32));
        let scale = gaussians.scale()[i];
        let s = scale.to_array().map_inline(R::from_f32);
        let most = R::from_f32(scale.max_element());
        let some = most.gt(R::ZERO);
        let part = |i: usize| R::select(some, s[i] / most, R::ZERO);
        let b = [part(1) * part(2), part(0) * part(2), part(0) * part(1)];
        Self {
            position: Vector3::from_glam(gaussians.position()[i]),
            covariance: squared(&axes, s),
            adjugate: squared(&axes, b),
        }
    }

    /// The shape of surfel `i`, which is k standard deviations wide.
    #[inline(always)]
    #[must_use]
    pub fn of_surfel(surfels: &Surfels, i: usize, k: f32) -> Self {
        let k = R::from_f32(k);
        let position = Vector3::from_glam(surfels.position()[i]);
        let (covariance, adjugate) = match surfels.tangents() {
            None => {
                let s = R::from_f32(surfels.radius()[i]) / k;
                disc(Vector3::from_glam(surfels.normal()[i]), s * s)
            }
            Some(tangents) => {
                let divided = |v: glam::Vec3| Vector3::from_glam(v).map(|part: R| part / k);
                let [u, v] = tangents[i].map_inline(divided);
                let sum = |a: Symmetric<R>, b: Symmetric<R>| {
                    let mut sum = a;
                    sum.iter_mut().zip(b).for_each(|(a, b)| *a = *a + b);
                    sum
                };
                (sum(outer(u), outer(v)), outer(u.cross(v)))
            }
        };
        Self { position, covariance, adjugate }
    }
}

/// The rows of the rotation of a unit quaternion (x, y, z, w).
#[inline(always)]
pub(super) fn rotation<R: Real>([x, y, z, w]: [R; 4]) -> [[R; 3]; 3] {
    let two = R::from_f32(2.0);
    let diagonal = |a: R, b: R| R::ONE - two * (a * a + b * b);
    [
        [diagonal(y, z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), diagonal(x, z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), diagonal(x, y)],
    ]
}

/// (A diag f) (A diag f)^T.
#[inline(always)]
fn squared<R: Real>(axes: &[[R; 3]; 3], factors: [R; 3]) -> Symmetric<R> {
    let row = |i: usize| {
        Vector3::new(axes[i][0] * factors[0], axes[i][1] * factors[1], axes[i][2] * factors[2])
    };
    let rows = [0, 1, 2].map_inline(row);
    PAIRS.map_inline(|(i, j): (usize, usize)| rows[i].dot(rows[j]))
}

/// Row and column of each number of a [`Symmetric`]. A loop over these is compiled once, which matters
/// where numbers are balls.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// v v^T.
#[inline(always)]
fn outer<R: Real>(v: Vector3<R>) -> Symmetric<R> {
    [v.x * v.x, v.x * v.y, v.x * v.z, v.y * v.y, v.y * v.z, v.z * v.z]
}

/// S and B of a disc with this normal and variance.
#[inline(always)]
fn disc<R: Real>(n: Vector3<R>, variance: R) -> (Symmetric<R>, Symmetric<R>) {
    let [xx, xy, xz, yy, yz, zz] = outer(n);
    let off = |product: R| -(variance * product);
    let on = |a: R, b: R| variance * (a + b);
    ([on(yy, zz), off(xy), off(xz), on(xx, zz), off(yz), on(xx, yy)], outer(n))
}

/// A projected Gaussian, with every number on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedGaussian<R> {
    /// The centre in the camera frame: x right, y down, t into the picture.
    pub place: Vector3<R>,
    /// S', the covariance in the camera frame, in world units^2.
    pub covariance: Symmetric<R>,
    /// (X, Y), the centre on the screen, in px.
    pub center: Vector2<R>,
    /// V0, the ellipse without the low-pass filter: (xx, xy, yy), in px^2.
    pub unfiltered: [R; 3],
    /// V, the ellipse: (xx, xy, yy), in px^2.
    pub ellipse: [R; 3],
    /// det V.
    pub det: R,
    /// V^-1: (xx, xy, yy), in 1 / px^2.
    pub conic: [R; 3],
    /// The factor of the opacity.
    pub compensation: R,
}

/// See [`Compensation::Mip`].
#[inline(always)]
fn compensated_by_mip<R: Real>(det0: R, det: R) -> R {
    let tiny = R::from_f32(0.000_001);
    let root = (det0 / (det + tiny) + tiny).root_of_squares();
    let if_det = R::select(det.gt(tiny), root, R::ZERO);
    R::select(det0.gt(tiny), if_det, R::ZERO)
}

/// The camera and the kernel, as all Gaussians of a picture share them.
#[derive(Clone, Copy, Debug)]
pub struct GaussianProjector<R> {
    /// The camera.
    pub view: View<R>,
    /// W, the rows of the rotation into the camera frame.
    frame: [Vector3<R>; 3],
    near: R,
    /// The least and the greatest x/t, then y/t, in the Jacobian; none: unbounded.
    limits: Option<[[R; 2]; 2]>,
    low_pass: R,
    compensation: Compensation,
    /// What the discs share that meet rays.
    pub(crate) rays: RayRules<R>,
}

impl<R: Real> GaussianProjector<R> {
    /// Prepares for a picture.
    #[must_use]
    pub fn new(view: View<R>, kernel: &GaussianKernel) -> Self {
        let row = |i: usize| {
            let [x, y, z, _] = view.rows[i];
            Vector3::new(x, y, z)
        };
        let half = R::from_f32(0.5);
        let side = |size: R, scale: R, center: R| {
            let tangent = (half * size) / scale;
            let fov = R::from_f32(1.3) * tangent;
            let beyond = R::from_f32(0.3) * tangent;
            match kernel.clamp {
                Clamp::None | Clamp::Fov => [-fov, fov],
                Clamp::Edges => [-(center / scale + beyond), (size - center) / scale + beyond],
            }
        };
        let limits = [side(view.width, view.fx, view.cx), side(view.height, view.fy, view.cy)];
        let near = if kernel.near == 0.0 { view.near } else { R::from_f32(kernel.near) };
        Self {
            frame: [row(0), -row(1), -row(2)],
            near,
            rays: RayRules::new(kernel, near),
            limits: (kernel.clamp != Clamp::None && view.perspective).then_some(limits),
            low_pass: R::from_f32(kernel.low_pass),
            compensation: kernel.compensation,
            view,
        }
    }

    /// A matrix of the world in the camera frame: W A W^T.
    #[inline(always)]
    #[must_use]
    pub fn turned(&self, a: &Symmetric<R>) -> Symmetric<R> {
        let [xx, xy, xz, yy, yz, zz] = *a;
        let rows = [Vector3::new(xx, xy, xz), Vector3::new(xy, yy, yz), Vector3::new(xz, yz, zz)];
        let times = |v: Vector3<R>| Vector3::new(rows[0].dot(v), rows[1].dot(v), rows[2].dot(v));
        let products = self.frame.map_inline(times);
        PAIRS.map_inline(|(i, j): (usize, usize)| self.frame[i].dot(products[j]))
    }

    /// A direction of the world in the camera frame.
    #[inline(always)]
    #[must_use]
    pub(super) fn direction(&self, v: Vector3<R>) -> Vector3<R> {
        let [x, y, z] = self.frame;
        Vector3::new(x.dot(v), y.dot(v), z.dot(v))
    }

    /// The centre in the camera frame.
    #[inline(always)]
    #[must_use]
    pub fn place(&self, position: Vector3<R>) -> Vector3<R> {
        let p = self.view.point(position);
        Vector3::new(p.x, -p.y, -p.z)
    }

    /// Whether the centre is not farther than the near plane.
    #[inline(always)]
    pub fn behind(&self, place: Vector3<R>) -> R::Truth {
        !place.z.gt(self.near)
    }

    /// Projects a Gaussian; the numbers mean nothing if it is behind or degenerate.
    #[inline(always)]
    #[must_use]
    pub fn project(&self, shape: &GaussianShape<R>) -> ProjectedGaussian<R> {
        let View { fx, fy, cx, cy, perspective, .. } = self.view;
        let place = self.place(shape.position);
        let Vector3 { x, y, z: t } = place;
        let covariance = self.turned(&shape.covariance);
        let [sxx, sxy, sxz, syy, syz, szz] = covariance;
        let (jacobian, center) = if perspective {
            let (u, v) = (x / t, y / t);
            let [bu, bv] = self.limits.map_or([u, v], |[of_u, of_v]| {
                [u.clamped(of_u[0], of_u[1]), v.clamped(of_v[0], of_v[1])]
            });
            let jacobian = [fx / t, -((fx * bu) / t), fy / t, -((fy * bv) / t)];
            (jacobian, Vector2::new(cx + fx * u, cy + fy * v))
        } else {
            ([fx, R::ZERO, fy, R::ZERO], Vector2::new(cx + fx * x, cy + fy * y))
        };
        let [jx, jxz, jy, jyz] = jacobian;
        let a = jx * sxx + jxz * sxz;
        let b = jx * sxy + jxz * syz;
        let c = jx * sxz + jxz * szz;
        let d = jy * syy + jyz * syz;
        let e = jy * syz + jyz * szz;
        let unfiltered = [a * jx + c * jxz, b * jy + c * jyz, d * jy + e * jyz];
        let [xx, xy, yy] = unfiltered;
        let ellipse = [xx + self.low_pass, xy, yy + self.low_pass];
        let [fxx, _, fyy] = ellipse;
        let det0 = xx * yy - xy * xy;
        let det = fxx * fyy - xy * xy;
        let inverse = R::ONE / det;
        let ratio = |least: f32| (det0 / det).at_least(R::from_f32(least)).root_of_squares();
        let compensation = match self.compensation {
            Compensation::None => R::ONE,
            Compensation::Ratio => ratio(0.0),
            Compensation::Floor => ratio(0.000_025),
            Compensation::Mip => compensated_by_mip(det0, det),
        };
        let conic = [fyy * inverse, -(xy * inverse), fxx * inverse];
        ProjectedGaussian {
            place,
            covariance,
            center,
            unfiltered,
            ellipse,
            det,
            conic,
            compensation,
        }
    }

    /// (i + 1/2 - c) / f for the column and row of a pixel, y down: the ray (u, v, 1) of a
    /// perspective camera, or the place of the ray of an orthographic one.
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, (x, y): (u32, u32)) -> [R; 2] {
        let View { fx, fy, cx, cy, .. } = self.view;
        let center = |i: u32| R::from_f32(i as f32 + 0.5);
        [(center(x) - cx) / fx, (center(y) - cy) / fy]
    }

    /// The depth at which the density of a Gaussian is greatest along the [`Self::ray`] (u, v) of a
    /// pixel, from B' and the centre in the camera frame. With the ray's direction d, which has d.z = 1, and a point o
    /// of it:
    ///
    /// ```text
    ///   perspective    d = (u, v, 1)   m = centre
    ///   orthographic   d = (0, 0, 1)   m = (x - u, y - v, t)
    ///   g = B' d       depth = (g . m) / (g . d), or t unless g . d > 0 and the result is finite
    /// ```
    ///
    /// For a disc that is where the ray meets its plane.
    #[inline(always)]
    #[must_use]
    pub fn deepest(&self, adjugate: &Symmetric<R>, place: Vector3<R>, [u, v]: [R; 2]) -> R {
        let (d, m) = if self.view.perspective {
            (Vector3::new(u, v, R::ONE), place)
        } else {
            let m = Vector3::new(place.x - u, place.y - v, place.z);
            (Vector3::new(R::ZERO, R::ZERO, R::ONE), m)
        };
        let [xx, xy, xz, yy, yz, zz] = *adjugate;
        let g = Vector3::new(
            Vector3::new(xx, xy, xz).dot(d),
            Vector3::new(xy, yy, yz).dot(d),
            Vector3::new(xz, yz, zz).dot(d),
        );
        let across = g.dot(d);
        let depth = g.dot(m) / across;
        R::select(across.gt(R::ZERO) & depth.is_finite(), depth, place.z)
    }
}

impl<R: Real> ProjectedGaussian<R> {
    /// Whether the Gaussian has no ellipse in this arithmetic.
    #[inline(always)]
    pub fn degenerate(&self) -> R::Truth {
        let [xx, xy, yy] = self.conic;
        let finite = self.det.is_finite()
            & xx.is_finite()
            & xy.is_finite()
            & yy.is_finite()
            & self.center.x.is_finite()
            & self.center.y.is_finite();
        !(self.det.gt(R::ZERO) & finite)
    }

    /// q/2 at a pixel, half the square of its distance from the centre in standard deviations:
    ///
    /// ```text
    ///   dx = X - (x + 1/2)    dy = Y - (y + 1/2)
    ///   1/2 ((xx (dx dx)) + (yy (dy dy))) + xy (dx dy)
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn power(center: Vector2<R>, [xx, xy, yy]: [R; 3], (x, y): (u32, u32)) -> R {
        let dx = center.x - R::from_f32(x as f32 + 0.5);
        let dy = center.y - R::from_f32(y as f32 + 0.5);
        R::from_f32(0.5) * (xx * (dx * dx) + yy * (dy * dy)) + xy * (dx * dy)
    }
}
