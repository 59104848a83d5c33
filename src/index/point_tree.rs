//! Split points into halves again and again: the tree behind the neighbour search and behind the
//! order from back to front.
//!
//! A node is a range of points, and it is split in place. Its axis is the widest: the axis of the
//! largest extent (largest minus smallest coordinate, in f64), among equal ones the first. Its own
//! point is the point of rank `len / 2`, counted from 0, in the order of (coordinate along the
//! axis, index). The points before it are the low half, the points after it the high half.
//! `Decided:` coordinates compare as numbers, so that -0 and +0 are a tie.
//!
//! So the tree is a function of the points and their indices, and its depth is the logarithm of
//! their number whatever they are, coincident points included.

use crate::frame::Exec;
use glam::Vec3;
use std::cmp::Ordering;
use std::ops::Range;

/// Ranges up to this length are split in one job.
const JOB: usize = 1 << 13;

/// The points in the order of the tree: low half, own point, high half.
#[derive(Debug)]
pub(crate) struct PointTree {
    entries: Vec<Entry>,
    /// The axis of each split range, stored at the middle of the range.
    axis: Vec<u8>,
    /// The most points of a range that is not split.
    leaf: usize,
}

/// What a search of the tree looks for.
pub(crate) trait Search {
    /// Looks at the point of a rank.
    fn look(&mut self, rank: usize);

    /// Whether the search reaches points that are at least this far away along each axis.
    fn reaches(&self, offset: [f64; 3]) -> bool;
}

/// A point and its index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) point: Vec3,
    pub(crate) id: u32,
}

/// A range of the tree while it is built.
type HalfOfTree<'a> = (&'a mut [Entry], &'a mut [u8]);

impl PointTree {
    /// Makes the tree of fewer than 2^32 finite points. Ranges of at most `leaf` points, at least
    /// 1, are not split: their order has no meaning.
    pub(crate) fn new(points: &[Vec3], leaf: usize, exec: &Exec) -> Self {
        let mut entries: Vec<_> =
            points.iter().zip(0..).map(|(&point, id)| Entry { point, id }).collect();
        let mut axis = vec![0; points.len()];
        let mut parts: Vec<HalfOfTree<'_>> = vec![(&mut entries, &mut axis)];
        // The first part is the longest, because a low half is never shorter than its high half.
        while parts[0].0.len() > JOB {
            parts = exec.ordered(parts, halve).into_iter().flatten().collect();
        }
        exec.ordered(parts, |part| split(part, leaf));
        Self { entries, axis, leaf }
    }

    /// All points, in the order of the tree.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Shows a search every point that it reaches from a place, and some others. The nearer half of a
    /// range comes first.
    ///
    /// The search must compute distances to points and to planes by the same operations. Because
    /// rounding is monotone, no point behind a plane is then nearer than the plane.
    pub(crate) fn search(&self, from: Vec3, search: &mut impl Search) {
        self.descend(0..self.entries.len(), from, [0.0; 3], search);
    }

    fn descend(
        &self,
        range: Range<usize>,
        from: Vec3,
        mut offset: [f64; 3],
        search: &mut impl Search,
    ) {
        if range.len() <= self.leaf {
            range.for_each(|rank| search.look(rank));
            return;
        }
        let (middle, axis) = self.node(&range);
        search.look(middle);
        let beyond = f64::from(from[axis]) - f64::from(self.entries[middle].point[axis]);
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if beyond < 0.0 { (low, high) } else { (high, low) };
        self.descend(near, from, offset, search);
        offset[axis] = beyond;
        if search.reaches(offset) {
            self.descend(far, from, offset, search);
        }
    }

    /// The rank of the point that splits a range, and the axis along which it does.
    #[inline(always)]
    pub(crate) fn node(&self, range: &Range<usize>) -> (usize, usize) {
        let middle = range.start + range.len() / 2;
        (middle, usize::from(self.axis[middle]))
    }
}

/// Splits a range down to its leaves.
fn split(part: HalfOfTree<'_>, leaf: usize) {
    if part.0.len() > leaf {
        let [low, high] = halve(part);
        split(low, leaf);
        split(high, leaf);
    }
}

/// Splits a range that is not empty once.
fn halve<'a>((entries, axes): HalfOfTree<'a>) -> [HalfOfTree<'a>; 2] {
    let (middle, axis) = divide(entries);
    axes[middle] = axis as u8;
    let (low, high) = entries.split_at_mut(middle);
    let (low_axes, high_axes) = axes.split_at_mut(middle);
    [(low, low_axes), (&mut high[1..], &mut high_axes[1..])]
}

/// Partitions a range, which must not be empty: the point of rank `len / 2` moves to its place,
/// points before it go before it, and points after it go after it. Returns the rank and the axis.
pub(super) fn divide(entries: &mut [Entry]) -> (usize, usize) {
    let axis = widest(entries.iter().map(|entry| entry.point));
    let middle = entries.len() / 2;
    entries.select_nth_unstable_by(middle, |a, b| {
        let by_coordinate = a.point[axis].partial_cmp(&b.point[axis]);
        by_coordinate.unwrap_or(Ordering::Equal).then(a.id.cmp(&b.id))
    });
    (middle, axis)
}

/// The axis of the largest extent of some points, the first among equal ones.
pub(crate) fn widest(points: impl Iterator<Item = Vec3>) -> usize {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for point in points {
        low = low.min(point);
        high = high.max(point);
    }
    let extent = high.as_dvec3() - low.as_dvec3();
    let mut axis = 0;
    for other in 1..3 {
        if extent[other] > extent[axis] {
            axis = other;
        }
    }
    axis
}

/// Points for property tests.
#[cfg(test)]
pub(crate) mod given {
    use glam::Vec3;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => (-3_i8..=3).prop_map(f32::from),
            4 => -1.0_f32..1.0,
            1 => prop::sample::select(vec![-0.0, f32::MIN_POSITIVE, 1e-45, -1e-40]),
            1 => prop::sample::select(vec![f32::MAX, -f32::MAX, 1e30, 3e38, 16_777_216.0]),
            2 => (0_u32..4).prop_map(|ulps| f32::from_bits(1.0_f32.to_bits() + ulps)),
        ]
    }

    /// Points with ties, extremes, and runs on a line and at one place.
    pub(crate) fn points() -> impl Strategy<Value = Vec<Vec3>> {
        let point = prop_oneof![
            6 => [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array),
            2 => coordinate().prop_map(|t| Vec3::new(t, 2.0, -1.0)),
            1 => Just(Vec3::ONE),
        ];
        prop::collection::vec(point, 1..120)
    }
}
