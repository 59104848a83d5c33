//! Find the distance to the nearest of a growing set of points, with a tree that grows with them.
//!
//! The distances are the samplers' distances, in `f32`. Rounding is monotone, so that the rounded
//! distance to a plane is never above the rounded distance to a point behind it. So planes tell
//! which leaves to skip, without a margin.
//!
//! A sampler seldom needs an exact distance: an upper bound is enough for a place that is too near.
//! So [`look`] finds only the nearest point in the leaf of each place, for many places at once. Then
//! [`Nearest::refine`] searches the other leaves for the few places that matter.

use super::greedy::squared_distance;
use crate::index::point_tree::widest;
use crate::number::Real;
use crate::number::lanes::vectorized;
use glam::Vec3;

/// The most points of a leaf.
const LEAF: usize = 64;
/// Places that descend side by side, because each step of one place waits for its last.
const RUN: usize = 8;
const ROOT: u32 = 0;

/// Points in the leaves of a tree.
pub(super) struct Nearest {
    /// The root is the first.
    nodes: Vec<Node>,
    /// The parent of each node.
    parents: Vec<u32>,
    leaves: Vec<Leaf>,
    /// The nodes that a search has yet to visit, and how far away they are along each axis.
    ahead: Vec<(u32, [f32; 4])>,
}

/// A plane across an axis, and the nodes below it and above it. Points in the plane are above.
///
/// At a leaf, everything is below an infinite plane. The child below is the node itself, and in
/// place of the child above is the number of the leaf.
#[derive(Clone, Copy)]
struct Node {
    plane: f32,
    axis: u32,
    children: [u32; 2],
}

/// Points, one in each lane. A lane without a point is at +inf along each axis.
#[repr(align(64))]
struct Leaf {
    position: [[f32; LEAF]; 3],
}

/// What is known of the squared distance from a place to the nearest point.
#[derive(Clone, Copy)]
pub(super) struct Known {
    pub(super) place: Vec3,
    /// The distance is at most this.
    pub(super) most: f32,
    /// It is at least the lesser of this and `most`.
    beyond: f32,
    /// The points in this node are in `most`; if it is the root, none need be.
    node: u32,
}

impl Known {
    /// Nothing.
    pub(super) fn nothing(place: Vec3) -> Self {
        Self { place, most: f32::INFINITY, beyond: 0.0, node: ROOT }
    }

    /// Takes account of a point that is added.
    #[inline(always)]
    pub(super) fn lower(&mut self, point: Vec3) {
        self.most = self.most.at_most(squared_distance(self.place, point));
    }
}

impl Nearest {
    /// No points yet.
    pub(super) fn none() -> Self {
        Self {
            nodes: vec![Node::leaf(ROOT, 0)],
            parents: vec![ROOT],
            leaves: vec![Leaf::EMPTY],
            ahead: Vec::new(),
        }
    }

    /// Makes `most` exact.
    pub(super) fn refine(&mut self, known: &mut Known) {
        if known.beyond < known.most {
            known.most = nearer(self, known, known.most);
            known.beyond = f32::INFINITY;
        }
    }

    /// Whether no point is nearer than `limit`.
    pub(super) fn is_beyond(&mut self, known: &Known, limit: f32) -> bool {
        known.most >= limit && (known.beyond >= limit || nearer(self, known, limit) >= limit)
    }

    /// Adds a place, whose `most` must be exact.
    pub(super) fn add(&mut self, known: &Known) {
        let place = lanes(known.place);
        let mut at = known.node;
        loop {
            let node = self.nodes[at as usize];
            let child = node.child(node.across(&place));
            if child == at {
                break;
            }
            at = child;
        }
        let number = self.nodes[at as usize].children[1];
        let leaf = &mut self.leaves[number as usize];
        // An equal point changes no distance. So the points of a full leaf differ.
        if (known.most == 0.0 && leaf.has(known.place)) || leaf.put(known.place) {
            return;
        }
        let (axis, plane, above) = leaf.split();
        let first = self.nodes.len() as u32;
        self.nodes.push(Node::leaf(first, number));
        self.nodes.push(Node::leaf(first + 1, self.leaves.len() as u32));
        self.parents.extend([at; 2]);
        self.leaves.push(above);
        self.nodes[at as usize] = Node { plane, axis: axis as u32, children: [first, first + 1] };
        self.add(known);
    }
}

/// The coordinates, with a fourth that saves bounds checks.
#[inline(always)]
fn lanes(place: Vec3) -> [f32; 4] {
    [place.x, place.y, place.z, 0.0]
}

vectorized!(
    /// Finds the nearest point in the leaf of each place, of which nothing is known yet.
    pub(super) fn look(points: &Nearest, places: &mut [Known]) {
        for run in places.chunks_mut(RUN) {
            let mut to = [[0.0; 4]; RUN];
            for (to, known) in to.iter_mut().zip(run.iter()) {
                *to = lanes(known.place);
            }
            let (mut at, mut gap) = ([ROOT; RUN], [f32::INFINITY; RUN]);
            loop {
                let mut moved = 0;
                for i in 0..RUN {
                    let node = &points.nodes[at[i] as usize];
                    let across = node.across(&to[i]);
                    gap[i] = gap[i].at_most(across.abs());
                    let child = node.child(across);
                    moved |= child ^ at[i];
                    at[i] = child;
                }
                if moved == 0 {
                    break;
                }
            }
            for (i, known) in run.iter_mut().enumerate() {
                let leaf = points.nodes[at[i] as usize].children[1];
                known.most = points.leaves[leaf as usize].nearest(known.place);
                known.beyond = gap[i] * gap[i];
                known.node = at[i];
            }
        }
    }
);

vectorized!(
    /// The least squared distance to a point that is not in `most`, or `least` if that is less.
    fn nearer(points: &mut Nearest, known: &Known, mut least: f32) -> f32 {
        let Nearest { nodes, parents, leaves, ahead } = points;
        let place = lanes(known.place);
        ahead.clear();
        if known.node == ROOT {
            ahead.push((ROOT, [0.0; 4]));
        }
        // The other child of each node above is behind one plane.
        let mut at = known.node;
        while at != ROOT {
            let parent = parents[at as usize];
            let node = &nodes[parent as usize];
            let offset = node.farther(&place, &[0.0; 4]);
            if square(&offset) < least {
                let [below, above] = node.children;
                ahead.push((below ^ above ^ at, offset));
            }
            at = parent;
        }
        while let Some((mut at, offset)) = ahead.pop() {
            if !(square(&offset) < least) {
                continue;
            }
            loop {
                let node = &nodes[at as usize];
                let near = node.child(node.across(&place));
                let [below, above] = node.children;
                if near == at {
                    least = least.at_most(leaves[above as usize].nearest(known.place));
                    break;
                }
                let offset = node.farther(&place, &offset);
                if square(&offset) < least {
                    ahead.push((below ^ above ^ near, offset));
                }
                at = near;
            }
        }
        least
    }
);

/// The squared length, by the operations of the squared distance.
#[inline(always)]
fn square([x, y, z, _]: &[f32; 4]) -> f32 {
    (x * x + y * y) + z * z
}

impl Node {
    fn leaf(own: u32, leaf: u32) -> Self {
        Self { plane: f32::INFINITY, axis: 0, children: [own, leaf] }
    }

    /// How far above the plane a place is.
    #[inline(always)]
    fn across(&self, place: &[f32; 4]) -> f32 {
        // The mask changes no axis, and saves a bounds check.
        place[(self.axis & 3) as usize] - self.plane
    }

    /// The child on the side of a place.
    #[inline(always)]
    fn child(&self, across: f32) -> u32 {
        self.children[usize::from(across >= 0.0)]
    }

    /// How far a place is from the other child along each axis, if it is `offset` from this node.
    #[inline(always)]
    fn farther(&self, place: &[f32; 4], &[x, y, z, _]: &[f32; 4]) -> [f32; 4] {
        let across = self.across(place);
        // A store to the axis and a load of all would stall.
        match self.axis {
            0 => [across, y, z, 0.0],
            1 => [x, across, z, 0.0],
            _ => [x, y, across, 0.0],
        }
    }
}

impl Leaf {
    const EMPTY: Self = Self { position: [[f32::INFINITY; LEAF]; 3] };

    /// The least squared distance to a point.
    #[inline(always)]
    fn nearest(&self, to: Vec3) -> f32 {
        let [x, y, z] = &self.position;
        let mut least = f32::INFINITY.to_bits();
        for i in 0..LEAF {
            let (dx, dy, dz) = (x[i] - to.x, y[i] - to.y, z[i] - to.z);
            // Squares are never negative, so that their bits compare like the numbers.
            least = least.min(((dx * dx + dy * dy) + dz * dz).to_bits());
        }
        f32::from_bits(least)
    }

    fn point(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.position;
        Vec3::new(x[lane], y[lane], z[lane])
    }

    fn has(&self, point: Vec3) -> bool {
        (0..LEAF).any(|lane| self.point(lane) == point)
    }

    /// Puts a point into the first free lane; returns false if there is none.
    fn put(&mut self, point: Vec3) -> bool {
        let free = self.position[0].iter().position(|x| x.is_infinite());
        let Some(lane) = free else { return false };
        for axis in 0..3 {
            self.position[axis][lane] = point[axis];
        }
        true
    }

    /// Splits a full leaf of different points near the median along the widest axis. Returns the
    /// axis, the plane, and the leaf of the points above it.
    fn split(&mut self) -> (usize, f32, Self) {
        let axis = widest((0..LEAF).map(|lane| self.point(lane)));
        let mut values = self.position[axis];
        values.sort_unstable_by(f32::total_cmp);
        // Both sides get points, because the values are not all equal.
        let plane = (1..LEAF)
            .filter(|&i| values[i - 1] < values[i])
            .min_by_key(|i| i.abs_diff(LEAF / 2))
            .map_or(f32::INFINITY, |i| values[i]);
        let (mut below, mut above) = (Self::EMPTY, Self::EMPTY);
        for lane in 0..LEAF {
            let side = if self.position[axis][lane] < plane { &mut below } else { &mut above };
            side.put(self.point(lane));
        }
        *self = below;
        (axis, plane, above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute(points: &[Vec3], to: Vec3) -> f32 {
        let all = points.iter().map(|point| squared_distance(to, *point));
        all.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    }

    proptest! {
        #[test]
        fn the_nearest_is_that_of_all(
            points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 2..600),
            scale in prop::sample::select(vec![
                [1.0_f32, 1.0, 1.0], [1.0, 1e-3, 1.0], [0.0, 0.0, 3.0], [0.0; 3], [2e-23; 3],
                [3e37, 1e38, 1.0], [1e-20, 1.0, 1e19],
            ]),
            lattice: bool,
            shrink in prop::sample::select(vec![1.0_f32, 0.95, 0.7]),
            ahead in 0_usize..100,
        ) {
            let mut size = 1.0;
            let points: Vec<Vec3> = points
                .into_iter()
                .map(|p| {
                    // Some sets gather at a point.
                    size *= shrink;
                    let p = if lattice { p.map(|x| (x * 6.0).floor()) } else { p };
                    Vec3::from_array(p) * Vec3::from_array(scale) * size
                })
                .collect();
            let mut tree = Nearest::none();
            // What was known before later points were added stays true.
            let mut early = [Known::nothing(points[0])];
            for (i, point) in points.iter().enumerate() {
                let least = brute(&points[..i], *point);
                let mut known = [Known::nothing(*point)];
                if i % 3 != 0 {
                    look(&tree, &mut known);
                }
                for limit in [least, least * 1.5, least * 0.5, f32::from_bits(1)] {
                    prop_assert_eq!(tree.is_beyond(&known[0], limit), least >= limit);
                }
                tree.refine(&mut known[0]);
                prop_assert_eq!(known[0].most, least);
                tree.add(&known[0]);
                let [early] = &mut early;
                early.lower(*point);
                if i % 100 == ahead {
                    tree.refine(early);
                    prop_assert_eq!(early.most, brute(&points[..=i], early.place));
                    *early = Known::nothing(points[points.len() - 1 - i / 2]);
                    look(&tree, std::slice::from_mut(early));
                }
            }
        }
    }
}
