//! Draw the true picture: one ray for each pixel.

use super::{Hit, Surface};
use crate::frame::{Frame, NamedPlane, Plane, Samples};
use crate::number::MapInline;
use crate::scene::{Camera, Projection};
use glam::DVec3;

/// The planes of [`super::Shape::true_picture`].
pub(super) fn true_picture(surface: &Surface, camera: &Camera) -> Frame<f64> {
    let Camera { width, height, .. } = *camera;
    let world_from_view = camera.view_from_world.as_dmat4().inverse();
    let mut hits: Vec<Option<Hit>> = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let (origin, direction) = view_ray(camera, x, y);
            let origin = world_from_view.transform_point3(origin);
            let direction = world_from_view.transform_vector3(direction);
            hits.push(surface.trace(origin, direction, f64::from(camera.near)));
        }
    }
    let hits = Plane::from_values(width, height, hits);
    let vector = |v: DVec3| v.to_array().map_inline(|v| v + 0.0); // -0 + 0 = +0
    let color = hits.map(|hit| hit.map_or([0.0; 3], |hit| vector(hit.color)));
    let depth = hits.map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t + 0.0));
    let normal = hits.map(|hit| hit.map_or([0.0; 3], |hit| vector(hit.normal)));
    let planes = [
        ("", Samples::Color(color)),
        ("Z", Samples::Scalar(depth)),
        ("normal", Samples::Vector(normal)),
    ]
    .map(|(name, samples)| NamedPlane { name: name.into(), samples });
    Frame { width, height, planes: planes.into() }
}

/// Origin and direction in view space of the ray through a pixel's centre. Its parameter is the
/// depth.
fn view_ray(camera: &Camera, x: u32, y: u32) -> (DVec3, DVec3) {
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map_inline(f64::from);
    let right = (f64::from(x) + 0.5 - cx) / fx;
    let up = -(f64::from(y) + 0.5 - cy) / fy;
    match camera.projection {
        Projection::Perspective => (DVec3::ZERO, DVec3::new(right, up, -1.0)),
        Projection::Orthographic => (DVec3::new(right, up, 0.0), -DVec3::Z),
    }
}
