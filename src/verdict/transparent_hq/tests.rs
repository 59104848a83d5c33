use crate::frame::{Exec, Frame, Samples};
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::tests::{color, scalar, surfels};
use crate::method::transparent;
use crate::method::transparent_hq::Settings;
use crate::method::{Method, Session};
use crate::scene::{Camera, Environment, Lens, Scene};
use crate::shade::optics::{BendingLayers, Refraction};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, Outline, SplatSettings};
use crate::verdict::Outcome;
use crate::verdict::client::Rounding;
use crate::verdict::tests::{
    Slip, assert_environment_found, assert_found, assert_none_wrong_in_halves, assert_right,
    assert_right_in_doubles, camera, surroundings, transparent, verdict,
};

fn settings(kernel: Kernel, epsilon: f32, nearest: DepthTest) -> Settings {
    let epsilon = Epsilon::World(epsilon);
    let splats = SplatSettings { kernel, epsilon, ..SplatSettings::BOTH_SIDES };
    let bins = BinCount::Count(40);
    let layers = transparent::Settings { splats, bins, ..Default::default() };
    Settings { layers, nearest, refraction: None }
}

const VORONOI: DepthTest = DepthTest::Voronoi(BinCount::Epsilon);

#[test]
fn what_the_crate_renders_is_right() {
    let perspective = Kernel { outline: Outline::Perspective, ..Kernel::DEFAULT };
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, size, lens, settings) in [
        (Shape::Sphere, [27, 21], None, settings(Kernel::DEFAULT, 0.1, VORONOI)),
        (Shape::Torus, [19, 31], None, settings(Kernel::ZP06, 0.05, DepthTest::Plain)),
        (Shape::Cluster, [27, 21], None, settings(Kernel::ZPVBG01, 0.1, VORONOI)),
        (Shape::Sheets { gap: 0.2 }, [9, 1], flat, settings(perspective, 0.05, VORONOI)),
    ] {
        let scene = Scene::lit("", transparent(shape.surfels(250, 5).unwrap()));
        let (camera, method) = (camera(shape, size, lens), Method::TransparentHq(settings));
        assert_right(&scene, &camera, method);
        assert_right_in_doubles(&scene, &camera, method);
        // With 11 digits, fragments just behind the end of the band are often undecided.
        assert_none_wrong_in_halves(&scene, &camera, method);
    }
}

#[test]
fn of_scenes_without_colours_too() {
    let scene = Scene::unlit("", surfels(100, 0.2, false, 3));
    let method = Method::TransparentHq(settings(Kernel::DEFAULT, 0.1, VORONOI));
    assert_right(&scene, &camera(Shape::Sphere, [29, 13], None), method);
}

/// Layers of random surfels, a few at each pixel.
fn layered() -> (Scene, Camera, Settings) {
    let scene = Scene::lit("", transparent(surfels(150, 0.3, true, 1)));
    let settings = settings(Kernel::DEFAULT, 0.1, VORONOI);
    (scene, camera(Shape::Sphere, [37, 33], None), settings)
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let slips = [
        ("nearest.group00.Z", Slip::Off(1e-4), "geometry"),
        ("nearest.group01.id", Slip::More, "geometry"),
        ("nearest.group00.weight", Slip::NotANumber, "geometry"),
        ("Z", Slip::Next, "nearest"),
        ("id", Slip::More, "nearest"),
        ("normal", Slip::Off(1e-3), "nearest"),
        ("weight", Slip::Off(1e-3), "nearest"),
        ("nearest", Slip::Off(1e-3), "nearest"),
        ("nearest.A", Slip::Off(1e-4), "nearest"),
        ("nearest.A", Slip::NotANumber, "nearest"),
        ("nearest.mask", Slip::More, "nearest"),
        ("blended.group00", Slip::Off(1e-3), "blending"),
        ("blended.group01", Slip::NotANumber, "blending"),
        ("blended.group00.opacities", Slip::Off(1e-4), "blending"),
        ("blended.group01.count", Slip::More, "blending"),
        ("blended.group00.id", Slip::More, "blending"),
        ("blended", Slip::Off(1e-4), "averaging"),
        ("blended.hidden", Slip::Off(1e-2), "averaging"),
        ("blended.layers", Slip::NotANumber, "averaging"),
        ("l", Slip::Off(1e-4), "compositing"),
        ("layers", Slip::Off(1e-4), "compositing"),
        ("", Slip::Off(1e-4), "compositing"),
        ("", Slip::NotANumber, "compositing"),
        ("A", Slip::Off(1e-4), "compositing"),
    ];
    let (scene, camera, settings) = layered();
    assert_found(&scene, &camera, Method::TransparentHq(settings), &slips);
}

/// Asserts that these stages are wrong under `settings`.
fn assert_wrong(
    scene: &Scene,
    camera: &Camera,
    settings: Settings,
    frame: &Frame<f32>,
    stage: &str,
) {
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(scene, Method::TransparentHq(settings), &exec).unwrap();
    for rounding in [Rounding::Ieee, Rounding::Gpu] {
        let found = verdict(&session, camera, frame, rounding);
        let found = found.first_wrong().map(|stage| stage.stage);
        assert_eq!(found, Some(stage), "{rounding:?}");
    }
}

/// The planes of a method, with all stages.
fn rendered(scene: &Scene, camera: &Camera, method: Method) -> Frame<f32> {
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(scene, method, &exec).unwrap();
    session.define::<f32>(camera, true).unwrap().frame
}

#[test]
fn layers_that_begin_elsewhere_are_found() {
    let (scene, camera, settings) = layered();
    // All fragments are blended, including the nearest layer's.
    let right = rendered(&scene, &camera, Method::TransparentHq(settings));
    let all = rendered(&scene, &camera, Method::Transparent(settings.layers));
    let mut frame = right.clone();
    let blended = |name: &str| name.starts_with("blended.group");
    frame.planes.retain(|plane| !blended(&plane.name));
    frame.planes.extend(all.planes.into_iter().filter(|plane| blended(&plane.name)));
    assert_wrong(&scene, &camera, settings, &frame, "blending");
    // The blended layers begin behind a band of another depth.
    let mut other = settings;
    other.layers.splats.epsilon = Epsilon::World(0.2);
    let behind = rendered(&scene, &camera, Method::TransparentHq(other));
    let mut frame = right;
    frame.planes.retain(|plane| !blended(&plane.name));
    frame.planes.extend(behind.planes.into_iter().filter(|plane| blended(&plane.name)));
    assert_wrong(&scene, &camera, settings, &frame, "blending");
}

#[test]
fn the_other_layers_before_the_nearest_are_found() {
    let (scene, camera, settings) = layered();
    let mut frame = rendered(&scene, &camera, Method::TransparentHq(settings));
    let (near, opacity) = (color(&frame, "nearest").clone(), scalar(&frame, "nearest.A").clone());
    let (others, alpha) = (color(&frame, "blended").clone(), scalar(&frame, "blended.A").clone());
    let plane = frame.planes.iter_mut().find(|plane| plane.name.is_empty()).unwrap();
    let Samples::Color(plane) = &mut plane.samples else { panic!("no colours") };
    for (i, value) in plane.values_mut().iter_mut().enumerate() {
        let through = (1.0 - alpha.values()[i]) * opacity.values()[i];
        *value = [0, 1, 2].map(|c| others.values()[i][c] + through * near.values()[i][c]);
    }
    assert_wrong(&scene, &camera, settings, &frame, "compositing");
}

#[test]
fn the_picture_is_judged_without_the_stages() {
    let (scene, camera, settings) = layered();
    let mut frame = rendered(&scene, &camera, Method::TransparentHq(settings));
    let of_stages = ["nearest", "blended", "l"];
    let own = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    frame.planes.retain(|plane| !of_stages.contains(&own(&plane.name).as_str()));
    let plane = frame.planes.iter_mut().find(|plane| plane.name.is_empty()).unwrap();
    let Samples::Color(plane) = &mut plane.samples else { panic!("no colours") };
    let seen = plane.values().iter().filter(|value| value[0] > 0.0).count();
    for value in plane.values_mut() {
        *value = value.map(|part| part * 1.01);
    }
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(&scene, Method::TransparentHq(settings), &exec).unwrap();
    let found = verdict(&session, &camera, &frame, Rounding::Gpu);
    let wrong = found.first_wrong().unwrap();
    assert_eq!(wrong.stage, "compositing");
    assert!(2 * wrong.wrong as usize > seen, "{} of {seen}", wrong.wrong);
}

fn refracting(settings: Settings, ratio: [f32; 3], layers: BendingLayers) -> Settings {
    Settings { refraction: Some(Refraction { ratio, layers }), ..settings }
}

const GLASS: [f32; 3] = [0.6875, 0.671_875, 0.656_25];

#[test]
fn what_is_seen_through_layers_that_bend_light_is_right() {
    let plain = settings(Kernel::DEFAULT, 0.1, VORONOI);
    // Light that leaves glass is reflected totally.
    let out = GLASS.map(|ratio| 1.0 / ratio);
    for (shape, environment, settings) in [
        (Shape::Sphere, Environment::Sky, plain),
        (Shape::Torus, surroundings(0, false), plain),
        (Shape::Sphere, Environment::Sky, refracting(plain, GLASS, BendingLayers::Multiple)),
        (Shape::Torus, surroundings(0, false), refracting(plain, GLASS, BendingLayers::Single)),
        (Shape::Cluster, surroundings(0, false), refracting(plain, out, BendingLayers::Multiple)),
    ] {
        let mut scene = Scene::lit("", transparent(shape.surfels(250, 5).unwrap()));
        scene.environment = Some(environment);
        let (camera, method) = (camera(shape, [27, 21], None), Method::TransparentHq(settings));
        assert_right(&scene, &camera, method);
        assert_right_in_doubles(&scene, &camera, method);
    }
}

#[test]
fn tiles_and_sizes_do_not_matter() {
    let plain = settings(Kernel::DEFAULT, 0.1, VORONOI);
    let settings = refracting(plain, GLASS, BendingLayers::Multiple);
    let mut scene = Scene::lit("", transparent(Shape::Torus.surfels(250, 5).unwrap()));
    scene.environment = Some(surroundings(0, false));
    for (tile, size) in [(8, [27, 21]), (64, [27, 21]), (8, [70, 65]), (64, [70, 65])] {
        let exec = Exec::new(1, tile).unwrap();
        let session = Session::new(&scene, Method::TransparentHq(settings), &exec).unwrap();
        let camera = camera(Shape::Torus, size, None);
        let frame = session.define::<f32>(&camera, true).unwrap().frame;
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = verdict(&session, &camera, &frame, rounding);
            assert_eq!(found.outcome(), Outcome::Right, "{tile} {size:?} {}", found.undecided);
        }
    }
}

#[test]
fn another_refraction_or_environment_is_found() {
    let (mut scene, camera, plain) = layered();
    let right = refracting(plain, GLASS, BendingLayers::Multiple);
    assert_environment_found(&scene, &camera, Method::TransparentHq(right), "compositing");
    assert_environment_found(&scene, &camera, Method::TransparentHq(plain), "compositing");
    scene.environment = Some(surroundings(0, false));
    let frame = |settings| rendered(&scene, &camera, Method::TransparentHq(settings));
    let inverse = GLASS.map(|ratio| 1.0 / ratio);
    let swapped = [GLASS[2], GLASS[1], GLASS[0]];
    let others = [
        refracting(plain, inverse, BendingLayers::Multiple),
        refracting(plain, swapped, BendingLayers::Multiple),
        refracting(plain, GLASS, BendingLayers::Single),
        plain,
    ];
    for other in others {
        assert_wrong(&scene, &camera, right, &frame(other), "compositing");
        assert_wrong(&scene, &camera, other, &frame(right), "compositing");
    }
    let slips = [
        ("", Slip::Off(0.1), "compositing"),
        ("", Slip::NotANumber, "compositing"),
        ("A", Slip::Off(1e-4), "compositing"),
    ];
    assert_found(&scene, &camera, Method::TransparentHq(right), &slips);
}
