//! Make the folder of a hierarchy, or resume an unfinished one, see the [module](super).

use super::bytes::Hash;
use super::gather::{below, gather};
use super::layout::Layout;
use super::plan::{self, refused};
use super::read::Hierarchy;
use super::{mesh, surfels};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::replace::write_atomically;
use crate::progress::Progress;
use crate::scene::{Object, Triangles};
use crate::source::hierarchy::{Flaws, Settings, Traversal, approximate};
use glam::Vec3;
use std::io::Write;
use std::path::Path;

/// A summary of what was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Built {
    /// Name, triangles and flaws of each geometry.
    pub geometries: Vec<(String, u64, Flaws)>,
    /// Nodes that have enough triangles to be approximated.
    pub nodes: u32,
    /// How many of these were already in the folder.
    pub found: u32,
    /// How many of these no pixel sees.
    pub unseen: u32,
}

/// The scene that a hierarchy is made of: its geometries by number, and its objects.
pub(in crate::io) struct Geometries<'a> {
    pub(in crate::io) names: Vec<String>,
    pub(in crate::io) objects: Vec<Object>,
    /// The colour of what has none.
    pub(in crate::io) fill: Vec3,
    /// Reads the triangles of a geometry, and says how many were dropped.
    pub(in crate::io) read: Box<dyn Fn(usize) -> Result<(Triangles, u64)> + 'a>,
}

/// See [`SceneFile::approximate`](crate::io::scene_file::SceneFile::approximate).
pub(in crate::io) fn build(
    scene: Geometries<'_>,
    folder: &Path,
    settings: &Settings,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Built> {
    let mut work = Work::begin(scene, folder, settings, exec, progress)?;
    // Children have larger numbers, so this order makes them first.
    for node in (0..work.wanted.len() as u32).rev() {
        work.make(node)?;
    }
    work.finish()
}

/// A hierarchy in the making. The index grows as nodes are made.
pub(super) struct Work<'a> {
    hierarchy: Hierarchy,
    settings: &'a Settings,
    exec: &'a Exec,
    progress: Progress<'a>,
    /// How many surfels to make for each node.
    pub(super) wanted: Vec<u32>,
    made: Vec<bool>,
    /// Surfels wanted by the nodes that are made, and by all nodes.
    surfels: u64,
    total: u64,
    built: Built,
}

impl<'a> Work<'a> {
    /// Writes the geometries; no node is approximated yet.
    pub(super) fn begin(
        scene: Geometries<'_>,
        folder: &Path,
        settings: &'a Settings,
        exec: &'a Exec,
        progress: Progress<'a>,
    ) -> Result<Self> {
        let Geometries { names, objects, fill, read } = scene;
        let plan = plan::hash(settings, fill, &objects, names.len());
        plan::begin(folder, &plan)?;
        let mut geometries = Vec::with_capacity(names.len());
        let mut built = Built { geometries: Vec::new(), nodes: 0, found: 0, unseen: 0 };
        let count = names.len();
        for (number, name) in names.into_iter().enumerate() {
            progress("geometries", number as u64, count as u64);
            let header = geometry(folder, number as u32, || read(number))
                .map_err(|error| named(&name, error))?;
            let triangles = header.nodes.first().map_or(0, |root| root.below);
            built.geometries.push((name, triangles, header.flaws));
            geometries.push(header);
        }
        let hashes: Vec<Hash> = geometries.iter().map(|one| one.hash).collect();
        let mut layout = Layout::over(&objects, &geometries, settings)?;
        geometries.into_iter().for_each(|header| layout.append(header, settings));
        let (index, wanted) =
            layout.finish(plan::of_all(&plan, &hashes), fill, settings.properties.clone());
        built.nodes = wanted.iter().filter(|count| **count > 0).count() as u32;
        Ok(Self {
            hierarchy: Hierarchy { folder: folder.to_owned(), index },
            settings,
            exec,
            progress,
            made: vec![false; wanted.len()],
            surfels: 0,
            total: wanted.iter().copied().map(u64::from).sum(),
            wanted,
            built,
        })
    }

    /// Makes the surfels of a node, unless they are in the folder; bottom-up, makes the nodes below
    /// first.
    pub(super) fn make(&mut self, node: u32) -> Result<()> {
        let at = node as usize;
        let count = self.wanted[at];
        if self.made[at] || count == 0 {
            return Ok(());
        }
        if self.settings.traversal == Traversal::BottomUp {
            self.make_below(node)?;
        }
        let Hierarchy { folder, index } = &self.hierarchy;
        let hash = index.hash;
        (self.progress)("surfels", self.surfels, self.total);
        let further = self.settings.properties.len();
        let mut header = surfels::header(folder, &hash, node, further)?;
        if header.is_some() {
            self.built.found += 1;
        } else {
            let Settings { traversal, .. } = *self.settings;
            let drawn = |side| gather(&self.hierarchy, node, side, traversal);
            let (before, total) = (self.surfels, self.total);
            // Only the sampler counts surfels; other steps have other totals.
            let picks = |_: &str, done, of| {
                if of == u64::from(count) {
                    (self.progress)("surfels", before + done, total);
                }
            };
            let cloud = approximate(&drawn, count, self.settings, self.exec, &picks)?;
            surfels::write(folder, &hash, node, &cloud)?;
            // Read it back, because the estimate comes from the normals as stored.
            header = surfels::header(folder, &hash, node, further)?;
        }
        let Some(header) = header else {
            let what = "another hierarchy replaced it while this one was made";
            return Err(Error::format(&surfels::path(folder, node), what));
        };
        let known = &mut self.hierarchy.index.nodes[at];
        (known.surfels, known.estimate) = (header.count, header.estimate);
        self.built.unseen += u32::from(header.count == 0);
        self.made[at] = true;
        self.surfels += u64::from(count);
        (self.progress)("surfels", self.surfels, self.total);
        Ok(())
    }

    /// Makes the nearest approximated nodes below.
    fn make_below(&mut self, node: u32) -> Result<()> {
        for child in below(&self.hierarchy, node) {
            if self.wanted[child as usize] > 0 {
                self.make(child)?;
            } else {
                self.make_below(child)?;
            }
        }
        Ok(())
    }

    /// Writes the bounds and the index, once all nodes are made.
    pub(super) fn finish(self) -> Result<Built> {
        self.hierarchy.write_bounds(self.exec, self.progress)?;
        let bytes = self.hierarchy.index.file();
        write_atomically(&self.hierarchy.folder.join("index"), |to| to.write_all(&bytes))?;
        Ok(self.built)
    }
}

/// Adds the name of the geometry to an error.
fn named(name: &str, error: Error) -> Error {
    match error {
        Error::Invalid(what) if !what.starts_with(name) => {
            Error::Invalid(format!("{name}: {what}"))
        }
        other => other,
    }
}

/// The header of a geometry's file; writes the file if it is missing.
fn geometry(
    folder: &Path,
    number: u32,
    read: impl FnOnce() -> Result<(Triangles, u64)>,
) -> Result<mesh::Header> {
    let (triangles, dropped) = read()?;
    let hash = mesh::hash(&triangles);
    // A damaged file is treated as missing, and written again.
    if let Ok(Some(header)) = mesh::read(folder, number) {
        if header.hash != hash {
            return Err(refused(folder, "another geometry"));
        }
        return Ok(header);
    }
    mesh::write(folder, number, &hash, &triangles, dropped)?;
    // Another process may have replaced the file meanwhile.
    match mesh::read(folder, number)? {
        Some(header) if header.hash == hash => Ok(header),
        _ => Err(refused(folder, "another geometry")),
    }
}
