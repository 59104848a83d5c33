//! Parse the text of a part that holds the projection alone.

use super::exactly::Exactly;
use super::table;
use crate::error::{Error, Result};
use crate::io::scene_file::{CameraChoice, MethodChoice};
use crate::scene::{Light, Phong};

/// What the stages after the projection need of the text, which has other entries too.
#[derive(serde::Deserialize)]
pub(in crate::io::scene_file) struct PartText {
    pub(in crate::io::scene_file) splatref: String,
    pub(in crate::io::scene_file) number: String,
    storage: Option<String>,
    scene: RawScene,
    #[serde(deserialize_with = "table::method")]
    pub(in crate::io::scene_file) method: MethodChoice,
    pub(in crate::io::scene_file) camera: CameraChoice,
    pub(in crate::io::scene_file) projection: RawProjection,
    #[serde(default)]
    pub(in crate::io::scene_file) light: Vec<Light>,
    pub(in crate::io::scene_file) material: Phong,
}

#[derive(serde::Deserialize)]
struct RawScene {
    offset: Option<Exactly<f64, 3>>,
}

/// The table that [`crate::io::provenance::text_of_projection`] describes.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::io::scene_file) struct RawProjection {
    pub(in crate::io::scene_file) stages: bool,
    pub(in crate::io::scene_file) colors: bool,
    pub(in crate::io::scene_file) tangents: bool,
    pub(in crate::io::scene_file) environment: bool,
}

impl PartText {
    pub(in crate::io::scene_file) fn parse(text: &str) -> Result<Self> {
        toml::from_str(text).map_err(|error| {
            let what = error.message().trim().replace('\n', " ");
            Error::Invalid(format!("the text of the parts: {what}; render the parts again"))
        })
    }

    /// What was subtracted from the coordinates of the files.
    pub(in crate::io::scene_file) fn offset(&self) -> glam::DVec3 {
        self.scene.offset.map_or(glam::DVec3::ZERO, |offset| offset.0.into())
    }

    /// Whether all numbers are `f32`, as the stages after the projection need them.
    pub(in crate::io::scene_file) fn is_single(&self) -> bool {
        self.number == "f32" && self.storage.is_none()
    }
}
