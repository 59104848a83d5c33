//! What the tests of several methods draw.

use super::{Method, Preparation, ewa, pyramid, render_f32, single_pass, template};
use crate::frame::Exec;
use crate::number::random::unit;
use crate::scene::Groups;
use crate::scene::{Camera, Cloud, Lens, Light, Phong, Pose, Scene, Surfels};
use glam::{DVec3, Vec3};

/// Random surfels around the origin, with radii about `radius` and normals of any direction.
pub(super) fn surfels(count: u64, radius: f32, color: bool, seed: u64) -> Surfels {
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
pub(super) fn scene(surfels: Surfels) -> Scene {
    let (name, material) = (String::new(), Phong::default());
    let primitives = Default::default();
    Scene { name, surfels, primitives, lights: vec![], material, environment: None }
}

/// Cameras of both kinds for pictures of many sizes.
pub(super) fn cameras() -> Vec<Camera> {
    let sizes = [[1, 1], [1, 9], [33, 17], [64, 64], [130, 47]];
    let lenses = [Lens::FieldOfView(40.0), Lens::Orthographic(3.0)];
    let pose = Pose { eye: DVec3::new(0.5, 0.25, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let cameras = sizes.into_iter().flat_map(|size| lenses.map(|lens| (size, lens)));
    cameras.map(|([w, h], lens)| Camera::new(w, h, pose, lens).unwrap()).collect()
}

/// Whatever an earlier picture had, its memory shows nothing of it.
#[test]
fn the_memory_of_an_earlier_picture_changes_no_bit() {
    let exec = Exec::new(2, 16).unwrap();
    let methods = [
        Method::Ewa(ewa::Settings::default()),
        Method::SinglePass(single_pass::Settings::default()),
        Method::Pyramid(pyramid::Settings::default()),
        Method::Template(template::Settings::default()),
    ];
    let [small, large] = [6, 8].map(|i| cameras()[i]);
    for method in methods {
        let mut earlier = None;
        // Camera, light, colours.
        let pictures = [
            (large, true, true),
            (large, false, false),
            (large, true, false),
            (large, false, true),
            (small, true, true),
            (small, true, false),
            (small, false, false),
            (large, true, false),
        ];
        for (i, (camera, lit, color)) in pictures.into_iter().enumerate() {
            let lights = if lit { vec![Light::DEFAULT] } else { vec![] };
            let scene = Scene { lights, ..scene(surfels(500, 0.1, color, i as u64)) };
            let groups = Groups::new(vec![0; 500], vec![], vec![1.0]).unwrap();
            let prepared = Preparation::new(&scene.surfels, Some(groups), &method, &exec);
            let draw =
                |earlier| render_f32(&scene, &prepared, &camera, &method, &exec, earlier).unwrap();
            let (alone, after) = (draw(None), draw(earlier.take()));
            assert!(alone.tally.visible > 50, "{alone:?}");
            let same = format!("{:?}", alone.frame) == format!("{:?}", after.frame);
            assert!(same, "{method:?}, picture {i}");
            earlier = Some(after);
        }
    }
}
