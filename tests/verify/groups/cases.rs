//! The scenes that the client is tried on.

use glam::{DVec3, Vec3};
use splatref::method::single_pass::{BinCount, DepthTest, Settings};
use splatref::scene::{Camera, Cloud, Groups, Lens, Light, Pose, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::{Epsilon, Kernel, Outline, SplatSettings};

/// A scene, a camera, settings.
pub(super) type Case = (Scene, Camera, Settings);

fn camera(shape: Shape) -> Camera {
    Camera::new(47, 35, shape.default_pose(), shape.default_lens()).unwrap()
}

fn surfels(shape: &str, count: usize, seed: u64) -> (Shape, Surfels) {
    let shape = Shape::by_name(shape).unwrap();
    (shape, shape.surfels(count, seed).unwrap())
}

/// Surfels in K groups, the group of each given.
fn grouped(surfels: Surfels, count: u8, own: impl Fn(usize) -> usize) -> Surfels {
    let mut cloud = surfels.into_cloud();
    let own = (0..cloud.position.len()).map(|i| u8::try_from(own(i)).unwrap()).collect();
    cloud.groups = Some(Groups::new(own, vec![], vec![1.0; count.into()]).unwrap());
    Surfels::new(cloud).unwrap().0
}

fn splats(kernel: Kernel, epsilon: Epsilon) -> SplatSettings {
    SplatSettings { kernel, epsilon, ..SplatSettings::default() }
}

/// Groups as the method makes them.
fn sphere() -> Case {
    let (shape, surfels) = surfels("sphere", 300, 0);
    (Scene::lit("sphere", surfels), camera(shape), Settings::default())
}

/// Without colours.
fn orthographic_torus() -> Case {
    let (shape, surfels) = surfels("torus", 400, 1);
    let mut cloud = grouped(surfels, 4, |i| i % 4).into_cloud();
    cloud.color = None;
    let scene = Scene::lit("torus", Surfels::new(cloud).unwrap().0);
    let camera = Camera::new(47, 35, shape.default_pose(), Lens::Orthographic(2.5)).unwrap();
    let splats = splats(Kernel::DEFAULT, Epsilon::World(0.125));
    (scene, camera, Settings { splats, depth: DepthTest::Plain })
}

/// Seen from both sides, without light; two of the groups are empty.
fn cluster() -> Case {
    let (shape, surfels) = surfels("cluster", 500, 2);
    let scene = Scene::unlit("cluster", grouped(surfels, 8, |i| [0, 1, 2, 4, 5, 7][i / 7 % 6]));
    let splats = SplatSettings { kernel: Kernel::ZPVBG01, cull: false, ..SplatSettings::default() };
    (scene, camera(shape), Settings { splats, depth: DepthTest::Voronoi(BinCount::Count(32)) })
}

/// What an extension has added and enlarged is nothing to this method.
fn extended_sphere() -> Case {
    let (shape, surfels) = surfels("sphere", 240, 3);
    let mut cloud = surfels.into_cloud();
    let count = cloud.position.len();
    let own = (0..count).map(|i| u8::from(i % 3 == 0)).collect();
    let added = (0..u32::try_from(count).unwrap()).step_by(5).map(|i| (i, u8::from(i % 3 != 0)));
    cloud.groups = Some(Groups::new(own, added.collect(), vec![1.25, 1.5]).unwrap());
    let mut scene = Scene::lit("sphere", Surfels::new(cloud).unwrap().0);
    scene.lights.push(Light::Point {
        position: Vec3::new(-2.0, 1.0, 2.5),
        color: Vec3::new(0.0, 0.25, 0.75),
    });
    let splats = splats(Kernel::ZP06, Epsilon::DEFAULT);
    (scene, camera(shape), Settings { splats, ..Settings::default() })
}

/// Some of the discs reach the near plane.
fn checkerboard(outline: Outline, depth: DepthTest, epsilon: Epsilon, groups: u8) -> Case {
    let (shape, surfels) = surfels("checkerboard", 700, 4);
    let surfels = grouped(surfels, groups, |i| i / 3 % usize::from(groups));
    let scene = Scene::lit("checkerboard", surfels);
    let splats = splats(Kernel { outline, cutoff: 2.375, low_pass: 0.5 }, epsilon);
    (scene, camera(shape), Settings { splats, depth })
}

/// The widest kernel, seen from both sides.
fn wide_staircase() -> Case {
    let (shape, surfels) = surfels("staircase", 120, 5);
    let scene = Scene::lit("staircase", grouped(surfels, 8, |i| i * i % 8));
    let kernel = Kernel { outline: Outline::Perspective, cutoff: 4.0, low_pass: 4.0 };
    let splats = SplatSettings { cull: false, ..splats(kernel, Epsilon::MedianRadii(1.5)) };
    (scene, camera(shape), Settings { splats, depth: DepthTest::Voronoi(BinCount::Count(3)) })
}

/// From within: surfels are behind the camera, and beside the view.
fn inside_the_cluster() -> Case {
    let (_, surfels) = surfels("cluster", 250, 6);
    let scene = Scene::lit("cluster", grouped(surfels, 2, |i| i % 2));
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let pose = Pose { eye, target: DVec3::new(1.0, -0.25, -0.5), up: DVec3::Z };
    let camera = Camera::new(47, 35, pose, Lens::FieldOfView(75.0)).unwrap();
    let kernel = Kernel { outline: Outline::RayCast, ..Kernel::DEFAULT };
    let splats = SplatSettings { cull: false, ..splats(kernel, Epsilon::World(0.05)) };
    (scene, camera, Settings { splats, depth: DepthTest::Voronoi(BinCount::Count(60_000)) })
}

/// The radius of a disc whose rim nearly goes through centres of pixels.
const SMALLER: f32 = 5.0 * (1.0 - 1.0 / 262_144.0);

/// Discs that face the camera and whose numbers are exact, so that decisions lie at their limits: a
/// unit of the world is a pixel, epsilon and a bin are 2 deep, and a disc has a radius of 5 pixels.
fn limits(depth: DepthTest) -> Case {
    // Column, row, depth, group.
    let discs: [(f32, f32, f32, u8); 19] = [
        // Out of sight: with these the depths are from 64 to 192.
        (-27.0, 23.0, 64.0, 0),
        (91.0, 23.0, 64.0, 0),
        (18.5, 23.5, 75.0, 0),
        // Ties within a group and across groups, at the centre and at the rim of each other.
        (20.5, 10.5, 64.0, 1),
        (20.5, 10.5, 64.0, 1),
        (23.5, 10.5, 64.0, 0),
        (15.5, 10.5, 64.0, 0),
        (30.5, 10.5, 64.0, 1),
        // Smaller by less than the digits of q that matter.
        (52.5, 35.5, 64.0, 1),
        // Two in one bin, and one at the border to the next; the visible band ends at its depth.
        (40.5, 10.5, 66.0, 0),
        (42.5, 10.5, 64.0, 0),
        (44.5, 10.5, 65.0, 0),
        (41.5, 13.5, 66.0, 3),
        (43.5, 13.5, 67.0, 3),
        // A chain across groups of which each is within epsilon of the next.
        (20.5, 35.5, 68.0, 0),
        (22.5, 35.5, 66.0, 1),
        (24.5, 35.5, 64.0, 3),
        (26.5, 35.5, 62.0, 1),
        (18.5, 23.5, 53.0, 0),
    ];
    let position = |d: &(f32, f32, f32, u8)| Vec3::new(d.0 - 32.0, 24.0 - d.1, 64.0 - d.2);
    let count = discs.len();
    let cloud = Cloud {
        position: discs.iter().map(position).collect(),
        normal: Some(vec![Vec3::new(-0.0, 0.0, 1.0); count]),
        radius: Some((0..count).map(|i| if i == 8 { SMALLER } else { 5.0 }).collect()),
        color: Some((0..count).map(|i| Vec3::new(0.25, 0.5, i as f32 / 32.0)).collect()),
        groups: Some(Groups::new(discs.map(|d| d.3).to_vec(), vec![], vec![1.0; 4]).unwrap()),
        ..Cloud::default()
    };
    let scene = Scene::lit("limits", Surfels::new(cloud).unwrap().0);
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 128.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(64, 48, pose, Lens::Orthographic(48.0)).unwrap();
    let kernel = Kernel { outline: Outline::RayCast, cutoff: 2.5, low_pass: 0.0 };
    (scene, camera, Settings { splats: splats(kernel, Epsilon::World(2.0)), depth })
}

/// All of them, by name.
pub(super) fn cases() -> Vec<(&'static str, Case)> {
    let voronoi = DepthTest::Voronoi;
    let (bins, zero) = (voronoi(BinCount::Epsilon), Epsilon::World(0.0));
    let (ray_cast, perspective) = (Outline::RayCast, Outline::Perspective);
    vec![
        ("sphere", sphere()),
        ("orthographic torus", orthographic_torus()),
        ("cluster", cluster()),
        ("extended sphere", extended_sphere()),
        ("limits", limits(DepthTest::Plain)),
        ("limits in bins", limits(voronoi(BinCount::Epsilon))),
        ("checkerboard", checkerboard(perspective, DepthTest::Plain, zero, 3)),
        ("checkerboard in bins", checkerboard(ray_cast, bins, Epsilon::DEFAULT, 4)),
        ("wide staircase", wide_staircase()),
        ("inside the cluster", inside_the_cluster()),
    ]
}
