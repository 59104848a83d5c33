//! Surfel approximations of a scene, as [`crate::io::hierarchy`] stores them.

use super::model::check_properties;
use super::{Model, SceneFile, Source};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::hierarchy::{self, Built, Geometries};
use crate::progress::Progress;
use crate::scene::{Camera, Triangles};
use crate::source::hierarchy::Settings;
use std::path::Path;

impl SceneFile {
    /// Makes the hierarchy of the scene in a folder, or resumes an unfinished one. The parent of the
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
    pub fn approximate(
        &self,
        folder: &Path,
        settings: &Settings,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Built> {
        let scene = self.to_approximate(settings, exec, progress)?;
        hierarchy::build(scene, folder, settings, exec, progress)
    }

    /// What a hierarchy is made of, once it is known that there can be one.
    pub(in crate::io) fn to_approximate<'a>(
        &'a self,
        settings: &'a Settings,
        exec: &'a Exec,
        progress: Progress<'a>,
    ) -> Result<Geometries<'a>> {
        if settings.most == 0 {
            return Err(Error::Usage("a hierarchy of 0 surfels; give at least 1".into()));
        }
        if self.hierarchy.is_some() {
            let what = format!("{} is a hierarchy already; give a mesh or a scene", self.name);
            return Err(Error::Usage(what));
        }
        Camera::check_size(settings.side, settings.side)?;
        let models: Vec<(String, &Model)> = self
            .models
            .iter()
            .map(|model| (model.source.name(), model))
            .chain(self.geometries.iter().map(|one| (one.name.clone(), &one.model)))
            .collect();
        // Check every model before the folder is made.
        if let Some(moving) = self.geometries.iter().find(|one| matches!(one.files(), Ok(Some(_))))
        {
            let what = "a hierarchy samples triangles that do not move, but this geometry has a file for \
                        each frame; name one file";
            return Err(Error::Invalid(format!("{}: {what}", moving.name)));
        }
        for (name, model) in &models {
            check(name, model)?;
            check_properties(model, &settings.properties)?;
        }
        let objects = self.objects()?;
        let fill = self.material.color;
        let (names, models): (Vec<String>, Vec<&Model>) = models.into_iter().unzip();
        let read =
            move |geometry: usize| self.triangles(models[geometry], settings, exec, progress);
        Ok(Geometries { names, objects, fill, read: Box::new(read) })
    }

    /// The triangles of a model, and how many were dropped.
    fn triangles(
        &self,
        model: &Model,
        settings: &Settings,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<(Triangles, u64)> {
        let alone = Self {
            models: vec![model.clone()],
            geometries: Vec::new(),
            objects: Vec::new(),
            environment: None,
            surface: None,
            ..self.clone()
        };
        let loaded = alone.load_polygons(&settings.properties, exec, progress)?;
        Ok((loaded.scene.primitives.triangles, loaded.dropped_primitives))
    }
}

/// Refuses a model that cannot be approximated.
fn check(name: &str, model: &Model) -> Result<()> {
    let what = match &model.source {
        Source::Shape { .. } => "a shape has surfels of its own, but no triangles to sample",
        Source::File { prefix: Some(_), .. } => {
            "a prefix needs points, but a hierarchy samples triangles; remove it"
        }
        Source::File { .. } if model.progressive => {
            "progressive needs points, but a hierarchy samples triangles; remove it"
        }
        Source::File { .. } | Source::Tree { .. } => return Ok(()),
    };
    Err(Error::Invalid(format!("{name}: {what}")))
}
