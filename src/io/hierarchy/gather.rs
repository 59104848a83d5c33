//! What a node is approximated of: triangles of its own, surfels or triangles of what is below.

use super::index::{NONE, Node, Object};
use super::read::Hierarchy;
use crate::error::Result;
use crate::scene::{Cloud, Similarity, Triangles};
use crate::source::hierarchy::approximate::{drawn, pixel};
use crate::source::hierarchy::parts::Gathered;
use crate::source::hierarchy::{Part, Traversal};
use glam::Vec3;
use std::collections::BTreeMap;

/// Where something is shown, and in which colour.
#[derive(Clone, Copy)]
struct Placement {
    place: Similarity,
    color: Option<Vec3>,
}

/// The triangles that the pictures of one node show.
struct Gather<'a> {
    hierarchy: &'a Hierarchy,
    bottom_up: bool,
    /// The side of a pixel of the pictures.
    pixel: f64,
    /// Whether the node is one over the objects, which may show something again.
    upper: bool,
    all: Gathered,
    /// What objects show more than once: triangles and surfels, by their nodes.
    parts: BTreeMap<u32, Part>,
    surfels: BTreeMap<u32, Cloud>,
}

/// What pictures of a node with this side show. What is below has its surfels already, if they are drawn.
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
        pixel: pixel(side, (low, high)),
        upper: geometry == NONE,
        all: Gathered::new(&hierarchy.numbers()),
        parts: BTreeMap::new(),
        surfels: BTreeMap::new(),
    };
    gather.triangles(node, &Placement { place: Similarity::IDENTITY, color: None })?;
    gather.all.finish()
}

/// The nodes below a node, as its pictures show them: the roots of its objects' geometries, then its children.
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
    /// The triangles of a node, and what is drawn of what is below.
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
        if !self.bottom_up || surfels == 0 {
            return self.triangles(node, shown);
        }
        let scale = shown.place.scale;
        let (count, half) = drawn(estimate, surfels, self.pixel / scale);
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
        let squares: Vec<[Vec3; 3]> = (0..count as usize).map(placed).collect();
        self.all.squares(&squares, cloud, (half * scale) as f32)?;
        if !self.upper {
            self.surfels.remove(&node);
        }
        Ok(())
    }

    /// The own triangles of a node, kept where objects may show them again.
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
