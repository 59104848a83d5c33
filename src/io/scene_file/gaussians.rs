//! Load a scene of 3D Gaussians.

use super::load::GaussianReport;
use super::model::Purpose;
use super::{Draw, Loaded, Model, SceneFile, Source, offset};
use crate::error::{Error, Result};
use crate::io::gaussians;
use crate::scene::{Gaussians, Light, Phong};
use crate::shade::harmonics::rotation::place;
use std::path::Path;

impl SceneFile {
    /// The model of 3D Gaussians with its file, if the scene has one.
    ///
    /// # Errors
    /// One line if the scene has anything beside it, or if a choice applies to surfels.
    pub(super) fn gaussians(&self, purpose: Purpose<'_>) -> Result<Option<(&Model, &Path)>> {
        let holds = |model: &'_ &Model| path(model).is_some_and(gaussians::holds);
        let Some(model) = self.all_models().find(holds) else { return Ok(None) };
        let Some(path) = path(model) else { return Ok(None) };
        let refused = |what: String| Err(Error::format(path, what));
        if let Purpose::Candidates(_) = purpose {
            return refused(
                "the file holds 3D Gaussians, but a mesh is needed; give a mesh".into(),
            );
        }
        if let Some(choice) = choice_of_surfels(model) {
            return refused(format!("`{choice}` does not apply to 3D Gaussians; remove it"));
        }
        if self.all_models().count() > 1 || self.has_objects() || !self.objects.is_empty() {
            return refused(
                "a scene of 3D Gaussians has one model and no objects; remove the others".into(),
            );
        }
        let lit = !self.lights.is_empty() && self.lights != [Light::DEFAULT];
        if lit || self.material != Phong::default() {
            let key = if lit { "light" } else { "material" };
            return refused(format!(
                "`{key}` does not apply to 3D Gaussians, because their colours hold their light; \
                 remove it"
            ));
        }
        Ok(Some((model, path)))
    }
}

/// The file of a model, if it comes from one.
fn path(model: &Model) -> Option<&Path> {
    match &model.source {
        Source::File { path, .. } => Some(path),
        Source::Shape { .. } | Source::Tree { .. } => None,
    }
}

/// The key of a choice that applies to surfels only, if the model has one.
fn choice_of_surfels(model: &Model) -> Option<&'static str> {
    let Source::File { radius, prefix, texture, color_range, color_by, .. } = &model.source else {
        return None;
    };
    let choices = [
        (radius.is_some(), "radius"),
        (prefix.is_some(), "prefix"),
        (texture.is_some(), "texture"),
        (color_range.is_some(), "color_range"),
        (color_by.is_some(), "color_by"),
        (model.draw != Draw::Surfels, "draw"),
        (model.color.is_some(), "color"),
        (model.opacity.is_some(), "opacity"),
        (model.mipmaps.is_some(), "mipmaps"),
        (model.progressive, "progressive` or `surfel_size"),
    ];
    choices.into_iter().find_map(|(given, key)| given.then_some(key))
}

impl Loaded {
    /// Reads the Gaussians of the model that [`SceneFile::gaussians`] found.
    pub(super) fn read_gaussians(&mut self, model: &Model, path: &Path) -> Result<()> {
        let gaussians::GaussianFile { mut arrays, offset: own, convention, warnings } =
            gaussians::read(path)?;
        let reach = || offset::greatest(arrays.position.iter());
        let shared = offset::of_model(model, own, reach).unwrap_or_default();
        self.move_to(shared);
        place(&mut arrays, &offset::moved(model, own, shared).transform);
        let (gaussians, dropped) = Gaussians::new(arrays).map_err(|error| match error {
            Error::Invalid(what) => Error::format(path, what),
            other => other,
        })?;
        self.scene.gaussians = Some(gaussians);
        self.scene.lights = Vec::new();
        self.gaussians = Some(GaussianReport { convention, dropped });
        self.warnings =
            warnings.into_iter().map(|what| Error::format(path, what).to_string()).collect();
        Ok(())
    }
}
