//! Read a hierarchy one node at a time.

use super::index::{Geometry, Index, NONE, Node, Object};
use super::mesh;
use super::surfels::{self, Header};
use crate::error::{Error, Result};
use crate::io::input;
use crate::scene::{Cloud, Triangles, Vertices};
use crate::source::hierarchy::{Numbers, Part};
use glam::Vec3;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A hierarchy in a folder. Its index is in memory; methods read the rest on demand.
#[derive(Clone, Debug, PartialEq)]
pub struct Hierarchy {
    pub(super) folder: PathBuf,
    pub(super) index: Index,
}

impl Hierarchy {
    /// Whether a folder holds a hierarchy, or a part of one.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        folder.join("plan").is_file() || folder.join("index").is_file()
    }

    /// Reads the index of a folder.
    ///
    /// # Errors
    /// [`Error::Io`] if there is none, or it cannot be read; [`Error::Format`] if it is damaged.
    pub fn open(folder: &Path) -> Result<Self> {
        let path = folder.join("index");
        if folder.join("plan").exists() && !path.exists() {
            let what = "the hierarchy is incomplete; rerun `splatref surfels` to resume";
            return Err(Error::format(folder, what));
        }
        let bytes = input::bytes(&path).map_err(|source| Error::io(&path, source))?;
        let index = Index::from_file(&bytes).map_err(|what| Error::format(&path, what))?;
        Ok(Self { folder: folder.to_owned(), index })
    }

    /// All nodes: first the nodes over the objects, then the nodes of geometry 0, of geometry 1,
    /// ...
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.index.nodes
    }

    /// How many nodes are over the objects; the first, if there is one, is the root of the scene.
    #[must_use]
    pub fn upper(&self) -> u32 {
        self.index.upper
    }

    /// The objects, in the order of their nodes; moving objects come last.
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.index.objects
    }

    /// The geometries.
    #[must_use]
    pub fn geometries(&self) -> &[Geometry] {
        &self.index.geometries
    }

    /// The colour of triangles without one.
    #[must_use]
    pub fn fill(&self) -> Vec3 {
        self.index.fill
    }

    /// Which numbers vertices and surfels have beside normals and colours.
    #[must_use]
    pub fn numbers(&self) -> Numbers {
        let opacity = self.index.geometries.iter().any(|one| one.kind.veiled);
        Numbers { opacity, properties: self.index.properties.clone() }
    }

    /// Reads the first `most` surfels of a node, or all: positions, normals, colours and
    /// [numbers](Hierarchy::numbers) in their order. Reads at most 1,023 more than these, because a
    /// checksum covers a block of 1,024.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be read. [`Error::Format`] if they differ from the index or from
    /// their checksum, or if the process may not hold them. [`Error::Invalid`] if there is no such node.
    pub fn surfels(&self, node: u32, most: u32) -> Result<Cloud> {
        self.some_surfels(node, 0..most)
    }

    /// [`Hierarchy::surfels`] from the first to the last of a range.
    pub(super) fn some_surfels(&self, node: u32, range: Range<u32>) -> Result<Cloud> {
        let Node { surfels: count, estimate, .. } = *self.node(node)?;
        if count == 0 {
            return Ok(Cloud::default());
        }
        let header = Header { node, count, estimate };
        surfels::read(&self.folder, &self.index.hash, &header, &self.numbers(), range)
    }

    /// Reads the own triangles of a node, in the coordinates of its geometry, with all attributes
    /// of vertices; radii are 0. A node over the objects has none.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`].
    pub fn triangles(&self, node: u32) -> Result<Triangles> {
        joined(self.part(node)?)
    }

    /// The same triangles for drawing: opaque, without further properties.
    pub(super) fn drawn_triangles(&self, node: u32) -> Result<Triangles> {
        joined(Part { opacity: None, properties: Vec::new(), ..self.part(node)? })
    }

    pub(super) fn part(&self, node: u32) -> Result<Part> {
        let node = self.node(node)?;
        if node.geometry == NONE {
            return Ok(Part::default());
        }
        let Geometry { hash, kind, .. } = &self.index.geometries[node.geometry as usize];
        mesh::part(&self.folder, hash, node, *kind, &self.numbers())
    }

    fn node(&self, node: u32) -> Result<&Node> {
        let nodes = &self.index.nodes;
        nodes.get(node as usize).ok_or_else(|| {
            Error::Invalid(format!("node {node} does not exist; there are {}", nodes.len()))
        })
    }
}

fn joined(part: Part) -> Result<Triangles> {
    let Part { position, normal, color, opacity, properties, triangles } = part;
    let radius = vec![0.0; position.len()];
    let vertices = Vertices { position, direction: normal, radius, color, opacity, properties };
    Ok(Triangles::new(vertices, triangles)?.0)
}
