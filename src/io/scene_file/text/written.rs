//! Write a scene file as text.

use super::super::{CameraChoice, OutputSettings, SceneFile};
use super::camera::RawCamera;
use super::folder::Folder;
use super::model::RawModel;
use super::object::RawObject;
use super::table::Written;
use super::{RawEnvironment, RawLight, RawMaterial, RawRefinement, RawSequence};
use crate::error::{Error, Result};
use crate::method::Method;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Light, Phong};
use crate::setting::Fields;
use std::path::{Path, PathBuf};

/// The tables of a file, in the order of the example.
#[derive(serde::Serialize)]
struct Tables {
    hierarchy: Option<PathBuf>,
    surface: Option<PathBuf>,
    model: Option<Vec<RawModel>>,
    geometry: Option<Vec<RawModel>>,
    object: Option<Vec<RawObject>>,
    sequence: Option<RawSequence>,
    refinement: Option<RawRefinement>,
    camera: Option<RawCamera>,
    light: Option<Vec<RawLight>>,
    material: Option<RawMaterial>,
    environment: Option<RawEnvironment>,
    method: Written,
    groups: Option<Written>,
    output: Option<Written>,
}

/// Writes the text of a file at `path`, see [`SceneFile::text`].
pub(in crate::io::scene_file) fn write(file: &SceneFile, path: &Path) -> Result<String> {
    let tables = Tables::from_file(file, &Folder::containing(path)?)?;
    toml::to_string(&tables)
        .map_err(|error| Error::Invalid(format!("the scene cannot be written as TOML: {error}")))
}

impl Tables {
    fn from_file(file: &SceneFile, place: &Folder) -> Result<Self> {
        let SceneFile { name: _, frame: _, hierarchy, models, geometries, objects, .. } = file;
        let SceneFile { refinement, camera, lights, material, environment, .. } = file;
        let method = file.method.method()?;
        let default = Method::by_name(method.name())?.values();
        let groups = file.grouping(&method)?;
        let output = file.output;
        let objects =
            objects.iter().map(|object| RawObject::from_object(object, geometries, place));
        Ok(Self {
            hierarchy: hierarchy.as_deref().map(|folder| place.path(folder)),
            surface: file.surface.as_deref().map(|exr| place.path(exr)),
            model: some(models.iter().map(|model| RawModel::from_model(model, place))),
            geometry: some(geometries.iter().map(|one| RawModel::of_geometry(one, place))),
            object: some(objects),
            sequence: (file.frames > 1).then_some(RawSequence { frames: file.frames }),
            refinement: (*refinement != Refinement::default())
                .then(|| RawRefinement::from_refinement(refinement)),
            camera: (*camera != CameraChoice::default())
                .then(|| RawCamera::from_choice(camera, place)),
            light: (lights[..] != [Light::DEFAULT])
                .then(|| lights.iter().map(RawLight::from_light).collect()),
            material: (*material != Phong::default()).then(|| RawMaterial::from_material(material)),
            environment: environment
                .as_ref()
                .map(|choice| RawEnvironment::from_choice(choice, place)),
            method: Written {
                name: Some(method.name()),
                settings: other_than(method.values(), &default),
            },
            groups: groups.map(|groups| Written { name: None, settings: groups.values() }),
            output: (output != OutputSettings::default()).then(|| Written {
                name: None,
                settings: other_than(output.values(), &OutputSettings::default().values()),
            }),
        })
    }
}

/// An array, if it is not empty.
fn some<T>(all: impl Iterator<Item = T>) -> Option<Vec<T>> {
    let all: Vec<T> = all.collect();
    (!all.is_empty()).then_some(all)
}

/// The values that differ from their defaults.
fn other_than<T: PartialEq>(values: Vec<T>, default: &[T]) -> Vec<T> {
    values.into_iter().filter(|value| !default.contains(value)).collect()
}
