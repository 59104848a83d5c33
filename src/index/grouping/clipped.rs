//! Clipped(p, r, k): how much of a disc others cover \[ZP06, section 4.2.2\].

use super::budget::Budget;
use super::disc::{SpaceDisc, dot};
use super::disc_tree::{DISCS, DiscTree};
use crate::error::Result;
use crate::frame::Exec;
use crate::number::elementary::{cos, sin};
use crate::number::random;
use glam::DVec3;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::LazyLock;

/// How many points of a disc are asked whether they are covered.
pub(super) const SAMPLES: usize = 64;

/// The golden angle, pi (3 - sqrt(5)), in radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The samples of the unit disc: x, y and x^2 + y^2 of each; and the cosines and sines of the
/// angles that they are turned by.
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
    disc: SpaceDisc,
    u: DVec3,
    v: DVec3,
}

impl DiscSamples {
    #[inline]
    pub(super) fn of(disc: SpaceDisc) -> Self {
        let (u, v) = axes(disc.normal);
        let (c, s) = PATTERN.turn[(random::bits(0, disc.surfel.into()) >> 58) as usize];
        Self { disc, u: c * u + s * v, v: c * v - s * u }
    }

    /// Bit m is set if sample m is covered by a disc, see the [module](super).
    #[inline]
    pub(super) fn covered_by(&self, other: &SpaceDisc) -> u64 {
        if dot(self.disc.normal, other.normal) < 0.0 {
            return 0;
        }
        let d = self.disc.center - other.center;
        let r = self.disc.radius;
        let (a, b) = (2.0 * r * dot(d, self.u), 2.0 * r * dot(d, self.v));
        let (r2, most) = (r * r, other.radius * other.radius - dot(d, d));
        let Pattern { x, y, q, .. } = &*PATTERN;
        let mut covered = 0;
        for m in 0..SAMPLES {
            covered |= u64::from((a * x[m] + b * y[m]) + r2 * q[m] <= most) << m;
        }
        covered
    }
}

/// Two perpendicular axes of the plane across a unit normal; no length has to be divided by.
///
/// Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017.
fn axes(n: DVec3) -> (DVec3, DVec3) {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let u = DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let v = DVec3::new(b, sign + n.y * n.y * a, -n.y);
    (u, v)
}

/// The part of a disc that a mask of covered samples leaves, in [0, 1].
pub(super) fn open(covered: u64) -> f64 {
    f64::from(covered.count_zeros()) / SAMPLES as f64
}

/// For each place, the samples that surfels of a lower index cover, all radii times `scale`.
pub(super) fn by_lower(
    tree: &DiscTree,
    scale: f64,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
) -> Result<Vec<u64>> {
    let budget = Budget::new(tree.surfel.len(), scale);
    let job = |blocks: Range<usize>| {
        let first = tree.places(blocks.start).start;
        let disc = |place: usize| {
            let disc = tree.disc(place);
            SpaceDisc { radius: scale * disc.radius, ..disc }
        };
        let mut covered = vec![0; tree.places(blocks.end - 1).end - first];
        for block in blocks {
            let samples: Vec<DiscSamples> =
                tree.places(block).map(|i| DiscSamples::of(disc(i))).collect();
            let mut seen = 0;
            tree.near(block, scale, |i, j| {
                let mask = &mut covered[i - first];
                seen += 1;
                if tree.surfel[j] < tree.surfel[i] {
                    *mask |= samples[i - block * DISCS].covered_by(&disc(j));
                }
                *mask != u64::MAX
            });
            budget.spend(seen)?;
        }
        Ok(covered)
    };
    let mut covered = Vec::with_capacity(tree.surfel.len());
    tree.parts(exec, progress, job, |part: Vec<u64>| covered.extend(part))?;
    Ok(covered)
}

/// The covered area of eq. 7 for all radii times `scale`, divided by pi scale^2, and the sum of the
/// squared radii: sums in ascending index.
pub(super) fn area(tree: &DiscTree, covered: &[u64]) -> (f64, f64) {
    let mut order: Vec<u32> = (0..covered.len() as u32).collect();
    order.sort_unstable_by_key(|&place| tree.surfel[place as usize]);
    let (mut area, mut sum) = (0.0, 0.0);
    for place in order {
        let r = tree.disc(place as usize).radius;
        area += r * r * open(covered[place as usize]);
        sum += r * r;
    }
    (area, sum)
}
