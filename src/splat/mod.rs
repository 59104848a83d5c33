//! Turn a surfel into its footprint on the screen.
//!
//! ```text
//!   surfel (position, normal, radius) ──View──▶ centre p, normal n       view space
//!     ──project──▶ Splat = Footprint + bounds                            pixels
//!     ──Footprint──▶ q(X, Y), nearness(X, Y)                             one fragment
//! ```
//!
//! **Nearness** orders fragments: w = 1/t under a perspective camera, w = -t under an orthographic
//! one. So nearness is affine in the pixel position over a plane, and the nearer fragment has the
//! larger w under both cameras. An empty pixel has the nearness of t = +inf: 0 or -inf.
//!
//! This module knows neither tiles nor pictures. Sources: \[ZPvBG01\] (affine), \[ZRB+04\]
//! (perspective), \[BHZK05\] (ray casting).

pub mod batch;
pub mod bounds;
pub mod clip;
pub mod crossing;
mod disc;
mod disc_lanes;
pub mod ellipse;
pub(crate) mod enclosed;
mod fate;
pub mod frustum;
pub mod gaussian;
pub mod project;
mod projector;
pub mod ray_disc;
pub mod record;
pub mod settings;
mod shape;
#[cfg(test)]
pub(crate) mod tests;
pub mod view;

pub use batch::Tally;
pub use disc::Disc;
pub use ellipse::Ellipse;
pub use fate::{Fate, Reasons};
pub use project::project;
pub use projector::Projector;
pub(crate) use settings::culling;
pub use settings::{Epsilon, SplatSettings};
pub use view::View;

use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::number::{Exact, Real, Truth, Vector2};

/// How a disc becomes a shape on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Outline {
    /// The ellipse of the projection linearized at the centre, convolved with the low-pass filter
    /// \[ZPvBG01\].
    #[default]
    Affine,
    /// The ellipse that is the exact projection of the disc \[ZRB+04\], then the low-pass filter. A
    /// disc that reaches the near plane has no such ellipse and is drawn as `Affine`.
    Perspective,
    /// The disc itself, by intersecting each pixel's ray with the disc's plane. The low-pass filter
    /// enters as the larger of the two weights \[BHZK05\].
    RayCast,
}

/// The reconstruction kernel and the low-pass filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// How a disc becomes a shape on the screen.
    pub outline: Outline,
    /// The cut-off k: a disc of radius r is a Gaussian of standard deviation r/k, cut at k. In
    /// [1/4, 4].
    pub cutoff: f32,
    /// The variance h of the low-pass filter in px^2. In [0, 16].
    pub low_pass: f32,
}

impl Kernel {
    /// The default: k = 2 (the disc is two standard deviations wide), h = 0.25 px^2.
    pub const DEFAULT: Self = Self { outline: Outline::Affine, cutoff: 2.0, low_pass: 0.25 };
    /// The choice of \[ZPvBG01\]: cut at one standard deviation, a low-pass filter of variance 1.
    pub const ZPVBG01: Self = Self { outline: Outline::Affine, cutoff: 1.0, low_pass: 1.0 };

    /// The choice of \[ZP06, section 3.1\]: the distance from the centre in the disc's plane, no
    /// low-pass filter.
    pub const ZP06: Self = Self { outline: Outline::RayCast, cutoff: 2.0, low_pass: 0.0 };

    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the cut-off or the low-pass variance is out of range.
    pub fn check(&self) -> Result<()> {
        if !(0.25..=4.0).contains(&self.cutoff) {
            let what = format!("kernel: a cut-off of {}; give 0.25 to 4", self.cutoff);
            return Err(Error::Invalid(what));
        }
        if !(0.0..=16.0).contains(&self.low_pass) {
            let what = format!("kernel: a low-pass variance of {}; give 0 to 16", self.low_pass);
            return Err(Error::Invalid(what));
        }
        Ok(())
    }
}

impl Default for Kernel {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A kernel on the screen: all that the fragments of one surfel need.
///
/// At the offset (dx, dy) = (X, Y) - `center`, in this order of operations:
///
/// ```text
///   u = ux dx + uy dy      v = vy dy      f = u u + v v
///   w = (w0 + wx dx) + wy dy
///
///   Affine, Perspective    q = f                     w clamped to [w_far, w_near]
///   RayCast                q = the smaller of        w clamped likewise
///                              f / (w w)   if 0 < w <= 1/near, else +inf
///                              (orthographic: f   if w <= -near, else +inf)
///                              (dx dx + dy dy) / h            if h > 0
///
///   inside                 q <= k k
///   weight                 amplitude * exp(-0.5 q)
/// ```
///
/// f is d^T Q d, with the conic Q given by its Cholesky factor. A sum of squares is never negative,
/// and keeps the digits that the expanded form loses on thin ellipses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint<R> {
    /// The centre of the ellipse in pixels.
    pub center: Vector2<R>,
    /// Factor of the conic.
    pub ux: R,
    /// Factor of the conic.
    pub uy: R,
    /// Factor of the conic.
    pub vy: R,
    /// Nearness of the disc's plane at `center`.
    pub w0: R,
    /// Change of nearness per pixel to the right.
    pub wx: R,
    /// Change of nearness per pixel down.
    pub wy: R,
    /// The least nearness of the disc itself.
    pub w_far: R,
    /// The greatest nearness of the disc itself, at most the nearness of the near plane.
    pub w_near: R,
    /// The weight at q = 0.
    pub amplitude: R,
}

/// How many numbers a footprint has.
pub(crate) const FOOTPRINT: usize = 11;

/// What the fragments of a splat in one column of pixels share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column<R> {
    dx: R,
    /// ux dx.
    u: R,
    /// w0 + wx dx.
    w: R,
}

/// What the fragments of a splat in one row of pixels share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<R> {
    dy: R,
    /// uy dy.
    u: R,
    /// v v.
    v: R,
    /// wy dy.
    w: R,
}

/// What the fragments of every splat of a picture share.
#[derive(Clone, Copy, Debug)]
pub struct Shared<R> {
    /// k^2, the limit for q, see [`crate::composite::decide::inside`].
    pub limit: R,
    /// Whether q comes from ray casting.
    pub ray_cast: bool,
    /// Whether nearness is 1/t; if not, it is -t.
    pub perspective: bool,
    /// h, the variance of the low-pass filter in px^2.
    pub low_pass: R,
    /// Nearness of the near plane.
    pub w_clip: R,
}

impl<R> Shared<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Shared<S> {
        Shared {
            limit: f(self.limit),
            ray_cast: self.ray_cast,
            perspective: self.perspective,
            low_pass: f(self.low_pass),
            w_clip: f(self.w_clip),
        }
    }
}

impl<R: Real> Shared<R> {
    /// Computes the shared numbers of a picture.
    #[must_use]
    pub fn new(view: &View<R>, kernel: &Kernel) -> Self {
        let cutoff = R::from_f32(kernel.cutoff);
        Self {
            limit: cutoff * cutoff,
            ray_cast: kernel.outline == Outline::RayCast,
            perspective: view.perspective,
            low_pass: R::from_f32(kernel.low_pass),
            w_clip: view.nearness(view.near),
        }
    }

    /// The depth t of a nearness: 1/w, or -w under an orthographic camera.
    #[inline(always)]
    pub fn depth(&self, nearness: R) -> R {
        if self.perspective { R::ONE / nearness } else { -nearness }
    }

    /// The nearness of an empty pixel, whose depth is +inf.
    #[inline]
    #[must_use]
    pub fn empty(&self) -> R {
        if self.perspective { R::ZERO } else { -R::INFINITY }
    }
}

impl<R> Footprint<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Footprint<S> {
        Footprint {
            center: self.center.map(&f),
            ux: f(self.ux),
            uy: f(self.uy),
            vy: f(self.vy),
            w0: f(self.w0),
            wx: f(self.wx),
            wy: f(self.wy),
            w_far: f(self.w_far),
            w_near: f(self.w_near),
            amplitude: f(self.amplitude),
        }
    }

    /// The numbers in the order of the fields.
    #[inline(always)]
    pub(crate) fn numbers(self) -> [R; FOOTPRINT] {
        let Self { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude } = self;
        [center.x, center.y, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude]
    }

    /// The footprint with these [`Footprint::numbers`].
    #[inline(always)]
    pub(crate) fn of_numbers(numbers: [R; FOOTPRINT]) -> Self {
        let [x, y, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude] = numbers;
        let center = Vector2::new(x, y);
        Self { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude }
    }
}

impl<R: Real> Footprint<R> {
    /// The form f at an offset from the centre.
    #[inline(always)]
    pub fn form(&self, dx: R, dy: R) -> R {
        let u = self.ux * dx + self.uy * dy;
        let v = self.vy * dy;
        u * u + v * v
    }

    /// The nearness of the disc's plane, not clamped.
    #[inline(always)]
    pub fn plane(&self, dx: R, dy: R) -> R {
        (self.w0 + self.wx * dx) + self.wy * dy
    }

    /// q and nearness of the fragment at an offset from the centre.
    #[inline(always)]
    pub fn fragment(&self, shared: &Shared<R>, dx: R, dy: R) -> (R, R) {
        let form = self.form(dx, dy);
        let w = self.plane(dx, dy);
        let q = if shared.ray_cast { ray_cast(shared, form, w, dx, dy) } else { form };
        (q, w.clamped(self.w_far, self.w_near))
    }

    /// The terms that all fragments of a column share, at dx from the centre.
    #[inline(always)]
    pub(crate) fn column(&self, dx: R) -> Column<R> {
        Column { dx, u: self.ux * dx, w: self.w0 + self.wx * dx }
    }

    /// The terms that all fragments of a row share, at dy from the centre.
    #[inline(always)]
    pub(crate) fn row(&self, dy: R) -> Row<R> {
        let v = self.vy * dy;
        Row { dy, u: self.uy * dy, v: v * v, w: self.wy * dy }
    }

    /// [`Footprint::fragment`], bit for bit, where a column and a row cross.
    #[inline(always)]
    pub(crate) fn crossing(&self, shared: &Shared<R>, column: &Column<R>, row: &Row<R>) -> (R, R) {
        let u = column.u + row.u;
        let form = u * u + row.v;
        let w = column.w + row.w;
        let q = if shared.ray_cast { ray_cast(shared, form, w, column.dx, row.dy) } else { form };
        (q, w.clamped(self.w_far, self.w_near))
    }

    /// The weight of a fragment whose q is inside.
    #[inline(always)]
    pub fn weight(&self, q: R) -> R {
        self.amplitude * (q * R::from_f32(-0.5)).exp()
    }
}

/// q of the disc by ray casting, or q of the low-pass filter where it is smaller.
#[inline(always)]
fn ray_cast<R: Real>(shared: &Shared<R>, form: R, w: R, dx: R, dy: R) -> R {
    let q = if shared.perspective { form / (w * w) } else { form };
    let hits = w.le(shared.w_clip) & (w.gt(R::ZERO) | R::Truth::from(!shared.perspective));
    let q = R::select(hits, q, R::INFINITY);
    // h is an input, so it is the same in every number.
    if shared.low_pass.gt(R::ZERO).certainly() {
        q.at_most((dx * dx + dy * dy) / shared.low_pass)
    } else {
        q
    }
}

/// q and nearness of the fragment of a splat at the centre of a pixel:
/// [`Footprint::fragment`] at the offset ((x + 1/2) - `center.x`, (y + 1/2) - `center.y`).
#[inline(always)]
pub fn fragment<R: Real>(
    shared: &Shared<R>,
    footprint: &Footprint<R>,
    (x, y): (u32, u32),
) -> (R, R) {
    let dx = R::from_f32(x as f32 + 0.5) - footprint.center.x;
    let dy = R::from_f32(y as f32 + 0.5) - footprint.center.y;
    footprint.fragment(shared, dx, dy)
}

/// A surfel on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat<R: Real> {
    /// The kernel of the splat.
    pub footprint: Footprint<R>,
    /// The pixels that may be inside.
    pub bounds: Rect,
    /// The index of the surfel in its scene.
    pub surfel: u32,
    /// Whether the back of the surfel is seen; its normal is then reversed.
    pub back: R::Truth,
}

impl<R: Exact> Splat<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S: Real>(&self, f: impl Fn(R) -> S) -> Splat<S> {
        let Self { footprint, bounds, surfel, back } = *self;
        Splat { footprint: footprint.map(f), bounds, surfel, back: back.into() }
    }
}
