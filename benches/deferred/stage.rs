//! What stands before the camera: surfels along a curve, a board of checks, a model that is turned.

use super::order::along_a_curve;
use glam::{DMat3, DVec3, Vec3};
use splatref::Result;
use splatref::scene::objects::{Geometry, Motion, Object, Objects};
use splatref::scene::transform::rotation;
use splatref::scene::{
    Camera, Cloud, Lens, Pose, Primitives, Scene, Similarity, Sphere, Surfels, objects::Ids,
};

/// The model is at rest up to this frame, and turned in the next.
pub(crate) const REST: u32 = 2;

/// A model in the unit sphere that is turned once, before a board that is at rest.
pub(crate) struct Stage {
    model: Surfels,
    base: Similarity,
    board: Surfels,
}

impl Stage {
    /// `lean` is what the model is turned by, in degrees about +x, before it stands there.
    pub(crate) fn new(model: Surfels, lean: f64) -> Result<Self> {
        let Sphere { center, radius } = model.bounding_sphere();
        let lean: DMat3 = rotation(DVec3::X, lean);
        let scale = 1.0 / radius;
        let base = Similarity { rotation: lean, scale, translation: lean * (center * -scale) };
        Ok(Self { model: along_a_curve(model)?, base, board: board(200, 2.0, 0.25)? })
    }

    /// The scene in which the model is turned by some degrees about +y after [`REST`].
    pub(crate) fn scene(&self, degrees: f64, frame: u32) -> Result<Scene> {
        let turn = rotation(DVec3::Y, degrees);
        let turned = Similarity {
            rotation: turn * self.base.rotation,
            translation: turn * self.base.translation,
            ..self.base
        };
        let behind =
            Similarity { translation: DVec3::new(0.25, 0.0, -1.5), ..Similarity::IDENTITY };
        let geometry = |name: &str, surfels: &Surfels| Geometry {
            name: name.into(),
            surfels: surfels.clone(),
            primitives: Primitives::default(),
            detail: None,
        };
        let object = |name: &str, geometry, motion| Object {
            name: name.into(),
            geometry,
            motion,
            color: None,
        };
        let objects = Objects::new(
            vec![geometry("model", &self.model), geometry("board", &self.board)],
            vec![
                object("model", 0, Motion::new(vec![(REST, self.base), (REST + 1, turned)])?),
                object("board", 1, Motion::still(behind)),
            ],
            Vec3::splat(0.75),
        )?;
        let objects = Some(objects.at(frame)?);
        Ok(Scene { objects, ..Scene::lit("stage", Surfels::none()) })
    }

    /// A square picture.
    pub(crate) fn camera(side: u32) -> Result<Camera> {
        let pose = Pose { eye: DVec3::new(0.5, 0.5, 5.0), target: DVec3::ZERO, up: DVec3::Y };
        Camera::new(side, side, pose, Lens::FieldOfView(34.0))
    }
}

/// The object of a surfel of the flattened scene.
pub(crate) fn object_of(ids: &Ids, index: u32) -> Option<u32> {
    let mut end = 0;
    ids.order().iter().copied().find(|&object| {
        end += u64::from(ids.count(object));
        u64::from(index) < end
    })
}

/// `side` x `side` surfels on the square |x|, |y| <= `half` in the plane z = 0, normal +z, with checks
/// of the side `square`. The radius is the spacing.
pub(crate) fn board(side: u32, half: f64, square: f64) -> Result<Surfels> {
    let spacing = 2.0 * half / f64::from(side);
    let at = |i: u32| (f64::from(i) + 0.5) * spacing - half;
    let position: Vec<Vec3> =
        (0..side * side).map(|i| DVec3::new(at(i % side), at(i / side), 0.0).as_vec3()).collect();
    let count = position.len();
    let cloud = Cloud {
        color: Some(position.iter().map(|p| check(p.as_dvec3(), square)).collect()),
        normal: Some(vec![Vec3::Z; count]),
        radius: Some(vec![spacing as f32; count]),
        position,
        ..Cloud::default()
    };
    along_a_curve(Surfels::new(cloud)?.0)
}

/// Light or dark, by the cube of this side that a point lies in.
pub(crate) fn check(p: DVec3, side: f64) -> Vec3 {
    let cell = (p / side + 0.25).floor();
    let odd = (cell.x + cell.y + cell.z).rem_euclid(2.0) == 1.0;
    Vec3::splat(if odd { 0.0625 } else { 0.875 })
}
