//! Bound clusters of neighbouring surfels, so that a view drops many surfels at once.
//!
//! A cluster is [`Clusters::SURFELS`] surfels that follow one another in the scene: scans and meshes
//! list neighbours one after the other. `splat::cluster` says when a view drops a cluster.

use crate::frame::Exec;
use crate::number::MapInline;
use crate::scene::Surfels;
use glam::Vec3;
use std::ops::Range;

/// The clusters of a scene, in the order of its surfels.
#[derive(Debug)]
pub struct Clusters {
    clusters: Vec<Cluster>,
}

/// Bounds of the surfels of a cluster. They contain the surfels of the scene as they are, without any
/// rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    /// A place among the centres.
    pub(crate) center: Vec3,
    /// No centre is farther from `center`, or more than 10^-18 farther.
    pub(crate) radius: f32,
    /// A direction among the normals, of length 1 within 2^-20, or 0.
    pub(crate) axis: Vec3,
    /// For every normal n, |n - axis| is at most this.
    pub(crate) spread: f32,
    /// No surfel reaches farther from its centre: not its radius r or, for an ellipse, sqrt(U . U + V . V).
    pub(crate) reach: f32,
    /// No surfel has a shorter reach. 0 if a surfel is a thin or a tilted ellipse: if not |U|^2 + |V|^2
    /// <= 16 |N| for N = U x V, or if N/|N| differs from the normal and from its opposite by more than
    /// 2^-11.
    pub(crate) least: f32,
}

impl Clusters {
    /// How many surfels a cluster has; the last one may have fewer.
    pub const SURFELS: usize = 64;

    /// Bounds the surfels of a scene. There are no clusters if less than a quarter of them are smaller
    /// than half of the scene: surfels in random order would only pay for the tests.
    #[must_use]
    pub fn new(surfels: &Surfels, exec: &Exec) -> Self {
        let (count, mut clusters) = (surfels.len().div_ceil(Self::SURFELS), Vec::new());
        exec.extend(&mut clusters, count, |i| {
            let first = i * Self::SURFELS;
            Cluster::around(surfels, first..surfels.len().min(first + Self::SURFELS))
        });
        let small = 0.5 * surfels.bounding_sphere().1;
        let tight = clusters.iter().filter(|cluster| f64::from(cluster.radius) < small).count();
        if 4 * tight < count {
            clusters.clear();
        }
        Self { clusters }
    }

    /// Splits a range of surfels at the borders of clusters, and gives each part with its cluster; no
    /// part if there are no clusters.
    pub(crate) fn parts(
        &self,
        range: Range<usize>,
    ) -> impl Iterator<Item = (Range<usize>, &Cluster)> {
        let (first, end) = (range.start / Self::SURFELS, range.end.div_ceil(Self::SURFELS));
        let clusters = (first..end).zip(self.clusters.iter().skip(first));
        clusters.map(move |(i, cluster)| {
            let first = i * Self::SURFELS;
            (range.start.max(first)..range.end.min(first + Self::SURFELS), cluster)
        })
    }
}

impl Cluster {
    /// Bounds some surfels, at least one.
    fn around(surfels: &Surfels, range: Range<usize>) -> Self {
        let (positions, normals) =
            (&surfels.position()[range.clone()], &surfels.normal()[range.clone()]);
        let corners = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        let (low, high) = positions.iter().fold((positions[0], positions[0]), corners);
        let center = low * 0.5 + high * 0.5;
        let axis = normals.iter().sum::<Vec3>().normalize_or_zero();
        let (mut least, mut reach) = (f64::INFINITY, 0.0_f64);
        for i in range {
            let (own, shortest) = reaches(surfels, i);
            least = if shortest < least { shortest } else { least };
            reach = if own > reach { own } else { reach };
        }
        Self {
            center,
            radius: farthest(positions, center),
            axis,
            spread: farthest(normals, axis),
            reach: above(reach),
            least: (least * (1.0 - SLACK)) as f32,
        }
    }
}

/// More than the rounding of a bound: 2^-20.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// A number that is surely not smaller.
fn above(bound: f64) -> f32 {
    (bound * (1.0 + SLACK)) as f32
}

/// At least the greatest distance of a point, but for distances below 10^-18, whose squares may vanish.
fn farthest(points: &[Vec3], from: Vec3) -> f32 {
    // A difference of two `f32` is rounded once, so the error is a few units of the distance.
    let square = points.iter().map(|point| (*point - from).length_squared());
    above(
        square
            .fold(0.0_f32, |most, square| if square > most { square } else { most })
            .sqrt()
            .into(),
    )
}

/// The reach of a surfel, and what [`Cluster::least`] makes of it.
fn reaches(surfels: &Surfels, i: usize) -> (f64, f64) {
    let Some(tangents) = surfels.tangents() else {
        let radius = f64::from(surfels.radius()[i]);
        return (radius, radius);
    };
    let [u, v] = tangents[i].map_inline(|tangent| tangent.as_dvec3());
    let (n, normal) = (u.cross(v), surfels.normal()[i].as_dvec3());
    let (square, area) = (u.dot(u) + v.dot(v), n.length());
    let side = if n.dot(normal) < 0.0 { -1.0 } else { 1.0 };
    let tilt = (n * (side / area) - normal).length();
    // Comparisons that NaN fails.
    let sound = square <= 16.0 * area && tilt <= 1.0 / 2048.0;
    (square.sqrt(), if sound { square.sqrt() } else { 0.0 })
}
