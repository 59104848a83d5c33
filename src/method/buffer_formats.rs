//! Emulate the buffer formats of older GPUs: draw a picture whose passes store their numbers in few
//! digits.
//!
//! The GPUs of the five papers blended into 8-bit or half-float buffers and tested depths of 16 or
//! 24 bits. \[ZP06, 5.2\] counts on "current 8-bit color and alpha resolutions", and \[MOC08, 4\]
//! has "all buffers and textures" in 16-bit floats. [`super::Session::emulate`] draws the
//! definition of a method in `f32`. It rounds the planes that each [stage](super::Stage) leaves
//! before the next stage reads them:
//!
//! - [`Buffers`] rounds planes of colours, vectors and numbers. It does not round depths, indices
//!   and counts.
//! - [`DepthBuffer`] rounds planes of depths, see [`super::Holds::Depth`].
//! - A stage that works level by level runs once for each level. So a level is rounded before the
//!   next level is made from it.
//! - Where fragments are *tested* against a depth buffer, the test compares the values that the
//!   buffer holds. If the depths of several fragments round to one value, the first fragment stays.
//!   This applies to the tests that a nearest fragment wins: visibility splatting, the depth-images
//!   of [`mod@super::single_pass`], the pixels of [`mod@super::projection`], the discs of
//!   [`mod@super::blue`] and the indices of [`mod@super::deferred`]. The splats of
//!   [`mod@super::gaussians`] are tested so against a surface, and an equal one is drawn. It does not apply to the tests
//!   by epsilon, because they read a depth in `f32` from a buffer. Under the Voronoi depth test the
//!   buffer holds z / n of \[ZP06, eq. 10\] and no depth.
//! - Where fragments are *blended* into a buffer, the buffer is rounded after every fragment. The
//!   sums of attribute splatting ([`mod@super::ewa`], [`mod@super::deferred`], and each layer of
//!   [`mod@super::peeling`]) are rounded after every addition. The layers of
//!   [`mod@super::transparent`] and [`mod@super::transparent_hq`] are rounded after every layer
//!   that is laid over the layers before. The layers of [`mod@super::peeling`] are rounded after
//!   every layer that is laid under them.
//! - The depth that **normalization** shows, as the plane `Z`, is the depth that it reads back from
//!   the depth buffer: `visibility.Z` of [`mod@super::ewa`], `difference.Z` of
//!   [`mod@super::deferred`], each as it is stored. Like every plane that a stage leaves, `Z` is then
//!   rounded itself. Where `deferred` shows a polygon, or without its second pass a fragment of
//!   B(i), the depth is that fragment's in `f32`, rounded once.
//! - Diagnostics that no buffer holds (`margin`, `voronoi`) are not rounded.
//!
//! # Rounding
//!
//! The formulas are computed in f64, which holds every `f32`:
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
//! Each result is rounded to `f32` once, and -0 becomes +0. The depth of an empty pixel, +inf,
//! stays. n and f are the depths between which the scene's [bounding
//! sphere](crate::scene::Scene::bounding_sphere) lies. With t the depth of the sphere's centre and
//! r its radius, n = t - r, at least the near plane, and f = t + r, at least 2 n.
//!
//! # Decided
//!
//! - Fragments come in `f32`, and only the stored values are rounded, because the blending units of
//!   that time computed in more digits than they stored.
//! - A value that overflows a half float becomes the greatest half float and not +inf, because no
//!   plane may hold the results of infinities.
//! - Numbers with a unit (pixels, bins, world units) stay `f32` under `unorm8`, because no 8 bits
//!   could hold them.
//! - The shift by epsilon is added in `f32` to the depth that the depth buffer holds.
//! - The bins of \[ZP06, eq. 6\] that [`mod@super::transparent`] tests are whole numbers of at most
//!   16 bits. They are told apart in every format.
//! - A layer of `peeling` begins at the depth that the buffer holds, and the next layer begins
//!   beyond that depth and epsilon. Where a step of the buffer is more than epsilon, a fragment may
//!   be in no layer or in several.
//! - `deferred` carries to the next frame what a frame in `f32` saw.

use super::stage::{Holds, PlaneRow, Stage};
use crate::composite::bins::DepthBins;
use crate::composite::over::Blend;
use crate::composite::under::Under;
use crate::frame::{Frame, NamedPlane, Samples};
use crate::number::{Exact, MapInline, Real};
use crate::scene::{Camera, Projection, Scene, Sphere};
use crate::setting::Words;

/// The buffer format of colours, weights, normals and their sums.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Buffers {
    /// `f32`: values are stored unchanged.
    #[default]
    F32,
    /// Half floats.
    F16,
    /// 8 bits in [0, 1].
    Unorm8,
}

/// The buffer format of depths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthBuffer {
    /// `f32`: depths are stored unchanged.
    #[default]
    F32,
    /// Half floats of the depth t itself.
    F16,
    /// 24 bits in [0, 1].
    Unorm24,
    /// 16 bits in [0, 1].
    Unorm16,
}

/// The formats of all buffers of a renderer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Formats {
    /// The format of colours, weights, normals and their sums.
    pub buffers: Buffers,
    /// The format of depths.
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
    /// Formats that store every value unchanged.
    pub const WHOLE: Self = Self { buffers: Buffers::F32, depth: DepthBuffer::F32 };

    /// Whether these formats store every value unchanged.
    #[must_use]
    pub fn keep_all(self) -> bool {
        self == Self::default()
    }

    /// Rounds the planes that a stage leaves.
    pub(crate) fn store(self, stage: &Stage, left: &mut Frame<f32>, range: &DepthRange) {
        for NamedPlane { name, samples } in &mut left.planes {
            let Some(PlaneRow { holds, unit, .. }) = stage.row(name) else { continue };
            // No 8 bits could hold a number with a unit.
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

/// Replaces each value by its stored value, with -0 as +0.
fn store_each(values: &mut [f32], store: impl Fn(f64) -> f64) {
    for value in values {
        *value = store(f64::from(*value)) as f32 + 0.0;
    }
}

impl Buffers {
    /// Rounds a number; `unorm8` holds numbers in [0, 1].
    fn number(self, v: f64) -> f64 {
        match self {
            Self::F32 => v,
            Self::F16 => half(v),
            Self::Unorm8 => steps(if v > 0.0 { v } else { 0.0 }, 255.0),
        }
    }

    /// Rounds a component of a vector; `unorm8` holds components in [-1, 1].
    fn signed(self, v: f64) -> f64 {
        match self {
            Self::F32 => v,
            Self::F16 => half(v),
            Self::Unorm8 if v < 0.0 => -steps(-v, 127.0),
            Self::Unorm8 => steps(v, 127.0),
        }
    }

    /// Rounds a sum of numbers that fragments are added to.
    #[inline]
    pub(crate) fn sum<R: Exact>(self, v: R) -> R {
        if self == Self::F32 { v } else { R::from_f32(self.number(v.to_f64()) as f32 + 0.0) }
    }

    /// Rounds a sum of colours.
    #[inline]
    pub(crate) fn color<R: Exact>(self, [x, y, z]: [R; 3]) -> [R; 3] {
        [self.sum(x), self.sum(y), self.sum(z)]
    }

    /// Rounds a sum of vectors.
    #[inline]
    pub(crate) fn vector<R: Exact>(self, v: [R; 3]) -> [R; 3] {
        if self == Self::F32 {
            v
        } else {
            v.map_inline(|v| R::from_f32(self.signed(v.to_f64()) as f32 + 0.0))
        }
    }

    /// Rounds layers that were blended from front to back.
    #[inline]
    pub(crate) fn under<R: Exact>(self, Under { color, alpha, through }: Under<R>) -> Under<R> {
        Under { color: self.color(color), alpha: self.sum(alpha), through: self.sum(through) }
    }

    /// Rounds blended layers.
    #[inline]
    pub(crate) fn blend<R: Exact>(self, Blend { color, alpha }: Blend<R>) -> Blend<R> {
        Blend { color: self.color(color), alpha: self.sum(alpha) }
    }
}

/// The range of depths that a depth buffer of whole numbers can tell apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthRange {
    near: f64,
    far: f64,
    perspective: bool,
}

impl DepthRange {
    pub(crate) fn new(scene: &Scene, camera: &Camera) -> Self {
        let Sphere { center, radius } = scene.bounding_sphere();
        let [m0, m1, m2, m3] = camera.view_from_world.row(2).to_array().map_inline(f64::from);
        let t = -(((m0 * center.x + m1 * center.y) + m2 * center.z) + m3);
        let least = f64::from(camera.near);
        let near = if t - radius > least { t - radius } else { least };
        let far = if t + radius > 2.0 * near { t + radius } else { 2.0 * near };
        let perspective = camera.projection == Projection::Perspective;
        Self { near, far, perspective }
    }

    /// The value that a buffer holds for a depth. It grows with the depth; buffers of whole numbers
    /// hold z in [0, 1].
    fn held(&self, t: f64, format: DepthBuffer) -> f64 {
        let Self { near, far, perspective } = *self;
        if !format.is_whole() || !t.is_finite() {
            return format.share(t);
        }
        let z = (t - near) / (far - near);
        format.share(if perspective { z * (far / t) } else { z })
    }

    /// The depth that you read back from a buffer.
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
    /// Whether the format stores whole numbers.
    fn is_whole(self) -> bool {
        matches!(self, Self::Unorm24 | Self::Unorm16)
    }

    /// The value that the format holds for `z`. Formats of whole numbers hold values in [0, 1];
    /// +inf stays.
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

/// Compares fragments in a depth test by the values that the depth buffer holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthKey {
    format: DepthBuffer,
    range: DepthRange,
}

impl DepthKey {
    /// A key that compares unchanged values.
    pub(crate) const WHOLE: Self = Self {
        format: DepthBuffer::F32,
        range: DepthRange { near: 0.0, far: 1.0, perspective: false },
    };

    /// The key of a depth buffer.
    pub(crate) fn new(format: DepthBuffer, range: DepthRange) -> Self {
        Self { format, range }
    }

    /// The value that the depth test compares for a depth.
    #[inline]
    pub(crate) fn depth<R: Exact>(&self, t: R) -> f64 {
        self.range.held(t.to_f64(), self.format)
    }

    /// The depth that you read back from the buffer.
    #[inline]
    pub(crate) fn stored<R: Exact>(&self, t: R) -> R {
        if self.format == DepthBuffer::F32 {
            return t;
        }
        R::from_f32(self.range.store(t.to_f64(), self.format) as f32)
    }

    /// The value that the depth test compares for a nearness, which belongs to the depth `t`.
    #[inline]
    pub(crate) fn nearness<R: Exact>(&self, w: R, t: impl FnOnce() -> R) -> f64 {
        if self.format == DepthBuffer::F32 { w.to_f64() } else { -self.depth(t()) }
    }

    /// The value that the depth test compares for a Voronoi-enhanced depth in bins.
    #[inline]
    pub(crate) fn voronoi<R: Exact>(&self, z: R, bins: &DepthBins<R>) -> f64 {
        if self.format == DepthBuffer::F32 {
            z.to_f64()
        } else {
            self.format.share(bins.share(z).to_f64())
        }
    }
}

/// Rounds `v`, at least 0, to the nearest of `count` equal steps from 0 to 1.
fn steps(v: f64, count: f64) -> f64 {
    let v = if v < 1.0 { v } else { 1.0 };
    (count * v + 0.5).floor() / count
}

/// The nearest half float, ties to the even one. Beyond the greatest half float, the greatest of
/// the same sign.
fn half(v: f64) -> f64 {
    const MOST: f64 = 65_504.0;
    // Adding and subtracting WHOLE leaves the nearest whole number, ties to the even one.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    if !v.is_finite() {
        return v;
    }
    let exponent = (v.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    let step = if exponent < -14 { -24 } else { exponent - 10 };
    // 2^step, made from its bits.
    let step = f64::from_bits(((step + 1023) as u64) << 52);
    let nearest = ((v / step + WHOLE) - WHOLE) * step;
    nearest.clamped(-MOST, MOST)
}

#[cfg(test)]
mod tests;
