//! Gather the input of a node's approximation: its own triangles, and surfels or triangles from
//! below.

use super::index::{NONE, Node, Object};
use super::read::Hierarchy;
use crate::error::Result;
use crate::scene::{Cloud, Similarity, Triangles};
use crate::source::hierarchy::approximate::{drawn, pixel};
use crate::source::hierarchy::parts::Gathered;
use crate::source::hierarchy::{Part, Traversal};
use glam::Vec3;
use std::collections::BTreeMap;

/// A place and a colour in which something is shown.
#[derive(Clone, Copy)]
struct Placement {
    place: Similarity,
    color: Option<Vec3>,
}

/// The triangles in the pictures of one node.
struct Gather<'a> {
    hierarchy: &'a Hierarchy,
    bottom_up: bool,
    /// The side of a pixel in the pictures.
    pixel: f64,
    /// Whether this is a node over the objects; then several objects may show the same thing.
    upper: bool,
    all: Gathered,
    /// Triangles and surfels that objects may show again, by their nodes.
    parts: BTreeMap<u32, Part>,
    surfels: BTreeMap<u32, Cloud>,
}

/// The triangles that pictures of `side` pixels show of a node. Bottom-up, the nodes below must
/// have their surfels already.
pub(super) fn gather(
    hierarchy: &Hierarchy,
    node: u32,
    side: u32,
    traversal: Traversal,
) -> Result<Triangles> {
    let Node { low, high, geometry, .. } = hierarchy.nodes()[node as usize];
    let mut gather = Gather {
        hierarchy,
        bottom_up: traversal == Traversal::BottomUp,
        pixel: pixel(side, low, high),
        upper: geometry == NONE,
        all: Gathered::new(&hierarchy.numbers()),
        parts: BTreeMap::new(),
        surfels: BTreeMap::new(),
    };
    gather.triangles(node, &Placement { place: Similarity::IDENTITY, color: None })?;
    gather.all.finish()
}

/// The nodes below a node, in the order of its pictures: the roots of its objects' geometries, then
/// its children.
pub(super) fn below(hierarchy: &Hierarchy, node: u32) -> Vec<u32> {
    let Node { objects, children, .. } = &hierarchy.nodes()[node as usize];
    let own = &hierarchy.objects()[objects.start as usize..objects.end as usize];
    let roots = own.iter().map(|object| hierarchy.root(object));
    roots.chain(children.clone()).collect()
}

impl Hierarchy {
    /// The root of the tree of an object's geometry.
    #[must_use]
    pub fn root(&self, object: &Object) -> u32 {
        self.geometries()[object.geometry as usize].nodes.start
    }
}

impl Gather<'_> {
    /// Adds the own triangles of a node, and what stands for the nodes below.
    fn triangles(&mut self, node: u32, shown: &Placement) -> Result<()> {
        let Node { geometry, triangles, objects, children, .. } =
            self.hierarchy.nodes()[node as usize].clone();
        if triangles > 0 {
            let part = self.part(node)?;
            self.all.part(part, &shown.place, shown.color, self.hierarchy.fill())?;
        }
        if geometry == NONE {
            let own = self.hierarchy;
            for object in &own.objects()[objects.start as usize..objects.end as usize] {
                let shown = Placement { place: object.place, color: object.color };
                self.child(own.root(object), &shown)?;
            }
        }
        children.into_iter().try_for_each(|child| self.child(child, shown))
    }

    fn child(&mut self, node: u32, shown: &Placement) -> Result<()> {
        let Node { surfels, estimate, .. } = self.hierarchy.nodes()[node as usize];
        // Top-down, or without surfels, the triangles below stand for themselves.
        if !self.bottom_up || surfels == 0 {
            return self.triangles(node, shown);
        }
        let scale = shown.place.scale;
        let (count, radius) = drawn(estimate, surfels, self.pixel / scale);
        let known = self.surfels.get(&node).map_or(0, |cloud| cloud.position.len());
        if known < count as usize {
            let read = self.hierarchy.surfels(node, count)?;
            self.surfels.insert(node, read);
        }
        let cloud = &self.surfels[&node];
        let (normal, color) = (cloud.normal.as_deref(), cloud.color.as_deref());
        let (normal, color) = (normal.unwrap_or_default(), color.unwrap_or_default());
        let identity = shown.place == Similarity::IDENTITY;
        let placed = |i: usize| {
            let (mut p, mut n) = (cloud.position[i], normal[i]);
            if !identity {
                (p, n) = shown.place.surfel(p, n);
            }
            [p, n, shown.color.unwrap_or(color[i])]
        };
        let discs: Vec<[Vec3; 3]> = (0..count as usize).map(placed).collect();
        self.all.hexagons(&discs, cloud, (radius * scale) as f32)?;
        // A node of a geometry is shown once, so its surfels need not stay in memory.
        if !self.upper {
            self.surfels.remove(&node);
        }
        Ok(())
    }

    /// The own triangles of a node, kept if other objects may show them again.
    fn part(&mut self, node: u32) -> Result<Part> {
        if !self.upper {
            return self.hierarchy.part(node);
        }
        if let Some(part) = self.parts.get(&node) {
            return Ok(part.clone());
        }
        let part = self.hierarchy.part(node)?;
        self.parts.insert(node, part.clone());
        Ok(part)
    }
}
