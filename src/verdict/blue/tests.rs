//! Tests of verdicts on pictures of discs.

use crate::frame::{Exec, Frame, NO_ID, Samples};
use crate::index::Index;
use crate::method::Job;
use crate::method::blue::Settings;
use crate::method::blue::explain::{BlueEnd, explain};
use crate::method::blue::fast::tests::triangle;
use crate::method::tests::{id, surfels};
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Lens, Pose, Scene, Sides, Surfels};
use crate::source::Shape;
use crate::verdict::client::{Client, Rounding, Ties};
use crate::verdict::tests::{
    Slip, assert_environment_found, assert_found_where, assert_none_wrong_in_halves, assert_right,
    assert_right_in_doubles, camera, verdict,
};
use crate::verdict::{Fault, Outcome, Verdict};
use glam::{DVec3, Vec3};

fn blue(cull: bool) -> Method {
    Settings { cull }.into()
}

/// Gives some surfels a side of their square, and others none.
fn sided(mut scene: Scene) -> Scene {
    let runs = vec![(0, None), (40, Some(2.5)), (90, None), (130, Some(7.0)), (300, Some(1.0))];
    scene.sides = Some(Sides::new(runs).unwrap());
    scene
}

#[test]
fn what_the_crate_renders_is_right() {
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, lens, cull) in [
        (Shape::Sphere, None, true),
        (Shape::Cluster, None, false),
        (Shape::Torus, flat, true),
        (Shape::Sheets { gap: 0.2 }, flat, false),
    ] {
        let scene = Scene::lit("", shape.surfels(400, 5).unwrap());
        let camera = camera(shape, [37, 31], lens);
        assert_right(&scene, &camera, blue(cull));
        assert_right(&sided(scene), &camera, blue(cull));
    }
}

#[test]
fn so_are_scenes_without_colours_thin_pictures_and_triangles() {
    for (i, size) in [[1, 1], [1, 9], [29, 13]].into_iter().enumerate() {
        let mut scene = Scene::unlit("", surfels(60, 0.3, false, 3));
        let camera = camera(Shape::Sphere, size, None);
        assert_right(&scene, &camera, blue(false));
        scene.primitives = triangle(i == 0);
        assert_right(&sided(scene), &camera, blue(i == 1));
    }
}

#[test]
fn so_is_what_rounds_otherwise() {
    let scene = sided(Scene::lit("", surfels(200, 0.3, true, 1)));
    let camera = camera(Shape::Sphere, [37, 33], None);
    assert_right_in_doubles(&scene, &camera, blue(true));
    assert_none_wrong_in_halves(&scene, &camera, blue(false));
}

/// Random surfels, a triangle through them, and a camera.
fn mixed() -> (Scene, Camera, Method) {
    let mut scene = sided(Scene::lit("", surfels(200, 0.3, true, 1)));
    scene.primitives = triangle(true);
    (scene, camera(Shape::Sphere, [37, 33], None), blue(false))
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let (scene, camera, method) = mixed();
    let slips = [
        ("Z", Slip::Off(1e-4), "discs"),
        ("Z", Slip::NotANumber, "discs"),
        ("discs.offset", Slip::Off(1e-3), "discs"),
        ("discs.offset", Slip::NotANumber, "discs"),
        ("normal", Slip::Off(1e-3), "discs"),
        ("normal", Slip::NotANumber, "discs"),
        ("resolved", Slip::Off(1e-4), "discs"),
        ("weight", Slip::Next, "discs"),
        ("id", Slip::More, "discs"),
        ("id", Slip::Dropped, "discs"),
        ("", Slip::Off(1e-3), "shading"),
        ("", Slip::NotANumber, "shading"),
        ("A", Slip::Off(1e-3), "shading"),
    ];
    // Only surfels are dropped: the triangle is there twice, and which of two is shown is not
    // judged.
    let of_surfel = |frame: &Frame<f32>, i: usize| id(frame, "id").values()[i] < 200;
    assert_found_where(&scene, &camera, method, &slips, of_surfel);
}

#[test]
fn another_environment_is_found() {
    let (scene, camera, method) = mixed();
    assert_environment_found(&scene, &camera, method, "shading");
}

/// Asserts that a picture of another scene or of other settings is wrong in the discs.
fn assert_other(right: &Scene, other: &Scene, camera: &Camera, methods: [Method; 2]) {
    let exec = Exec::new(1, 16).unwrap();
    let [right, other] = [(right, methods[0]), (other, methods[1])]
        .map(|(scene, method)| Session::new(scene, method, &exec).unwrap());
    let frame = other.define::<f32>(camera, true).unwrap().frame;
    let without = |frame: &Frame<f32>| Frame {
        planes: frame.planes.iter().filter(|plane| plane.name != "id").cloned().collect(),
        ..*frame
    };
    for frame in [&frame, &without(&frame)] {
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = verdict(&right, camera, frame, rounding);
            assert_eq!(found.first_wrong().map(|stage| stage.stage), Some("discs"));
        }
    }
}

#[test]
fn the_faults_of_a_shader_are_found() {
    let (scene, camera, _) = mixed();
    let with = |change: &dyn Fn(&mut Cloud)| {
        let mut cloud = scene.surfels.clone().into_cloud();
        change(&mut cloud);
        Scene { surfels: Surfels::new(cloud).unwrap().0, ..scene.clone() }
    };
    let both = [blue(false); 2];
    // Rims that are drawn too far, or not far enough.
    for factor in [1.01, 0.99] {
        let other = with(&|cloud| {
            cloud.radius.iter_mut().flatten().for_each(|radius| *radius *= factor);
        });
        assert_other(&scene, &other, &camera, both);
    }
    // Squares that do not become discs in depth, because all normals point towards the camera.
    let other = with(&|cloud| cloud.normal.iter_mut().flatten().for_each(|n| *n = Vec3::Z));
    assert_other(&scene, &other, &camera, both);
    // Squares that are a fifth of a pixel off, too large or too small.
    let other = with(&|cloud| cloud.position.iter_mut().for_each(|p| p.x += 0.02));
    assert_other(&scene, &other, &camera, both);
    for side in [6.9, 7.2] {
        let mut sides = scene.clone();
        sides.sides = Some(Sides::new(vec![(0, Some(7.0))]).unwrap());
        let mut other = sides.clone();
        other.sides = Some(Sides::new(vec![(0, Some(side))]).unwrap());
        assert_other(&sides, &other, &camera, both);
    }
    // Culling where there should be none, missing culling, and no triangles.
    assert_other(&scene, &scene, &camera, [blue(false), blue(true)]);
    assert_other(&scene, &scene, &camera, [blue(true), blue(false)]);
    let other = Scene { primitives: crate::scene::Primitives::default(), ..scene.clone() };
    assert_other(&scene, &other, &camera, both);
}

/// Discs of all sizes and places, at the near plane and beyond every number.
#[test]
fn extremes_are_right_or_undecided() {
    let numbers = [-3e38_f32, -4.0, 1e-30, 0.3, 3.99, 4.01, 3e38];
    let mut cloud = Cloud::default();
    for (i, &z) in numbers.iter().enumerate() {
        for (k, &x) in numbers.iter().enumerate() {
            cloud.position.push(Vec3::new(x, numbers[(i + 3 * k) % numbers.len()], z));
            let normal = [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, -0.8)][(i + k) % 3];
            cloud.normal.get_or_insert_default().push(normal);
            cloud.radius.get_or_insert_default().push([1e-20, 0.1, 7.0, 1e19, 3e38][(i + k) % 5]);
        }
    }
    let scene = Scene::lit("", Surfels::new(cloud).unwrap().0);
    let exec = Exec::new(1, 16).unwrap();
    for lens in [Lens::FieldOfView(40.0), Lens::Orthographic(3.0)] {
        let pose = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(23, 17, pose, lens).unwrap();
        let session = Session::new(&scene, blue(false), &exec).unwrap();
        let frame = session.define::<f32>(&camera, true).unwrap().frame;
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = verdict(&session, &camera, &frame, rounding);
            let wrong = found.first_wrong().and_then(|stage| stage.worst.clone());
            assert_eq!(wrong, None, "{rounding:?}");
        }
    }
}

/// Two discs in one place.
#[test]
fn of_equals_the_client_says_which_it_keeps() {
    let cloud = Cloud {
        position: vec![Vec3::ZERO; 2],
        normal: Some(vec![Vec3::Z; 2]),
        radius: Some(vec![0.5; 2]),
        ..Cloud::default()
    };
    let scene = Scene::unlit("twins", Surfels::new(cloud).unwrap().0);
    let pose = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(16, 16, pose, Lens::FieldOfView(30.0)).unwrap();
    let exec = Exec::sequential();
    let session = Session::new(&scene, blue(true), &exec).unwrap();
    let mut frame = session.define::<f32>(&camera, true).unwrap().frame;
    for last in [false, true] {
        for (ties, outcome) in [
            (Ties::Lowest, if last { Outcome::Wrong } else { Outcome::Right }),
            (Ties::Last, if last { Outcome::Right } else { Outcome::Wrong }),
            (Ties::Any, Outcome::Right),
        ] {
            let mut client = Client::from(&frame);
            client.ties = ties;
            let found = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
            assert_eq!(found.outcome(), outcome, "{ties:?}, {last}");
            let worst = found.stages[0].worst.as_ref().map(|worst| &worst.fault);
            assert!(worst.is_none_or(|fault| matches!(fault, Fault::Tie { .. })), "{worst:?}");
        }
        for plane in &mut frame.planes {
            if let Samples::Index(plane) = &mut plane.samples {
                let shown = plane.values_mut().iter_mut().filter(|id| **id != NO_ID);
                shown.for_each(|id| *id = 1);
            }
        }
    }
    assert!(id(&frame, "id").values().iter().filter(|id| **id == 1).count() > 40);
}

/// A fault for a missing surfel, an id outside its rim, and an id nowhere near, each by its name.
#[test]
fn a_fault_says_which_surfel() {
    let scene = Scene::unlit("", surfels(60, 0.3, false, 3));
    let camera = camera(Shape::Sphere, [29, 23], None);
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(&scene, blue(false), &exec).unwrap();
    let right = session.define::<f32>(&camera, false).unwrap().frame;
    let fault = |(x, y): (u32, u32), own: u32| {
        let mut frame = right.clone();
        frame.planes.retain(|plane| plane.name == "id");
        let Samples::Index(plane) = &mut frame.planes[0].samples else { panic!("ids") };
        plane.values_mut()[(y * 29 + x) as usize] = own;
        let found = verdict(&session, &camera, &frame, Rounding::Ieee);
        found.stages[0].worst.clone().map_or(Fault::Absent { surfel: NO_ID }, |worst| worst.fault)
    };
    let index = Index::default();
    let job = Job::new(&scene, &index, &camera, &exec);
    let mut found = [0; 3];
    for at in (0..23).flat_map(|y| (0..29).map(move |x| (x, y))).step_by(11) {
        let own = *id(&right, "id").at(at.0, at.1);
        if own != NO_ID {
            let fault = fault(at, NO_ID);
            assert!(matches!(fault, Fault::LeftOut { surfel, .. } if surfel == own), "{fault:?}");
            found[0] += 1;
        }
        let touches = explain::<f64>(&job, &Settings { cull: false }, at).unwrap().touches;
        for other in (0..60).step_by(7).filter(|other| *other != own) {
            let touch = touches.iter().find(|touch| touch.id == other);
            match (fault(at, other), touch.map(|touch| touch.end)) {
                (Fault::Outside { surfel, rim }, Some(BlueEnd::Discarded | BlueEnd::Near)) => {
                    assert!(surfel == other && rim > 1.0);
                    found[1] += 1;
                }
                (Fault::Absent { surfel }, None) => {
                    assert_eq!(surfel, other);
                    found[2] += 1;
                }
                (Fault::LeftOut { surfel, .. }, Some(BlueEnd::Loses(_) | BlueEnd::Nearest(_))) => {
                    assert_eq!(surfel, own);
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(found.iter().all(|count| *count > 0), "{found:?}");
}
