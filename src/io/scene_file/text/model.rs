//! Parse and write models and geometries.

use super::exactly::Exactly;
use super::folder::Folder;
use super::transform::RawTransform;
use crate::io::scene_file::{DEFAULT_COUNT, Draw, Geometry, Model, Source, TREE};
use crate::io::scene_file::{check_mipmaps, check_opacity, check_prefix, shapes};
use crate::scene::light::{MAX_RADIANCE, is_color};
use crate::scene::objects::detail::tree::MOST_PIXELS;
use crate::source::{Shape, plant};
use glam::Vec3;
use std::path::PathBuf;

/// A model, or a geometry.
#[derive(Default, serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawModel {
    name: Option<String>,
    detail: Option<f64>,
    file: Option<PathBuf>,
    radius: Option<f32>,
    prefix: Option<usize>,
    texture: Option<PathBuf>,
    color_range: Option<f64>,
    color_by: Option<String>,
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
    mipmaps: Option<usize>,
    #[serde(default)]
    progressive: Option<bool>,
    transform: Option<RawTransform>,
}

impl RawModel {
    pub(super) fn geometry(mut self) -> Result<Geometry, String> {
        let name =
            self.name.take().ok_or("a geometry needs a `name`, because objects refer to it")?;
        let detail = self.detail.take();
        if let Some(pixels) = detail.filter(|pixels| !(0.0..=MOST_PIXELS).contains(pixels)) {
            return Err(format!("detail is {pixels} pixels; give 0 to {MOST_PIXELS}"));
        }
        if detail.is_some() && self.progressive == Some(true) {
            return Err(
                "`detail` and `progressive` are two kinds of levels of detail; remove one".into()
            );
        }
        let geometry = Geometry { name, detail, model: self.model()? };
        if geometry.files()?.is_some() && detail.is_some() {
            let what = "`detail` is made of one file, but this geometry has one for each frame; remove \
                        `detail`, or name one file";
            return Err(what.into());
        }
        Ok(geometry)
    }

    pub(super) fn model(mut self) -> Result<Model, String> {
        let source = self.source()?;
        let draw = Draw::choose(self.draw.as_deref(), self.split.map(|split| split.0), &source)?;
        let without = matches!(draw, Draw::Polygons | Draw::Facets);
        if without && matches!(source, Source::File { radius: Some(_), .. }) {
            return Err(format!("`radius` does not apply to {}: remove it", draw.word()));
        }
        if let Some(key) = self.left() {
            let of = match &source {
                Source::File { .. } => "a file",
                Source::Shape { shape, .. } => shape.name(),
                Source::Tree { .. } => TREE,
            };
            return Err(format!("`{key}` does not apply to {of}: remove it"));
        }
        let color = self.color.map(color).transpose()?;
        if let Some(opacity) = self.opacity {
            check_opacity(opacity).map_err(|error| error.to_string())?;
        }
        if let Some(levels) = self.mipmaps {
            check_mipmaps(levels).map_err(|error| error.to_string())?;
        }
        let (transform, opacity, mipmaps) =
            (self.transform.unwrap_or_default().similarity()?, self.opacity, self.mipmaps);
        let progressive = self.progressive.unwrap_or(false);
        Ok(Model { source, draw, transform, color, opacity, mipmaps, progressive })
    }

    pub(super) fn of_geometry(geometry: &Geometry, place: &Folder) -> Self {
        let Geometry { name, detail, model } = geometry;
        Self { name: Some(name.clone()), detail: *detail, ..Self::from_model(model, place) }
    }

    pub(super) fn from_model(model: &Model, place: &Folder) -> Self {
        let Model { ref source, draw, transform, color, opacity, mipmaps, progressive } = *model;
        let split = match draw {
            Draw::Hybrid(half) => Some(Exactly(half.numbers())),
            _ => None,
        };
        Self {
            draw: (draw != Draw::default_for(source)).then(|| draw.word().into()),
            split,
            color: color.map(|color| Exactly(color.to_array())),
            opacity,
            mipmaps,
            progressive: progressive.then_some(true),
            transform: RawTransform::from_similarity(&transform),
            ..Self::of_source(source, place)
        }
    }

    fn of_source(source: &Source, place: &Folder) -> Self {
        match *source {
            Source::File { ref path, radius, prefix, ref texture, color_range, ref color_by } => {
                Self {
                    file: Some(place.path(path)),
                    radius,
                    prefix,
                    texture: texture.as_deref().map(|texture| place.path(texture)),
                    color_range,
                    color_by: color_by.clone(),
                    ..Self::default()
                }
            }
            Source::Tree { leaves, seed } => Self {
                shape: Some(TREE.into()),
                leaves: Some(leaves),
                seed: Some(seed),
                ..Self::default()
            },
            Source::Shape { shape, count, seed } => Self {
                shape: Some(shape.name().into()),
                count: Some(count),
                seed: Some(seed),
                ..Self::of_parameters(shape)
            },
        }
    }

    fn of_parameters(shape: Shape) -> Self {
        let none = Self::default();
        match shape {
            Shape::Sphere | Shape::Torus | Shape::Cluster => none,
            Shape::Checkerboard { square } => Self { square: Some(square), ..none },
            Shape::Sheets { gap } => Self { gap: Some(gap), ..none },
            Shape::Staircase { step, thickness } => {
                Self { step: Some(step), thickness: Some(thickness), ..none }
            }
        }
    }

    /// The source; takes every key that it uses, so that `left` finds the rest.
    fn source(&mut self) -> Result<Source, String> {
        match (self.file.take(), self.shape.take()) {
            (Some(path), None) => {
                let (radius, prefix) = (self.radius.take(), self.prefix.take());
                if let Some(points) = prefix {
                    check_prefix(points).map_err(|error| error.to_string())?;
                }
                let color_range = self.color_range.take();
                if let Some(range) =
                    color_range.filter(|range| !(*range > 0.0 && range.is_finite()))
                {
                    return Err(format!(
                        "color_range is {range}; give the code of white, such as 255"
                    ));
                }
                let (texture, color_by) = (self.texture.take(), self.color_by.take());
                Ok(Source::File { path, radius, prefix, texture, color_range, color_by })
            }
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

    /// A given key that the source has not taken.
    fn left(&self) -> Option<&'static str> {
        let keys = [
            ("name", self.name.is_some()),
            ("detail", self.detail.is_some()),
            ("radius", self.radius.is_some()),
            ("prefix", self.prefix.is_some()),
            ("texture", self.texture.is_some()),
            ("color_range", self.color_range.is_some()),
            ("color_by", self.color_by.is_some()),
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

/// A colour for a whole model or object.
pub(super) fn color(color: Exactly<f32, 3>) -> Result<Vec3, String> {
    let color = Vec3::from_array(color.0);
    let refused = || format!("color must be three numbers in [0, {MAX_RADIANCE}]");
    is_color(color).then_some(color).ok_or_else(refused)
}
