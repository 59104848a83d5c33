//! The scenes that the client is tried on.

use glam::{DVec3, Vec3};
use splatref::method::{Method, pyramid, template};
use splatref::scene::{Camera, Cloud, Lens, Light, Pose, Scene, Surfels};
use splatref::source::Shape;

/// A scene, a camera, a method.
pub(super) type Case = (Scene, Camera, Method);

fn camera([width, height]: [u32; 2], shape: Shape) -> Camera {
    Camera::new(width, height, shape.default_pose(), shape.default_lens()).unwrap()
}

fn sphere() -> (Scene, Camera) {
    let scene = Scene::lit("sphere", Shape::Sphere.surfels(500, 0).unwrap());
    (scene, camera([61, 47], Shape::Sphere))
}

/// Without colours.
fn orthographic_torus() -> (Scene, Camera) {
    let shape = Shape::Torus;
    let mut scene = Scene::lit("torus", shape.surfels(800, 1).unwrap());
    let mut cloud = scene.surfels.into_cloud();
    cloud.color = None;
    scene.surfels = Surfels::new(cloud).unwrap().0;
    let lens = Lens::Orthographic(2.5);
    (scene, Camera::new(61, 47, shape.default_pose(), lens).unwrap())
}

/// Seen from both sides, without light.
fn cluster() -> (Scene, Camera) {
    let shape = Shape::by_name("cluster").unwrap();
    let scene = Scene::unlit("cluster", shape.surfels(1500, 2).unwrap());
    (scene, camera([61, 47], shape))
}

/// Flat surfaces, of which some hide others, under a light in the scene.
fn odd_staircase() -> (Scene, Camera) {
    let shape = Shape::by_name("staircase").unwrap();
    let mut scene = Scene::lit("staircase", shape.surfels(400, 5).unwrap());
    scene.lights.push(Light::Point {
        position: Vec3::new(-2.0, 1.0, 2.5),
        color: Vec3::new(0.0, 0.25, 0.75),
    });
    (scene, camera([33, 30], shape))
}

/// From within, through a wide lens: discs behind the camera, edge-on, and larger than the picture.
fn inside_the_cluster() -> (Scene, Camera) {
    let shape = Shape::by_name("cluster").unwrap();
    let scene = Scene::lit("cluster", shape.surfels(900, 6).unwrap());
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let pose = Pose { eye, target: DVec3::new(1.0, -0.25, -0.5), up: DVec3::Z };
    (scene, Camera::new(40, 31, pose, Lens::FieldOfView(75.0)).unwrap())
}

/// Discs in one plane, many of them with equal depths but for rounding.
fn checkerboard() -> (Scene, Camera) {
    let shape = Shape::by_name("checkerboard").unwrap();
    let scene = Scene::lit("checkerboard", shape.surfels(1500, 4).unwrap());
    (scene, camera([48, 35], shape))
}

/// A sphere of discs four times as wide as it needs.
fn wide_discs() -> (Scene, Camera) {
    let mut cloud = Shape::Sphere.surfels(600, 7).unwrap().into_cloud();
    cloud.radius = cloud.radius.map(|radii| radii.iter().map(|radius| 4.0 * radius).collect());
    let scene = Scene::lit("wide discs", Surfels::new(cloud).unwrap().0);
    (scene, camera([45, 45], Shape::Sphere))
}

/// Discs whose numbers are exact, so that decisions lie at their limits: a unit of the world is a
/// pixel, and the column and the row of a centre are given.
fn limits() -> (Scene, Camera) {
    let slanted = Vec3::new(0.5, 0.0, 1.0).normalize();
    // Column, row, z, radius, normal.
    let discs: [(f32, f32, f32, f32, Vec3); 19] = [
        // Behind all others and larger than the top level can show.
        (16.5, 15.5, -512.0, 200.0, Vec3::Z),
        // Two in one pixel, equally near. On the rim of a radius of 2 lie centres of pixels.
        (8.5, 8.5, 0.0, 2.0, Vec3::Z),
        (8.5, 8.5, 0.0, 2.0, Vec3::Z),
        // Equally near in one cell of level 1, and too large for level 0 of a template of 5 x 5.
        (20.5, 8.5, 0.0, 4.0, Vec3::Z),
        (21.5, 8.5, 0.0, 4.0, Vec3::Z),
        // Touching spheres in one cell of level 1.
        (20.5, 20.5, 0.0, 4.0, Vec3::Z),
        (21.5, 20.5, -8.0, 4.0, Vec3::Z),
        // Two equally near, of which only the second's interval reaches the third.
        (4.5, 20.5, 0.0, 2.0, Vec3::Z),
        (5.5, 20.5, 0.0, 6.0, Vec3::Z),
        (4.5, 21.5, -4.0, 2.0, Vec3::Z),
        // The centre of its cell of level 1 is on its rim.
        (28.5, 4.5, 0.0, 0.75, slanted),
        (26.5, 26.5, 3.0, 2.5, Vec3::Z),
        // Intervals that touch in one cell of level 1.
        (24.5, 14.5, 0.0, 2.0, Vec3::Z),
        (25.5, 14.5, -2.0, 2.0, Vec3::Z),
        // The same, but the second is too small for the cell.
        (28.5, 14.5, 0.0, 2.0, Vec3::Z),
        (29.5, 14.5, -2.0, 0.5, Vec3::Z),
        // In the last column, which is odd, and too large for level 0.
        (32.5, 24.5, 0.0, 4.0, Vec3::Z),
        // A level of radius 2.5 is level 0; hidden by what comes after it.
        (12.5, 26.5, -40.0, 2.5, Vec3::Z),
        (13.5, 26.5, 0.0, 2.5, slanted),
    ];
    let count = discs.len() as f32;
    let cloud = Cloud {
        position: discs.iter().map(|d| Vec3::new(d.0 - 16.5, 15.0 - d.1, d.2)).collect(),
        normal: Some(discs.iter().map(|disc| disc.4).collect()),
        radius: Some(discs.iter().map(|disc| disc.3).collect()),
        color: Some((0..discs.len()).map(|i| Vec3::new(0.25, 0.5, i as f32 / count)).collect()),
        ..Cloud::default()
    };
    let scene = Scene::lit("limits", Surfels::new(cloud).unwrap().0);
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 64.0), target: DVec3::ZERO, up: DVec3::Y };
    (scene, Camera::new(33, 30, pose, Lens::Orthographic(30.0)).unwrap())
}

/// The cases of templates, by name.
pub(super) fn of_template() -> Vec<(&'static str, Case)> {
    let default = template::Settings::default();
    let of = |size: u32| template::Settings { size, ..default };
    let case = |(scene, camera), settings| (scene, camera, Method::Template(settings));
    let gaussian = template::Falloff::Gaussian;
    vec![
        ("sphere, 3 x 3", case(sphere(), of(3))),
        ("sphere", case(sphere(), default)),
        ("orthographic torus", case(orthographic_torus(), default)),
        ("cluster, 3 x 3", case(cluster(), template::Settings { cull: false, ..of(3) })),
        (
            "odd staircase",
            case(odd_staircase(), template::Settings { falloff: gaussian, ..default }),
        ),
        ("limits", case(limits(), default)),
        (
            "inside the cluster",
            case(inside_the_cluster(), template::Settings { cull: false, ..default }),
        ),
        (
            "checkerboard",
            case(
                checkerboard(),
                template::Settings { levels: template::LevelRule::Covering, ..of(7) },
            ),
        ),
        (
            "wide discs",
            case(
                wide_discs(),
                template::Settings { levels: template::LevelRule::Radius, ..default },
            ),
        ),
    ]
}

/// The cases of pull and push, by name.
pub(super) fn of_pyramid() -> Vec<(&'static str, Case)> {
    let default = pyramid::Settings::default();
    let case = |(scene, camera), settings| (scene, camera, Method::Pyramid(settings));
    let (weights, occlusion) = (pyramid::Weights::Box, pyramid::Occlusion::Outside);
    vec![
        ("sphere", case(sphere(), default)),
        (
            "orthographic torus",
            case(orthographic_torus(), pyramid::Settings { weights, ..default }),
        ),
        ("cluster", case(cluster(), pyramid::Settings { cull: false, ..default })),
        ("odd staircase", case(odd_staircase(), pyramid::Settings { occlusion, ..default })),
        ("limits", case(limits(), default)),
        (
            "inside the cluster",
            case(inside_the_cluster(), pyramid::Settings { cull: false, ..default }),
        ),
        ("checkerboard", case(checkerboard(), default)),
        ("wide discs", case(wide_discs(), pyramid::Settings { occlusion, ..default })),
    ]
}
