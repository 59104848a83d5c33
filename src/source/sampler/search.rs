//! Search for the nearest point, by the squared distances of [`super::greedy`].

use super::greedy::squared_distance;
use crate::index::point_tree::PointTree;
use glam::Vec3;
use std::ops::Range;

/// Ranges of the tree with at most this many points are searched linearly.
pub(super) const LEAF: usize = 8;

/// A squared distance, and the index of the point at this distance. Of equal distances the lower
/// index wins.
pub(super) type Found = (f32, u32);

/// The search for the point of a tree that is nearest to a place.
pub(super) struct Search<'a> {
    pub(super) tree: &'a PointTree,
    pub(super) point: Vec3,
    /// The index of a point to ignore.
    pub(super) own: u32,
}

impl Search<'_> {
    /// The nearest point, or `found` if that is nearer, or as near with a lower index.
    pub(super) fn nearest(&self, mut found: Found) -> Found {
        self.within(0..self.tree.entries().len(), &mut found);
        found
    }

    /// Replaces `found` if the range has a nearer point.
    fn within(&self, range: Range<usize>, found: &mut Found) {
        if range.len() <= LEAF {
            range.for_each(|rank| self.offer(rank, found));
            return;
        }
        let (middle, axis) = self.tree.node(&range);
        self.offer(middle, found);
        let out = self.point[axis] - self.tree.entries()[middle].point[axis];
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if out < 0.0 { (low, high) } else { (high, low) };
        self.within(near, found);
        // This holds after rounding too: rounding is monotone, so no point behind the plane is
        // nearer than the plane.
        if out * out <= found.0 {
            self.within(far, found);
        }
    }

    #[inline(always)]
    fn offer(&self, rank: usize, found: &mut Found) {
        let entry = self.tree.entries()[rank];
        let distance = squared_distance(self.point, entry.point);
        let nearer = distance < found.0 || (distance == found.0 && entry.id < found.1);
        if nearer && entry.id != self.own {
            *found = (distance, entry.id);
        }
    }
}
