//! Write a scene file as text.

use super::super::{CameraChoice, OutputSettings, SceneFile};
use super::camera::RawCamera;
use super::model::RawModel;
use super::object::RawObject;
use super::table::Written;
use super::{RawEnvironment, RawLight, RawMaterial, RawRefinement, RawSequence};
use crate::error::{Error, Result};
use crate::method::Method;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Light, Phong};
use crate::setting::Fields;
use std::path::{Path, PathBuf, absolute};

/// The tables of a file, in the order of the example.
#[derive(serde::Serialize)]
struct Tables {
    hierarchy: Option<PathBuf>,
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
    let tables = Tables::of(file, &Folder::of(path)?)?;
    toml::to_string(&tables)
        .map_err(|error| Error::Invalid(format!("TOML cannot say the scene: {error}")))
}

impl Tables {
    fn of(file: &SceneFile, place: &Folder) -> Result<Self> {
        let SceneFile { name: _, frame: _, hierarchy, models, geometries, objects, .. } = file;
        let SceneFile { refinement, camera, lights, material, environment, .. } = file;
        let method = file.method.method()?;
        let default = Method::by_name(method.name())?.values();
        let groups = file.grouping(&method)?;
        let output = file.output;
        let objects = objects.iter().map(|object| RawObject::of(object, geometries, place));
        Ok(Self {
            hierarchy: hierarchy.as_deref().map(|folder| place.path(folder)),
            model: some(models.iter().map(|model| RawModel::of(model, place))),
            geometry: some(geometries.iter().map(|one| RawModel::of_geometry(one, place))),
            object: some(objects),
            sequence: (file.frames > 1).then_some(RawSequence { frames: file.frames }),
            refinement: (*refinement != Refinement::default())
                .then(|| RawRefinement::of(refinement)),
            camera: (*camera != CameraChoice::default()).then(|| RawCamera::of(camera)),
            light: (lights[..] != [Light::DEFAULT])
                .then(|| lights.iter().map(RawLight::of).collect()),
            material: (*material != Phong::default()).then(|| RawMaterial::of(material)),
            environment: environment.as_ref().map(|choice| RawEnvironment::of(choice, place)),
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

/// The folder that the file is written to.
pub(super) struct Folder(PathBuf);

impl Folder {
    fn of(path: &Path) -> Result<Self> {
        let whole = absolute(path).map_err(|source| Error::io(path, source))?;
        Ok(Self(whole.parent().unwrap_or(&whole).to_owned()))
    }

    /// The path of another file in the text: relative if it lies in the folder or below, else
    /// absolute.
    pub(super) fn path(&self, other: &Path) -> PathBuf {
        let whole = absolute(other).unwrap_or_else(|_| other.to_owned());
        whole.strip_prefix(&self.0).map(Path::to_owned).unwrap_or(whole)
    }
}
