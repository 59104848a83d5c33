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
use crate::io::scene_file::{Model, SceneFile, Source, check_properties};
use crate::scene::Camera;
use crate::source::hierarchy::{Flaws, Settings, Traversal, approximate};
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

/// Makes the hierarchy of a scene in a folder, or resumes an unfinished one. The parent of the
/// folder must exist. Models are taken as their triangles, in the order of [`SceneFile::models`]
/// and [`SceneFile::geometries`].
///
/// `progress` gets the name of a step, how much of it is done, and the total; for "surfels" both
/// are numbers of surfels.
///
/// # Errors
/// The errors of [`SceneFile::load_polygons`] and [`crate::source::candidates::candidates`].
/// [`Error::Usage`] if you ask for no surfel or no picture. [`Error::Format`] if the folder holds
/// something else. [`Error::Io`] if the folder cannot be written to. Also an error if the process
/// may not hold what one node needs.
pub fn build(
    file: &SceneFile,
    folder: &Path,
    settings: &Settings,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Built> {
    let mut work = Work::begin(file, folder, settings, exec, progress)?;
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
    progress: &'a dyn Fn(&str, u64, u64),
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
        file: &SceneFile,
        folder: &Path,
        settings: &'a Settings,
        exec: &'a Exec,
        progress: &'a dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        if settings.most == 0 {
            return Err(Error::Usage("a hierarchy of 0 surfels; give at least 1".into()));
        }
        if file.hierarchy.is_some() {
            let what = format!("{} is a hierarchy already; name a mesh or a scene", file.name);
            return Err(Error::Usage(what));
        }
        Camera::check_size(settings.side, settings.side)?;
        let models: Vec<(String, &Model)> = file
            .models
            .iter()
            .map(|model| (model.source.name(), model))
            .chain(file.geometries.iter().map(|one| (one.name.clone(), &one.model)))
            .collect();
        // Check every model before the folder is made.
        for (name, model) in &models {
            check(name, model)?;
            check_properties(model, &settings.properties)?;
        }
        let objects = file.objects()?;
        let fill = file.material.color;
        let plan = plan::hash(settings, fill, &objects, models.len());
        plan::begin(folder, &plan)?;
        let mut geometries = Vec::with_capacity(models.len());
        let mut built = Built { geometries: Vec::new(), nodes: 0, found: 0, unseen: 0 };
        for (number, (name, model)) in (0..).zip(models) {
            progress("geometries", u64::from(number), file.all_models().count() as u64);
            let header =
                geometry(file, model, (folder, number), &settings.properties, exec, progress)
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
            let what = "it was replaced by another hierarchy while this one was made";
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
        let bytes = self.hierarchy.index.bytes();
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

/// Refuses a model that cannot be approximated.
fn check(name: &str, model: &Model) -> Result<()> {
    let what = match &model.source {
        Source::Shape { .. } => "a shape has surfels of its own and no triangles to approximate",
        Source::File { prefix: Some(_), .. } => "a prefix is of points, which are not approximated",
        Source::File { .. } if model.progressive => "progressive points are not approximated",
        Source::File { .. } | Source::Tree { .. } => return Ok(()),
    };
    Err(Error::Invalid(format!("{name}: {what}")))
}

/// The header of a geometry's file; writes the file if it is missing.
fn geometry(
    file: &SceneFile,
    model: &Model,
    (folder, number): (&Path, u32),
    properties: &[String],
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<mesh::Header> {
    let alone = SceneFile {
        models: vec![model.clone()],
        geometries: Vec::new(),
        objects: Vec::new(),
        environment: None,
        ..file.clone()
    };
    let loaded = alone.load_polygons(properties, exec, progress)?;
    let triangles = &loaded.scene.primitives.triangles;
    let hash = mesh::hash(triangles);
    // A damaged file is treated as missing, and written again.
    if let Ok(Some(header)) = mesh::read(folder, number) {
        if header.hash != hash {
            return Err(refused(folder, "another geometry"));
        }
        return Ok(header);
    }
    mesh::write(folder, number, &hash, triangles, loaded.dropped_primitives)?;
    // Another process may have replaced the file meanwhile.
    match mesh::read(folder, number)? {
        Some(header) if header.hash == hash => Ok(header),
        _ => Err(refused(folder, "another geometry")),
    }
}
