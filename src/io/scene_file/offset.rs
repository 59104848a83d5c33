//! Give all files of a scene one offset, so that map coordinates fit `f32`.
//!
//! The reader of a PLY may subtract an offset from the positions of a file, see [`crate::io::ply`].
//! A scene has one offset for everything: the place to which the offset of its first such model goes
//! by the transform of that model. Along an axis where this place is less than 8 times as far from 0
//! as the model reaches, the offset is 0, because the transform itself has moved the model there.
//! What was read with another offset, or with none, is moved by the difference in f64, together with
//! the transform of its model, and rounded to `f32` once.
//!
//! The camera and point lights of the scene file are in the coordinates of the files; the offset is
//! subtracted from them too. `Decided:` a scene of objects has no offset, because its places are
//! displacements.

use super::Model;
use super::model::ModelParts;
use crate::number::Real;
use crate::scene::Similarity;
use glam::{DVec3, Vec3};

/// See the module.
const FAR: f64 = 8.0;

/// The offset of a scene of these models.
pub(super) fn shared<'a>(all: impl IntoIterator<Item = (&'a Model, &'a ModelParts)>) -> DVec3 {
    let of = |(model, parts): (&Model, &ModelParts)| of_model(model, parts.offset, || reach(parts));
    all.into_iter().find_map(of).unwrap_or_default()
}

/// The offset of a scene that begins with a model, which was read with its `own` offset and then
/// reaches so far from 0. `None` if it was read without one.
pub(super) fn of_model(model: &Model, own: DVec3, reach: impl Fn() -> f64) -> Option<DVec3> {
    if own == DVec3::ZERO {
        return None;
    }
    let place = place(model, own);
    let reach = reach() * model.transform.scale;
    let far = |value: f64| if value.abs() >= FAR * reach { value } else { 0.0 };
    Some(DVec3::new(far(place.x), far(place.y), far(place.z)))
}

/// Where the transform of a model moves its offset.
fn place(model: &Model, offset: DVec3) -> DVec3 {
    let Similarity { rotation, scale, translation } = model.transform;
    match model.transform == Similarity::IDENTITY {
        true => offset,
        false => rotation * (offset * scale) + translation,
    }
}

/// The greatest coordinate of what was read.
fn reach(parts: &ModelParts) -> f64 {
    let surfels = parts.surfels.position().iter();
    let primitives = &parts.primitives;
    let lines = [&primitives.ribbons, &primitives.tubes];
    let lines = lines.into_iter().flat_map(|lines| &lines.vertices().position);
    let triangles = &primitives.triangles.vertices().position;
    greatest(surfels.chain(triangles).chain(lines))
}

/// The greatest finite coordinate, whatever its sign.
pub(super) fn greatest<'a>(positions: impl Iterator<Item = &'a Vec3>) -> f64 {
    let finite = positions.filter(|place| place.is_finite());
    finite.fold(0.0, |most, place| most.at_least(place.abs().max_element())).into()
}

/// The model with a transform from what was read with its `own` offset to the scene's.
pub(super) fn moved(model: &Model, own: DVec3, scene: DVec3) -> Model {
    let mut model = model.clone();
    // Without offsets the transform keeps its bits.
    if own != DVec3::ZERO || scene != DVec3::ZERO {
        model.transform.translation = place(&model, own) - scene;
    }
    model
}
