//! From text to a [`SceneFile`].
//!
//! Each table is read into a struct that mirrors its keys and then converted; a conversion that
//! fails is reported by serde at the table's place in the text.

mod exactly;
mod table;

use super::{
    CameraChoice, DEFAULT_COUNT, Draw, EnvironmentChoice, GroupChoice, MethodChoice, Model,
    OutputSettings, SceneFile, Source, TREE, check_opacity, shapes, stem,
};
use crate::error::{Error, Result};
use crate::io::input;
use crate::scene::light::{MAX_RADIANCE, is_color};
use crate::scene::transform::{self, Similarity};
use crate::scene::{Lens, Light, Phong};
use crate::source::{Shape, plant};
use exactly::Exactly;
use glam::{DMat3, DVec3, Vec3};
use serde::de::{self, Deserialize, Deserializer};
use std::path::{Path, PathBuf};

pub(super) fn parse(text: &str, path: &Path) -> Result<SceneFile> {
    let file: File = toml::from_str(text).map_err(|error| input::no_toml(path, text, &error))?;
    if file.model.is_empty() {
        let what = "there is no [[model]]: name a file or a shape";
        return Err(Error::format(path, what));
    }
    // Joining keeps a path that is absolute.
    let beside = |other: &Path| path.parent().unwrap_or(Path::new("")).join(other);
    let mut models = file.model;
    for model in &mut models {
        if let Source::File { path: model, .. } = &mut model.source {
            *model = beside(model);
        }
    }
    let mut environment = file.environment;
    if let Some(EnvironmentChoice::File(map)) = &mut environment {
        *map = beside(map);
    }
    Ok(SceneFile {
        name: stem(path),
        models,
        camera: file.camera,
        lights: file.light.unwrap_or_else(|| vec![Light::DEFAULT]),
        material: file.material,
        environment,
        method: file.method,
        groups: file.groups,
        output: file.output,
    })
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    model: Vec<Model>,
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

through! {
    Model: RawModel, RawModel::model;
    CameraChoice: RawCamera, RawCamera::choice;
    Light: RawLight, RawLight::light;
    Phong: RawMaterial, RawMaterial::material;
    EnvironmentChoice: RawEnvironment, RawEnvironment::choice;
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawModel {
    file: Option<PathBuf>,
    radius: Option<f32>,
    draw: Option<String>,
    split: Option<Exactly<f64, 4>>,
    shape: Option<String>,
    square: Option<f32>,
    gap: Option<f32>,
    step: Option<f32>,
    thickness: Option<f32>,
    count: Option<usize>,
    leaves: Option<usize>,
    seed: Option<u64>,
    color: Option<Exactly<f32, 3>>,
    opacity: Option<f32>,
    #[serde(default)]
    transform: RawTransform,
}

impl RawModel {
    fn model(mut self) -> std::result::Result<Model, String> {
        let source = self.source()?;
        let draw = Draw::choose(self.draw.as_deref(), self.split.map(|split| split.0), &source)?;
        let without = matches!(draw, Draw::Polygons | Draw::Facets);
        if without && matches!(source, Source::File { radius: Some(_), .. }) {
            return Err(format!("`radius` means nothing to {}: remove it", draw.word()));
        }
        if let Some(key) = self.left() {
            let of = match &source {
                Source::File { .. } => "a file",
                Source::Shape { shape, .. } => shape.name(),
                Source::Tree { .. } => TREE,
            };
            return Err(format!("`{key}` means nothing to {of}: remove it"));
        }
        let color = self.color.map(|color| Vec3::from_array(color.0));
        if !color.is_none_or(is_color) {
            return Err(format!("color must be three numbers in [0, {MAX_RADIANCE}]"));
        }
        if let Some(opacity) = self.opacity {
            check_opacity(opacity).map_err(|error| error.to_string())?;
        }
        let (transform, opacity) = (self.transform.similarity()?, self.opacity);
        Ok(Model { source, draw, transform, color, opacity })
    }

    /// The source; takes every key that it uses.
    fn source(&mut self) -> std::result::Result<Source, String> {
        match (self.file.take(), self.shape.take()) {
            (Some(path), None) => Ok(Source::File { path, radius: self.radius.take() }),
            (None, Some(name)) if name == TREE => {
                let leaves = self.leaves.take().unwrap_or(plant::LEAVES);
                Ok(Source::Tree { leaves, seed: self.seed.take().unwrap_or(0) })
            }
            (None, Some(name)) => {
                let shape = Shape::by_name(&name)
                    .ok_or_else(|| format!("shape `{name}`; give one of {}", shapes()))?;
                let shape = self.parameters(shape);
                let count = self.count.take().unwrap_or(DEFAULT_COUNT);
                Ok(Source::Shape { shape, count, seed: self.seed.take().unwrap_or(0) })
            }
            _ => Err("a model is either a `file` or a `shape`".into()),
        }
    }

    /// A key that was given and that the source has not taken.
    fn left(&self) -> Option<&'static str> {
        let keys = [
            ("radius", self.radius.is_some()),
            ("square", self.square.is_some()),
            ("gap", self.gap.is_some()),
            ("step", self.step.is_some()),
            ("thickness", self.thickness.is_some()),
            ("count", self.count.is_some()),
            ("leaves", self.leaves.is_some()),
            ("seed", self.seed.is_some()),
        ];
        keys.iter().find(|(_, is_left)| *is_left).map(|(key, _)| *key)
    }

    /// The shape with the parameters that were given for it.
    fn parameters(&mut self, mut shape: Shape) -> Shape {
        let given = |parameter: &mut f32, key: &mut Option<f32>| {
            *parameter = key.take().unwrap_or(*parameter);
        };
        match &mut shape {
            Shape::Sphere | Shape::Torus | Shape::Cluster => {}
            Shape::Checkerboard { square } => given(square, &mut self.square),
            Shape::Sheets { gap } => given(gap, &mut self.gap),
            Shape::Staircase { step, thickness } => {
                given(step, &mut self.step);
                given(thickness, &mut self.thickness);
            }
        }
        shape
    }
}

#[derive(serde::Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawTransform {
    scale: Option<f64>,
    rotate: Option<RawRotation>,
    translate: Option<Exactly<f64, 3>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRotation {
    axis: Option<Exactly<f64, 3>>,
    degrees: Option<f64>,
    matrix: Option<Exactly<Exactly<f64, 3>, 3>>,
}

impl RawTransform {
    fn similarity(self) -> std::result::Result<Similarity, String> {
        let rotation = match self.rotate {
            None => DMat3::IDENTITY,
            Some(RawRotation { axis: Some(axis), degrees: Some(degrees), matrix: None }) => {
                let axis = DVec3::from_array(axis.0);
                if !(axis.length() > 0.0 && axis.is_finite() && degrees.is_finite()) {
                    return Err("rotate: axis must not be 0, nor any number infinite".into());
                }
                transform::rotation(axis, degrees)
            }
            Some(RawRotation { axis: None, degrees: None, matrix: Some(rows) }) => {
                DMat3::from_cols_array_2d(&rows.0.map(|row| row.0)).transpose()
            }
            Some(_) => return Err("rotate: give axis and degrees, or a matrix".into()),
        };
        let similarity = Similarity {
            rotation,
            scale: self.scale.unwrap_or(1.0),
            translation: self.translate.map_or(DVec3::ZERO, |by| by.0.into()),
        };
        similarity.check().map_err(|error| error.to_string())?;
        Ok(similarity)
    }
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCamera {
    size: Option<Exactly<u32, 2>>,
    eye: Option<Exactly<f64, 3>>,
    target: Option<Exactly<f64, 3>>,
    up: Option<Exactly<f64, 3>>,
    fov: Option<f64>,
    focal: Option<f64>,
    ortho: Option<f64>,
}

impl RawCamera {
    fn choice(self) -> std::result::Result<CameraChoice, String> {
        let lenses = [
            self.fov.map(Lens::FieldOfView),
            self.focal.map(Lens::Focal),
            self.ortho.map(Lens::Orthographic),
        ];
        let mut lenses = lenses.into_iter().flatten();
        let lens = lenses.next();
        if lenses.next().is_some() {
            return Err("camera: give one of fov, focal and ortho".into());
        }
        let vector = |v: Option<Exactly<f64, 3>>| v.map(|v| DVec3::from_array(v.0));
        Ok(CameraChoice {
            size: self.size.map(|size| size.0),
            eye: vector(self.eye),
            target: vector(self.target),
            up: vector(self.up),
            lens,
        })
    }
}

#[derive(serde::Deserialize)]
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
}

#[derive(serde::Deserialize)]
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
}

#[derive(serde::Deserialize)]
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
}
