//! Parse the text of a [`SceneFile`], and write it.
//!
//! Each table is read into a struct that mirrors its keys, and then converted. If the conversion
//! fails, serde reports the table's place in the text. Writing uses the same structs.

/// Implements `Deserialize` through a struct that mirrors the keys.
macro_rules! through {
    ($($target:ty: $raw:ty, $convert:expr;)*) => {$(
        impl<'de> Deserialize<'de> for $target {
            fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
                let convert: fn($raw) -> std::result::Result<$target, String> = $convert;
                <$raw>::deserialize(from).and_then(|raw| convert(raw).map_err(de::Error::custom))
            }
        }
    )*};
}

mod camera;
mod exactly;
mod folder;
mod model;
mod object;
pub(super) mod projection;
mod table;
mod transform;
mod written;

pub(super) use written::write;

use super::{
    CameraChoice, EnvironmentChoice, Geometry, GroupChoice, MOST_FRAMES, MethodChoice, Model,
    OutputSettings, Places, SceneFile, Source, stem,
};
use crate::error::{Error, Result};
use crate::io::input;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Light, Phong};
use camera::RawCamera;
use exactly::Exactly;
use folder::Folder;
use glam::Vec3;
use model::RawModel;
use object::Unresolved;
use serde::de::{self, Deserialize, Deserializer};
use std::path::{Path, PathBuf};

/// The camera of a table with the keys of `[camera]`.
pub(super) fn parse_camera(camera: toml::Value, path: &Path) -> Result<CameraChoice> {
    camera.try_into().map_err(|error: toml::de::Error| {
        Error::format(path, error.message().trim().replace('\n', " "))
    })
}

pub(super) fn parse(text: &str, path: &Path) -> Result<SceneFile> {
    input::ask_for_toml(path, text)?;
    let file: File = toml::from_str(text).map_err(|error| input::no_toml(path, text, &error))?;
    for (i, geometry) in file.geometry.iter().enumerate() {
        if file.geometry[..i].iter().any(|other| other.name == geometry.name) {
            let what = format!("two [[geometry]] have the name `{}`; rename one", geometry.name);
            return Err(Error::format(path, what));
        }
    }
    let models = file.model.len() + file.geometry.len() + file.object.len();
    if file.hierarchy.is_some() && models > 0 {
        let what = "a hierarchy cannot be combined with models or objects; remove one";
        return Err(Error::format(path, what));
    }
    // Geometries alone draw nothing.
    if file.hierarchy.is_none() && file.model.is_empty() && file.object.is_empty() {
        let what = match file.geometry.as_slice() {
            [] => "no [[model]]; name a file or a shape",
            _ => "no [[object]] and no [[model]]; a geometry is drawn only where an object uses it",
        };
        return Err(Error::format(path, what));
    }
    let objects = object::resolve(file.object, &file.geometry).map_err(|(at, what)| {
        Error::format(path, format!("line {}: {what}", input::line(text, at)))
    })?;
    let (mut models, mut geometries, mut objects) = (file.model, file.geometry, objects);
    // `join` keeps an absolute path as it is.
    let beside = |other: &Path| path.parent().unwrap_or(Path::new("")).join(other);
    for model in models.iter_mut().chain(geometries.iter_mut().map(|geometry| &mut geometry.model))
    {
        if let Source::File { path: model, texture, .. } = &mut model.source {
            *model = beside(model);
            texture.iter_mut().for_each(|texture| *texture = beside(texture));
        }
    }
    for object in &mut objects {
        if let Places::Table { path: table, .. } = &mut object.places {
            *table = beside(table);
        }
    }
    let (mut environment, mut camera) = (file.environment, file.camera);
    if let Some(EnvironmentChoice::File(map)) = &mut environment {
        *map = beside(map);
    }
    camera.views.iter_mut().for_each(|views| views.path = beside(&views.path));
    Ok(SceneFile {
        name: stem(path),
        hierarchy: file.hierarchy.as_deref().map(beside),
        models,
        geometries,
        objects,
        frames: file.sequence.0,
        frame: 0,
        refinement: file.refinement,
        camera,
        lights: file.light.unwrap_or_else(|| vec![Light::DEFAULT]),
        material: file.material,
        environment,
        surface: file.surface.as_deref().map(beside),
        method: file.method,
        groups: file.groups,
        output: file.output,
    })
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    hierarchy: Option<PathBuf>,
    surface: Option<PathBuf>,
    #[serde(default)]
    model: Vec<Model>,
    #[serde(default)]
    geometry: Vec<Geometry>,
    #[serde(default)]
    object: Vec<Unresolved>,
    #[serde(default)]
    sequence: Sequence,
    #[serde(default)]
    refinement: Refinement,
    #[serde(default)]
    camera: CameraChoice,
    light: Option<Vec<Light>>,
    #[serde(default)]
    material: Phong,
    environment: Option<EnvironmentChoice>,
    #[serde(default, deserialize_with = "table::method")]
    method: MethodChoice,
    #[serde(default, deserialize_with = "table::groups")]
    groups: GroupChoice,
    #[serde(default, deserialize_with = "table::output")]
    output: OutputSettings,
}

through! {
    Model: RawModel, RawModel::model;
    Geometry: RawModel, RawModel::geometry;
    Sequence: RawSequence, RawSequence::sequence;
    Refinement: RawRefinement, RawRefinement::refinement;
    CameraChoice: RawCamera, RawCamera::choice;
    Light: RawLight, RawLight::light;
    Phong: RawMaterial, RawMaterial::material;
    EnvironmentChoice: RawEnvironment, RawEnvironment::choice;
}

/// The number of frames.
struct Sequence(u32);

impl Default for Sequence {
    fn default() -> Self {
        Self(1)
    }
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawSequence {
    frames: u32,
}

impl RawSequence {
    fn sequence(self) -> std::result::Result<Sequence, String> {
        if (1..=MOST_FRAMES).contains(&self.frames) {
            return Ok(Sequence(self.frames));
        }
        Err(format!("a sequence of {} frames; give 1 to {MOST_FRAMES}", self.frames))
    }
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawRefinement {
    surfel_size: Option<f32>,
    budget: Option<u32>,
    #[serde(default)]
    zones: Vec<Exactly<f32, 2>>,
}

impl RawRefinement {
    fn refinement(self) -> std::result::Result<Refinement, String> {
        let surfel_size = self.surfel_size.unwrap_or(Refinement::default().surfel_size);
        let zones = self.zones.into_iter().map(|zone| zone.0).collect();
        let refinement = Refinement { surfel_size, budget: self.budget, zones };
        refinement.check().map(|()| refinement).map_err(|error| error.to_string())
    }

    fn from_refinement(refinement: &Refinement) -> Self {
        let Refinement { surfel_size, budget, ref zones } = *refinement;
        let zones = zones.iter().map(|zone| Exactly(*zone)).collect();
        Self { surfel_size: Some(surfel_size), budget, zones }
    }
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
enum RawLight {
    Directional {
        towards: Exactly<f32, 3>,
        #[serde(default = "white")]
        color: Exactly<f32, 3>,
    },
    Headlight {
        towards: Exactly<f32, 3>,
        #[serde(default = "white")]
        color: Exactly<f32, 3>,
    },
    Point {
        position: Exactly<f32, 3>,
        #[serde(default = "white")]
        color: Exactly<f32, 3>,
    },
}

fn white() -> Exactly<f32, 3> {
    Exactly([1.0; 3])
}

impl RawLight {
    fn light(self) -> std::result::Result<Light, String> {
        let light = match self {
            Self::Directional { towards, color } => {
                Light::Directional { towards: towards.0.into(), color: color.0.into() }
            }
            Self::Headlight { towards, color } => {
                Light::Headlight { towards: towards.0.into(), color: color.0.into() }
            }
            Self::Point { position, color } => {
                Light::Point { position: position.0.into(), color: color.0.into() }
            }
        };
        light.check().map(|()| light).map_err(|error| error.to_string())
    }

    fn from_light(light: &Light) -> Self {
        let array = |v: Vec3| Exactly(v.to_array());
        match *light {
            Light::Directional { towards, color } => {
                Self::Directional { towards: array(towards), color: array(color) }
            }
            Light::Headlight { towards, color } => {
                Self::Headlight { towards: array(towards), color: array(color) }
            }
            Light::Point { position, color } => {
                Self::Point { position: array(position), color: array(color) }
            }
        }
    }
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawMaterial {
    ambient: Option<f32>,
    diffuse: Option<f32>,
    specular: Option<f32>,
    shininess: Option<f32>,
    color: Option<Exactly<f32, 3>>,
}

impl RawMaterial {
    fn material(self) -> std::result::Result<Phong, String> {
        let default = Phong::default();
        let material = Phong {
            ambient: self.ambient.unwrap_or(default.ambient),
            diffuse: self.diffuse.unwrap_or(default.diffuse),
            specular: self.specular.unwrap_or(default.specular),
            shininess: self.shininess.unwrap_or(default.shininess),
            color: self.color.map_or(default.color, |color| color.0.into()),
        };
        material.check().map(|()| material).map_err(|error| error.to_string())
    }

    fn from_material(material: &Phong) -> Self {
        let Phong { ambient, diffuse, specular, shininess, color } = *material;
        Self {
            ambient: Some(ambient),
            diffuse: Some(diffuse),
            specular: Some(specular),
            shininess: Some(shininess),
            color: Some(Exactly(color.to_array())),
        }
    }
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawEnvironment {
    file: Option<PathBuf>,
    sky: Option<bool>,
}

impl RawEnvironment {
    fn choice(self) -> std::result::Result<EnvironmentChoice, String> {
        match (self.file, self.sky) {
            (Some(path), None) => Ok(EnvironmentChoice::File(path)),
            (None, Some(true)) => Ok(EnvironmentChoice::Sky),
            _ => Err("environment: give either a `file` or `sky = true`".into()),
        }
    }

    fn from_choice(environment: &EnvironmentChoice, place: &Folder) -> Self {
        match environment {
            EnvironmentChoice::Sky => Self { file: None, sky: Some(true) },
            EnvironmentChoice::File(path) => Self { file: Some(place.path(path)), sky: None },
        }
    }
}
