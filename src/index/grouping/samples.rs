//! The samples of a disc, and which of them another disc covers \[ZP06, section 4.2.2\].

use super::disc::{SpaceDisc, dot};
use crate::number::elementary::{cos, sin};
use crate::number::lanes::vectorized;
use crate::number::random;
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// How many points of a disc are tested for being covered.
pub(super) const SAMPLES: usize = 64;

/// The golden angle, pi (3 - sqrt(5)), in radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The samples of the unit disc: x, y and x^2 + y^2 of each; and the cosines and sines of the
/// angles by which the samples are turned.
struct Pattern {
    x: [f64; SAMPLES],
    y: [f64; SAMPLES],
    q: [f64; SAMPLES],
    turn: [(f64, f64); SAMPLES],
}

static PATTERN: LazyLock<Pattern> = LazyLock::new(|| {
    let q: [f64; SAMPLES] = std::array::from_fn(|m| (m as f64 + 0.5) / SAMPLES as f64);
    let along =
        |of: fn(f64) -> f64| std::array::from_fn(|m| q[m].sqrt() * of(m as f64 * GOLDEN_ANGLE));
    let angle = |m: usize| m as f64 * (TAU / SAMPLES as f64);
    let turn = std::array::from_fn(|m| (cos(angle(m)), sin(angle(m))));
    Pattern { x: along(cos), y: along(sin), q, turn }
});

/// The samples of a disc.
pub(super) struct DiscSamples {
    pattern: &'static Pattern,
    disc: SpaceDisc,
    u: DVec3,
    v: DVec3,
}

impl DiscSamples {
    /// The samples of a surfel's disc.
    #[inline(always)]
    pub(super) fn new(disc: SpaceDisc, surfel: u32) -> Self {
        let (u, v) = axes(disc.normal.as_dvec3());
        let pattern = &*PATTERN;
        let (c, s) = pattern.turn[(random::bits(0, surfel.into()) >> 58) as usize];
        Self { pattern, disc, u: c * u + s * v, v: c * v - s * u }
    }

    /// Bit m is set if a disc covers sample m, see the [module](super).
    #[inline(always)]
    pub(super) fn covered_by(&self, other: &SpaceDisc) -> u64 {
        if self.disc.cosine(other) < 0.0 {
            return 0;
        }
        let d = self.disc.center.as_dvec3() - other.center.as_dvec3();
        let r = self.disc.radius;
        let (a, b) = (2.0 * r * dot(d, self.u), 2.0 * r * dot(d, self.v));
        let (r2, most) = (r * r, other.radius * other.radius - dot(d, d));
        let Pattern { x, y, q, .. } = self.pattern;
        let mut covered = 0;
        for m in 0..SAMPLES {
            covered |= u64::from((a * x[m] + b * y[m]) + r2 * q[m] <= most) << m;
        }
        covered
    }
}

/// Two perpendicular axes of the plane across a unit normal, without dividing by a length.
///
/// Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017.
#[inline(always)]
fn axes(n: DVec3) -> (DVec3, DVec3) {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let u = DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let v = DVec3::new(b, sign + n.y * n.y * a, -n.y);
    (u, v)
}

vectorized!(
    /// [`DiscSamples::covered_by`] for callers that are not compiled for vectors.
    pub(super) fn covered_by(samples: &DiscSamples, other: &SpaceDisc) -> u64 {
        samples.covered_by(other)
    }
);
