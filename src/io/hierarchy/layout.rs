//! Number the nodes of all trees before any node has surfels.

use super::bytes::Hash;
use super::index::{Geometry, Index, NONE, Node, Object};
use super::mesh::Header;
use crate::error::{Error, Result};
use crate::scene;
use crate::scene::Similarity;
use crate::scene::objects::detail::prefix::Estimate;
use crate::source::hierarchy::octree::{Branch, Corners, Item, around};
use crate::source::hierarchy::{BOUND, Settings, octree};
use glam::Vec3;

/// Nodes, objects and geometries in the order of the index, and how many surfels to make for each
/// node.
#[derive(Default)]
pub(super) struct Layout {
    upper: u32,
    nodes: Vec<Node>,
    objects: Vec<Object>,
    geometries: Vec<Geometry>,
    wanted: Vec<u32>,
}

impl Layout {
    /// Starts with the tree over the objects.
    pub(super) fn over(
        all: &[scene::Object],
        geometries: &[Header],
        settings: &Settings,
    ) -> Result<Self> {
        let (rest, moving): (Vec<u32>, Vec<u32>) =
            (0..all.len() as u32).partition(|&i| all[i as usize].motion.is_still());
        let items = rest.iter().map(|&i| {
            let object = &all[i as usize];
            item(object, geometries[object.geometry].nodes.first())
        });
        let tree = octree(&items.collect::<Result<Vec<Item>>>()?, BOUND);
        let mut layout = Self { upper: tree.nodes.len() as u32, ..Self::default() };
        for (number, branch) in (0..).zip(&tree.nodes) {
            let own = tree.own(number).iter().map(|&item| rest[item as usize]);
            own.for_each(|i| layout.objects.push(object(all, i, number)));
            layout.nodes.push(node(branch));
            let several = branch.items > 1;
            layout.wanted.push(if several { settings.count(branch.weight) } else { 0 });
        }
        layout.objects.extend(moving.into_iter().map(|i| object(all, i, NONE)));
        Ok(layout)
    }

    /// Appends the tree of a geometry.
    pub(super) fn append(&mut self, header: Header, settings: &Settings) {
        let first = self.nodes.len() as u32;
        let Header { hash, kind, flaws, nodes } = header;
        let of = first..first + nodes.len() as u32;
        self.geometries.push(Geometry { nodes: of, kind, flaws, hash });
        for mut node in nodes {
            node.parent = if node.parent == NONE { NONE } else { node.parent + first };
            node.children = node.children.start + first..node.children.end + first;
            self.wanted.push(settings.count(node.below));
            self.nodes.push(node);
        }
    }

    pub(super) fn finish(
        self,
        hash: Hash,
        fill: Vec3,
        properties: Vec<String>,
    ) -> (Index, Vec<u32>) {
        let Self { upper, nodes, objects, geometries, wanted } = self;
        (Index { hash, fill, upper, nodes, objects, geometries, properties }, wanted)
    }
}

/// An object that does not move, as an item of the tree; `root` is the root of its geometry.
fn item(object: &scene::Object, root: Option<&Node>) -> Result<Item> {
    let (low, high) = root.map(|root| (root.low, root.high)).unwrap_or_default();
    let Corners { low, high } = placed(Corners { low, high }, &object.motion.at(0));
    if !(low.is_finite() && high.is_finite()) {
        let what = "leaves the range of f32; make its scale smaller, or move it closer";
        return Err(Error::Invalid(format!("{} {what}", object.name)));
    }
    Ok(Item { low, high, weight: root.map_or(0, |root| root.below) })
}

fn object(all: &[scene::Object], number: u32, node: u32) -> Object {
    let scene::Object { geometry, motion, color, .. } = &all[number as usize];
    let (geometry, color) = (*geometry as u32, *color);
    Object { number, geometry, node, color, moves: node == NONE, place: motion.at(0) }
}

fn node(branch: &Branch) -> Node {
    Node {
        parent: branch.parent,
        children: branch.children.clone(),
        geometry: NONE,
        low: branch.low,
        high: branch.high,
        below: branch.weight,
        triangles: 0,
        vertices: 0,
        offset: 0,
        objects: branch.own.clone(),
        surfels: 0,
        estimate: Estimate { count: 0, distance: 0.0 },
    }
}

/// The box around a box in its place, see the [module](super).
fn placed(Corners { low, high }: Corners, place: &Similarity) -> Corners {
    let corner = |i: u32| {
        let of = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        place.point(Vec3::new(of(0), of(1), of(2)))
    };
    let points = (0..8).map(|i| Corners { low: corner(i), high: corner(i) });
    let Corners { low, high } = points.reduce(around).unwrap_or_default();
    Corners { low: low.map(f32::next_down), high: high.map(f32::next_up) }
}
