//! A mesh as it is: the truth for surfels that were made from it.

use super::shot::Shot;
use glam::{Mat3, Vec3};
use splatref::Result;
use splatref::frame::{Exec, Plane, Samples};
use splatref::method::{Session, pyramid};
use splatref::scene::{Camera, Cloud, Primitives, Scene, Surfels};
use splatref::shade::phong::Shader;
use splatref::source::derive;
use splatref::splat::View;

/// The triangles of a cloud, before cameras.
pub(crate) struct Mesh(Scene);

impl Mesh {
    /// The mesh under the lights and with the material of a scene.
    pub(crate) fn new(cloud: Cloud, like: &Scene, exec: &Exec) -> Result<Self> {
        let (triangles, _) = derive::polygons(cloud, exec, &|_, _, _| ())?;
        let primitives = Primitives { triangles, ..Primitives::default() };
        Ok(Self::of(Scene { surfels: Surfels::none(), primitives, ..like.clone() }))
    }

    /// The triangles of a scene that has nothing else.
    pub(crate) fn of(scene: Scene) -> Self {
        Self(scene)
    }

    /// The triangles rasterized at the pixels' centres, both sides of them, with interpolated
    /// normals and colours, lit; and the normals in world space.
    pub(crate) fn truth(&self, camera: &Camera, exec: &Exec) -> Result<(Shot, Plane<[f32; 3]>)> {
        let method = pyramid::Settings { cull: false, ..pyramid::Settings::default() }.into();
        let session = Session::with_groups(&self.0, method, None, exec)?;
        let frame = session.define::<f32>(camera, true)?.frame;
        let (mut depth, mut normal, mut color) = (None, None, None);
        for plane in frame.planes {
            match (plane.name.as_str(), plane.samples) {
                ("projection.Z", Samples::Scalar(plane)) => depth = Some(plane),
                ("projection.normal", Samples::Vector(plane)) => normal = Some(plane),
                ("projection", Samples::Color(plane)) => color = Some(plane),
                _ => {}
            }
        }
        let depth = depth.expect("a stage");
        let world_from_view = Mat3::from_mat4(camera.view_from_world).transpose();
        let normal = normal.expect("a stage");
        let normal = normal.map(|n| (world_from_view * Vec3::from(*n)).normalize_or_zero().into());
        let shader = Shader::<f32>::new(View::new(camera), &self.0.lights, self.0.material);
        let color = shader.shade(&depth, Some(&normal), None, color, exec);
        let alpha = depth.map(|depth| f32::from(u8::from(depth.is_finite())));
        Ok((Shot { color, alpha, depth }, normal))
    }
}
