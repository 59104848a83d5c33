//! The scenes that the client is tried on.

use glam::{DVec3, Vec3};
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::Method;
use splatref::scene::{Camera, Cloud, Lens, Light, Pose, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::{Epsilon, Kernel, Outline, SplatSettings};
use std::path::Path;

/// A scene, a camera, settings.
pub(crate) type Case = (Scene, Camera, SplatSettings);

fn camera(shape: Shape) -> Camera {
    Camera::new(61, 47, shape.default_pose(), shape.default_lens()).unwrap()
}

fn sphere() -> Case {
    let scene = Scene::lit("sphere", Shape::Sphere.surfels(500, 0).unwrap());
    (scene, camera(Shape::Sphere), SplatSettings::default())
}

fn orthographic_torus() -> Case {
    let shape = Shape::Torus;
    let mut scene = Scene::lit("torus", shape.surfels(800, 1).unwrap());
    let mut cloud = scene.surfels.into_cloud();
    cloud.color = None;
    scene.surfels = Surfels::new(cloud).unwrap().0;
    let lens = Lens::Orthographic(2.5);
    let camera = Camera::new(61, 47, shape.default_pose(), lens).unwrap();
    (scene, camera, SplatSettings { epsilon: Epsilon::World(0.125), ..SplatSettings::default() })
}

/// Seen from both sides, without light.
fn cluster() -> Case {
    let shape = Shape::by_name("cluster").unwrap();
    let scene = Scene::unlit("cluster", shape.surfels(1500, 2).unwrap());
    let settings =
        SplatSettings { kernel: Kernel::ZPVBG01, cull: false, ..SplatSettings::default() };
    (scene, camera(shape), settings)
}

/// A directional light and a point, beside the headlight.
fn add_lights(scene: &mut Scene) {
    scene.lights.push(Light::Directional {
        towards: Vec3::new(2.0, -1.0, 0.5),
        color: Vec3::new(0.5, 0.25, 0.0),
    });
    scene.lights.push(Light::Point {
        position: Vec3::new(-2.0, 1.0, 2.5),
        color: Vec3::new(0.0, 0.25, 0.75),
    });
}

/// Under every kind of light.
fn ray_cast_sphere() -> Case {
    let mut scene = Scene::lit("sphere", Shape::Sphere.surfels(500, 3).unwrap());
    add_lights(&mut scene);
    let settings = SplatSettings { kernel: Kernel::ZP06, ..SplatSettings::default() };
    (scene, camera(Shape::Sphere), settings)
}

/// Some of the discs reach the near plane.
fn checkerboard(outline: Outline) -> Case {
    let shape = Shape::by_name("checkerboard").unwrap();
    let scene = Scene::lit("checkerboard", shape.surfels(3000, 4).unwrap());
    let kernel = Kernel { outline, ..Kernel::DEFAULT };
    (scene, camera(shape), SplatSettings { kernel, ..SplatSettings::default() })
}

/// The widest kernel, seen from both sides.
fn wide_staircase() -> Case {
    let shape = Shape::by_name("staircase").unwrap();
    let scene = Scene::lit("staircase", shape.surfels(600, 5).unwrap());
    let kernel = Kernel { outline: Outline::Perspective, cutoff: 4.0, low_pass: 16.0 };
    let epsilon = Epsilon::MedianRadii(1.5);
    (scene, camera(shape), SplatSettings { kernel, epsilon, cull: false })
}

/// From within: surfels are behind the camera, and beside the view.
fn inside_the_cluster() -> Case {
    let shape = Shape::by_name("cluster").unwrap();
    let mut scene = Scene::lit("cluster", shape.surfels(900, 6).unwrap());
    add_lights(&mut scene);
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let pose = Pose { eye, target: DVec3::new(1.0, -0.25, -0.5), up: DVec3::Z };
    let camera = Camera::new(61, 47, pose, Lens::FieldOfView(75.0)).unwrap();
    let kernel = Kernel { outline: Outline::RayCast, ..Kernel::DEFAULT };
    let epsilon = Epsilon::World(0.05);
    (scene, camera, SplatSettings { kernel, epsilon, cull: false })
}

/// Discs that face the camera, whose standard deviation is 2 px and whose rim goes through centres
/// of pixels; four lie in one plane, and one is smaller by less than the digits of q that matter.
fn rims() -> Case {
    let columns = [20.5, 23.5, 20.5, 30.5, 24.5];
    let position = columns.map(|x| Vec3::new(x - 32.0, if x > 30.0 { 7.5 } else { 0.5 }, 0.0));
    let cloud = Cloud {
        position: position.to_vec(),
        normal: Some(vec![Vec3::Z; 5]),
        radius: Some(vec![5.0, 5.0, 5.0, 5.0 * (1.0 - 1.0 / 262_144.0), 5.0]),
        color: Some((0..5_u8).map(|i| Vec3::new(0.25, 0.5, 0.125 * f32::from(i))).collect()),
        ..Cloud::default()
    };
    let scene = Scene::lit("rims", Surfels::new(cloud).unwrap().0);
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 64.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(64, 48, pose, Lens::Orthographic(48.0)).unwrap();
    let kernel = Kernel { outline: Outline::RayCast, cutoff: 2.5, low_pass: 0.0 };
    (scene, camera, SplatSettings { kernel, epsilon: Epsilon::World(0.0), cull: true })
}

/// The golden `ewa_ladder_raycast`: decisions beside their limits, by steps of 1e-6 and more.
fn ladder() -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/ewa_ladder_raycast.toml");
    let file = SceneFile::open(path).unwrap();
    let ready = file.ready(&Exec::sequential(), &|_, _, _| ()).unwrap();
    let Method::Ewa(settings) = ready.method else { panic!("the golden is of EWA") };
    (ready.loaded.scene, ready.camera, settings)
}

/// All of them, by name.
pub(crate) fn cases() -> Vec<(&'static str, Case)> {
    vec![
        ("sphere", sphere()),
        ("orthographic torus", orthographic_torus()),
        ("cluster", cluster()),
        ("ray-cast sphere", ray_cast_sphere()),
        ("perspective checkerboard", checkerboard(Outline::Perspective)),
        ("ray-cast checkerboard", checkerboard(Outline::RayCast)),
        ("wide staircase", wide_staircase()),
        ("inside the cluster", inside_the_cluster()),
        ("rims", rims()),
        ("ladder", ladder()),
    ]
}
