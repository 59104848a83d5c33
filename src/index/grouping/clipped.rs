//! Clipped(p, r, k): how much of a disc others cover \[ZP06, section 4.2.2\].

use super::budget::Budget;
use super::disc::{SpaceDisc, dot};
use super::disc_tree::{DiscTree, NearBlocks};
use super::parts::Parts;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::elementary::{cos, sin};
use crate::number::lanes::vectorized;
use crate::number::random;
use glam::DVec3;
use std::f64::consts::TAU;
use std::ops::Range;
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
    pub(super) fn of(disc: SpaceDisc, surfel: u32) -> Self {
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

/// For each place, the samples that surfels of a lower index cover, with all radii times `scale`.
pub(super) fn by_lower(
    tree: &DiscTree,
    scale: f64,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
) -> Result<Parts<Vec<u64>>> {
    let budget = Budget::new(tree.surfel.len(), scale);
    Parts::of(tree, exec, progress, |places| covered_by_lower(tree, places, scale, &budget))
}

vectorized!(
    /// [`by_lower`] for some places.
    fn covered_by_lower(
        tree: &DiscTree,
        places: Range<usize>,
        scale: f64,
        budget: &Budget,
    ) -> Result<Vec<u64>> {
        let disc = |place: usize| {
            let disc = tree.discs[place];
            SpaceDisc { radius: scale * disc.radius, ..disc }
        };
        let mut covered = Vec::with_capacity(places.len());
        let (mut room, mut seen) = (NearBlocks::default(), 0);
        for i in places {
            let (mut mask, samples) = (0, DiscSamples::of(disc(i), tree.surfel[i]));
            tree.near(i, scale, &mut room, |near, so_many| {
                near[..so_many].iter().all(|&j| {
                    seen += 1;
                    if tree.surfel[j as usize] < tree.surfel[i] {
                        mask |= samples.covered_by(&disc(j as usize));
                    }
                    mask != u64::MAX
                })
            });
            covered.push(mask);
            budget.spend_many(&mut seen)?;
        }
        budget.spend(seen)?;
        Ok(covered)
    }
);

/// The covered area of eq. 7 with all radii times `scale`, divided by pi scale^2, and the sum of
/// the squared radii: sums in ascending index.
pub(super) fn area(tree: &DiscTree, covered: &Parts<Vec<u64>>) -> (f64, f64) {
    let [area] = areas(tree, |place| [covered.at(place).count_zeros() as u8]);
    (area, tree.square.iter().fold(0.0, |sum, square| sum + square))
}

/// The area of each of several sets, divided by pi, summed in ascending index. `open` tells how
/// many samples of a place each set leaves uncovered.
pub(super) fn areas<const SETS: usize>(
    tree: &DiscTree,
    open: impl Fn(usize) -> [u8; SETS],
) -> [f64; SETS] {
    let mut areas = [0.0; SETS];
    for (open, square) in by_rank(tree, [0; SETS], open).into_iter().zip(&tree.square) {
        for (area, open) in areas.iter_mut().zip(open) {
            *area += open_area(*square, open);
        }
    }
    areas
}

/// [`areas`] for each of `count` groups; each rank is in one group.
pub(super) fn areas_of_groups(
    tree: &DiscTree,
    count: usize,
    group: impl Fn(usize) -> usize,
    open: impl Fn(usize) -> u8,
) -> Vec<f64> {
    let mut areas = vec![0.0; count];
    for (rank, (open, square)) in by_rank(tree, 0, open).into_iter().zip(&tree.square).enumerate() {
        areas[group(rank)] += open_area(*square, open);
    }
    areas
}

/// The uncovered area of a disc, divided by pi.
fn open_area(square: f64, open: u8) -> f64 {
    square * (f64::from(open) / SAMPLES as f64)
}

/// Reorders a value of each place by rank.
fn by_rank<T: Copy>(tree: &DiscTree, none: T, of: impl Fn(usize) -> T) -> Vec<T> {
    let mut all = vec![none; tree.rank.len()];
    for (place, &rank) in tree.rank.iter().enumerate() {
        all[rank as usize] = of(place);
    }
    all
}

vectorized!(
    /// [`DiscSamples::covered_by`] for callers that are not compiled for vectors.
    pub(super) fn covered_by(samples: &DiscSamples, other: &SpaceDisc) -> u64 {
        samples.covered_by(other)
    }
);
