//! The fast path equals the definition, bit for bit.

use crate::frame::Exec;
use crate::method::tests::{cameras, scene, surfels};
use crate::method::{Method, Session, blue};
use crate::scene::{Camera, Cloud, Light, Primitives, Scene, Sides, Surfels, Triangles, Vertices};
use glam::Vec3;

/// The planes of the definition and of the fast path are equal as text. The shortest decimals tell
/// floats apart, and the signs of zeros.
fn assert_equal(scene: &Scene, camera: &Camera, cull: bool) -> u64 {
    let method = Method::from(blue::Settings { cull });
    let exec = Exec::sequential();
    let plain = Session::new(scene, method, &exec).unwrap();
    let plain = plain.define::<f32>(camera, false).unwrap();
    for (threads, tile) in [(1, 8), (3, 16), (2, 64)] {
        let exec = Exec::new(threads, tile).unwrap();
        let mut session = Session::new(scene, method, &exec).unwrap();
        let fast = session.render(camera).unwrap();
        assert_eq!(fast.tally, plain.tally);
        assert!(format!("{:?}", fast.frame) == format!("{:?}", plain.frame), "{threads} {tile}");
    }
    plain.tally.visible
}

/// Sides for some surfels, from a part of a pixel on, and none for others.
fn sides() -> Sides {
    let some = [None, Some(0.5), Some(1.0), None, Some(2.5), Some(4.0), Some(8.0), Some(31.0)];
    let runs = (0..).step_by(7).zip(some.into_iter().cycle().take(40));
    Sides::new(runs.collect()).unwrap()
}

#[test]
fn pictures_have_the_bits_of_the_definition() {
    let mut drawn = 0;
    for (i, camera) in (0..).zip(cameras()) {
        for (count, radius) in [(1, 1.0), (15, 3.0), (16, 0.02), (17, 0.1), (400, 0.2)] {
            for sided in [false, true] {
                let mut scene = scene(surfels(count, radius, count % 2 == 1, i));
                scene.sides = sided.then(sides);
                scene.lights.extend((i % 4 < 2).then_some(Light::DEFAULT));
                drawn += assert_equal(&scene, &camera, i % 3 == 0);
            }
        }
    }
    assert!(drawn > 5000, "{drawn}");
}

/// Surfels in front of the camera, behind it, at it and far off, of sizes from the smallest to the
/// largest.
#[test]
fn so_have_pictures_of_what_is_huge_tiny_and_near() {
    let numbers = [-3e38_f32, -1e20, -4.0, -0.0, 1e-30, 0.3, 3.99, 4.0, 4.01, 1e6, 3e38];
    let radii = [f32::MIN_POSITIVE, 1e-20, 0.1, 7.0, 1e19, 3e38];
    let mut cloud = Cloud::default();
    for (i, &z) in numbers.iter().enumerate() {
        for (k, &x) in numbers.iter().enumerate() {
            for (j, &radius) in radii.iter().enumerate() {
                cloud.position.push(Vec3::new(x, numbers[(i + 3 * k + j) % numbers.len()], z));
                let normal =
                    [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, -0.8), Vec3::Y][(i + k + j) % 4];
                cloud.normal.get_or_insert_default().push(normal);
                cloud.radius.get_or_insert_default().push(radius);
            }
        }
    }
    let (surfels, _) = Surfels::new(cloud).unwrap();
    let mut scene = Scene::lit("extremes", surfels);
    for camera in cameras() {
        for near in [0.01, 1e-30, 3.0] {
            let camera = Camera { near, ..camera };
            scene.sides = None;
            assert_equal(&scene, &camera, false);
            scene.sides = Some(Sides::new(vec![(0, Some(f32::MAX)), (90, Some(1e-45))]).unwrap());
            assert_equal(&scene, &camera, true);
        }
    }
}

/// A triangle through the surfels, with colours or without.
pub(crate) fn triangle(color: bool) -> Primitives {
    let vertices = Vertices {
        position: vec![
            Vec3::new(-1.0, -0.8, 0.3),
            Vec3::new(1.2, 0.0, -0.9),
            Vec3::new(0.0, 1.0, 0.6),
        ],
        direction: vec![Vec3::Z; 3],
        radius: vec![0.0; 3],
        color: color.then(|| vec![Vec3::X, Vec3::Y, Vec3::Z]),
        ..Vertices::default()
    };
    let triangles = Triangles::new(vertices, vec![[0, 1, 2], [0, 1, 2]]).unwrap().0;
    Primitives { triangles, ..Primitives::default() }
}

#[test]
fn so_have_pictures_with_triangles() {
    for camera in cameras() {
        for (own, others) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut scene = scene(surfels(100, 0.2, own, 3));
            scene.primitives = triangle(others);
            scene.lights.extend(others.then_some(Light::DEFAULT));
            assert_equal(&scene, &camera, false);
        }
    }
}
