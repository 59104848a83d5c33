//! Scenes that the tests of several methods draw, and tests of every method in the table.

mod explanations;
mod extremes;
mod laps;
mod planes;
mod stages;
mod ties;

use crate::frame::{Frame, Plane, Samples};
use crate::number::Exact;
use crate::number::random::unit;
use crate::scene::{Camera, Cloud, Groups, Lens, Pose, Scene, Surfels};
use crate::source::Shape;
use glam::{DVec3, Vec3};

/// Random surfels around the origin, with radii about `radius` and normals of any direction.
pub(crate) fn surfels(count: u64, radius: f32, color: bool, seed: u64) -> Surfels {
    let v =
        |i: u64, k: u64| Vec3::from_array([0, 1, 2].map(|c| unit(seed + k, 3 * i + c) * 2.0 - 1.0));
    let of = |k: u64| (0..count).map(|i| v(i, k)).collect::<Vec<_>>();
    let radii = (0..count).map(|i| radius * (0.25 + unit(seed + 9, i)));
    let cloud = Cloud {
        position: of(1),
        normal: Some(of(2)),
        radius: Some(radii.collect()),
        color: color.then(|| of(3).iter().map(|c| *c * 0.5 + 0.5).collect()),
        ..Cloud::default()
    };
    Surfels::new(cloud).unwrap().0
}

/// An unlit scene.
pub(crate) fn scene(surfels: Surfels) -> Scene {
    Scene::unlit("", surfels)
}

/// Cameras of both kinds for pictures of many sizes.
pub(crate) fn cameras() -> Vec<Camera> {
    let sizes = [[1, 1], [1, 9], [33, 17], [64, 64], [130, 47]];
    let lenses = [Lens::FieldOfView(40.0), Lens::Orthographic(3.0)];
    let pose = Pose { eye: DVec3::new(0.5, 0.25, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let cameras = sizes.into_iter().flat_map(|size| lenses.map(|lens| (size, lens)));
    cameras.map(|([w, h], lens)| Camera::new(w, h, pose, lens).unwrap()).collect()
}

/// A sphere in a light, its surfels in three groups, so that no two neighbours share one.
pub(crate) fn sphere_of_groups() -> (Scene, Groups) {
    let surfels = Shape::Sphere.surfels(150, 3).unwrap();
    let own = (0..surfels.len()).map(|i| (i % 3) as u8).collect();
    let groups = Groups::new(own, Vec::new(), vec![1.0; 3]).unwrap();
    (Scene::lit("sphere", surfels), groups)
}

/// A plane of one number a pixel.
pub(crate) fn scalar<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Plane<R> {
    match frame.plane(name) {
        Some(Samples::Scalar(plane)) => plane,
        other => panic!("{name}: {other:?}"),
    }
}

/// A plane of colours.
pub(crate) fn color<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Plane<[R; 3]> {
    match frame.plane(name) {
        Some(Samples::Color(plane)) => plane,
        other => panic!("{name}: {other:?}"),
    }
}

/// A plane of small counts.
pub(crate) fn count<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Plane<u8> {
    match frame.plane(name) {
        Some(Samples::Count(plane)) => plane,
        other => panic!("{name}: {other:?}"),
    }
}

/// A plane of surfels.
pub(crate) fn id<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Plane<u32> {
    match frame.plane(name) {
        Some(Samples::Index(plane)) => plane,
        other => panic!("{name}: {other:?}"),
    }
}
