//! Parse and write places and rotations.

use super::exactly::Exactly;
use crate::scene::transform::{self, Similarity};
use glam::{DMat3, DVec3};

#[derive(Default, serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTransform {
    pub(super) scale: Option<f64>,
    pub(super) rotate: Option<RawRotation>,
    pub(super) translate: Option<Exactly<f64, 3>>,
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRotation {
    axis: Option<Exactly<f64, 3>>,
    degrees: Option<f64>,
    matrix: Option<Exactly<Exactly<f64, 3>, 3>>,
}

impl RawTransform {
    pub(super) fn similarity(self) -> Result<Similarity, String> {
        let rotation = match self.rotate {
            None => DMat3::IDENTITY,
            Some(RawRotation { axis: Some(axis), degrees: Some(degrees), matrix: None }) => {
                let axis = DVec3::from_array(axis.0);
                if !(transform::is_axis(axis) && degrees.is_finite()) {
                    return Err("rotate: axis must be finite and not 0".into());
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

    /// `None` for the identity.
    pub(super) fn from_similarity(similarity: &Similarity) -> Option<Self> {
        let Similarity { rotation, scale, translation } = *similarity;
        let rows = Exactly(rotation.transpose().to_cols_array_2d().map(Exactly));
        let matrix = RawRotation { axis: None, degrees: None, matrix: Some(rows) };
        (*similarity != Similarity::IDENTITY).then(|| Self {
            scale: (scale != 1.0).then_some(scale),
            rotate: (rotation != DMat3::IDENTITY).then_some(matrix),
            translate: (translation != DVec3::ZERO).then(|| Exactly(translation.to_array())),
        })
    }
}
