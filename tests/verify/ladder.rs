//! The goldens `*_ladder*`, whose decisions lie beside their limits by steps of 1e-6 and more: what a
//! limit that is a little off turns is wrong, as no rounding turns it.

use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::{Method, Session};
use splatref::setting::{Fields, Value};
use splatref::verify::client::{Client, Rounding};
use splatref::verify::verdict::Outcome;
use std::path::Path;

/// The word of a verdict on the pictures that the crate draws of a golden if its method has this
/// setting, and the first stage that is wrong.
fn judged(
    golden: &str,
    setting: (&str, f32),
    promise: Rounding,
) -> (Outcome, Option<&'static str>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(golden);
    let exec = Exec::sequential();
    let ready = SceneFile::open(&path).unwrap().ready(&exec, &|_, _, _| ()).unwrap();
    let (name, value) = setting;
    let mut changed = ready.method;
    changed.set(name, &Value::Number(value)).unwrap();
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

const GOLDENS: [&str; 3] =
    ["ewa_ladder_affine.toml", "ewa_ladder_raycast.toml", "zp06_ladder.toml"];

#[test]
fn limits_a_little_off_are_wrong() {
    for golden in GOLDENS {
        for (setting, value, promise, right) in [
            ("cutoff", 2.0, Rounding::Ieee, true),
            ("cutoff", 2.0, Rounding::Gpu, true),
            // The limit of q is the square.
            ("cutoff", 2.000_001, Rounding::Ieee, false),
            ("cutoff", 1.999_999, Rounding::Ieee, false),
            ("cutoff", 2.000_02, Rounding::Gpu, false),
            ("cutoff", 1.999_98, Rounding::Gpu, false),
            ("epsilon", 1.000_002, Rounding::Ieee, false),
            ("epsilon", 0.999_998, Rounding::Ieee, false),
            ("epsilon", 1.000_01, Rounding::Gpu, false),
            ("epsilon", 0.999_99, Rounding::Gpu, false),
        ] {
            let (outcome, stage) = judged(golden, (setting, value), promise);
            let expected = if right { Outcome::Right } else { Outcome::Wrong };
            assert_eq!(outcome, expected, "{golden}: {setting} {value}, {promise:?}");
            let late = ["attributes", "compositing"].contains(&stage.unwrap_or("attributes"));
            assert!(late || setting == "cutoff", "{golden}: {setting} {value}, {stage:?}");
        }
    }
}
