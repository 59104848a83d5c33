//! Build the graph of neighbours that face alike.
//!
//! Internally, points have the ranks of the tree, because neighbours in the tree are near in
//! memory.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::{Entry, PointTree, Search};
use crate::memory;
use crate::progress::Progress;
use crate::source::sampler::greedy::squared_distance;
use crate::source::sampler::search::{LEAF, is_within};
use glam::Vec3;
use std::ops::Range;

/// The most neighbours of a point.
const NEAR: usize = 16;
/// Points of one job.
const JOB: usize = 4096;
/// The most bytes that the tree, neighbours and edges take for a point.
const BYTES_A_POINT: u64 = 40 + 3 * 8 * NEAR as u64;

/// A graph of points, see the [module](super).
#[derive(Debug)]
pub struct Graph {
    /// The rank of each point, by index.
    rank: Vec<u32>,
    /// For each rank, the end of its edges; they begin at the end of the rank before.
    ends: Vec<u64>,
    /// Rank and length.
    edges: Vec<(u32, f32)>,
}

impl Graph {
    /// The graph of points, each with a normal. `progress` gets the name of the step, the number of
    /// points done, and their total.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not as many normals as points, if a point is not finite, if
    /// a normal is null or not finite, if the reach is not a finite number above 0, or if there are
    /// 2^32 points or more.
    pub fn new(
        points: &[Vec3],
        normals: &[Vec3],
        reach: f32,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        check(points, normals, reach)?;
        let n = points.len();
        memory::ask(n as u64 * BYTES_A_POINT, || format!("the neighbours of {n} points"))?;
        let tree = PointTree::new(points, LEAF, exec);
        let around = Around { tree: &tree, normals, reach2: reach * reach };
        let mut near = Vec::with_capacity(n * NEAR);
        let mut ends = Vec::with_capacity(n);
        let batch = JOB * 16 * exec.threads();
        for first in (0..n).step_by(batch) {
            progress("finding neighbours", first as u64, n as u64);
            let ranks = first..(first + batch).min(n);
            let jobs = ranks.clone().step_by(JOB).map(|from| from..(from + JOB).min(ranks.end));
            for part in exec.ordered(jobs.collect(), |ranks| around.neighbours(ranks)) {
                for found in part {
                    near.extend(found.iter().map(|found| (found.rank, found.d2.sqrt())));
                    ends.push(near.len() as u64);
                }
            }
        }
        progress("finding neighbours", n as u64, n as u64);
        let mut rank = vec![0; n];
        tree.entries().iter().zip(0..).for_each(|(entry, at)| rank[entry.id as usize] = at);
        let (ends, edges) = both_ways(&ends, &near);
        Ok(Self { rank, ends, edges })
    }

    /// The number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rank.len()
    }

    /// Whether the graph has no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rank.is_empty()
    }

    /// The number of connected parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        let mut seen = vec![false; self.len()];
        let (mut parts, mut ahead) = (0, Vec::new());
        for rank in 0..self.len() as u32 {
            if seen[rank as usize] {
                continue;
            }
            parts += 1;
            seen[rank as usize] = true;
            ahead.push(rank);
            while let Some(at) = ahead.pop() {
                for &(to, _) in self.edges(at) {
                    if !seen[to as usize] {
                        seen[to as usize] = true;
                        ahead.push(to);
                    }
                }
            }
        }
        parts
    }

    /// The rank of a point.
    #[inline(always)]
    pub(super) fn rank(&self, id: u32) -> u32 {
        self.rank[id as usize]
    }

    /// The edges at a rank: the other rank, and the length.
    #[inline(always)]
    pub(super) fn edges(&self, rank: u32) -> &[(u32, f32)] {
        &self.edges[range(&self.ends, rank)]
    }
}

fn check(points: &[Vec3], normals: &[Vec3], reach: f32) -> Result<()> {
    let invalid = |what| Err(Error::Invalid(what));
    let n = points.len();
    if n != normals.len() {
        return invalid(format!("{} normals, but {n} points", normals.len()));
    }
    if u32::try_from(n).is_err() {
        return invalid(format!("{n} points, but indices have 32 bits: split the model"));
    }
    if !(reach > 0.0 && reach.is_finite()) {
        return invalid(format!("a reach of {reach}; give a length above 0"));
    }
    if let Some(at) = points.iter().position(|point| !point.is_finite()) {
        return invalid(format!(
            "point {at} is not finite, so it has no distance to others; remove it"
        ));
    }
    if let Some(at) = normals.iter().position(|n| !n.is_finite() || *n == Vec3::ZERO) {
        return invalid(format!("the normal of point {at} is zero or not finite"));
    }
    Ok(())
}

fn range(ends: &[u64], rank: u32) -> Range<usize> {
    let rank = rank as usize;
    let from = if rank == 0 { 0 } else { ends[rank - 1] };
    from as usize..ends[rank] as usize
}

/// Edges at both of their ends, from edges that are known at one end or at both.
fn both_ways(ends: &[u64], near: &[(u32, f32)]) -> (Vec<u64>, Vec<(u32, f32)>) {
    let n = ends.len() as u32;
    let of = |rank: u32| &near[range(ends, rank)];
    // The edges that the other end does not know.
    let one_way = |from: u32| {
        let unknown = move |&&(to, _): &&(u32, f32)| of(to).iter().all(|(back, _)| *back != from);
        of(from).iter().filter(unknown).map(move |&(to, length)| (from, to, length))
    };
    let mut room: Vec<u64> = (0..n).map(|rank| of(rank).len() as u64).collect();
    (0..n).flat_map(one_way).for_each(|(_, to, _)| room[to as usize] += 1);
    let mut total = 0;
    let mut next: Vec<u64> = Vec::with_capacity(ends.len());
    for room in &mut room {
        next.push(total);
        total += *room;
        *room = total;
    }
    let mut edges = vec![(0, 0.0); total as usize];
    let mut add = |from: u32, to: u32, length: f32| {
        let next = &mut next[from as usize];
        edges[*next as usize] = (to, length);
        *next += 1;
    };
    for rank in 0..n {
        of(rank).iter().for_each(|&(to, length)| add(rank, to, length));
        one_way(rank).for_each(|(from, to, length)| add(to, from, length));
    }
    (room, edges)
}

/// The search of neighbours.
struct Around<'a> {
    tree: &'a PointTree,
    normals: &'a [Vec3],
    reach2: f32,
}

/// A neighbour.
#[derive(Clone, Copy)]
struct Near {
    d2: f32,
    id: u32,
    rank: u32,
}

impl Around<'_> {
    /// The neighbours of the points with these ranks.
    fn neighbours(&self, ranks: Range<usize>) -> Vec<Vec<Near>> {
        let one = |entry: &Entry| {
            let normal = self.normals[entry.id as usize];
            let found = Vec::with_capacity(NEAR + 1);
            let mut query = Query { around: self, point: entry.point, normal, id: entry.id, found };
            self.tree.search(entry.point, &mut query);
            query.found
        };
        self.tree.entries()[ranks].iter().map(one).collect()
    }
}

/// The point whose neighbours are searched, and the neighbours found so far, in their order.
struct Query<'a> {
    around: &'a Around<'a>,
    point: Vec3,
    normal: Vec3,
    id: u32,
    found: Vec<Near>,
}

impl Query<'_> {
    /// Points farther away than this are not needed.
    fn limit(&self) -> f32 {
        self.found.get(NEAR - 1).map_or(self.around.reach2, |last| last.d2)
    }
}

impl Search for Query<'_> {
    #[inline]
    fn look(&mut self, rank: usize) {
        let entry = self.around.tree.entries()[rank];
        let d2 = squared_distance(self.point, entry.point);
        if !(d2 <= self.limit()) || entry.id == self.id {
            return;
        }
        if !alike(self.normal, self.around.normals[entry.id as usize]) {
            return;
        }
        let nearer = |other: &Near| other.d2 < d2 || (other.d2 == d2 && other.id < entry.id);
        let at = self.found.iter().rposition(nearer).map_or(0, |last| last + 1);
        self.found.insert(at, Near { d2, id: entry.id, rank: rank as u32 });
        self.found.truncate(NEAR);
    }

    #[inline]
    fn reaches(&self, offset: [f64; 3]) -> bool {
        is_within(offset, self.limit())
    }
}

/// Whether two normals face alike.
pub(in crate::source::sampler) fn alike(a: Vec3, b: Vec3) -> bool {
    let [a, b] = [a.as_dvec3(), b.as_dvec3()];
    let dot = |a: glam::DVec3, b: glam::DVec3| (a.x * b.x + a.y * b.y) + a.z * b.z;
    let s = dot(a, b);
    s >= 0.0 || 4.0 * (s * s) < dot(a, a) * dot(b, b)
}
