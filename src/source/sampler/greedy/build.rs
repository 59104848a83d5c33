//! Divide points into regions of buckets.
//!
//! 1. A sample of the points is halved at its medians, widest axis first, into the wanted number of
//!    leaves.
//! 2. Each chunk of the points is sorted by leaf; a chunk is a job.
//! 3. Each region takes neighbouring leaves, and halves the points of each down to buckets.
//!
//! The tree affects only the time, not the result.

use super::order::Division;
use super::tree::{BUCKET, Bucket, Group, Region};
use crate::frame::Exec;
use crate::index::point_tree::{Entry, widest};
use crate::number::MapInline;
use crate::number::lanes::LANES;
use crate::number::random;
use glam::Vec3;
use std::ops::Range;

/// One of this many points is in the sample.
const SAMPLE: usize = 32;
/// The most leaves, because each chunk of the points is scattered to all of them.
const MOST_LEAVES: usize = 4096;
/// Points that descend side by side.
const RUN: usize = 8;
/// The most points of a group.
const GROUP: usize = BUCKET * LANES;

/// Builds the tree, without distances, from at least one point.
pub(super) fn regions(points: &[Vec3], how: &Division, exec: &Exec) -> Vec<Region> {
    let leaves = points.len().div_ceil(how.leaf).min(MOST_LEAVES);
    let cuts = Cuts::new(points, leaves, exec);
    let chunk = points.len().div_ceil(2 * exec.threads());
    let chunks = points.chunks(chunk).enumerate().map(|(i, part)| (i * chunk, part));
    let sorted = exec.ordered(chunks.collect(), |(first, part)| Sorted::new(&cuts, first, part));
    let regions = how.regions.min(leaves);
    let ranges = (0..regions).map(|i| leaves * i / regions..leaves * (i + 1) / regions);
    exec.ordered(ranges.collect(), |range: Range<usize>| {
        let points = |leaf| sorted.iter().map(|sorted| sorted.leaf(leaf).len()).sum::<usize>();
        let buckets = |points: usize| points.div_ceil(BUCKET) + points.div_ceil(GROUP);
        let most = range.clone().map(|leaf| buckets(points(leaf))).sum();
        let mut growing = Growing { buckets: Vec::with_capacity(most), groups: Vec::new() };
        let mut entries = Vec::new();
        for leaf in range {
            entries.clear();
            sorted.iter().for_each(|sorted| entries.extend_from_slice(sorted.leaf(leaf)));
            growing.leaf(&mut entries);
        }
        // The sample may leave a region without points.
        if growing.groups.is_empty() {
            growing.groups.push(Group::new(0));
        }
        Region::new(growing.buckets, growing.groups)
    })
}

/// The planes that cut space, as a tree: the root is 1, and node i has the children 2 i and 2
/// i + 1. All paths have one length, and each leads to a leaf.
struct Cuts {
    planes: Vec<(f32, u8)>,
    depth: u32,
    /// The leaf at the end of each path.
    leaf: Vec<u16>,
}

/// A part of the sample, the node that cuts it, and its range of leaves.
struct Part<'a> {
    sample: &'a mut [Vec3],
    node: usize,
    leaves: Range<usize>,
}

impl Cuts {
    fn new(points: &[Vec3], leaves: usize, exec: &Exec) -> Self {
        let depth = leaves.next_power_of_two().ilog2();
        // Choose at random, because regular steps would take only a few rows of points on a grid.
        let mut sample: Vec<Vec3> = points
            .chunks_exact(SAMPLE)
            .zip(0..)
            .map(|(few, i)| few[random::bits(0, i) as usize % SAMPLE])
            .collect();
        let paths = 1 << depth;
        let mut cuts = Self {
            // Everything is below an infinite plane.
            planes: vec![(f32::INFINITY, 0); paths],
            depth,
            leaf: vec![0; paths],
        };
        let mut parts = vec![Part { sample: &mut sample, node: 1, leaves: 0..leaves }];
        for _ in 0..depth {
            let cut = exec.ordered(parts, |part| part.cut());
            parts = Vec::with_capacity(2 * cut.len());
            for (node, plane, halves) in cut {
                cuts.planes[node] = plane;
                parts.extend(halves);
            }
        }
        for part in parts {
            cuts.leaf[part.node - paths] = part.leaves.start as u16;
        }
        cuts
    }

    /// The leaf of each point.
    fn leaves(&self, points: &[Vec3]) -> Vec<u16> {
        let mut leaves = Vec::with_capacity(points.len());
        let (runs, rest) = points.as_chunks::<RUN>();
        runs.iter().for_each(|run| leaves.extend(self.leaves_of_run(run)));
        leaves.extend(rest.iter().map(|&point| self.leaves_of_run(&[point])[0]));
        leaves
    }

    /// The leaf of each point. The points descend side by side, because each step of one point
    /// waits for its last.
    #[inline(always)]
    fn leaves_of_run<const N: usize>(&self, points: &[Vec3; N]) -> [u16; N] {
        // The masks change no index, and save bounds checks.
        let last = self.planes.len() - 1;
        let points = points.map_inline(|point| [point.x, point.y, point.z, 0.0]);
        let mut nodes = [1; N];
        for _ in 0..self.depth {
            for (node, point) in nodes.iter_mut().zip(&points) {
                let (plane, axis) = self.planes[*node & last];
                *node = 2 * *node + usize::from(point[usize::from(axis & 3)] >= plane);
            }
        }
        nodes.map_inline(|node| self.leaf[node & last])
    }
}

impl<'a> Part<'a> {
    /// The plane, and the parts on both sides of it.
    fn cut(self) -> (usize, (f32, u8), Vec<Self>) {
        let Self { sample, node, leaves } = self;
        if leaves.len() < 2 {
            // Everything stays on the lower side.
            return (node, (f32::INFINITY, 0), vec![Part { sample, node: 2 * node, leaves }]);
        }
        let half = leaves.len() / 2;
        let middle = leaves.start + half;
        let axis = widest(sample.iter().copied());
        let rank = sample.len() * half / leaves.len();
        let mut plane = f32::INFINITY;
        if rank < sample.len() {
            let by = |a: &Vec3, b: &Vec3| a[axis].total_cmp(&b[axis]);
            plane = sample.select_nth_unstable_by(rank, by).1[axis];
        }
        let (low, high) = sample.split_at_mut(rank);
        let low = Part { sample: low, node: 2 * node, leaves: leaves.start..middle };
        let high = Part { sample: high, node: 2 * node + 1, leaves: middle..leaves.end };
        (node, (plane, axis as u8), vec![low, high])
    }
}

/// A chunk of the points, sorted by leaf.
struct Sorted {
    entries: Vec<Entry>,
    /// The end of each leaf.
    ends: Vec<u32>,
}

impl Sorted {
    /// Sorts a chunk of points; `first` is the index of its first point.
    fn new(cuts: &Cuts, first: usize, points: &[Vec3]) -> Self {
        let mut ends = vec![0; cuts.leaf.len()];
        let leaf = cuts.leaves(points);
        leaf.iter().for_each(|&leaf| ends[usize::from(leaf)] += 1);
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        let mut entries = vec![Entry { point: Vec3::ZERO, id: 0 }; points.len()];
        for ((&point, leaf), id) in points.iter().zip(leaf).zip(first as u32..) {
            let end = &mut ends[usize::from(leaf)];
            entries[*end as usize] = Entry { point, id };
            *end += 1;
        }
        Self { entries, ends }
    }

    fn leaf(&self, leaf: usize) -> &[Entry] {
        let start = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.entries[start as usize..self.ends[leaf] as usize]
    }
}

/// A region under construction.
struct Growing {
    buckets: Vec<Bucket>,
    groups: Vec<Group>,
}

impl Growing {
    /// Makes the groups of a leaf, all about equally full.
    fn leaf(&mut self, entries: &mut [Entry]) {
        let groups = entries.len().div_ceil(GROUP);
        if groups > 1 {
            let (low, high) = halves(entries, entries.len() * (groups / 2) / groups);
            self.leaf(low);
            self.leaf(high);
        } else if groups == 1 {
            let first = self.buckets.len();
            let mut group = Group::new(first);
            self.bucket(entries, &mut group, first);
            self.groups.push(group);
        }
    }

    /// Makes the buckets of a group; all but the last are full.
    fn bucket(&mut self, entries: &mut [Entry], group: &mut Group, first: usize) {
        let buckets = entries.len().div_ceil(BUCKET);
        if buckets > 1 {
            let (low, high) = halves(entries, buckets / 2 * BUCKET);
            self.bucket(low, group, first);
            self.bucket(high, group, first);
            return;
        }
        group.put(self.buckets.len() - first, bounds(entries), lowest(entries));
        // Fill the bucket in its place, because it is large.
        self.buckets.push(Bucket::EMPTY);
        let Some(bucket) = self.buckets.last_mut() else { return };
        for (lane, entry) in entries.iter().enumerate() {
            bucket.put(lane, entry.point.to_array(), entry.id);
        }
    }
}

/// Splits entries into the `low` lowest along the widest axis, and the others.
fn halves(entries: &mut [Entry], low: usize) -> (&mut [Entry], &mut [Entry]) {
    // A comparison along a constant axis is clearly faster.
    match widest(entries.iter().map(|entry| entry.point)) {
        0 => entries.select_nth_unstable_by(low, |a, b| a.point.x.total_cmp(&b.point.x)),
        1 => entries.select_nth_unstable_by(low, |a, b| a.point.y.total_cmp(&b.point.y)),
        _ => entries.select_nth_unstable_by(low, |a, b| a.point.z.total_cmp(&b.point.z)),
    };
    entries.split_at_mut(low)
}

/// The lowest index.
fn lowest(entries: &[Entry]) -> u32 {
    entries.iter().fold(u32::MAX, |lowest, entry| lowest.min(entry.id))
}

/// The least and the largest coordinates.
fn bounds(entries: &[Entry]) -> [[f32; 3]; 2] {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for entry in entries {
        low = low.min(entry.point);
        high = high.max(entry.point);
    }
    [low.to_array(), high.to_array()]
}
