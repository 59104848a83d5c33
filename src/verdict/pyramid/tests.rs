use crate::frame::{Exec, Frame};
use crate::method::projection::SampleKind;
use crate::method::projection::tests::lit;
use crate::method::pyramid::tests::indexed;
use crate::method::pyramid::{Occlusion, Settings, Weights};
use crate::method::tests::{scene, surfels};
use crate::method::{Method, Session};
use crate::scene::indexed::{Indexed, Vertices};
use crate::scene::{Camera, Lens, Primitives, Scene};
use crate::source::Shape;
use crate::verdict::client::{Client, Rounding};
use crate::verdict::tests::{
    Slip, assert_found, assert_found_where, assert_right, assert_right_in_halves,
};
use crate::verdict::{Doubt, Outcome};
use glam::Vec3;

fn camera(shape: Shape, size: [u32; 2], lens: Option<Lens>) -> Camera {
    let lens = lens.unwrap_or(shape.default_lens());
    Camera::new(size[0], size[1], shape.default_pose(), lens).unwrap()
}

fn rare() -> Settings {
    Settings {
        weights: Weights::Box,
        occlusion: Occlusion::Outside,
        cull: false,
        ..Settings::default()
    }
}

/// Primitives between random points, wide enough that coarse levels have some.
fn wide<const N: usize>(count: u32, seed: u64) -> Indexed<N> {
    let narrow: Indexed<N> = indexed(count, seed);
    let (of, corners) = (narrow.vertices().clone(), narrow.corners().to_vec());
    let radius = of.radius.iter().map(|radius| radius * 6.0).collect();
    Indexed::new(Vertices { radius, ..of }, corners).unwrap().0
}

/// Surfels mixed with triangles, ribbons and tubes.
fn hybrid(color: bool) -> Scene {
    let primitives =
        Primitives { triangles: wide(5, 100), ribbons: wide(20, 200), tubes: wide(20, 300) };
    lit(Scene { primitives, ..scene(surfels(200, 0.1, color, 7)) })
}

#[test]
fn what_the_crate_renders_is_right() {
    let flat = Some(Lens::Orthographic(3.0));
    for (shape, size, lens, settings, lit) in [
        (Shape::Sphere, [57, 43], None, Settings::default(), true),
        (Shape::Cluster, [33, 50], None, rare(), true),
        (Shape::Torus, [31, 17], None, Settings::default(), false),
        (Shape::Sheets { gap: 0.02 }, [32, 40], flat, Settings::default(), true),
    ] {
        let surfels = shape.surfels(700, 5).unwrap();
        let scene = if lit { Scene::lit("", surfels) } else { Scene::unlit("", surfels) };
        assert_right(&scene, &camera(shape, size, lens), Method::Pyramid(settings));
    }
}

#[test]
fn of_scenes_without_colours_and_of_thin_pictures_too() {
    let scene = Scene::lit("", surfels(300, 0.2, false, 3));
    for size in [[1, 1], [1, 9], [29, 13]] {
        let settings = Settings { cull: size[0] == 1, ..Settings::default() };
        assert_right(&scene, &camera(Shape::Sphere, size, None), Method::Pyramid(settings));
    }
}

#[test]
fn of_scenes_of_ribbons_tubes_and_triangles_too() {
    for (color, lens, settings) in
        [(true, None, Settings::default()), (false, Some(Lens::Orthographic(3.0)), rare())]
    {
        let camera = camera(Shape::Sphere, [37, 29], lens);
        assert_right(&hybrid(color), &camera, Method::Pyramid(settings));
    }
}

#[test]
fn each_slip_is_found_in_its_stage() {
    // Large surfels, so that coarse levels are not empty.
    let scene = Scene::lit("", surfels(400, 0.4, true, 3));
    let camera = camera(Shape::Sphere, [45, 37], None);
    let slips = [
        ("projection.Z", Slip::Off(1e-4), "projection"),
        ("projection.id", Slip::More, "projection"),
        ("projection.id", Slip::Dropped, "projection"),
        ("projection.kind", Slip::More, "projection"),
        ("projection.extent", Slip::Off(1e-4), "projection"),
        ("pull01.front", Slip::Off(1e-4), "pull"),
        ("pull02.back", Slip::NotANumber, "pull"),
        ("pull01.kind", Slip::Dropped, "pull"),
        ("pull02.displacement.X", Slip::Off(1e-4), "pull"),
        ("pull03", Slip::Off(1e-4), "pull"),
        ("push00.front", Slip::Off(1e-4), "push"),
        ("push01.normal", Slip::NotANumber, "push"),
        ("push02.kind", Slip::Dropped, "push"),
        ("push00.kind", Slip::More, "push"),
        ("push01.extent", Slip::Off(1e-4), "push"),
        ("Z", Slip::Next, "shading"),
        ("kind", Slip::More, "shading"),
        ("normal", Slip::Off(1e-4), "shading"),
        ("", Slip::Off(1e-3), "shading"),
        ("A", Slip::Off(0.5), "shading"),
    ];
    assert_found(&scene, &camera, Method::Pyramid(Settings::default()), &slips);
}

#[test]
fn each_slip_beside_primitives_is_found_in_its_stage() {
    let camera = camera(Shape::Sphere, [37, 29], None);
    let slips = [
        ("projection.kind", Slip::More, "projection"),
        ("projection.tangent", Slip::Off(1e-4), "projection"),
        ("pull01.tangent", Slip::Off(1e-4), "pull"),
        ("push00.tangent", Slip::Off(1e-4), "push"),
        ("tangent", Slip::Off(1e-4), "shading"),
        ("", Slip::Off(1e-3), "shading"),
    ];
    assert_found(&hybrid(true), &camera, Method::Pyramid(Settings::default()), &slips);
}

#[test]
fn each_slip_of_a_ribbon_a_tube_or_a_triangle_is_found() {
    let slips = [
        ("projection.Z", Slip::Off(1e-4), "projection"),
        ("projection.id", Slip::More, "projection"),
        ("projection.id", Slip::Dropped, "projection"),
        ("projection.radius", Slip::Off(1e-4), "projection"),
        ("projection.normal", Slip::Off(1e-3), "projection"),
        ("projection", Slip::Off(1e-4), "projection"),
        ("projection.kind", Slip::More, "projection"),
    ];
    for lens in [None, Some(Lens::Orthographic(3.0))] {
        let camera = camera(Shape::Sphere, [37, 29], lens);
        for kind in [SampleKind::Polygon, SampleKind::Ribbon, SampleKind::Tube] {
            // The normal of a tube under an orthographic camera is (0, 0, 1).
            let flat = lens.is_some() && kind == SampleKind::Tube;
            let slips: Vec<_> =
                slips.into_iter().filter(|of| !flat || of.0 != "projection.normal").collect();
            let method = Method::Pyramid(rare());
            assert_found_where(&hybrid(true), &camera, method, &slips, |frame, place| {
                frame.count("projection.kind").unwrap().values()[place] == kind as u8
            });
        }
    }
}

#[test]
fn a_client_that_keeps_its_planes_in_halves_is_right() {
    let scene = hybrid(true);
    assert_right_in_halves(
        &scene,
        &camera(Shape::Sphere, [37, 29], None),
        Method::Pyramid(Settings::default()),
    );
}

#[test]
fn levels_that_are_not_handed_in_are_said() {
    let scene = Scene::lit("", surfels(300, 0.2, true, 3));
    let (camera, exec) = (camera(Shape::Sphere, [45, 37], None), Exec::sequential());
    let session = Session::new(&scene, Method::Pyramid(Settings::default()), &exec).unwrap();
    let whole = session.define::<f32>(&camera, true).unwrap().frame;
    let missing = |without: &dyn Fn(&str) -> bool| {
        let planes = whole.planes.iter().filter(|plane| !without(&plane.name)).cloned();
        let frame = Frame { planes: planes.collect(), ..whole };
        let verdict = session.verify(&camera, &Client::from(&frame), 1.0).unwrap();
        assert_eq!(verdict.first_wrong().map(|stage| stage.stage), None);
        let stages = verdict.stages.into_iter().map(|stage| (stage.stage, stage.missing));
        stages.collect::<Vec<_>>()
    };
    let none = || Vec::<String>::new();
    let all = |pull, push| {
        vec![("projection", none()), ("pull", pull), ("push", push), ("shading", none())]
    };
    assert_eq!(missing(&|_| false), all(none(), none()));
    // Drop the last two of six pull levels, and one plane.
    let last = |name: &str| name.starts_with("pull05") || name.starts_with("pull06");
    let found = missing(&|name| last(name) || name == "pull02.normal");
    let expected = ["pull02.normal", "level 5", "level 6"].map(str::to_owned).to_vec();
    assert_eq!(found, all(expected, none()));
    let found = missing(&|name| name.starts_with("push00"));
    assert_eq!(found, all(none(), vec!["level 0".into()]));
    // A phase without any plane is not judged.
    assert_eq!(missing(&|name| name.starts_with("pull")), all(none(), none()));
}

/// A plane from before the camera to behind it, so that the near plane cuts its triangles, and two
/// ribbons beside it.
fn across(ribbons: bool) -> Scene {
    let vertices = |places: &[[f32; 3]]| Vertices {
        position: places.iter().map(|at| (*at).into()).collect(),
        direction: vec![Vec3::new(0.6, 0.8, 0.0); places.len()],
        radius: vec![0.1; places.len()],
        color: Some((0..places.len()).map(|i| Vec3::new(0.2 * i as f32, 0.7, 0.4)).collect()),
        ..Vertices::default()
    };
    let floor =
        vertices(&[[-3.0, -1.0, -4.0], [3.0, -1.0, -4.0], [3.0, -0.6, 9.0], [-3.0, -1.2, 9.0]]);
    let triangles = Indexed::new(floor, vec![[0, 1, 2], [0, 2, 3]]).unwrap().0;
    let lines = vertices(&[[0.1, 0.2, -3.0], [0.2, 0.6, 9.0], [-0.8, 0.1, -2.0], [-0.4, 0.9, 9.0]]);
    let lines = Indexed::new(lines, vec![[0, 1], [2, 3]]).unwrap().0;
    let ribbons = if ribbons { lines } else { Indexed::default() };
    let primitives = Primitives { triangles, ribbons, ..Primitives::default() };
    lit(Scene { primitives, ..scene(surfels(60, 0.1, true, 7)) })
}

#[test]
fn triangles_that_the_near_plane_cuts_are_judged() {
    let (scene, camera) = (across(false), camera(Shape::Sphere, [37, 29], None));
    let method = Method::Pyramid(rare());
    let exec = Exec::sequential();
    let session = Session::new(&scene, method, &exec).unwrap();
    let frame = session.define::<f32>(&camera, true).unwrap().frame;
    let kinds = frame.count("projection.kind").unwrap().values();
    let polygons = kinds.iter().filter(|kind| **kind == SampleKind::Polygon as u8).count();
    assert!(polygons > 300, "{polygons}");
    for rounding in [Rounding::Ieee, Rounding::Gpu] {
        let client = Client { rounding, ..Client::from(&frame) };
        // Coarse levels of a floor have many near ties.
        let verdict = session.verify(&camera, &client, 1.0).unwrap();
        assert_eq!(verdict.outcome(), Outcome::Right, "{rounding:?}");
        assert_eq!(verdict.stages[0].doubtful(Doubt::Unbounded as u8), 0, "{rounding:?}");
    }
    let slips = [
        ("projection.Z", Slip::Off(1e-3), "projection"),
        ("projection.id", Slip::More, "projection"),
        ("projection.id", Slip::Dropped, "projection"),
        ("projection", Slip::Off(1e-2), "projection"),
        ("projection.normal", Slip::NotANumber, "projection"),
    ];
    assert_found_where(&scene, &camera, method, &slips, |frame, place| {
        frame.count("projection.kind").unwrap().values()[place] == SampleKind::Polygon as u8
    });
}

/// A ribbon that is cut is not judged, and its pixels say so.
#[test]
fn pixels_of_a_ribbon_that_is_cut_have_no_bounds() {
    let (scene, camera) = (across(true), camera(Shape::Sphere, [37, 29], None));
    let exec = Exec::sequential();
    let session = Session::new(&scene, Method::Pyramid(rare()), &exec).unwrap();
    let frame = session.define::<f32>(&camera, true).unwrap().frame;
    let verdict = session.verify(&camera, &Client::from(&frame), 0.0).unwrap();
    let kinds = frame.count("projection.kind").unwrap().values();
    let ribbons = kinds.iter().map(|kind| *kind == SampleKind::Ribbon as u8);
    let open = verdict.stages[0].doubts.values().iter();
    let open = open.map(|doubts| doubts & Doubt::Unbounded as u8 != 0);
    assert!(open.eq(ribbons), "{}", verdict.unbounded);
    assert!(verdict.unbounded > 10, "{}", verdict.unbounded);
    assert_eq!(verdict.outcome(), Outcome::Undecidable);
}
