use crate::method::Method;
use crate::method::template::{Falloff, LevelRule, Settings};
use crate::method::tests::surfels;
use crate::method::tests::verdicts::{Slip, assert_found, assert_right};
use crate::scene::{Camera, Lens, Scene};
use crate::source::Shape;

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
    // Large, so that coarse levels are not empty.
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
