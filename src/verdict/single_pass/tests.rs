use crate::frame::{Exec, Frame, NO_ID, Samples};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::single_pass::{BinCount, DepthTest, Settings};
use crate::method::tests::{count, id, scalar, surfels};
use crate::method::{Method, Session};
use crate::scene::{Cloud, Lens, Scene, Surfels};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, Outline, SplatSettings};
use crate::verdict::client::Rounding;
use crate::verdict::tests::{
    Slip, assert_environment_found, assert_found, assert_right, camera, verdict,
};

const VORONOI: DepthTest = DepthTest::Voronoi(BinCount::Epsilon);

/// Surfels in groups with this overlap.
fn grouped(surfels: Surfels, overlap: f32) -> Surfels {
    let rules = Rules { overlap, opposite: true, coplanar: None };
    let grouping = Grouping { rules, count: None, extension: Extension::None };
    let exec = Exec::sequential();
    let (groups, _, _) = grouping.groups(&surfels, &exec, &|_, _, _| ()).unwrap();
    // Regular surfels may need only one group.
    assert!(groups.len() > 1 || overlap < 1.0);
    Surfels::new(Cloud { groups: Some(groups), ..surfels.into_cloud() }).unwrap().0
}

fn settings(kernel: Kernel, epsilon: Epsilon, depth: DepthTest) -> Settings {
    Settings { splats: SplatSettings { kernel, epsilon, ..SplatSettings::default() }, depth }
}

#[test]
fn what_the_crate_renders_is_right() {
    let perspective = Kernel { outline: Outline::Perspective, ..Kernel::DEFAULT };
    let flat = Some(Lens::Orthographic(3.0));
    let world = Epsilon::World(0.05);
    let few = DepthTest::Voronoi(BinCount::Count(7));
    for (shape, lens, overlap, settings) in [
        (
            Shape::Sphere,
            None,
            0.4,
            settings(Kernel::DEFAULT, SplatSettings::default().epsilon, VORONOI),
        ),
        (Shape::Sphere, None, 1.0, settings(Kernel::ZP06, world, DepthTest::Plain)),
        (Shape::Torus, None, 1.0, settings(Kernel::ZP06, world, VORONOI)),
        (Shape::Cluster, None, 0.4, settings(Kernel::ZPVBG01, world, DepthTest::Plain)),
        (Shape::Cluster, None, 0.4, settings(perspective, world, few)),
        (Shape::Sheets { gap: 0.02 }, flat, 0.4, settings(Kernel::DEFAULT, world, VORONOI)),
        (
            Shape::Sheets { gap: 0.02 },
            flat,
            1.0,
            settings(Kernel::DEFAULT, Epsilon::World(0.0), DepthTest::Plain),
        ),
    ] {
        let scene = Scene::lit("", grouped(shape.surfels(500, 5).unwrap(), overlap));
        assert_right(&scene, &camera(shape, [41, 33], lens), Method::SinglePass(settings));
    }
}

#[test]
fn of_groups_that_overlap_too() {
    let shape = Shape::Sphere;
    for (overlap, depth) in [(0.4, DepthTest::Plain), (0.4, VORONOI), (0.1, VORONOI)] {
        let scene = Scene::lit("", grouped(surfels(250, 0.35, true, 2), overlap));
        let settings = settings(Kernel::DEFAULT, Epsilon::World(0.2), depth);
        let camera = camera(shape, [31, 37], None);
        assert_right(&scene, &camera, Method::SinglePass(settings));
    }
}

#[test]
fn of_scenes_without_colours_and_of_thin_pictures_too() {
    let shape = Shape::Sphere;
    let scene = Scene::unlit("", grouped(surfels(200, 0.2, false, 3), 0.4));
    for size in [[1, 1], [1, 9], [29, 13]] {
        let camera = camera(shape, size, None);
        assert_right(&scene, &camera, Method::SinglePass(Settings::default()));
    }
}

#[test]
fn each_slip_is_found_in_its_stage() {
    let shape = Shape::Sphere;
    let scene = Scene::lit("", grouped(surfels(300, 0.3, true, 1), 0.4));
    let slips = [
        ("group00.id", Slip::More, "geometry"),
        ("group00.id", Slip::Dropped, "geometry"),
        ("group01.id", Slip::Dropped, "geometry"),
        ("group00.Z", Slip::Off(1e-4), "geometry"),
        ("group01.Z", Slip::NotANumber, "geometry"),
        ("group01.weight", Slip::Off(1e-3), "geometry"),
        ("group00.normal", Slip::Off(1e-3), "geometry"),
        ("group01", Slip::Off(1e-3), "geometry"),
        ("group00.voronoi", Slip::Off(1e-3), "geometry"),
        ("sums.count", Slip::More, "compositing"),
        ("sums.weight", Slip::Off(1e-4), "compositing"),
        ("sums.normal", Slip::NotANumber, "compositing"),
        ("sums", Slip::Off(1e-4), "compositing"),
        ("resolved", Slip::Off(1e-4), "compositing"),
        ("Z", Slip::Next, "compositing"),
        ("Z", Slip::NotANumber, "compositing"),
        ("normal", Slip::Off(1e-4), "compositing"),
        ("weight", Slip::Next, "compositing"),
        ("id", Slip::More, "compositing"),
        ("", Slip::Off(1e-3), "shading"),
        ("A", Slip::Off(0.5), "shading"),
    ];
    let camera = camera(shape, [37, 33], None);
    let settings = settings(Kernel::DEFAULT, Epsilon::World(0.3), VORONOI);
    assert_found(&scene, &camera, Method::SinglePass(settings), &slips);
}

/// Changes the frame of a picture of several groups, and asserts that the first wrong stage is
/// `stage`.
fn changed(depth: DepthTest, change: impl Fn(&mut Frame<f32>) -> bool, stage: &str) {
    let scene = Scene::lit("", grouped(surfels(300, 0.3, true, 1), 0.4));
    let exec = Exec::new(1, 16).unwrap();
    let method = Method::SinglePass(settings(Kernel::DEFAULT, Epsilon::World(0.1), depth));
    let session = Session::new(&scene, method, &exec).unwrap();
    let camera = camera(Shape::Sphere, [37, 33], None);
    let mut frame = session.define::<f32>(&camera, true).unwrap().frame;
    assert!(change(&mut frame), "no place for the change");
    for rounding in [Rounding::Ieee, Rounding::Gpu] {
        let found = verdict(&session, &camera, &frame, rounding);
        let found = found.first_wrong().map(|stage| stage.stage);
        assert_eq!(found, Some(stage), "{rounding:?}");
    }
}

/// The values of a scalar plane.
fn values<'a>(frame: &'a mut Frame<f32>, name: &str) -> &'a mut [f32] {
    let plane = frame.planes.iter_mut().find(|plane| plane.name == name).unwrap();
    match &mut plane.samples {
        Samples::Scalar(plane) => plane.values_mut(),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn a_group_that_is_summed_from_beyond_epsilon_is_found() {
    let beyond = |frame: &mut Frame<f32>| {
        let (z, group) = (scalar(frame, "Z").clone(), scalar(frame, "group00.Z").clone());
        let far =
            |i: &usize| group.values()[*i].is_finite() && group.values()[*i] > 0.2 + z.values()[*i];
        let Some(i) = (0..z.values().len()).find(far) else { return false };
        let weight = scalar(frame, "group00.weight").values()[i];
        for name in ["sums.weight", "weight"] {
            values(frame, name)[i] += weight;
        }
        let plane = frame.planes.iter_mut().find(|plane| plane.name == "sums.count").unwrap();
        let Samples::Count(plane) = &mut plane.samples else { return false };
        plane.values_mut()[i] += 1;
        true
    };
    changed(VORONOI, beyond, "compositing");
    // The same from the picture alone.
    let alone = |frame: &mut Frame<f32>| {
        let found = beyond(frame);
        frame.planes.retain(|plane| !plane.name.starts_with("group"));
        found
    };
    changed(DepthTest::Plain, alone, "compositing");
}

#[test]
fn a_group_that_is_left_out_of_the_sums_is_found() {
    let less = |frame: &mut Frame<f32>| {
        let (counts, ids) = (count(frame, "sums.count").clone(), id(frame, "group00.id").clone());
        let first = |i: &usize| ids.values()[*i] != NO_ID && counts.values()[*i] == 1;
        let Some(i) = (0..ids.values().len()).find(first) else { return false };
        for name in ["sums.weight", "weight"] {
            values(frame, name)[i] = 0.0;
        }
        frame.planes.retain(|plane| !plane.name.starts_with("group"));
        true
    };
    changed(VORONOI, less, "compositing");
}

#[test]
fn the_other_depth_test_is_found() {
    // Hand in the image of the plain test for the Voronoi test, and the other way round.
    let scene = Scene::lit("", grouped(surfels(300, 0.4, true, 1), 0.3));
    let exec = Exec::new(1, 16).unwrap();
    let camera = camera(Shape::Sphere, [37, 33], None);
    let session = |depth| {
        let settings = settings(Kernel::DEFAULT, Epsilon::World(0.3), depth);
        Session::new(&scene, Method::SinglePass(settings), &exec).unwrap()
    };
    for (own, other) in [(VORONOI, DepthTest::Plain), (DepthTest::Plain, VORONOI)] {
        let mut frame = session(own).define::<f32>(&camera, true).unwrap().frame;
        frame.planes.retain(|plane| !plane.name.ends_with("voronoi"));
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = verdict(&session(other), &camera, &frame, rounding);
            let found = found.first_wrong().map(|stage| stage.stage);
            assert_eq!(found, Some("geometry"), "{other:?}");
        }
    }
}

#[test]
fn another_environment_is_found() {
    let scene = Scene::lit("", grouped(surfels(150, 0.3, true, 1), 0.4));
    let camera = camera(Shape::Sphere, [27, 21], None);
    assert_environment_found(
        &scene,
        &camera,
        Method::SinglePass(settings(Kernel::DEFAULT, Epsilon::World(0.1), VORONOI)),
        "shading",
    );
}
