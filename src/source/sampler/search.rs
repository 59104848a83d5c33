//! Search for the nearest point, by the squared distances of [`super::greedy`].

use super::greedy::squared_distance;
use crate::index::point_tree::{PointTree, Search};
use crate::number::MapInline;
use glam::Vec3;

/// Ranges of the tree with at most this many points are searched linearly.
pub(super) const LEAF: usize = 8;

/// A squared distance, and the index of the point at this distance. Of equal distances the lower
/// index wins.
pub(super) type Found = (f32, u32);

/// Whether a search within this squared distance reaches points that are so far along each axis.
#[inline]
pub(super) fn is_within([x, y, z]: [f64; 3], reach2: f32) -> bool {
    // In `f32`, as the squared distances are.
    let [x, y, z] = [x, y, z].map_inline(|offset| offset as f32);
    (x * x + y * y) + z * z <= reach2
}

/// The search for the point of a tree that is nearest to a place.
struct Nearest<'a> {
    tree: &'a PointTree,
    point: Vec3,
    /// The index of a point to ignore.
    own: u32,
    found: Found,
}

/// The point nearest to a place, except the point `own`; or `found` if that is nearer, or as near with
/// a lower index.
pub(super) fn nearest(tree: &PointTree, point: Vec3, own: u32, found: Found) -> Found {
    let mut nearest = Nearest { tree, point, own, found };
    tree.search(point, &mut nearest);
    nearest.found
}

impl Search for Nearest<'_> {
    #[inline]
    fn look(&mut self, rank: usize) {
        let entry = self.tree.entries()[rank];
        let distance = squared_distance(self.point, entry.point);
        let (least, id) = self.found;
        let nearer = distance < least || (distance == least && entry.id < id);
        if nearer && entry.id != self.own {
            self.found = (distance, entry.id);
        }
    }

    #[inline]
    fn reaches(&self, offset: [f64; 3]) -> bool {
        is_within(offset, self.found.0)
    }
}
