//! Turn a hierarchy into objects, so that each view draws only what it needs.
//!
//! [`Hierarchy::load`] reads the whole folder, [`Hierarchy::outlined`] only what a view draws.
//!
//! Each object of the hierarchy shows every node of its geometry's tree, in the object's place and
//! colour. A node over the objects is shown once, in its place. The object that shows a node has
//! the node's surfels as a [prefix](crate::scene::objects::detail::prefix), with the estimate from
//! the index, and the node's own triangles as primitives. It
//! [refines](crate::scene::objects::detail::refine) the object that shows the nearest node above
//! with something to show. The nodes over the objects lie above the roots of an object's geometry.
//! Nodes with neither surfels nor triangles are left out, and so are nodes of geometries that no
//! object shows.
//!
//! The nodes over the objects come first, by number, with the name `node-N`. Then come the nodes of
//! each object of the index, in its order, with the name `object-M.node-N`, in the order of nodes.
//! M is the object's number in the scene; N counts the nodes of all trees. Geometries are in the
//! order of nodes, each node once.
//!
//! The radius of a surfel is `r_m` sqrt(`p_m` / n), with which all surfels of the node cover.
//!
//! `Decided:` where `r_m` is 0, as for a single surfel, the density of the surfels is unknown. Then
//! half the diagonal of the node's box replaces `r_m`, or 1 if that is 0, in f64, rounded to f32.
//! The surfels stand for the whole node while it is about as small as they are drawn, and give way
//! to finer nodes when it is larger.
//!
//! `Decided:` moving objects stay in their place of frame 0, because a folder has no frames.

use super::index::{NONE, Node};
use super::read::Hierarchy;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::progress::Progress;
use crate::scene::merge::merge;
use crate::scene::objects::detail::prefix::Estimate;
use crate::scene::objects::outline::{Missing, Needed};
use crate::scene::objects::{Geometry, Object, Objects};
use crate::scene::{Motion, Primitives, Similarity, Surfels};
use crate::source::hierarchy::approximate::pixel;
use glam::Vec3;

/// Bytes in a loaded scene: a surfel, a vertex, a triangle with its box, and an object.
const OF_A_SURFEL: u64 = 96;
const OF_A_VERTEX: u64 = 48;
const OF_A_TRIANGLE: u64 = 48;
const OF_AN_OBJECT: u64 = 768;

/// Objects in the making, one for each node with something to show.
pub(super) struct Showing {
    /// For each node, the geometry with its surfels and triangles, if it has any.
    geometry: Vec<Option<usize>>,
    pub(super) objects: Vec<Object>,
    pub(super) coarser: Vec<Option<u32>>,
}

impl Hierarchy {
    /// Loads the whole folder as objects, see [`mod@crate::io::hierarchy`]. `progress` gets
    /// "loading", the number of nodes read, and their total.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`] and [`Hierarchy::triangles`]. [`Error::Invalid`] as
    /// [`Objects::new`], if there is nothing to show, or if the process may not hold it.
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

    /// The nodes that have surfels or triangles and are shown somewhere, in their order.
    pub(super) fn has(&self) -> Vec<u32> {
        let shown = self.shown();
        let has = |number: &u32| {
            let node = &self.nodes()[*number as usize];
            shown[*number as usize] && (node.surfels > 0 || node.triangles > 0)
        };
        (0..self.nodes().len() as u32).filter(has).collect()
    }

    /// The nodes that become the geometries of [`Hierarchy::load`], in their order.
    pub(in crate::io) fn shown_nodes(&self) -> impl Iterator<Item = &Node> {
        self.has().into_iter().map(|number| &self.nodes()[number as usize])
    }

    /// The objects that show these nodes, and the coarser object that each refines.
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

    /// Asks for memory for the needed parts of some nodes, and for the objects that show all nodes.
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

    /// A node as a geometry.
    fn geometry(&self, number: u32, exec: &Exec) -> Result<Geometry> {
        let node = &self.nodes()[number as usize];
        let (surfels, primitives) = self.read_all(number, exec)?;
        let geometry = Geometry { name: name(number), surfels, primitives, detail: None };
        if node.surfels == 0 { Ok(geometry) } else { geometry.with_prefix(estimate(node)) }
    }

    /// Reads the surfels and the own triangles of a node.
    pub(super) fn read_all(&self, number: u32, exec: &Exec) -> Result<(Surfels, Primitives)> {
        let surfels = 0..self.nodes()[number as usize].surfels;
        self.read(number, Missing { surfels, primitives: true }, Surfels::none(), exec)
    }

    /// Reads the missing part of a node. Returns the surfels in memory followed by those, and the
    /// primitives.
    pub(super) fn read(
        &self,
        number: u32,
        missing: Missing,
        held: Surfels,
        exec: &Exec,
    ) -> Result<(Surfels, Primitives)> {
        let node = &self.nodes()[number as usize];
        let mut primitives = Primitives::default();
        if missing.primitives {
            primitives.triangles = self.drawn_triangles(number)?;
        }
        if missing.surfels.is_empty() {
            return Ok((held, primitives));
        }
        let mut cloud = self.some_surfels(number, missing.surfels)?;
        cloud.radius = Some(vec![radius(node); cloud.position.len()]);
        if !held.is_empty() {
            // Every surfel has a colour, so none is filled in.
            cloud = merge(vec![held.into_cloud(), cloud], self.fill());
        }
        let count = cloud.position.len();
        let (surfels, _) = Surfels::new_or_none(cloud, exec)?;
        // A dropped surfel would shift the prefixes that views draw.
        if surfels.len() != count {
            let lost = count - surfels.len();
            let what = format!("{}: {lost} of {count} surfels are invalid", name(number));
            return Err(Error::format(&self.folder, what));
        }
        Ok((surfels, primitives))
    }
}

/// The name of a node.
pub(super) fn name(number: u32) -> String {
    format!("node-{number}")
}

/// The estimate of a node's density, see the [module](self).
pub(super) fn estimate(node: &Node) -> Estimate {
    let mut estimate = node.estimate;
    if estimate.distance == 0.0 {
        // A pixel of a picture with a side of two is half the diagonal.
        estimate.distance = pixel(2, node.low, node.high) as f32;
    }
    estimate
}

/// The radius of a node's surfels, see the [module](self).
pub(super) fn radius(node: &Node) -> f32 {
    let Estimate { count, distance } = estimate(node);
    let share = f64::from(count) / f64::from(node.surfels);
    (f64::from(distance) * share.sqrt()) as f32
}

/// The name, place and colour in which a tree is shown.
struct TreePlacement {
    /// The beginning of its objects' names.
    name: String,
    place: Similarity,
    color: Option<Vec3>,
}

impl Showing {
    /// Shows the nodes of a tree, as refinements of `above` if there is one. Returns, for each
    /// node, the object that shows it or the nearest node above it.
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
            // Parents have smaller numbers, so they are already there.
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
