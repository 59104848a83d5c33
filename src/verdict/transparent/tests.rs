use crate::method::Method;
use crate::method::single_pass::BinCount;
use crate::method::tests::surfels;
use crate::method::transparent::{BinEdges, Holes, Settings};
use crate::scene::{Lens, Scene};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, Outline, SplatSettings};
use crate::verdict::tests::{
    Slip, assert_environment_found, assert_found, assert_right, assert_right_in_doubles, camera,
    transparent,
};

fn settings(kernel: Kernel, bins: u32, holes: Holes) -> Settings {
    let splats =
        SplatSettings { kernel, epsilon: Epsilon::World(0.1), ..SplatSettings::BOTH_SIDES };
    // Follow the paper to the letter in both settings, or in none.
    let bin_edges = if holes == Holes::Background { BinEdges::Common } else { BinEdges::Staggered };
    Settings { splats, bins: BinCount::Count(bins), bin_edges, holes }
}

#[test]
fn what_the_crate_renders_is_right() {
    let perspective = Kernel { outline: Outline::Perspective, ..Kernel::DEFAULT };
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, lens, settings) in [
        (Shape::Sphere, None, settings(Kernel::DEFAULT, 40, Holes::Skipped)),
        (Shape::Cluster, None, settings(Kernel::ZPVBG01, 9, Holes::Background)),
        (Shape::Torus, None, settings(Kernel::ZP06, 300, Holes::Skipped)),
        (Shape::Torus, None, settings(perspective, 17, Holes::Skipped)),
        (Shape::Sheets { gap: 0.2 }, flat, settings(Kernel::DEFAULT, 21, Holes::Skipped)),
    ] {
        let scene = Scene::lit("", transparent(shape.surfels(250, 5).unwrap()));
        let (camera, method) = (camera(shape, [27, 21], lens), Method::Transparent(settings));
        assert_right(&scene, &camera, method);
        assert_right_in_doubles(&scene, &camera, method);
    }
}

#[test]
fn of_scenes_without_colours_and_of_thin_pictures_too() {
    let scene = Scene::unlit("", surfels(100, 0.2, false, 3));
    for size in [[1, 1], [1, 9], [29, 13]] {
        let settings = settings(Kernel::DEFAULT, 25, Holes::Skipped);
        assert_right(&scene, &camera(Shape::Sphere, size, None), Method::Transparent(settings));
    }
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let scene = Scene::lit("", transparent(surfels(150, 0.3, true, 1)));
    let slips = [
        ("blended.group00", Slip::Off(1e-3), "blending"),
        ("blended.group01", Slip::NotANumber, "blending"),
        ("blended.group00.A", Slip::Off(1e-4), "blending"),
        ("blended.group01.opacities", Slip::Off(1e-4), "blending"),
        ("blended.group00.bin", Slip::More, "blending"),
        ("blended.group01.count", Slip::More, "blending"),
        ("blended.group00.id", Slip::More, "blending"),
        ("blended", Slip::Off(1e-4), "averaging"),
        ("blended.A", Slip::NotANumber, "averaging"),
        ("blended.opacities", Slip::Off(1e-4), "averaging"),
        ("blended.hidden", Slip::Off(1e-2), "averaging"),
        ("blended.layers", Slip::Off(1e-4), "averaging"),
        ("layers", Slip::Next, "averaging"),
        ("Z", Slip::Off(1e-3), "averaging"),
        ("Z", Slip::NotANumber, "averaging"),
        ("id", Slip::More, "averaging"),
        ("", Slip::Next, "averaging"),
        ("A", Slip::Next, "averaging"),
    ];
    let camera = camera(Shape::Sphere, [37, 33], None);
    let settings = settings(Kernel::DEFAULT, 30, Holes::Skipped);
    assert_found(&scene, &camera, Method::Transparent(settings), &slips);
}

#[test]
fn another_environment_is_found() {
    let scene = Scene::lit("", transparent(surfels(150, 0.3, true, 1)));
    let camera = camera(Shape::Sphere, [27, 21], None);
    assert_environment_found(
        &scene,
        &camera,
        Method::Transparent(settings(Kernel::DEFAULT, 30, Holes::Skipped)),
        "averaging",
    );
}
