//! `splatref study`: errors that are the same again, folders that are gone on with, and refusals.

use super::{fails, names, splatref, succeeds};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::fs;
use std::path::Path;

const FEW: [&str; 8] =
    ["study", "torus", "--count", "600", "--size", "64x48", "--method", "template"];

fn study(at: &Path, more: &[&str]) -> String {
    succeeds(at, &[&FEW[..], more].concat())
}

fn kept(at: &Path, folder: &str) -> Value {
    serde_json::from_slice(&fs::read(at.join(folder).join("study.json")).unwrap()).unwrap()
}

/// Options and errors of all candidates.
fn errors(study: &Value) -> Vec<(String, Value)> {
    let of = |one: &Value| {
        let measured = &one["measured"];
        (one["options"].as_str().unwrap().to_owned(), measured["figures"].clone())
    };
    study["candidates"].as_array().unwrap().iter().map(of).collect()
}

#[test]
fn a_study_says_the_same_again() {
    let at = tempfile::tempdir().unwrap();
    let said = study(at.path(), &["-o", "a"]);
    assert!(said.contains("the exact surface, 8 x 8 rays a pixel"), "{said}");
    assert!(said.lines().any(|line| line.contains(" * --method template")), "{said}");
    assert_eq!(
        names(&at.path().join("a")),
        ["chart.png", "chart.svg", "index.html", "pictures", "study.csv", "study.json"]
    );
    study(at.path(), &["-o", "b", "--threads", "1", "--tile", "8"]);
    let [a, b] = ["a", "b"].map(|folder| kept(at.path(), folder));
    assert_eq!(errors(&a), errors(&b), "threads and tiles change no error");
    let rmse: Vec<f64> = errors(&a).iter().map(|(_, of)| of["rmse"].as_f64().unwrap()).collect();
    assert!(rmse.iter().all(|rmse| (1e-3..0.5).contains(rmse)), "{rmse:?}");
    let table = fs::read_to_string(at.path().join("a/study.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + rmse.len());
    let columns = table.lines().map(|line| line.split(',').count());
    assert!(columns.clone().all(|count| count == columns.clone().next().unwrap()), "{table}");
    let pictures = names(&at.path().join("a/pictures"));
    assert_eq!(pictures.len(), rmse.len() + 1, "the truth too: {pictures:?}");
    // Formats that are imitated have errors and no times, and so no place in the chart.
    let untimed = |one: &&Value| one["times"].as_array().unwrap().is_empty();
    let all = a["candidates"].as_array().unwrap();
    let untimed: Vec<&str> =
        all.iter().filter(untimed).map(|one| one["options"].as_str().unwrap()).collect();
    assert_eq!(untimed.len(), 5, "{untimed:?}");
    assert!(untimed.iter().all(|options| options.contains("storage ")), "{untimed:?}");
    let page = fs::read_to_string(at.path().join("a/index.html")).unwrap();
    assert_eq!(page.matches("data:image/png").count(), rmse.len() - untimed.len() + 1);
    assert!(!page.contains("{{") && !page.contains("http://") || page.contains("www.w3.org"));
}

/// Also of values with a dot, such as the cut-offs 1 and 1.5.
#[test]
fn each_picture_on_the_page_is_what_its_options_draw() {
    let at = tempfile::tempdir().unwrap();
    let scene = ["torus", "--count", "150", "--size", "24x18"];
    let options = ["--method", "single-pass", "-o", "a"];
    succeeds(at.path(), &[&["study"], &scene[..], &options].concat());
    let page = fs::read_to_string(at.path().join("a/index.html")).unwrap();
    let data =
        page.split_once("type=\"application/json\">").unwrap().1.split_once("</script>").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    let candidates = data["candidates"].as_array().unwrap();
    let dots = candidates.iter().filter(|one| one["options"].as_str().unwrap().contains('.'));
    assert!(dots.count() > 0, "a value with a dot");
    for one in candidates {
        let options: Vec<&str> = one["options"].as_str().unwrap().split(' ').collect();
        // Options of the candidate replace those of the scene.
        let scene: Vec<&str> = match options.contains(&"--count") {
            true => [&scene[..1], &scene[3..]].concat(),
            false => scene.to_vec(),
        };
        succeeds(at.path(), &[&["render"], &scene[..], &options, &["-o", "one.exr"]].concat());
        let drawn = fs::read(at.path().join("one.png")).unwrap();
        let shown = one["picture"].as_str().unwrap().strip_prefix("data:image/png;base64,");
        assert!(STANDARD.decode(shown.unwrap()).unwrap() == drawn, "{options:?}");
    }
}

#[test]
fn a_study_that_was_stopped_goes_on() {
    let at = tempfile::tempdir().unwrap();
    study(at.path(), &["-o", "whole"]);
    let whole = kept(at.path(), "whole");
    // Stopped after the first two: the others have nothing.
    let mut part = whole.clone();
    for record in part["candidates"].as_array_mut().unwrap().iter_mut().skip(2) {
        record["measured"] = Value::Null;
        record["times"] = Value::Array(Vec::new());
    }
    let first = part["candidates"][0]["times"][0].clone();
    fs::write(at.path().join("whole/study.json"), part.to_string()).unwrap();
    study(at.path(), &["-o", "whole", "--resume"]);
    let again = kept(at.path(), "whole");
    assert_eq!(errors(&again), errors(&whole));
    assert_eq!(again["candidates"][0]["times"][0], first, "what was timed is kept");
    // Of another picture nothing can go on.
    let other = ["study", "torus", "--count", "600", "--size", "64x49", "-o", "whole", "--resume"];
    assert!(fails(at.path(), &other, 1).contains("another scene, camera, truth or version"));
    fs::write(at.path().join("whole/study.json"), "{\"of\": 3}").unwrap();
    let broken = [&FEW[..], &["-o", "whole", "--resume"]].concat();
    assert!(fails(at.path(), &broken, 1).contains("not a study"));
    let none = [&FEW[..], &["-o", "none", "--resume"]].concat();
    fails(at.path(), &none, 1);
    assert!(!at.path().join("none").exists(), "nothing is made for what cannot go on");
}

#[test]
fn as_much_as_there_is_time_for() {
    let at = tempfile::tempdir().unwrap();
    let said = study(at.path(), &["-o", "a", "--time", "0.001s"]);
    assert!(said.contains("not tried"), "{said}");
    let all = kept(at.path(), "a");
    let measured = |one: &&Value| !one["measured"].is_null();
    assert_eq!(all["candidates"].as_array().unwrap().iter().filter(measured).count(), 1);
    study(at.path(), &["-o", "a", "--resume"]);
    let all = kept(at.path(), "a");
    assert!(all["candidates"].as_array().unwrap().iter().all(|one| measured(&one)));
}

#[test]
fn the_truth_may_be_that_of_another_scene() {
    let at = tempfile::tempdir().unwrap();
    let ball = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/ball.ply");
    succeeds(at.path(), &["surfels", ball, "-o", "points.ply", "--count", "300"]);
    let one =
        ["study", "points.ply", "--method", "template", "--size", "48x48", "--metric", "flip"];
    let alone = succeeds(at.path(), &[&one[..], &["-o", "alone"]].concat());
    assert!(alone.contains("no surface is known"), "{alone}");
    let with = succeeds(at.path(), &[&one[..], &["-o", "with", "--truth", ball]].concat());
    assert!(with.contains("the triangles, 8 x 8 rays a pixel"), "{with}");
    assert_ne!(errors(&kept(at.path(), "alone")), errors(&kept(at.path(), "with")));
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let at = tempfile::tempdir().unwrap();
    assert!(fails(at.path(), &["study", "nowhere.ply"], 1).contains("nowhere.ply"));
    fails(at.path(), &["study", "torus", "--metric", "beauty"], 2);
    for time in ["0s", "-3s", "60", "inf", "1e400s", "s"] {
        fails(at.path(), &["study", "torus", "--time", time], 2);
    }
    fails(at.path(), &["study", "torus", "--state", "x"], 2);
    fs::write(at.path().join("file"), "").unwrap();
    fails(at.path(), &[&FEW[..], &["-o", "file"]].concat(), 1);
    let cannot =
        fails(at.path(), &["study", "tree", "--count", "50", "--method", "ewa", "-o", "t"], 1);
    assert!(cannot.contains("--method pyramid"), "{cannot}");
    let out = splatref(at.path(), &["study", "torus", "--memory", "1M", "-o", "m"]);
    assert_eq!(out.status.code(), Some(1));
}

#[test]
fn one_failure_of_the_atlas() {
    let at = tempfile::tempdir().unwrap();
    let said = succeeds(at.path(), &["study", "failures", "--only", "bounds", "-o", "a"]);
    assert!(said.contains("bounds               breaks at 2 (distance, radii)"), "{said}");
    let page = fs::read_to_string(at.path().join("a/atlas.md")).unwrap();
    assert!(page.contains("## bounds\n") && !page.contains("## ewa-thin"));
    assert_eq!(names(&at.path().join("a/atlas")), ["bounds.png", "bounds.svg"]);
    let said = fails(at.path(), &["study", "failures", "--only", "nothing"], 2);
    assert!(said.contains("give one of ewa-grazing, "), "{said}");
    for others in [&["study", "torus", "failures"][..], &["study", "--metric", "flip", "failures"]]
    {
        fails(at.path(), &[others, &["--only", "bounds", "-o", "b"]].concat(), 2);
    }
    assert_eq!(names(at.path()), ["a"]);
    let said = fails(at.path(), &["study"], 2);
    assert!(said.contains("<SCENE>"), "{said}");
}
