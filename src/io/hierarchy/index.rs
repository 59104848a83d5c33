//! The index of a hierarchy, see the [module](super).

use super::bytes::{Hash, Reader, Writer, check_magic, checked};
use super::kind::Kind;
use super::surfels;
use crate::io::{Reason, checksum};
use crate::scene::Similarity;
use crate::scene::light::is_color;
use crate::scene::objects::detail::prefix::Estimate;
use crate::source::hierarchy::Flaws;
use glam::Vec3;
use std::ops::Range;

const MAGIC: &[u8; 16] = b"splatref tree 2\n";
const HEADER: u64 = 80;
const OF_A_NODE: u64 = 88;
const OF_AN_OBJECT: u64 = 136;
const OF_A_GEOMETRY: u64 = 80;
/// The index that stands for "none".
pub const NONE: u32 = u32::MAX;

/// A node of a hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The node above, in the same tree; [`NONE`] for a root.
    pub parent: u32,
    /// The nodes below, in the same tree.
    pub children: Range<u32>,
    /// The geometry that the tree belongs to, and whose coordinates it has; [`NONE`] for the tree
    /// over the objects.
    pub geometry: u32,
    /// The corner with the least coordinates of the box around the triangles here and below.
    pub low: Vec3,
    /// The corner with the greatest coordinates.
    pub high: Vec3,
    /// Number of triangles here and below, counted once for each object that shows them.
    pub below: u64,
    /// Number of its own triangles, which are in no node below.
    pub triangles: u32,
    /// Number of vertices of its own triangles.
    pub vertices: u32,
    /// Where its triangles begin in the file of the geometry.
    pub(super) offset: u64,
    /// Its own objects, as a range of [`super::Hierarchy::objects`].
    pub objects: Range<u32>,
    /// Number of its surfels; 0 if it is not approximated.
    pub surfels: u32,
    /// How densely its surfels cover.
    pub estimate: Estimate,
}

/// An object that shows a geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its number in the scene.
    pub number: u32,
    /// Its geometry.
    pub geometry: u32,
    /// The node over objects that it belongs to; [`NONE`] if it moves.
    pub node: u32,
    /// Linear RGB that replaces the geometry's colours.
    pub color: Option<Vec3>,
    /// Whether it changes its place in other frames.
    pub moves: bool,
    /// Its place in frame 0.
    pub place: Similarity,
}

/// A geometry and its tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The nodes of its tree, the root first.
    pub nodes: Range<u32>,
    /// Which attributes its vertices have.
    pub kind: Kind,
    /// The flaws of its triangles.
    pub flaws: Flaws,
    pub(super) hash: Hash,
}

/// The whole contents of the index.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Index {
    pub(super) hash: Hash,
    pub(super) fill: Vec3,
    /// How many nodes are over the objects.
    pub(super) upper: u32,
    pub(super) nodes: Vec<Node>,
    pub(super) objects: Vec<Object>,
    pub(super) geometries: Vec<Geometry>,
    /// The names of further properties of vertices and surfels.
    pub(super) properties: Vec<String>,
}

impl Index {
    /// The whole file.
    pub(super) fn file(&self) -> Vec<u8> {
        checksum::seal(self.bytes())
    }

    /// Reads the whole file.
    pub(super) fn from_file(bytes: &[u8]) -> Reason<Self> {
        check_magic(bytes, MAGIC, "the index")?;
        Self::parse(checked(bytes)?)
    }

    /// The file without its checksum.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut to = Writer::default();
        to.bytes(MAGIC);
        to.bytes(&self.hash);
        let counts = [self.nodes.len(), self.objects.len(), self.geometries.len()];
        let [nodes, objects, geometries] = counts.map(|count| count as u32);
        to.words(&[nodes, self.upper, objects, geometries]);
        to.vector(self.fill);
        to.words(&[self.properties.len() as u32]);
        for node in &self.nodes {
            let Range { start, end } = node.children;
            to.words(&[node.parent, start, end - start, node.geometry]);
            to.vector(node.low);
            to.vector(node.high);
            to.long(node.below);
            to.words(&[node.triangles, node.vertices]);
            to.long(node.offset);
            let Range { start, end } = node.objects;
            to.words(&[start, end - start, node.surfels, node.estimate.count]);
            to.float(node.estimate.distance);
            to.words(&[0]);
        }
        for object in &self.objects {
            let flags = u32::from(object.color.is_some()) + 2 * u32::from(object.moves);
            to.words(&[object.number, object.geometry, object.node, flags]);
            to.vector(object.color.unwrap_or_default());
            to.float(0.0);
            similarity(&mut to, &object.place);
        }
        for geometry in &self.geometries {
            let Range { start, end } = geometry.nodes;
            to.words(&[start, end - start, geometry.kind.word(), 0]);
            to.bytes(&geometry.hash);
            flaws(&mut to, geometry.flaws);
        }
        self.properties.iter().for_each(|name| to.text(name));
        to.0
    }

    /// Parses the file without its checksum.
    pub(super) fn parse(bytes: &[u8]) -> Reason<Self> {
        let mut rest = Reader(bytes);
        rest.take::<16>()?;
        let hash = rest.take::<32>()?;
        let [nodes, upper, objects, geometries] = rest.words()?;
        let fill = rest.vector()?;
        let properties = rest.word()?;
        let [n, o, g] = [nodes, objects, geometries].map(u64::from);
        let length = HEADER + n * OF_A_NODE + o * OF_AN_OBJECT + g * OF_A_GEOMETRY;
        // Names follow, of any length; `rest` must be empty after them.
        let long = if properties == 0 { length } else { length.max(bytes.len() as u64) };
        if long != bytes.len() as u64 {
            return Err(format!(
                "{nodes} nodes, {objects} objects and {geometries} geometries need {length} bytes, \
                 but the file has {}",
                bytes.len()
            ));
        }
        let nodes = (0..nodes).map(|_| node(&mut rest)).collect::<Reason<Vec<_>>>()?;
        let objects = (0..objects).map(|_| object(&mut rest)).collect::<Reason<Vec<_>>>()?;
        let geometries =
            (0..geometries).map(|_| geometry(&mut rest)).collect::<Reason<Vec<_>>>()?;
        let mut name = || rest.word().and_then(|length| rest.text(length));
        let properties = (0..properties).map(|_| name()).collect::<Reason<Vec<_>>>()?;
        if !rest.0.is_empty() {
            return Err(format!("{} bytes follow the last name", rest.0.len()));
        }
        let index = Self { hash, fill, upper, nodes, objects, geometries, properties };
        index.check()?;
        Ok(index)
    }

    /// Checks that every reference leads to something that can be there.
    fn check(&self) -> Reason<()> {
        if !is_color(self.fill) {
            return Err("the default colour is invalid".into());
        }
        let further = |one: &Geometry| one.kind.properties as usize;
        if self.geometries.iter().any(|one| further(one) != self.properties.len()) {
            return Err("a geometry lacks some of the common properties".into());
        }
        self.check_trees()?;
        for (i, node) in self.nodes.iter().enumerate() {
            self.check_node(node).map_err(|what| format!("node {i}: {what}"))?;
        }
        let own = self.nodes[..self.upper as usize].iter().flat_map(|node| node.objects.clone());
        let resting = self.objects.iter().filter(|object| object.node != NONE).count() as u32;
        if !own.eq(0..resting) {
            return Err("the nodes do not hold all objects at rest, one after the other".into());
        }
        for (i, object) in self.objects.iter().enumerate() {
            let node = self.nodes[..self.upper as usize].get(object.node as usize);
            let held = node.is_some_and(|node| node.objects.contains(&(i as u32)));
            if object.moves != (object.node == NONE) || !(object.moves || held) {
                return Err(format!("object {i} is not in its node"));
            }
            if self.geometries.get(object.geometry as usize).is_none() {
                return Err(format!("object {i} has no geometry"));
            }
            object.place.check().map_err(|error| format!("object {i}: {error}"))?;
        }
        Ok(())
    }

    /// Checks that the nodes form trees, level by level, one tree after the other.
    fn check_trees(&self) -> Reason<()> {
        let mut trees = vec![(0..self.upper, NONE)];
        trees.extend((0..).zip(&self.geometries).map(|(i, geometry)| (geometry.nodes.clone(), i)));
        let mut next = 0;
        for (range, of) in trees {
            if range.start != next || range.end < next || (range.is_empty() && of != NONE) {
                return Err("the trees do not follow each other".into());
            }
            next = range.end;
            if next as usize > self.nodes.len() {
                return Err("there are fewer nodes than the trees have".into());
            }
            // Children come level by level, so each node's children begin where the last ones end.
            let mut child = range.start + 1;
            for number in range.clone() {
                let node = &self.nodes[number as usize];
                let wrong = |what: &str| Err(format!("node {number}: {what}"));
                if node.geometry != of {
                    return wrong("it belongs to another tree");
                }
                if number == range.start && node.parent != NONE {
                    return wrong("the root of a tree has a parent");
                }
                let Range { start, end } = node.children;
                if start != child || end > range.end || end < start {
                    return wrong("its children are not the next nodes");
                }
                let known = |child: u32| self.nodes[child as usize].parent == number;
                if start <= number || !node.children.clone().all(known) {
                    return wrong("its children have another parent");
                }
                child = end;
            }
            if !range.is_empty() && child != range.end {
                return Err("some nodes have no parent".into());
            }
        }
        if next as usize != self.nodes.len() {
            return Err("there are more nodes than the trees have".into());
        }
        Ok(())
    }

    fn check_node(&self, node: &Node) -> Reason<()> {
        let Node { low, high, surfels, estimate, .. } = node;
        if !(low.is_finite() && high.is_finite() && low.cmple(*high).all()) {
            return Err("its box is invalid".into());
        }
        let upper = node.geometry == NONE;
        let own = if upper { node.triangles > 0 } else { !node.objects.is_empty() };
        if own || (node.triangles == 0) != (node.vertices == 0) {
            return Err("it has a field that nodes of its tree do not have".into());
        }
        surfels::check(*estimate, *surfels)
    }
}

pub(super) fn similarity(to: &mut Writer, place: &Similarity) {
    place.rotation.to_cols_array().into_iter().for_each(|v| to.double(v));
    to.double(place.scale);
    place.translation.to_array().into_iter().for_each(|v| to.double(v));
}

pub(super) fn flaws(to: &mut Writer, flaws: Flaws) {
    let Flaws { dropped, degenerate, duplicate, edges_of_many } = flaws;
    [dropped, degenerate, duplicate, edges_of_many].into_iter().for_each(|count| to.long(count));
}

pub(super) fn read_flaws(from: &mut Reader<'_>) -> Reason<Flaws> {
    Ok(Flaws {
        dropped: from.long()?,
        degenerate: from.long()?,
        duplicate: from.long()?,
        edges_of_many: from.long()?,
    })
}

/// A range, from its start and its length.
pub(super) fn range(start: u32, length: u32) -> Reason<Range<u32>> {
    Ok(start..start.checked_add(length).ok_or("a range ends beyond 32 bits")?)
}

fn node(from: &mut Reader<'_>) -> Reason<Node> {
    let [parent, first, children, geometry] = from.words()?;
    let (low, high) = (from.vector()?, from.vector()?);
    let below = from.long()?;
    let [triangles, vertices] = from.words()?;
    let offset = from.long()?;
    let [object, objects, surfels, p_m] = from.words()?;
    let estimate = Estimate { count: p_m, distance: from.float()? };
    from.word()?;
    let (children, objects) = (range(first, children)?, range(object, objects)?);
    Ok(Node {
        parent,
        children,
        geometry,
        low,
        high,
        below,
        triangles,
        vertices,
        offset,
        objects,
        surfels,
        estimate,
    })
}

fn object(from: &mut Reader<'_>) -> Reason<Object> {
    let [number, geometry, node, flags] = from.words()?;
    let color = from.vector()?;
    from.word()?;
    let (rotation, scale, translation) = (from.matrix()?, from.scale()?, from.position()?);
    if flags > 3 || !is_color(color) {
        return Err(format!("object {number} has invalid flags or an invalid colour"));
    }
    let color = (flags & 1 == 1).then_some(color);
    let place = Similarity { rotation, scale, translation };
    Ok(Object { number, geometry, node, color, moves: flags & 2 == 2, place })
}

fn geometry(from: &mut Reader<'_>) -> Reason<Geometry> {
    let [first, nodes, kind, _] = from.words()?;
    let (hash, flaws) = (from.take()?, read_flaws(from)?);
    Ok(Geometry { nodes: range(first, nodes)?, kind: Kind::of_word(kind), flaws, hash })
}
