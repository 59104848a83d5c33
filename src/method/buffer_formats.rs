//! Storage formats: the picture as it becomes where passes leave their numbers in buffers of few digits.
//!
//! The GPUs of the five papers blended into 8-bit or half-float buffers and tested depths of 16 or 24 bits:
//! \[ZP06, 5.2\] counts on "current 8-bit color and alpha resolutions", \[MOC08, 4\] has "all buffers and textures"
//! in 16-bit floats. [`super::Session::emulate`] draws the definition of a method in `f32` and rounds what each
//! [stage](super::Stage) leaves, before the next one reads it:
//!
//! - [`Buffers`] rounds planes of colours, vectors and numbers but depths, indices and counts.
//! - [`DepthBuffer`] rounds planes of depths, see [`super::Holds::Depth`].
//! - A stage that works level by level runs once for each, so that a level is rounded before the next is made
//!   of it.
//! - Where fragments are *tested* against a depth buffer, what the buffer holds of them is compared: of fragments whose
//!   depths round to one the first stays. Those are the tests that a nearest fragment wins (visibility splatting, the
//!   depth-images of [`mod@super::single_pass`], the pixels of [`mod@super::projection`], the discs of
//!   [`mod@super::blue`], the indices of [`mod@super::deferred`]), and not those by epsilon, which read a depth in `f32`
//!   from a buffer. Under the Voronoi depth test the buffer holds z / n of \[ZP06, eq. 10\] and no depth.
//! - Where fragments are *blended* into a buffer, the buffer is rounded after every one: the sums of
//!   attribute splatting ([`mod@super::ewa`], [`mod@super::deferred`], and each layer of
//!   [`mod@super::peeling`]) after every addition, the layers of [`mod@super::transparent`] and
//!   [`mod@super::transparent_hq`] after every one that is laid over those before, and those of [`mod@super::peeling`]
//!   after every one that is laid under them.
//! - Diagnostics that no buffer holds (`margin`, `voronoi`) are left as they are.
//!
//! # Rounding
//!
//! In f64, which holds every `f32`:
//!
//! ```text
//!   f16      the nearest binary16, ties to the even one, denormals too; beyond 65504: +-65504
//!   unorm8   colours, and numbers without a unit:   floor(255 min(max(v, 0), 1) + 1/2) / 255
//!            vectors without a unit:                +-floor(127 min(|v|, 1) + 1/2) / 127
//!   unormN   z = ((t - n) / (f - n)) (f / t)        under an orthographic camera without (f / t)
//!            k = floor((2^N - 1) min(max(z, 0), 1) + 1/2)      y = k / (2^N - 1)
//!            t = (n f) / (f - y (f - n))            under an orthographic camera n + y (f - n)
//! ```
//!
//! each rounded to `f32` once, -0 as +0; +inf, the depth of an empty pixel, stays. n and f are the depths
//! between which the scene's [bounding sphere](crate::scene::Scene::bounding_sphere) lies: with t its centre's and r
//! its radius, n = t - r, at least the near plane, f = t + r, at least 2 n.
//!
//! # Decided
//!
//! - Fragments come in `f32` and only what is stored is rounded: the blending units of that time
//!   computed in more digits than they stored.
//! - What overflows a half float is the greatest one and not +inf: no plane may hold what follows from infinities.
//! - `unorm8` of numbers with a unit (pixels, bins, world units) is `f32`: no 8 bits could hold them.
//! - The shift by epsilon is added in `f32` to what the depth buffer holds.
//! - The bins of \[ZP06, eq. 6\] that [`mod@super::transparent`] tests are whole numbers of at most 16 bits, and are told apart
//!   in every format.
//! - A layer of `peeling` begins at the depth that the buffer holds, and the next one beyond that depth and epsilon. Where a
//!   step of the buffer is more than epsilon a fragment may be in no layer or in several.
//! - What `deferred` carries to the next frame is what a frame in `f32` saw.

use super::stage::{Holds, PlaneRow, Stage};
use crate::composite::bins::DepthBins;
use crate::composite::over::Blend;
use crate::composite::under::Under;
use crate::frame::{Frame, NamedPlane, Samples};
use crate::number::{Exact, Real};
use crate::scene::{Camera, Projection, Scene};
use crate::setting::Words;

/// How colours, weights, normals and their sums are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Buffers {
    /// `f32`: as they are.
    #[default]
    F32,
    /// Half floats.
    F16,
    /// 8 bits in [0, 1].
    Unorm8,
}

/// How depths are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthBuffer {
    /// `f32`: as they are.
    #[default]
    F32,
    /// Half floats of the depth t itself.
    F16,
    /// 24 bits in [0, 1].
    Unorm24,
    /// 16 bits in [0, 1].
    Unorm16,
}

/// Both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Formats {
    /// Of colours, weights, normals and their sums.
    pub buffers: Buffers,
    /// Of depths.
    pub depth: DepthBuffer,
}

impl Words for Buffers {
    const WORDS: &'static [(&'static str, Self)] =
        &[("f32", Self::F32), ("f16", Self::F16), ("unorm8", Self::Unorm8)];
}

impl Words for DepthBuffer {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("f32", Self::F32),
        ("f16", Self::F16),
        ("unorm24", Self::Unorm24),
        ("unorm16", Self::Unorm16),
    ];
}

impl Formats {
    /// All is stored as it is.
    pub const WHOLE: Self = Self { buffers: Buffers::F32, depth: DepthBuffer::F32 };

    /// Whether all is stored as it is.
    #[must_use]
    pub fn keep_all(self) -> bool {
        self == Self::default()
    }

    /// Rounds what a stage leaves.
    pub(crate) fn store(self, stage: &Stage, left: &mut Frame<f32>, range: &DepthRange) {
        for NamedPlane { name, samples } in &mut left.planes {
            let Some(PlaneRow { holds, unit, .. }) = stage.row(name) else { continue };
            let keeps = !unit.is_empty() && self.buffers == Buffers::Unorm8;
            let buffers = if keeps { Buffers::F32 } else { self.buffers };
            match samples {
                _ if *holds == Holds::Diagnostic => {}
                Samples::Scalar(plane) if *holds == Holds::Depth => {
                    store_each(plane.values_mut(), |t| range.store(t, self.depth));
                }
                Samples::Scalar(plane) => store_each(plane.values_mut(), |v| buffers.number(v)),
                Samples::Color(plane) => {
                    let buffers = self.buffers;
                    store_each(plane.values_mut().as_flattened_mut(), |v| buffers.number(v));
                }
                Samples::Vector(plane) => {
                    store_each(plane.values_mut().as_flattened_mut(), |v| buffers.signed(v));
                }
                Samples::Index(_) | Samples::Count(_) => {}
            }
        }
    }
}

/// Each value as it is stored.
fn store_each(values: &mut [f32], store: impl Fn(f64) -> f64) {
    for value in values {
        *value = store(f64::from(*value)) as f32 + 0.0;
    }
}

impl Buffers {
    /// A number of [0, 1], as far as the format has such.
    fn number(self, v: f64) -> f64 {
        match self {
            Self::F32 => v,
            Self::F16 => half(v),
            Self::Unorm8 => steps(if v > 0.0 { v } else { 0.0 }, 255.0),
        }
    }

    /// A component of a vector.
    fn signed(self, v: f64) -> f64 {
        match self {
            Self::F32 => v,
            Self::F16 => half(v),
            Self::Unorm8 if v < 0.0 => -steps(-v, 127.0),
            Self::Unorm8 => steps(v, 127.0),
        }
    }

    /// A sum of numbers that fragments are added to.
    #[inline]
    pub(crate) fn sum<R: Exact>(self, v: R) -> R {
        if self == Self::F32 { v } else { R::from_f32(self.number(v.to_f64()) as f32 + 0.0) }
    }

    /// A sum of colours.
    #[inline]
    pub(crate) fn color<R: Exact>(self, [x, y, z]: [R; 3]) -> [R; 3] {
        [self.sum(x), self.sum(y), self.sum(z)]
    }

    /// A sum of vectors.
    #[inline]
    pub(crate) fn vector<R: Exact>(self, v: [R; 3]) -> [R; 3] {
        if self == Self::F32 {
            v
        } else {
            v.map(|v| R::from_f32(self.signed(v.to_f64()) as f32 + 0.0))
        }
    }

    /// Layers that were blended from the front.
    #[inline]
    pub(crate) fn under<R: Exact>(self, Under { color, alpha, through }: Under<R>) -> Under<R> {
        Under { color: self.color(color), alpha: self.sum(alpha), through: self.sum(through) }
    }

    /// Layers that were blended.
    #[inline]
    pub(crate) fn blend<R: Exact>(self, Blend { color, alpha }: Blend<R>) -> Blend<R> {
        Blend { color: self.color(color), alpha: self.sum(alpha) }
    }
}

/// The depths between which a depth buffer tells apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthRange {
    near: f64,
    far: f64,
    perspective: bool,
}

impl DepthRange {
    pub(crate) fn new(scene: &Scene, camera: &Camera) -> Self {
        let (center, radius) = scene.bounding_sphere();
        let [m0, m1, m2, m3] = camera.view_from_world.row(2).to_array().map(f64::from);
        let t = -(((m0 * center.x + m1 * center.y) + m2 * center.z) + m3);
        let least = f64::from(camera.near);
        let near = if t - radius > least { t - radius } else { least };
        let far = if t + radius > 2.0 * near { t + radius } else { 2.0 * near };
        let perspective = camera.projection == Projection::Perspective;
        Self { near, far, perspective }
    }

    /// What a buffer holds of a depth, as a number that grows with the depth: z in [0, 1] of whole numbers.
    fn held(&self, t: f64, format: DepthBuffer) -> f64 {
        let Self { near, far, perspective } = *self;
        if !format.is_whole() || !t.is_finite() {
            return format.share(t);
        }
        let z = (t - near) / (far - near);
        format.share(if perspective { z * (far / t) } else { z })
    }

    /// The depth that a buffer gives back.
    fn store(&self, t: f64, format: DepthBuffer) -> f64 {
        let y = self.held(t, format);
        let Self { near, far, perspective } = *self;
        if !format.is_whole() || !t.is_finite() {
            y
        } else if perspective {
            (near * far) / (far - y * (far - near))
        } else {
            near + y * (far - near)
        }
    }
}

impl DepthBuffer {
    /// Whether it holds whole numbers.
    fn is_whole(self) -> bool {
        matches!(self, Self::Unorm24 | Self::Unorm16)
    }

    /// What it holds of a number, which is one of [0, 1] if it holds whole numbers; +inf stays.
    fn share(self, z: f64) -> f64 {
        let count = match self {
            Self::F32 => return z,
            Self::F16 => return half(z),
            Self::Unorm24 => 16_777_215.0,
            Self::Unorm16 => 65_535.0,
        };
        if z == f64::INFINITY { z } else { steps(if z > 0.0 { z } else { 0.0 }, count) }
    }
}

/// What a depth test compares of a fragment: what the buffer holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthKey {
    format: DepthBuffer,
    range: DepthRange,
}

impl DepthKey {
    /// All is compared as it is.
    pub(crate) const WHOLE: Self = Self {
        format: DepthBuffer::F32,
        range: DepthRange { near: 0.0, far: 1.0, perspective: false },
    };

    /// Of a buffer.
    pub(crate) fn new(format: DepthBuffer, range: DepthRange) -> Self {
        Self { format, range }
    }

    /// Of a depth.
    #[inline]
    pub(crate) fn depth<R: Exact>(&self, t: R) -> f64 {
        self.range.held(t.to_f64(), self.format)
    }

    /// The depth that the buffer gives back.
    #[inline]
    pub(crate) fn stored<R: Exact>(&self, t: R) -> R {
        if self.format == DepthBuffer::F32 {
            return t;
        }
        R::from_f32(self.range.store(t.to_f64(), self.format) as f32)
    }

    /// Of a nearness, which belongs to the depth `t`.
    #[inline]
    pub(crate) fn nearness<R: Exact>(&self, w: R, t: impl FnOnce() -> R) -> f64 {
        if self.format == DepthBuffer::F32 { w.to_f64() } else { -self.depth(t()) }
    }

    /// Of a Voronoi-enhanced depth in bins.
    #[inline]
    pub(crate) fn voronoi<R: Exact>(&self, z: R, bins: &DepthBins<R>) -> f64 {
        if self.format == DepthBuffer::F32 {
            z.to_f64()
        } else {
            self.format.share(bins.share(z).to_f64())
        }
    }
}

/// The nearest of so many equal steps from 0 to 1, of a number of at least 0.
fn steps(v: f64, count: f64) -> f64 {
    let v = if v < 1.0 { v } else { 1.0 };
    (count * v + 0.5).floor() / count
}

/// The nearest half float, ties to the even one; the greatest of its sign beyond all.
fn half(v: f64) -> f64 {
    const MOST: f64 = 65_504.0;
    // Adding and taking away leaves a whole number: the nearest, ties to the even one.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    if !v.is_finite() {
        return v;
    }
    let exponent = (v.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    let step = if exponent < -14 { -24 } else { exponent - 10 };
    // 2^step, by its bits.
    let step = f64::from_bits(((step + 1023) as u64) << 52);
    let nearest = ((v / step + WHOLE) - WHOLE) * step;
    nearest.clamped(-MOST, MOST)
}

#[cfg(test)]
mod tests;
