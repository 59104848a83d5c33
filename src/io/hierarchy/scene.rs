//! A hierarchy as objects, of which a view draws what it needs.
//!
//! Each object of the hierarchy shows every node of its geometry's tree, in its place and its colour; a node over the objects is
//! shown once, where it is. What shows a node has the node's surfels as a
//! [prefix](crate::scene::objects::detail::prefix), with the estimate of the index, and its own triangles as primitives.
//! It is a [finer one](crate::scene::objects::detail::refine) of what shows the nearest node above that has
//! something to show; the roots of an object's geometry have the nodes over the objects above them. A node with
//! neither surfels nor triangles is left out, and so are nodes of geometries that no object shows.
//!
//! The objects are first those of the nodes over the objects, by number, `node-N`, then those of each
//! object of the index, in its order, `object-M.node-N` with M its number in the scene, in the order of nodes; N counts the nodes of
//! all trees. Geometries are in the order of nodes, each node once.
//!
//! The radius of a surfel is that with which all of the node cover, `r_m` sqrt(`p_m` / n).
//!
//! `Decided:` where `r_m` is 0, as of a single surfel, nothing is known of how densely the surfels cover. In the place of
//! `r_m` stands half the diagonal of the node's box, or 1 if that is 0, in f64, rounded to f32: the surfels stand for all of
//! the node while it is about as small as they are drawn, and give way to what is finer when it is larger.
//!
//! `Decided:` objects that move stand where they are in frame 0: a folder has no frames.
//!
//! [`Hierarchy::load`] reads all of it, [`Hierarchy::outlined`] what a view draws.

use super::index::{NONE, Node};
use super::read::Hierarchy;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::progress::Progress;
use crate::scene::objects::detail::prefix::Estimate;
use crate::scene::objects::outline::Needed;
use crate::scene::objects::{Geometry, Object, Objects};
use crate::scene::{Motion, Primitives, Similarity, Surfels};
use crate::source::hierarchy::approximate::pixel;
use glam::Vec3;

/// Bytes of a surfel, a vertex, a triangle with its box, and an object, in a loaded scene.
const OF_A_SURFEL: u64 = 96;
const OF_A_VERTEX: u64 = 48;
const OF_A_TRIANGLE: u64 = 48;
const OF_AN_OBJECT: u64 = 768;

/// Objects in the making: what shows each node of the tree that is gone through.
pub(super) struct Showing {
    /// Of each node the geometry that has its surfels and triangles, if it has some.
    geometry: Vec<Option<usize>>,
    pub(super) objects: Vec<Object>,
    pub(super) coarser: Vec<Option<u32>>,
}

impl Hierarchy {
    /// All that is in the folder as objects, see [`mod@crate::io::hierarchy`]. `progress` is told "loading", how
    /// many nodes are read, and of how many.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`] and [`Hierarchy::triangles`]; [`Error::Invalid`] as [`Objects::new`], if there is
    /// nothing to show, or if the process may not hold it.
    pub fn load(&self, exec: &Exec, progress: Progress<'_>) -> Result<Objects> {
        let has = self.has();
        self.ask(has.iter().map(|&number| {
            let node = &self.nodes()[number as usize];
            (node, Needed { surfels: node.surfels, primitives: true })
        }))?;
        let mut geometries = Vec::with_capacity(has.len());
        for (done, &number) in (0..).zip(&has) {
            progress("loading", done, has.len() as u64);
            geometries.push(self.geometry(number, exec)?);
        }
        let Showing { objects, coarser, .. } = self.showing(&has);
        let all = Objects::new(geometries, objects, self.fill())?.with_source(self.index.hash);
        all.with_coarser(coarser)
    }

    /// The nodes that have something and are shown somewhere, in their order.
    pub(super) fn has(&self) -> Vec<u32> {
        let shown = self.shown();
        let has = |number: &u32| {
            let node = &self.nodes()[*number as usize];
            shown[*number as usize] && (node.surfels > 0 || node.triangles > 0)
        };
        (0..self.nodes().len() as u32).filter(has).collect()
    }

    /// The nodes that are the geometries of [`Hierarchy::load`], in their order.
    pub(in crate::io) fn shown_nodes(&self) -> impl Iterator<Item = &Node> {
        self.has().into_iter().map(|number| &self.nodes()[number as usize])
    }

    /// What shows the nodes that have something: the objects, and of which each is a finer one.
    pub(super) fn showing(&self, has: &[u32]) -> Showing {
        let mut geometry = vec![None; self.nodes().len()];
        has.iter().enumerate().for_each(|(i, &number)| geometry[number as usize] = Some(i));
        let mut showing = Showing { geometry, objects: Vec::new(), coarser: Vec::new() };
        let of_scene =
            TreePlacement { name: String::new(), place: Similarity::IDENTITY, color: None };
        let upper = showing.tree(self, 0..self.upper(), &of_scene, None);
        for object in self.objects() {
            let above = if object.node == NONE { None } else { upper[object.node as usize] };
            let name = format!("object-{}.", object.number);
            let shown = TreePlacement { name, place: object.place, color: object.color };
            let nodes = self.geometries()[object.geometry as usize].nodes.clone();
            showing.tree(self, nodes, &shown, above);
        }
        showing
    }

    /// Whether each node is shown somewhere.
    fn shown(&self) -> Vec<bool> {
        let mut shown = vec![false; self.nodes().len()];
        shown[..self.upper() as usize].fill(true);
        for object in self.objects() {
            let nodes = &self.geometries()[object.geometry as usize].nodes;
            shown[nodes.start as usize..nodes.end as usize].fill(true);
        }
        shown
    }

    /// Asks for the memory of so much of some nodes, and of what shows all nodes.
    pub(super) fn ask<'a>(&self, needed: impl Iterator<Item = (&'a Node, Needed)>) -> Result<()> {
        let bytes = |(node, needed): (&Node, Needed)| {
            let primitives =
                u64::from(node.vertices) * OF_A_VERTEX + u64::from(node.triangles) * OF_A_TRIANGLE;
            u64::from(needed.surfels) * OF_A_SURFEL + if needed.primitives { primitives } else { 0 }
        };
        let nodes: u64 = needed.map(bytes).sum();
        let of = |geometry: u32| self.geometries()[geometry as usize].nodes.len() as u64;
        let objects = self.objects().iter().map(|object| of(object.geometry));
        let objects = objects.sum::<u64>() + u64::from(self.upper());
        memory::ask(nodes + objects * OF_AN_OBJECT, || {
            format!("{}: a hierarchy of {objects} nodes in their places", self.folder.display())
        })
    }

    /// The surfels and the own triangles of a node.
    fn geometry(&self, number: u32, exec: &Exec) -> Result<Geometry> {
        let node = &self.nodes()[number as usize];
        let all = Needed { surfels: node.surfels, primitives: true };
        let (surfels, primitives) = self.read(number, all, exec)?;
        let geometry = Geometry { name: name(number), surfels, primitives, detail: None };
        if node.surfels == 0 { Ok(geometry) } else { geometry.with_prefix(estimate(node)) }
    }

    /// So much of a node.
    pub(super) fn read(
        &self,
        number: u32,
        needed: Needed,
        exec: &Exec,
    ) -> Result<(Surfels, Primitives)> {
        let node = &self.nodes()[number as usize];
        let mut primitives = Primitives::default();
        if needed.primitives {
            primitives.triangles = self.drawn_triangles(number)?;
        }
        if needed.surfels == 0 {
            return Ok((Surfels::none(), primitives));
        }
        let mut cloud = self.surfels(number, needed.surfels)?;
        let count = cloud.position.len();
        cloud.radius = Some(vec![radius(node); count]);
        let (surfels, _) = Surfels::new_or_none(cloud, exec)?;
        if surfels.len() != count {
            let lost = count - surfels.len();
            let what = format!("{}: {lost} of {count} surfels can be none", name(number));
            return Err(Error::format(&self.folder, what));
        }
        Ok((surfels, primitives))
    }
}

/// What a node is called.
pub(super) fn name(number: u32) -> String {
    format!("node-{number}")
}

/// How densely the surfels of a node cover, see the [module](self).
pub(super) fn estimate(node: &Node) -> Estimate {
    let mut estimate = node.estimate;
    if estimate.distance == 0.0 {
        // A picture of two pixels' side: half the diagonal.
        estimate.distance = pixel(2, (node.low, node.high)) as f32;
    }
    estimate
}

/// The radius of the surfels of a node, see the [module](self).
pub(super) fn radius(node: &Node) -> f32 {
    let Estimate { count, distance } = estimate(node);
    let share = f64::from(count) / f64::from(node.surfels);
    (f64::from(distance) * share.sqrt()) as f32
}

/// Where a tree is shown.
struct TreePlacement {
    /// What the names of its objects begin with.
    name: String,
    place: Similarity,
    color: Option<Vec3>,
}

impl Showing {
    /// Shows the nodes of a tree, below an object if there is one; of each node the nearest object that shows it or one above.
    fn tree(
        &mut self,
        hierarchy: &Hierarchy,
        nodes: std::ops::Range<u32>,
        shown: &TreePlacement,
        above: Option<u32>,
    ) -> Vec<Option<u32>> {
        let mut nearest: Vec<Option<u32>> = Vec::with_capacity(nodes.len());
        for number in nodes.clone() {
            let parent = hierarchy.nodes()[number as usize].parent;
            // What is above has the smaller number.
            let over =
                if parent == NONE { above } else { nearest[(parent - nodes.start) as usize] };
            let Some(geometry) = self.geometry[number as usize] else {
                nearest.push(over);
                continue;
            };
            nearest.push(Some(self.objects.len() as u32));
            self.coarser.push(over);
            self.objects.push(Object {
                name: format!("{}{}", shown.name, name(number)),
                geometry,
                motion: Motion::still(shown.place),
                color: shown.color,
            });
        }
        nearest
    }
}
