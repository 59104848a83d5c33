//! The goldens `*_ladder*`, whose decisions lie beside their limits by steps of 1e-6 and more: what a
//! limit that is a little off turns is wrong, as no rounding turns it. Cut-offs that are off are bugs of
//! the [client](crate::verify::client).

use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::{Method, Session};
use splatref::scene::{Camera, Scene, Surfels};
use splatref::setting::{Fields, Value};
use splatref::verdict::Outcome;
use splatref::verdict::client::{Client, Rounding};
use std::path::Path;

/// The word of a verdict on the pictures that the crate draws of a golden with this epsilon, and the
/// first stage that is wrong.
fn judged(golden: &str, epsilon: f32, promise: Rounding) -> (Outcome, Option<&'static str>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(golden);
    let exec = Exec::sequential();
    let ready = SceneFile::open(&path).unwrap().ready(&exec, &|_, _, _| ()).unwrap();
    let mut changed = ready.method;
    changed.set("epsilon", &Value::Number(epsilon)).unwrap();
    let drawn = |method: Method| {
        let scene = &ready.loaded.scene;
        Session::prepare(scene, method, ready.grouping, &exec, &|_, _, _| ()).unwrap().0
    };
    let frame = drawn(changed).define::<f32>(&ready.camera, true).unwrap().frame;
    let mut client = Client::from(&frame);
    client.rounding = promise;
    let verdict = drawn(ready.method).verify(&ready.camera, &client, 0.02).unwrap();
    (verdict.outcome(), verdict.first_wrong().map(|stage| stage.stage))
}

const GOLDENS: [&str; 4] =
    ["ewa_ladder_affine.toml", "ewa_ladder_raycast.toml", "gbp04_ladder.toml", "zp06_ladder.toml"];

const PERSPECTIVE: &str = "ewa_ladder_perspective.toml";

#[test]
fn an_epsilon_a_little_off_is_wrong() {
    for golden in GOLDENS {
        for (epsilon, promise, right) in [
            (1.0, Rounding::Ieee, true),
            (1.0, Rounding::Gpu, true),
            (1.000_002, Rounding::Ieee, false),
            (0.999_998, Rounding::Ieee, false),
            (1.000_01, Rounding::Gpu, false),
            (0.999_99, Rounding::Gpu, false),
        ] {
            let (outcome, stage) = judged(golden, epsilon, promise);
            let expected = if right { Outcome::Right } else { Outcome::Wrong };
            assert_eq!(outcome, expected, "{golden}: {epsilon}, {promise:?}");
            let first = stage.is_none_or(|stage| ["attributes", "compositing"].contains(&stage));
            assert!(first, "{golden}: {epsilon}, {stage:?}");
        }
    }
}

/// In perspective, with pairs at the depths 4 and 8, so that the second is at the limit exactly.
#[test]
fn in_perspective_an_epsilon_a_little_off_is_wrong() {
    for (epsilon, promise, right) in [
        (4.0, Rounding::Ieee, true),
        (4.0, Rounding::Gpu, true),
        (4.000_008, Rounding::Ieee, false),
        (3.999_992, Rounding::Ieee, false),
        (4.000_04, Rounding::Gpu, false),
        (3.999_96, Rounding::Gpu, false),
    ] {
        let (outcome, stage) = judged(PERSPECTIVE, epsilon, promise);
        let expected = if right { Outcome::Right } else { Outcome::Wrong };
        assert_eq!(outcome, expected, "{epsilon}, {promise:?}");
        assert!(stage.is_none_or(|stage| stage == "attributes"), "{epsilon}, {stage:?}");
    }
}

/// From inside, with centres beside the near plane, in front of it and behind.
#[test]
fn from_inside_a_near_plane_a_little_off_is_wrong() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/ewa_ladder_inside.toml");
    let exec = Exec::sequential();
    let ready = SceneFile::open(&path).unwrap().ready(&exec, &|_, _, _| ()).unwrap();
    let session = Session::new(&ready.loaded.scene, ready.method, &exec).unwrap();
    // The number that separates two centres is exposed where nothing rounds.
    let all = [Rounding::Ieee, Rounding::Precise, Rounding::Gpu];
    for (near, outcome, promises) in [
        (0.5, Outcome::Right, &all[..]),
        (0.5_f32.next_up(), Outcome::Wrong, &all[..1]),
        (0.5_f32.next_down(), Outcome::Wrong, &all[..1]),
        (0.500_002, Outcome::Wrong, &all[..]),
        (0.499_998, Outcome::Wrong, &all[..]),
    ] {
        let camera = Camera { near, ..ready.camera };
        let frame = session.define::<f32>(&camera, true).unwrap().frame;
        for &promise in promises {
            let mut client = Client::from(&frame);
            client.rounding = promise;
            let verdict = session.verify(&ready.camera, &client, 0.02).unwrap();
            assert_eq!(verdict.outcome(), outcome, "{near}, {promise:?}");
            let stage = verdict.first_wrong().map(|stage| stage.stage);
            assert!(stage.is_none_or(|stage| stage == "visibility"), "{near}, {stage:?}");
        }
    }
}

/// `t < nearest + epsilon` in place of `<=`: as if the limit were the number before 8, because no depth lies
/// between. Whoever divides within 2.5 ulp may have either depth on either side.
#[test]
fn a_strict_test_is_wrong_at_an_exact_tie() {
    let before = 4.0_f32.next_down().next_down();
    assert_eq!(4.0 + before, 8.0_f32.next_down());
    let strict = judged(PERSPECTIVE, before, Rounding::Ieee);
    assert_eq!(strict, (Outcome::Wrong, Some("attributes")));
    assert_eq!(judged(PERSPECTIVE, before, Rounding::Gpu).0, Outcome::Right);
}

/// Discs of `blue` that are cut off at another radius.
#[test]
fn a_rim_a_little_off_is_wrong() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/bjfm19_ladder.toml");
    let exec = Exec::sequential();
    let ready = SceneFile::open(&path).unwrap().ready(&exec, &|_, _, _| ()).unwrap();
    let scene = &ready.loaded.scene;
    for (factor, promise, right) in [
        (1.0, Rounding::Ieee, true),
        (1.0, Rounding::Gpu, true),
        (1.000_002, Rounding::Ieee, false),
        (0.999_998, Rounding::Ieee, false),
        (1.000_05, Rounding::Gpu, false),
        (0.999_95, Rounding::Gpu, false),
    ] {
        let mut cloud = scene.surfels.clone().into_cloud();
        cloud.radius.iter_mut().flatten().for_each(|radius| *radius *= factor);
        let other = Scene { surfels: Surfels::new(cloud).unwrap().0, ..scene.clone() };
        let drawn = Session::new(&other, ready.method, &exec).unwrap();
        let frame = drawn.define::<f32>(&ready.camera, true).unwrap().frame;
        let mut client = Client::from(&frame);
        client.rounding = promise;
        let session = Session::new(scene, ready.method, &exec).unwrap();
        let verdict = session.verify(&ready.camera, &client, 0.02).unwrap();
        let expected = if right { Outcome::Right } else { Outcome::Wrong };
        assert_eq!(verdict.outcome(), expected, "{factor}, {promise:?}");
        let stage = verdict.first_wrong().map(|stage| stage.stage);
        assert!(right || stage == Some("discs"), "{factor}: {stage:?}");
        if (factor, promise) == (1.0, Rounding::Gpu) {
            // Nothing is behind these discs: an empty pixel tells too, that its fragment is not inside. Half of the
            // undecided ones are; where the edge of the square is undecided too, nothing is told.
            assert!(2 * verdict.shifts[0].decisions > verdict.undecided, "{:?}", verdict.shifts);
        }
    }
}
