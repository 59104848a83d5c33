//! `splatref verify`: what a client drew, judged from the command line.

use super::*;
use splatref::frame::{Frame, Plane, Samples};
use tempfile::TempDir;

const SCENE: [&str; 5] = ["sphere", "--count", "600", "--size", "61x47"];

/// A directory with `mine.exr`, every plane of [`SCENE`], and `plain.exr`, those of every picture.
fn pictures() -> TempDir {
    let at = TempDir::new().unwrap();
    let render = |rest: &[&str]| succeeds(at.path(), &[&["render"], &SCENE[..], rest].concat());
    render(&["--stages", "-o", "mine.exr"]);
    render(&["-o", "plain.exr"]);
    at
}

/// Exit code and what was printed, of the scene with options, without complaint.
fn verified(at: &TempDir, client: &str, rest: &[&str]) -> (i32, String) {
    let arguments = [&["verify"], &SCENE[..1], &[client], &SCENE[1..], rest].concat();
    let output = splatref(at.path(), &arguments);
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn what_render_writes_is_right() {
    let at = pictures();
    for promise in ["gpu", "ieee"] {
        for client in ["mine.exr", "plain.exr"] {
            let (code, said) = verified(&at, client, &["--promise", promise]);
            assert_eq!(code, 0, "{said}");
            assert!(said.lines().last().unwrap().starts_with("right: of "), "{said}");
            assert!(said.lines().count() <= 10, "{said}");
        }
    }
}

#[test]
fn a_wrong_setting_is_found_and_named() {
    let at = pictures();
    for (option, value, stage, likely) in [
        ("--low-pass", "0.5", "visibility", "half of the low-pass filter is missing"),
        ("--epsilon", "1r", "attributes", "epsilon is twice as wide"),
        ("--cutoff", "2.5", "visibility", ""),
    ] {
        let (code, said) = verified(&at, "plain.exr", &[option, value, "-oerrors.exr"]);
        assert_eq!(code, 1, "{said}");
        let line = |label: &str| said.lines().find(|line| line.starts_with(label));
        assert!(line("worst").unwrap().contains(stage), "{said}");
        assert!(line("looks like").unwrap_or("").contains(likely), "{said}");
        // The replay is a command that works and shows the wrong value.
        let replay = line("replay").unwrap().split_whitespace().skip(2);
        let replay: Vec<&str> = replay.collect();
        let shown = succeeds(at.path(), &replay);
        assert!(shown.contains(&format!("{stage:<14} WRONG")), "{shown}");
    }
}

#[test]
fn the_errors_are_written_as_json_and_exr() {
    let at = pictures();
    let files = ["--epsilon", "1r", "-o", "errors.exr", "--json", "verdict.json"];
    assert_eq!(verified(&at, "plain.exr", &files).0, 1);
    let json = fs::read_to_string(at.path().join("verdict.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["outcome"], &json["first_wrong"]), (&"wrong".into(), &"attributes".into()));
    let wrong = json["stages"][1]["wrong"].as_u64().unwrap();
    let errors = exr::read(&at.path().join("errors.exr")).unwrap();
    let beyond = floats(&errors, "attributes.error").into_iter().filter(|error| *error > 1.0);
    assert!(wrong > 0 && beyond.count() as u64 == wrong);
    assert!(floats(&errors, "visibility.error").into_iter().all(|error| error <= 1.0));
}

#[test]
fn verdicts_of_a_suite_are_added() {
    let at = pictures();
    for (client, json) in [("mine.exr", "a.json"), ("plain.exr", "b.json")] {
        assert_eq!(verified(&at, client, &["--promise", "ieee", "--json", json]).0, 0);
    }
    let said = succeeds(at.path(), &["suite", "a.json", "b.json"]);
    assert_eq!(said.matches("right        ieee").count(), 2, "{said}");
    // As if each had a hundred decisions that lean to one side.
    let json = fs::read_to_string(at.path().join("a.json")).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["shifts"][0]["limit"], "cut-off");
    json["shifts"][0]["decisions"] = 100.into();
    for (key, value) in [("score", -4e7), ("information", 4e12), ("variance", 1e14)] {
        json["shifts"][0][key] = value.into();
    }
    fs::write(at.path().join("a.json"), json.to_string()).unwrap();
    let one = succeeds(at.path(), &["suite", "a.json"]);
    assert!(one.contains("1.0e-5 of itself too small; z = -4.0"), "{one}");
    // Named twice, or copied, it leans no more.
    fs::copy(at.path().join("a.json"), at.path().join("copy.json")).unwrap();
    let thrice = succeeds(at.path(), &["suite", "a.json", "./a.json", "copy.json"]);
    assert!(thrice.contains("cut-off: 100 undecided decisions"), "{thrice}");
    for again in ["./a.json", "copy.json"] {
        assert!(
            thrice.contains(&format!("{again}: the same verdict as a.json, counted once")),
            "{thrice}"
        );
    }
    // Another picture that leans the same way.
    json["covered"] = 1.into();
    fs::write(at.path().join("b.json"), json.to_string()).unwrap();
    let output = splatref(at.path(), &["suite", "a.json", "b.json"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("WRONG        ieee  cut-off: 200 undecided decisions"), "{said}");
    fs::write(at.path().join("no.json"), "{}").unwrap();
    assert!(fails(at.path(), &["suite", "no.json"], 1).contains("not a verdict"));
}

#[test]
fn what_is_undecided_beyond_the_budget_is_undecidable() {
    let at = TempDir::new().unwrap();
    let scene = ["sheets", "--count", "400", "--size", "61x47", "--epsilon", "0"];
    succeeds(at.path(), &[&["render"], &scene[..], &["-o", "sheets.exr"]].concat());
    let budget = |share: &str| {
        let verify = [&["verify"], &scene[..1], &["sheets.exr"], &scene[1..], &["--budget", share]];
        splatref(at.path(), &verify.concat())
    };
    let said = String::from_utf8(budget("0").stdout).unwrap();
    assert_eq!(budget("0").status.code(), Some(3), "{said}");
    assert!(said.contains("% of the covered pixels have undecided sums"), "{said}");
    assert_eq!(budget("1").status.code(), Some(0));
}

#[test]
fn what_is_not_judged_is_not_right() {
    let at = pictures();
    fs::write(at.path().join("margin.toml"), "[planes.margin]\nfile = \"mine.exr\"\n").unwrap();
    let (code, said) = verified(&at, "margin.toml", &[]);
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("undecidable: no plane was judged"), "{said}");
}

#[test]
fn a_client_is_described_in_a_file_beside_its_planes() {
    let at = pictures();
    // The depths as a depth buffer holds them, upside down.
    let image = exr::read(&at.path().join("plain.exr")).unwrap();
    let (width, height) = (image.width as usize, image.height as usize);
    let depth = floats(&image, "Z");
    let (near, far) = (0.5_f64, 20.0_f64);
    let z = |t: f32| match f64::from(t) {
        t if t.is_finite() => far * (t - near) / (t * (far - near)),
        _ => 1.0,
    };
    let rows = (0..height).rev().flat_map(|y| depth[y * width..][..width].to_vec());
    let bytes: Vec<u8> = rows.flat_map(|t| (z(t) as f32).to_le_bytes()).collect();
    fs::write(at.path().join("depth.raw"), bytes).unwrap();
    let toml = "origin = \"bottom-left\"\n[planes.Z]\nfile = \"depth.raw\"\nmeaning = \"z-buffer\"\n\
                near = 0.5\nfar = 20\n";
    fs::write(at.path().join("mine.toml"), toml).unwrap();
    let (code, said) = verified(&at, "mine.toml", &[]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("hand in the planes of the stage attributes"), "{said}");
    fs::write(at.path().join("mine.toml"), toml.replace("bottom-left", "top-left")).unwrap();
    let (code, said) = verified(&at, "mine.toml", &[]);
    assert!(code == 1 && said.contains("rows are flipped"), "{said}");
}

#[test]
fn a_picture_alone_is_judged_end_to_end() {
    let at = pictures();
    fs::write(at.path().join("png.toml"), "[planes.RGB]\nfile = \"plain.png\"\n").unwrap();
    let (code, said) = verified(&at, "png.toml", &[]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("1 plane of ewa"), "{said}");
    assert!(said.contains("hand in the planes of the stage visibility"), "{said}");
    let (code, said) = verified(&at, "png.toml", &["--low-pass", "0.5"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("half of the low-pass filter is missing"), "{said}");
}

#[test]
fn what_cannot_be_judged_is_no_verdict() {
    let at = pictures();
    let refused = |rest: &[&str]| fails(at.path(), &[&["verify"], rest].concat(), 2);
    assert!(refused(&["sphere", "nothere.exr"]).contains("nothere.exr"));
    fs::write(at.path().join("broken.exr"), b"no picture").unwrap();
    assert!(refused(&["sphere", "broken.exr"]).contains("broken.exr"));
    assert!(refused(&["sphere", "plain.exr"]).contains("61 x 47"), "another size");
    assert!(refused(&["nothere.ply", "plain.exr"]).contains("nothere.ply"));
    let own = [&SCENE[..1], &["plain.exr"], &SCENE[1..], &["-o", "plain.exr"]].concat();
    assert!(refused(&own).contains("is also an input"));
    let twice = [&own[..own.len() - 1], &["x.exr", "--json", "./x.exr"]].concat();
    assert!(refused(&twice).contains("are the same file"));
    // A file that the description names.
    fs::write(at.path().join("mine.toml"), "file = \"plain.exr\"\n").unwrap();
    let named = [&SCENE[..1], &["mine.toml"], &SCENE[1..], &["-o", "plain.exr"]].concat();
    assert!(refused(&named).contains("is also an input"));
    // Of two files both are written, or none.
    fs::create_dir(at.path().join("taken.json")).unwrap();
    let both = [&own[..own.len() - 1], &["x.exr", "--json", "taken.json"]].concat();
    assert!(refused(&both).contains("taken.json"));
    assert!(!at.path().join("x.exr").exists());
    let strange =
        Frame::new(61, 47).with("stranger", Samples::Scalar(Plane::filled(61, 47, 1.0))).unwrap();
    exr::write(&at.path().join("strange.exr"), &strange, "").unwrap();
    let strange = [&SCENE[..1], &["strange.exr"], &SCENE[1..]].concat();
    assert!(refused(&strange).contains("strange"));
    // Records are of one method.
    let project = ["project", "sphere", "--count", "600", "--size", "61x47", "-o", "mine.bin"];
    succeeds(at.path(), &project);
    let toml = "file = \"plain.exr\"\nrecords = \"mine.bin\"\n";
    fs::write(at.path().join("records.toml"), toml).unwrap();
    assert_eq!(verified(&at, "records.toml", &[]).0, 0);
    let other = [&SCENE[..1], &["records.toml"], &SCENE[1..], &["--method", "peeling"]].concat();
    assert!(refused(&other).contains("only the method ewa judges records"));
    assert!(refused(&["sphere", "plain.exr", "--budget", "2"]).contains("a fraction from 0 to 1"));
}
