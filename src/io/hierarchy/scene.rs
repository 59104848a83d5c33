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

use super::index::{NONE, Node};
use super::read::Hierarchy;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
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
struct Showing {
    /// Of each node the geometry that has its surfels and triangles, if it has some.
    geometry: Vec<Option<usize>>,
    objects: Vec<Object>,
    coarser: Vec<Option<u32>>,
}

impl Hierarchy {
    /// All that is in the folder as objects, see [`mod@crate::io::hierarchy`]. `progress` is told "loading", how
    /// many nodes are read, and of how many.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`] and [`Hierarchy::triangles`]; [`Error::Invalid`] as [`Objects::new`], if there is
    /// nothing to show, or if the process may not hold it.
    pub fn load(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Objects> {
        self.ask()?;
        let (mut geometries, mut of_node) = (Vec::new(), Vec::with_capacity(self.nodes().len()));
        let shown = self.shown();
        for (number, node) in (0..).zip(self.nodes()) {
            progress("loading", u64::from(number), self.nodes().len() as u64);
            let has = shown[number as usize] && (node.surfels > 0 || node.triangles > 0);
            of_node.push(has.then_some(geometries.len()));
            if has {
                geometries.push(self.geometry(number, node, exec)?);
            }
        }
        let (objects, coarser) = (Vec::new(), Vec::new());
        let mut showing = Showing { geometry: of_node, objects, coarser };
        let of_scene = Shown { name: String::new(), place: Similarity::IDENTITY, color: None };
        let upper = showing.tree(self, 0..self.upper(), &of_scene, None);
        for object in self.objects() {
            let above = if object.node == NONE { None } else { upper[object.node as usize] };
            let name = format!("object-{}.", object.number);
            let shown = Shown { name, place: object.place, color: object.color };
            let nodes = self.geometries()[object.geometry as usize].nodes.clone();
            showing.tree(self, nodes, &shown, above);
        }
        Objects::new(geometries, showing.objects, self.fill())?.with_coarser(showing.coarser)
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

    /// Asks for the memory of all of it.
    fn ask(&self) -> Result<()> {
        let bytes = |node: &Node| {
            u64::from(node.surfels) * OF_A_SURFEL
                + u64::from(node.vertices) * OF_A_VERTEX
                + u64::from(node.triangles) * OF_A_TRIANGLE
        };
        let nodes: u64 = self.nodes().iter().map(bytes).sum();
        let of = |geometry: u32| self.geometries()[geometry as usize].nodes.len() as u64;
        let objects = self.objects().iter().map(|object| of(object.geometry));
        let objects = objects.sum::<u64>() + u64::from(self.upper());
        memory::ask(nodes + objects * OF_AN_OBJECT, || {
            format!("{}: a hierarchy of {objects} nodes in their places", self.folder.display())
        })
    }

    /// The surfels and the own triangles of a node.
    fn geometry(&self, number: u32, node: &Node, exec: &Exec) -> Result<Geometry> {
        let primitives = Primitives { triangles: self.triangles(number)?, ..Primitives::default() };
        let name = format!("node-{number}");
        if node.surfels == 0 {
            return Ok(Geometry { name, surfels: Surfels::none(), primitives, detail: None });
        }
        let mut cloud = self.surfels(number, u32::MAX)?;
        let mut estimate = node.estimate;
        if estimate.distance == 0.0 {
            // A picture of two pixels' side: half the diagonal.
            estimate.distance = pixel(2, (node.low, node.high)) as f32;
        }
        let share = f64::from(estimate.count) / f64::from(node.surfels);
        let radius = (f64::from(estimate.distance) * share.sqrt()) as f32;
        cloud.radius = Some(vec![radius; cloud.position.len()]);
        let (surfels, _) = Surfels::new_or_none(cloud, exec)?;
        if surfels.len() != node.surfels as usize {
            let lost = node.surfels as usize - surfels.len();
            let what = format!("{name}: {lost} of {} surfels can be none", node.surfels);
            return Err(Error::format(&self.folder, what));
        }
        Geometry { name, surfels, primitives, detail: None }.with_prefix(estimate)
    }
}

/// Where a tree is shown.
struct Shown {
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
        shown: &Shown,
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
                name: format!("{}node-{number}", shown.name),
                geometry,
                motion: Motion::still(shown.place),
                color: shown.color,
            });
        }
        nearest
    }
}
