use crate::frame::{Exec, NO_ID, Samples};
use crate::method::projection::tests::samples_mut;
use crate::method::template::{Falloff, LevelRule, Settings};
use crate::method::tests::surfels;
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Lens, Scene, Surfels};
use crate::source::Shape;
use crate::verdict::client::{Client, Ties};
use crate::verdict::tests::{Slip, assert_found, assert_right, assert_right_in_halves};

fn camera(shape: Shape, size: [u32; 2], lens: Option<Lens>) -> Camera {
    let lens = lens.unwrap_or(shape.default_lens());
    Camera::new(size[0], size[1], shape.default_pose(), lens).unwrap()
}

#[test]
fn what_the_crate_renders_is_right() {
    let narrow =
        Settings { size: 3, levels: LevelRule::Covering, falloff: Falloff::Gaussian, cull: false };
    let wide = Settings { size: 7, levels: LevelRule::Radius, ..Settings::default() };
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, size, lens, settings, lit) in [
        (Shape::Sphere, [57, 43], None, Settings::default(), true),
        (Shape::Cluster, [33, 50], None, narrow, true),
        (Shape::Torus, [31, 17], None, wide, false),
        (Shape::Sheets { gap: 0.02 }, [32, 40], flat, Settings::default(), true),
    ] {
        let surfels = shape.surfels(700, 5).unwrap();
        let scene = if lit { Scene::lit("", surfels) } else { Scene::unlit("", surfels) };
        assert_right(&scene, &camera(shape, size, lens), Method::Template(settings));
    }
}

#[test]
fn of_scenes_without_colours_and_of_thin_pictures_too() {
    let shape = Shape::Sphere;
    let scene = Scene::lit("", surfels(300, 0.2, false, 3));
    for size in [[1, 1], [1, 9], [29, 13]] {
        let settings = Settings { cull: size[0] == 1, ..Settings::default() };
        assert_right(&scene, &camera(shape, size, None), Method::Template(settings));
    }
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let shape = Shape::Sphere;
    // Large surfels, so that coarse levels are not empty.
    let scene = Scene::lit("", surfels(400, 0.4, true, 1));
    let settings = Settings { size: 3, levels: LevelRule::Covering, ..Settings::default() };
    let slips = [
        ("projection.Z", Slip::Off(1e-4), "projection"),
        ("projection.id", Slip::More, "projection"),
        ("projection.id", Slip::Dropped, "projection"),
        ("projection.normal", Slip::NotANumber, "projection"),
        ("projection.center.X", Slip::Off(1e-4), "projection"),
        ("projection.radius", Slip::Next, "projection"),
        ("level01.Z", Slip::Off(1e-4), "propagation"),
        ("level02.Z", Slip::NotANumber, "propagation"),
        ("level01.id", Slip::More, "propagation"),
        ("level02.id", Slip::Dropped, "propagation"),
        ("level03.center.Y", Slip::Off(1e-4), "propagation"),
        ("gathered.count", Slip::More, "reconstruction"),
        ("gathered.weight", Slip::Off(1e-4), "reconstruction"),
        ("gathered.Z", Slip::Next, "reconstruction"),
        ("gathered", Slip::Off(1e-4), "reconstruction"),
        ("id", Slip::More, "reconstruction"),
        ("Z", Slip::Off(1e-4), "normalization"),
        ("normal", Slip::Off(1e-4), "normalization"),
        ("weight", Slip::Next, "normalization"),
        ("", Slip::Off(1e-3), "shading"),
        ("A", Slip::Off(0.5), "shading"),
    ];
    let camera = camera(shape, [45, 37], None);
    assert_found(&scene, &camera, Method::Template(settings), &slips);
}

#[test]
fn a_client_that_keeps_its_planes_in_halves_is_right() {
    let scene = Scene::lit("", surfels(300, 0.4, true, 1));
    assert_right_in_halves(
        &scene,
        &camera(Shape::Sphere, [37, 29], None),
        Method::Template(Settings { size: 3, ..Settings::default() }),
    );
}

/// Every surfel is there twice, and the first one is kept.
#[test]
fn the_second_of_two_equal_surfels_is_found() {
    let once = surfels(200, 0.4, true, 1);
    let twice = |of: &[glam::Vec3]| of.repeat(2);
    let cloud = Cloud {
        position: twice(once.position()),
        normal: Some(twice(once.normal())),
        radius: Some(once.radius().repeat(2)),
        color: once.color().map(twice),
        ..Cloud::default()
    };
    let (twins, exec) = (Surfels::new(cloud).unwrap().0, Exec::sequential());
    let (scene, camera) = (Scene::lit("", twins), camera(Shape::Sphere, [37, 29], None));
    let method = Method::Template(Settings::default());
    assert_right(&scene, &camera, method);
    let session = Session::new(&scene, method, &exec).unwrap();
    let mut frame = session.define::<f32>(&camera, true).unwrap().frame;
    let Samples::Index(ids) = samples_mut(&mut frame, "projection.id") else { panic!("its type") };
    ids.values_mut().iter_mut().filter(|id| **id != NO_ID).for_each(|id| *id += 200);
    let mut client = Client::from(&frame);
    for (ties, right) in [(Ties::Lowest, false), (Ties::Last, true), (Ties::Any, true)] {
        client.ties = ties;
        let found = session.verify(&camera, &client, 1.0).unwrap();
        assert_eq!(found.stages[0].wrong == 0, right, "{ties:?}");
        assert!(right || found.stages[0].causes.ties > 50, "{:?}", found.stages[0].causes);
    }
}
