use crate::frame::{Exec, Samples};
use crate::method::peeling::Settings;
use crate::method::tests::scalar;
use crate::method::tests::surfels;
use crate::method::{Method, Session};
use crate::scene::{Camera, Lens, Scene};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, Outline, SplatSettings};
use crate::verdict::client::Rounding;
use crate::verdict::tests::{
    Slip, assert_environment_found, assert_found, assert_right, camera, transparent, verdict,
};

fn settings(kernel: Kernel, epsilon: f32, layers: u32) -> Settings {
    let epsilon = Epsilon::World(epsilon);
    Settings { splats: SplatSettings { kernel, epsilon, ..SplatSettings::BOTH_SIDES }, layers }
}

#[test]
fn what_the_crate_renders_is_right() {
    let perspective = Kernel { outline: Outline::Perspective, ..Kernel::DEFAULT };
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, lens, settings) in [
        (Shape::Sphere, None, settings(Kernel::DEFAULT, 0.1, 64)),
        (Shape::Cluster, None, settings(Kernel::ZPVBG01, 0.3, 8)),
        (Shape::Torus, None, settings(Kernel::ZP06, 0.1, 3)),
        (Shape::Torus, None, settings(perspective, 0.05, 16)),
        (Shape::Sheets { gap: 0.2 }, flat, settings(Kernel::DEFAULT, 0.05, 64)),
    ] {
        let scene = Scene::lit("", transparent(shape.surfels(400, 5).unwrap()));
        assert_right(&scene, &camera(shape, [37, 31], lens), Method::Peeling(settings));
    }
}

#[test]
fn of_scenes_without_colours_and_of_thin_pictures_too() {
    // Few surfels, because a pixel with more layers than leave planes is undecided.
    let scene = Scene::unlit("", surfels(60, 0.3, false, 3));
    for size in [[1, 1], [1, 9], [29, 13]] {
        let settings = settings(Kernel::DEFAULT, 0.6, 20);
        assert_right(&scene, &camera(Shape::Sphere, size, None), Method::Peeling(settings));
    }
}

/// Layers of random surfels, a few at each pixel.
fn layered() -> (Scene, Camera, Method) {
    let scene = Scene::lit("", transparent(surfels(120, 0.3, true, 1)));
    let method = Method::Peeling(settings(Kernel::DEFAULT, 0.2, 64));
    (scene, camera(Shape::Sphere, [37, 33], None), method)
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let (scene, camera, method) = layered();
    let slips = [
        ("layer1.Z", Slip::Off(1e-4), "layers"),
        ("layer1.Z", Slip::NotANumber, "layers"),
        ("layer2.Z", Slip::Off(1e-3), "layers"),
        ("layer2.Z", Slip::Dropped, "layers"),
        ("layer1.A", Slip::Off(1e-3), "layers"),
        ("layer2.A", Slip::NotANumber, "layers"),
        ("layer1", Slip::Off(1e-2), "layers"),
        ("layer3", Slip::NotANumber, "layers"),
        ("layer1.count", Slip::More, "layers"),
        ("layer3.count", Slip::More, "layers"),
        ("id", Slip::More, "layers"),
        ("Z", Slip::Next, "layers"),
        ("layers", Slip::More, "layers"),
        ("", Slip::Off(1e-3), "blending"),
        ("A", Slip::Off(1e-3), "blending"),
        ("A", Slip::NotANumber, "blending"),
    ];
    assert_found(&scene, &camera, method, &slips);
}

#[test]
fn layers_in_another_order_are_found() {
    let (scene, camera, method) = layered();
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(&scene, method, &exec).unwrap();
    let mut frame = session.define::<f32>(&camera, true).unwrap().frame;
    // Swap the first and the second layer wherever there are two.
    let depths = ["layer1.Z", "layer2.Z"].map(|name| scalar(&frame, name).clone());
    let there = |i: &usize| depths[1].values()[*i].is_finite();
    let i = (0..depths[0].values().len()).find(there).unwrap();
    for (name, depth) in [("layer1.Z", 1), ("layer2.Z", 0), ("Z", 1)] {
        let plane = frame.planes.iter_mut().find(|plane| plane.name == name).unwrap();
        let Samples::Scalar(plane) = &mut plane.samples else { panic!("{name}") };
        plane.values_mut()[i] = depths[depth].values()[i];
    }
    frame.planes.retain(|plane| plane.name.ends_with('Z'));
    for rounding in [Rounding::Ieee, Rounding::Gpu] {
        let found = verdict(&session, &camera, &frame, rounding);
        assert_eq!(found.first_wrong().map(|stage| stage.stage), Some("layers"));
    }
}

#[test]
fn another_environment_is_found() {
    let (scene, camera, method) = layered();
    assert_environment_found(&scene, &camera, method, "blending");
}
