mod behind;
mod edges;

use super::*;
use crate::compare::metrics::{Region, regions, rmse};
use crate::frame::Exec;
use crate::number::random::unit;
use crate::scene::indexed::Vertices;
use crate::scene::{Camera, Lens, Light, Phong, Pose, Scene, Surfels};
use glam::{DMat3, DVec3};

fn camera(size: [u32; 2], distance: f64, lens: Lens) -> Camera {
    let (eye, target, up) = (DVec3::new(0.0, 0.0, distance), DVec3::ZERO, DVec3::Y);
    Camera::new(size[0], size[1], Pose { eye, target, up }, lens).unwrap()
}

fn lights(name: &str, lights: Vec<Light>) -> Scene {
    Scene { lights, ..Scene::unlit(name, Surfels::none()) }
}

fn shape(name: &str) -> Surface {
    let shape = Shape::by_name(name).unwrap();
    Surface::Shape { shape, place: Similarity::IDENTITY, color: None }
}

fn see(surfaces: &[Surface], scene: &Scene, cull: bool, camera: &Camera) -> Truth {
    let exec = Exec::new(2, 16).unwrap();
    of_surfaces(surfaces, scene, cull, camera, &[], &exec, &|_, _, _| ()).unwrap()
}

/// White triangles at these positions, each with its own normal.
fn mesh(triangles: &[[[f32; 3]; 3]]) -> Surface {
    let (mut position, mut direction) = (Vec::new(), Vec::new());
    for corners in triangles {
        let [a, b, c] = corners.map(Vec3::from_array);
        position.extend([a, b, c]);
        direction.extend([(b - a).cross(c - a).normalize_or(Vec3::Z); 3]);
    }
    let n = position.len();
    let corners = (0..n as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let vertices = Vertices {
        position,
        direction,
        radius: vec![0.0; n],
        color: Some(vec![Vec3::ONE; n]),
        ..Vertices::default()
    };
    Surface::Triangles(Triangles::new(vertices, corners).unwrap().0)
}

/// A sphere of radius 1 as a mesh of `n` by `2 n` quads, with the mesh's normals or the sphere's.
fn globe(n: u32) -> Surface {
    let at = |i: u32, j: u32| {
        let polar = std::f64::consts::PI * f64::from(i) / f64::from(n);
        let around = std::f64::consts::PI * f64::from(j) / f64::from(n);
        let (sp, cp) =
            (crate::number::elementary::sin(polar), crate::number::elementary::cos(polar));
        let (sa, ca) =
            (crate::number::elementary::sin(around), crate::number::elementary::cos(around));
        DVec3::new(sp * ca, cp, -sp * sa).as_vec3()
    };
    let position: Vec<Vec3> = (0..=n).flat_map(|i| (0..=2 * n).map(move |j| at(i, j))).collect();
    let index = |i: u32, j: u32| i * (2 * n + 1) + j;
    let quads = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let corners = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let vertices = Vertices {
        direction: position.clone(),
        radius: vec![0.0; position.len()],
        color: None,
        position,
        ..Vertices::default()
    };
    Surface::Triangles(Triangles::new(vertices, corners.collect()).unwrap().0)
}

fn colors(truth: &Truth) -> Vec<f32> {
    truth.frame.color("").unwrap().values().iter().flatten().copied().collect()
}

/// The covered area of a white surface before black, in px.
fn area(truth: &Truth) -> f64 {
    colors(truth).iter().step_by(3).map(|v| f64::from(*v)).sum()
}

#[test]
fn the_area_of_a_triangle_is_that_of_its_corners() {
    let unlit = lights("triangle", vec![]);
    for lens in [Lens::FieldOfView(60.0), Lens::Orthographic(4.0)] {
        let camera = camera([200, 150], 3.0, lens);
        let corners = [[-1.1, -0.7, 0.0], [1.3, -0.2, 0.4], [0.1, 1.2, -0.5]];
        let truth = see(&[mesh(&[corners])], &unlit, true, &camera);
        let on_screen = corners.map(|[x, y, z]: [f32; 3]| {
            let t = if lens == Lens::Orthographic(4.0) { 1.0 } else { 3.0 - f64::from(z) };
            [f64::from(camera.fx) * f64::from(x) / t, f64::from(camera.fy) * f64::from(y) / t]
        });
        let [a, b, c] = on_screen;
        let expected = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        // Each of about 300 pixels on the outline is off by less than a hundredth on average.
        assert!((area(&truth) - expected).abs() < 1.5, "{} {expected}", area(&truth));
        assert_eq!(truth.how, How::Triangles);
        let behind = see(&[mesh(&[[corners[0], corners[2], corners[1]]])], &unlit, true, &camera);
        assert_eq!(area(&behind), 0.0, "seen from behind");
        let behind = see(&[mesh(&[[corners[0], corners[2], corners[1]]])], &unlit, false, &camera);
        assert!((area(&behind) - expected).abs() < 1.5);
    }
}

#[test]
fn a_sphere_has_its_outline_and_its_light() {
    let scene = Scene {
        material: Phong { ambient: 0.0, diffuse: 1.0, specular: 0.0, ..Phong::default() },
        ..lights("sphere", vec![Light::Headlight { towards: Vec3::Z, color: Vec3::ONE }])
    };
    let white = Surface::Shape {
        shape: Shape::Sphere,
        place: Similarity::IDENTITY,
        color: Some(Vec3::ONE),
    };
    let camera = camera([128, 128], 4.0, Lens::Orthographic(2.5));
    let truth = see(&[white], &scene, true, &camera);
    // The integral of n . z over the disc of radius 51.2 px is 2/3 of its area.
    let radius = 128.0 / 2.5;
    let expected = 2.0 / 3.0 * std::f64::consts::PI * radius * radius;
    assert!((area(&truth) / expected - 1.0).abs() < 1e-3, "{} {expected}", area(&truth));
    assert_eq!(truth.how, How::Exact);
    let depth = truth.frame.scalar("Z").unwrap();
    let (x, y) = (0.5 / radius, 0.5 / radius);
    let expected = 4.0 - (1.0_f64 - x * x - y * y).sqrt();
    assert!((f64::from(*depth.at(64, 64)) - expected).abs() < 1e-6);
    assert_eq!(*depth.at(0, 0), f32::INFINITY);
    let alpha = truth.frame.scalar("A").unwrap().values().iter().sum::<f32>();
    assert!((f64::from(alpha) / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 2e-3);
}

#[test]
fn a_finer_mesh_is_nearer_to_the_sphere() {
    let scene = lights("globe", vec![Light::DEFAULT]);
    let camera = camera([96, 96], 4.0, Lens::FieldOfView(40.0));
    let place = Similarity::IDENTITY;
    let color = Some(scene.material.color);
    let exact = colors(&see(
        &[Surface::Shape { shape: Shape::Sphere, place, color }],
        &scene,
        true,
        &camera,
    ));
    let errors = [8, 16, 32, 64].map(|n| {
        let found = see(&[globe(n)], &scene, true, &camera);
        rmse(&colors(&found), &exact)
    });
    // The sagitta of an edge falls with its square, and so does the outline, which the mesh cuts.
    assert!(errors.windows(2).all(|two| two[1] < 0.4 * two[0]), "{errors:?}");
    assert!(errors[3] < 2e-3, "{errors:?}");
}

/// The shape, scaled, turned and moved, looks the same as from a camera moved the other way.
#[test]
fn a_shape_in_its_place() {
    let scene = lights("torus", vec![]);
    let rotation = DMat3::from_axis_angle(DVec3::Y, 0.5);
    let place = Similarity { scale: 2.0, rotation, translation: DVec3::new(0.5, -1.0, 2.0) };
    let shape = Shape::by_name("torus").unwrap();
    let at = |p: DVec3| place.rotation * (p * place.scale) + place.translation;
    let [eye, target] = [DVec3::new(1.0, 3.0, 5.0), DVec3::new(0.1, 0.0, 0.2)];
    let lens = Lens::FieldOfView(45.0);
    let plain = Camera::new(64, 48, Pose { eye, target, up: DVec3::Y }, lens).unwrap();
    let moved =
        Camera::new(64, 48, Pose { eye: at(eye), target: at(target), up: DVec3::Y }, lens).unwrap();
    let a = see(
        &[Surface::Shape { shape, place: Similarity::IDENTITY, color: None }],
        &scene,
        true,
        &plain,
    );
    let b = see(&[Surface::Shape { shape, place, color: None }], &scene, true, &moved);
    // A sample on the outline may fall to the other side, because cameras are rounded.
    assert!(rmse(&colors(&a), &colors(&b)) < 2e-3);
    let of = |truth: &Truth| truth.frame.scalar("Z").unwrap().values().to_vec();
    let pairs = of(&a).into_iter().zip(of(&b)).filter(|(a, b)| a.is_finite() && b.is_finite());
    let off = pairs.filter(|(a, b)| (2.0 * a - b).abs() > 1e-4).count();
    assert!(off < 8, "{off}");
}

/// Compares each sample with each triangle by another formula [Moeller, Trumbore 1997].
fn brute(triangles: &[[[f32; 3]; 3]], camera: &Camera) -> Vec<f64> {
    let world = camera.view_from_world.as_dmat4().inverse();
    let origin = world.transform_point3(DVec3::ZERO);
    let hit = |x: f64, y: f64| {
        let px = (x - f64::from(camera.cx)) / f64::from(camera.fx);
        let py = -(y - f64::from(camera.cy)) / f64::from(camera.fy);
        let d = world.transform_vector3(DVec3::new(px, py, -1.0));
        let meets = |corners: &[[f32; 3]; 3]| {
            let [a, b, c] = corners.map(|c| Vec3::from_array(c).as_dvec3());
            let (e, f) = (b - a, c - a);
            let p = d.cross(f);
            let inverse = 1.0 / e.dot(p);
            let u = (origin - a).dot(p) * inverse;
            let q = (origin - a).cross(e);
            let v = d.dot(q) * inverse;
            let t = f.dot(q) * inverse;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > f64::from(camera.near)
        };
        triangles.iter().any(meets)
    };
    let side = f64::from(SAMPLES);
    let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
    let covered = |(x, y): (u32, u32)| {
        let eighth = |i: u32| (f64::from(i) + 0.5) / side;
        let samples = (0..SAMPLES).flat_map(|j| (0..SAMPLES).map(move |i| (i, j)));
        let hits =
            samples.filter(|&(i, j)| hit(f64::from(x) + eighth(i), f64::from(y) + eighth(j)));
        hits.count() as f64 / (side * side)
    };
    pixels.map(covered).collect()
}

#[test]
fn triangles_through_the_camera_are_those_of_brute_force() {
    let unlit = lights("soup", vec![]);
    for seed in 0..6 {
        let random = |i: u64| 6.0 * unit(seed, i) - 3.0;
        let corner = |i: u64| [random(3 * i), random(3 * i + 1), random(3 * i + 2) + 2.0];
        let soup: Vec<_> = (0..8).map(|i| [0, 1, 2].map(|k| corner(3 * i + k))).collect();
        // The near plane is 3 / 1024 in front of the eye, and triangles reach behind it.
        let camera = camera([40, 30], 3.0, Lens::FieldOfView(80.0));
        let truth = see(&[mesh(&soup)], &unlit, false, &camera);
        let found = colors(&truth);
        let expected = brute(&soup, &camera);
        let off = found
            .iter()
            .step_by(3)
            .zip(&expected)
            .filter(|(a, b)| (f64::from(**a) - **b).abs() > 1e-6);
        assert_eq!(off.count(), 0, "seed {seed}");
        assert!(expected.iter().sum::<f64>() > 50.0, "something is seen");
    }
}

/// Edges pass through samples and centres; each sample is in exactly one of two triangles or in
/// both, never in none.
#[test]
fn nothing_shows_through_a_closed_mesh() {
    let unlit = lights("cube", vec![]);
    for lens in [Lens::FieldOfView(50.0), Lens::Orthographic(3.0)] {
        let camera = camera([64, 64], 4.0, lens);
        let truth = see(&[globe(6)], &unlit, true, &camera);
        let alpha = truth.frame.scalar("A").unwrap().values();
        let color = truth.frame.color("").unwrap().values();
        let regions = regions(alpha, 64);
        let inside: Vec<usize> =
            (0..regions.len()).filter(|&i| regions[i] == Region::Interior).collect();
        assert!(inside.len() > 500);
        // All have the material's colour; a hole would be darker.
        let open = inside.iter().filter(|&&i| color[i][0] != unlit.material.color.x);
        assert_eq!(open.count(), 0);
    }
}

#[test]
fn threads_tiles_and_order_change_no_bit() {
    let scene = lights("both", vec![Light::DEFAULT]);
    let camera = camera([70, 45], 3.0, Lens::FieldOfView(50.0));
    let surfaces = [globe(9), shape("torus")];
    let expected = see(&surfaces, &scene, true, &camera);
    for (threads, tile) in [(1, 8), (2, 64), (3, 32)] {
        let exec = Exec::new(threads, tile).unwrap();
        let found =
            of_surfaces(&surfaces, &scene, true, &camera, &[[0, 0], [3, 5]], &exec, &|_, _, _| ())
                .unwrap();
        assert_eq!(found.frame, expected.frame);
        assert_eq!(&found.shifted[0], expected.frame.color("").unwrap());
    }
}

#[test]
fn a_shift_is_a_camera_that_is_shifted() {
    let scene = lights("torus", vec![Light::DEFAULT]);
    let camera = camera([48, 40], 5.0, Lens::FieldOfView(50.0));
    let exec = Exec::new(2, 16).unwrap();
    let shifts = [[1, 3], [7, 0], [4, 4]];
    let surfaces = [shape("torus"), globe(5)];
    let truth =
        of_surfaces(&surfaces, &scene, true, &camera, &shifts, &exec, &|_, _, _| ()).unwrap();
    for (found, [kx, ky]) in truth.shifted.iter().zip(shifts) {
        let moved =
            Camera { cx: camera.cx + kx as f32 / 8.0, cy: camera.cy + ky as f32 / 8.0, ..camera };
        let expected = see(&surfaces, &scene, true, &moved);
        let (a, b) = (found.values(), expected.frame.color("").unwrap().values());
        let off = a.iter().zip(b).flat_map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]).abs()));
        assert!(off.fold(0.0, |most, off| if off > most { off } else { most }) < 1e-5);
    }
}

#[test]
fn points_come_to_what_their_splats_cover() {
    let shape = Shape::Sphere;
    let scene = Scene::lit("sphere", shape.surfels(4000, 0).unwrap());
    let camera = camera([64, 48], 4.0, Lens::FieldOfView(40.0));
    let exec = Exec::new(2, 32).unwrap();
    let found = of_points(&scene, &camera, &[[0, 0], [4, 2]], &exec, &|_, _, _| ()).unwrap();
    assert_eq!(found.how, How::Points);
    assert_eq!(&found.shifted[0], found.frame.color("").unwrap());
    let exact = see(
        &[Surface::Shape { shape, place: Similarity::IDENTITY, color: None }],
        &scene,
        true,
        &camera,
    );
    // The splats reach 1/20 of the radius beyond the outline, and are smooth inside.
    assert!(rmse(&colors(&found), &colors(&exact)) < 0.06);
    let moved = Camera { cx: camera.cx + 0.5, cy: camera.cy + 0.25, ..camera };
    let moved = of_points(&scene, &moved, &[], &exec, &|_, _, _| ()).unwrap();
    let flat =
        |plane: &Plane<[f32; 3]>| plane.values().iter().flatten().copied().collect::<Vec<_>>();
    assert!(rmse(&flat(&found.shifted[1]), &colors(&moved)) < 1e-6);
}
