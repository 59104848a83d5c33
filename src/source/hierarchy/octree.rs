//! Build a tree over boxes, such as triangles of a geometry or objects of a scene: the loose octree
//! of \[Ulrich 2000\].
//!
//! Cells are cubes. The *loose* box of a cell is the cube of twice its side around the same middle.
//! All is computed in f64, from items whose box goes from a to b, with components that are finite
//! `f32`:
//!
//! ```text
//!   low, high  the corners of the box around all items
//!   S          the least power of two, of any exponent, that is no less than any extent of that box; 1 if that is a point
//!   m, e       of an item: the middle (a + b) / 2, and the greatest component of (b - a) / 2
//!   grid       of an item, for each axis: floor((m - low) / (S / 2^20)), at most 2^20 - 1
//!   depth      of an item: the greatest d up to 20 with e <= S / 2^(d + 1)
//!   cell       of an item at a depth d: floor(grid / 2^(20 - d))
//! ```
//!
//! The one cell of depth 0 has the side S and begins at low. An item whose half extent e is no
//! greater than half the side of a cell that holds its middle lies in the loose box of that cell.
//! Therefore *depth* is the depth of the deepest cell whose loose box is sure to hold the item.
//! (Middles are rounded: an item may stick out by 2^-52 of a coordinate.)
//!
//! **Nodes.** The root is the cell of depth 0 with all items. A node of depth d is divided if it
//! has more than one item and their weights are more than `bound` together. Each item whose own
//! depth is greater than d goes to the child of its cell of depth d + 1; the others stay. Children
//! without items are left out. The others are in the order of x + 2 y + 4 z, the lowest bits of
//! their cells. A node that keeps no item and has one child is replaced by that child.
//!
//! So an item is in one node. The items that stay in a node with children are too large for the
//! children. A node without children has no more than `bound`, or one item, or items that all have
//! depths up to its own.
//!
//! **Numbers.** The root is node 0, and nodes are numbered by levels: the children of node 0, the
//! children of its first child, of its second, ... Children of a node are neighbours, and have
//! greater numbers than the node. The items of a node are in ascending order. A node without
//! children has an empty range of them, which begins where they would: at 1 plus the number of
//! children of all nodes before it. Boxes of nodes have 0 in place of -0.
//!
//! `Decided:` 20 levels. Cells of the last level are a millionth of the scene wide; items that fall
//! into one such cell stay together. `Decided:` a chain of nodes with one child each is one node,
//! because they stand for the same items.

use glam::{DVec3, Vec3};
use std::collections::VecDeque;
use std::ops::Range;

/// The greatest depth of a cell.
const DEPTH: u32 = 20;
/// The parent of the root.
pub const NO_NODE: u32 = u32::MAX;

/// An object to put into the tree, such as a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// The corner of its box with the least coordinates, finite.
    pub low: Vec3,
    /// The other corner, finite, nowhere less than `low`.
    pub high: Vec3,
    /// How many triangles it counts for.
    pub weight: u64,
}

/// A node.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// The node above; [`NO_NODE`] for the root.
    pub parent: u32,
    /// The nodes below.
    pub children: Range<u32>,
    /// The items that stay here, as a range of [`Octree::order`].
    pub own: Range<u32>,
    /// The depth of its cell.
    pub depth: u32,
    /// The corner with the least coordinates of the box around all items here and below.
    pub low: Vec3,
    /// The other corner.
    pub high: Vec3,
    /// The weight of all items here and below.
    pub weight: u64,
    /// How many items are here and below.
    pub items: u32,
}

/// Items in nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Octree {
    /// The nodes by their numbers; empty if there are no items.
    pub nodes: Vec<Branch>,
    /// The items of node 0, of node 1, ...
    pub order: Vec<u32>,
}

/// The cell of an item, and the greatest depth at which it may lie.
struct Place {
    grid: [u32; 3],
    depth: u32,
}

/// A node that is not divided yet.
struct Waiting {
    items: Vec<u32>,
    depth: u32,
    parent: u32,
}

/// The tree over items, see the [module](self).
///
/// # Panics
/// If there are 2^32 items or more.
#[must_use]
pub fn octree(items: &[Item], bound: u64) -> Octree {
    assert!(u32::try_from(items.len()).is_ok(), "{} items", items.len());
    let mut tree = Octree::default();
    if items.is_empty() {
        return tree;
    }
    let places = places(items);
    let all = (0..items.len() as u32).collect();
    let mut queue = VecDeque::from([Waiting { items: all, depth: 0, parent: NO_NODE }]);
    while let Some(Waiting { items: mut here, mut depth, parent }) = queue.pop_front() {
        let number = tree.nodes.len() as u32;
        let (own, parts) = loop {
            let (own, mut parts) = divide(here, depth, items, &places, bound);
            // A chain of nodes with one child each becomes one node.
            match parts.as_mut_slice() {
                [one] if own.is_empty() => {
                    here = std::mem::take(one);
                    depth += 1;
                }
                _ => break (own, parts),
            }
        };
        let first = number + 1 + queue.len() as u32;
        let children = first..first + parts.len() as u32;
        let below = parts.into_iter();
        queue.extend(below.map(|items| Waiting { items, depth: depth + 1, parent: number }));
        let start = tree.order.len() as u32;
        tree.order.extend(own);
        let own = start..tree.order.len() as u32;
        let (low, high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        tree.nodes.push(Branch { parent, children, own, depth, low, high, weight: 0, items: 0 });
    }
    tree.sum(items);
    tree
}

impl Octree {
    /// Computes boxes, weights and counts, from the leaves up.
    fn sum(&mut self, items: &[Item]) {
        for number in (0..self.nodes.len()).rev() {
            let node = &mut self.nodes[number];
            for &item in &self.order[node.own.start as usize..node.own.end as usize] {
                let Item { low, high, weight } = items[item as usize];
                node.add(low, high, weight, 1);
            }
            let Branch { parent, low, high, weight, items, .. } = *node;
            if parent != NO_NODE {
                self.nodes[parent as usize].add(low, high, weight, items);
            }
        }
    }

    /// The items that stay in a node, ascending.
    #[must_use]
    pub fn own(&self, node: u32) -> &[u32] {
        let Range { start, end } = self.nodes[node as usize].own;
        &self.order[start as usize..end as usize]
    }
}

impl Branch {
    fn add(&mut self, low: Vec3, high: Vec3, weight: u64, items: u32) {
        let own = Corners { low: self.low, high: self.high };
        Corners { low: self.low, high: self.high } = around(own, Corners { low, high });
        self.weight += weight;
        self.items += items;
    }
}

/// An axis-parallel box: its corners with the least and with the greatest coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct Corners {
    /// The least coordinates.
    pub low: Vec3,
    /// The greatest coordinates.
    pub high: Vec3,
}

/// The box around two boxes, with 0 in place of -0.
#[must_use]
pub fn around(a: Corners, b: Corners) -> Corners {
    let least = |i: usize| if b.low[i] < a.low[i] { b.low[i] } else { a.low[i] } + 0.0;
    let most = |i: usize| if b.high[i] > a.high[i] { b.high[i] } else { a.high[i] } + 0.0;
    Corners {
        low: Vec3::new(least(0), least(1), least(2)),
        high: Vec3::new(most(0), most(1), most(2)),
    }
}

/// Divides items into the items that stay in a node, and the items of each child.
fn divide(
    here: Vec<u32>,
    depth: u32,
    items: &[Item],
    places: &[Place],
    bound: u64,
) -> (Vec<u32>, Vec<Vec<u32>>) {
    let weight: u64 = here.iter().map(|&item| items[item as usize].weight).sum();
    // A single item cannot be divided, whatever its weight.
    if weight <= bound || here.len() == 1 {
        return (here, Vec::new());
    }
    let mut own = Vec::new();
    let mut parts: [Vec<u32>; 8] = Default::default();
    for item in here {
        let Place { grid, depth: deepest } = &places[item as usize];
        if *deepest <= depth {
            own.push(item);
            continue;
        }
        let bit = |axis: usize| (grid[axis] >> (DEPTH - 1 - depth) & 1) as usize;
        parts[bit(0) + 2 * bit(1) + 4 * bit(2)].push(item);
    }
    (own, parts.into_iter().filter(|part| !part.is_empty()).collect())
}

fn places(items: &[Item]) -> Vec<Place> {
    let boxes = items.iter().map(|item| Corners { low: item.low, high: item.high });
    let Corners { low, high } = boxes.reduce(around).unwrap_or_default();
    let low = low.as_dvec3();
    let side = power_of_two((high.as_dvec3() - low).max_element());
    let cells = 1_u32 << DEPTH;
    let place = |item: &Item| {
        let (a, b) = (item.low.as_dvec3(), item.high.as_dvec3());
        let from: DVec3 = (a + b) / 2.0 - low;
        let cell = |axis: usize| {
            let at = from[axis] / (side / f64::from(cells));
            // The cast turns numbers below 0 into 0.
            (at.floor() as u32).min(cells - 1)
        };
        let half = ((b - a) / 2.0).max_element();
        let (mut depth, mut reach) = (0, side / 2.0);
        while depth < DEPTH && half <= reach / 2.0 {
            depth += 1;
            reach /= 2.0;
        }
        Place { grid: [cell(0), cell(1), cell(2)], depth }
    };
    items.iter().map(place).collect()
}

/// The least power of two that is no less than `extent`; 1 for 0.
fn power_of_two(extent: f64) -> f64 {
    let mut side = 1.0;
    while side < extent {
        side *= 2.0;
    }
    while extent > 0.0 && side / 2.0 >= extent {
        side /= 2.0;
    }
    side
}

#[cfg(test)]
mod tests;
