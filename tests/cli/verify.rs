//! `splatref verify`: what a client drew, judged from the command line.

use super::*;
use splatref::frame::{Frame, Plane, Samples};
use splatref::setting::Words;
use splatref::verdict::client::Rounding;
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
    for promise in ["gpu", "precise", "ieee"] {
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
fn json_lists_wrong_pixels_and_counts_errors() {
    let at = pictures();
    let (code, said) = verified(&at, "plain.exr", &["--epsilon", "1r", "--json", "verdict.json"]);
    assert_eq!(code, 1);
    let json = fs::read_to_string(at.path().join("verdict.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(said.contains(&format!("replay         {}", json["replay"].as_str().unwrap())));
    for stage in json["stages"].as_array().unwrap() {
        let counts: Vec<u64> = stage["histogram"]["counts"]
            .as_array()
            .unwrap()
            .iter()
            .map(|count| count.as_u64().unwrap())
            .collect();
        let edges = stage["histogram"]["edges"].as_array().unwrap();
        assert_eq!((counts.len(), counts.iter().sum::<u64>()), (edges.len() + 1, 61 * 47));
        let right = edges.iter().position(|edge| edge.as_f64() == Some(1.0)).unwrap();
        let wrong = stage["wrong"].as_u64().unwrap();
        assert_eq!(counts[right + 1..].iter().sum::<u64>(), wrong);
        let listed = stage["wrong_pixels"].as_array().unwrap();
        assert_eq!(listed.len() as u64, wrong.min(1000));
        if let Some(first) = listed.first() {
            assert_eq!(first["pixel"], stage["worst"]["pixel"]);
        }
    }
}

#[test]
fn a_page_is_written_whole_and_apart_from_other_files() {
    let at = pictures();
    let (code, said) = verified(&at, "mine.exr", &["--epsilon", "1r", "--report", "page.html"]);
    assert_eq!(code, 1, "{said}");
    assert_eq!(verified(&at, "mine.exr", &["--epsilon", "1r"]).1, said, "prints the same");
    let page = fs::read_to_string(at.path().join("page.html")).unwrap();
    for text in ["epsilon is twice as wide", "splatref explain sphere", "visible if depth"] {
        assert!(page.contains(text), "no {text}");
    }
    assert!(!page.contains("://") && page.ends_with("</html>\n"), "loads nothing");
    let verify = |rest: &[&str], code| {
        fails(
            at.path(),
            &[&["verify"], &SCENE[..1], &["mine.exr"], &SCENE[1..], rest].concat(),
            code,
        )
    };
    for rest in [["--json", "a.x", "--report", "./a.x"], ["-o", "a.exr", "--report", "a.exr"]] {
        assert!(verify(&rest, 2).contains("are the same file; give two names"));
    }
    assert!(verify(&["--report", "mine.exr"], 2).contains("is also an input"));
    assert!(verify(&["--report", "-"], 2).contains("standard output"));
    assert!(verify(&["--report", "none/page.html"], 2).contains("none/page.html"));
    // A read-only page stays, and no other file is replaced.
    fs::write(at.path().join("v.json"), "old").unwrap();
    fs::create_dir(at.path().join("folder.html")).unwrap();
    verify(&["--json", "v.json", "--report", "folder.html"], 2);
    assert_eq!(fs::read_to_string(at.path().join("v.json")).unwrap(), "old");
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn a_page_of_1024_x_768_pixels_has_less_than_10_mb() {
    let at = TempDir::new().unwrap();
    let scene = ["sphere", "--count", "20000", "--size", "1024x768"];
    succeeds(at.path(), &[&["render"], &scene[..], &["--stages", "-o", "mine.exr"]].concat());
    let page = ["--epsilon", "1r", "--report", "page.html"];
    let verify = [&["verify", "sphere", "mine.exr"], &scene[1..], &page].concat();
    assert_eq!(splatref(at.path(), &verify).status.code(), Some(1));
    let length = fs::metadata(at.path().join("page.html")).unwrap().len();
    assert!((1_000_000..10_000_000).contains(&length), "{length} bytes");
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
    assert!(said.contains("WRONG        ieee    cut-off: 200 undecided decisions"), "{said}");
    // So it is under every promise.
    for (word, _) in Rounding::WORDS {
        for (name, covered) in [("a.json", 2), ("b.json", 3)] {
            json["promise"] = (*word).into();
            json["covered"] = covered.into();
            fs::write(at.path().join(name), json.to_string()).unwrap();
        }
        let output = splatref(at.path(), &["suite", "a.json", "b.json"]);
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("cut-off: 200 undecided decisions"), "{said}");
    }
    fs::write(at.path().join("no.json"), "{}").unwrap();
    assert!(fails(at.path(), &["suite", "no.json"], 2).contains("not a verdict"));
}

#[test]
fn a_suite_knows_every_word_of_its_verdicts() {
    let at = pictures();
    assert_eq!(verified(&at, "plain.exr", &["--json", "right.json"]).0, 0);
    let right = fs::read_to_string(at.path().join("right.json")).unwrap();
    let right: serde_json::Value = serde_json::from_str(&right).unwrap();
    for (place, value, said) in [
        (
            "/outcome",
            "wrnog".into(),
            "outcome is \"wrnog\", but can be right, unlike, wrong, undecidable",
        ),
        ("/outcome", serde_json::Value::Null, "not a verdict"),
        ("/promise", "GPU".into(), "promise is \"GPU\", but can be "),
        ("/shifts/1/limit", "side".into(), "shifts.limit is \"side\", but can be cut-off, epsilon"),
        ("/method", "splat".into(), "method is \"splat\", which is unknown"),
        (
            "/stages/0/stage",
            "blending".into(),
            "stages.stage is \"blending\", but can be projection, visibility",
        ),
        ("/shifts/0/variance", (-1).into(), "the numbers of the limit cut-off are impossible"),
    ] {
        let mut changed = right.clone();
        *changed.pointer_mut(place).unwrap() = value;
        fs::write(at.path().join("changed.json"), changed.to_string()).unwrap();
        let complaint = fails(at.path(), &["suite", "right.json", "changed.json"], 2);
        assert!(complaint.contains("changed.json: ") && complaint.contains(said), "{complaint}");
    }
    for (place, said) in [
        ("", "the field \"new\" is unknown"),
        ("/stages/0", "the field \"new\""),
        ("/shifts/0", "`new`"),
    ] {
        let mut changed = right.clone();
        changed.pointer_mut(place).unwrap()["new"] = 1.into();
        fs::write(at.path().join("changed.json"), changed.to_string()).unwrap();
        let complaint = fails(at.path(), &["suite", "changed.json"], 2);
        assert!(complaint.contains(said), "{complaint}");
    }
    assert!(fails(at.path(), &["suite", "nowhere.json"], 2).contains("nowhere.json"));
    assert!(fails(at.path(), &["suite", "."], 2).contains("this is no file"));
}

/// Nobody writes into the pipe.
#[cfg(unix)]
#[test]
fn a_suite_does_not_wait_for_a_pipe() {
    let at = TempDir::new().unwrap();
    let made = Command::new("mkfifo").arg(at.path().join("pipe")).status().unwrap();
    assert!(made.success());
    assert!(fails(at.path(), &["suite", "pipe"], 2).contains("pipe: this is no file"));
}

#[test]
fn the_cause_can_be_left_out() {
    let at = pictures();
    let other = ["--low-pass", "0.5"];
    let (code, said) = verified(&at, "plain.exr", &other);
    assert!(code == 1 && said.contains("looks like"), "{said}");
    let (code, said) = verified(&at, "plain.exr", &[&["--no-cause"], &other[..]].concat());
    assert!(code == 1 && !said.contains("looks like"), "{said}");
    // The command that explains the pixel takes neither option, and keeps the one after them.
    let rest = ["--strict", "--no-cause", "--low-pass", "0.5"];
    let (_, said) = verified(&at, "plain.exr", &rest);
    let replay = said.lines().find(|line| line.starts_with("replay")).unwrap();
    assert!(replay.contains("--low-pass 0.5") && !replay.contains("--no-cause"), "{replay}");
}

/// Each plane of a picture alone: wrong where the picture is wrong, and never an error or a share
/// above 100 %.
#[test]
fn a_single_wrong_plane_gets_a_verdict() {
    let at = TempDir::new().unwrap();
    for method in splatref::method::Method::all() {
        let options = ["--count", "200", "--size", "32x24", "--method", method.name()];
        for shape in ["sphere", "torus"] {
            let output = format!("{shape}.exr");
            succeeds(at.path(), &[&["render", shape], &options[..], &["-o", &output]].concat());
        }
        for (shape, plane) in ["sphere", "torus"].into_iter().flat_map(|shape| {
            ["RGB", "A", "Z", "id", "normal", "weight"].map(|plane| (shape, plane))
        }) {
            let rows = method.stages().iter().flat_map(|stage| stage.leaves);
            let name = if plane == "RGB" { "" } else { plane };
            if !rows.into_iter().any(|row| row.is_called(name)) {
                continue;
            }
            let toml = format!("[planes.{plane}]\nfile = \"{shape}.exr\"\n");
            fs::write(at.path().join("one.toml"), toml).unwrap();
            let verify = [&["verify", "sphere", "one.toml", "--no-cause"], &options[..]].concat();
            let output = splatref(at.path(), &verify);
            let said = String::from_utf8(output.stdout).unwrap();
            let name = format!("{}, {plane} of a {shape}: {said}", method.name());
            assert!(output.stderr.is_empty(), "{name}");
            let shares = said.split_whitespace().zip(said.split_whitespace().skip(1));
            let mut shares = shares.filter(|(_, unit)| *unit == "%").map(|(share, _)| share);
            assert!(shares.all(|share| share.parse::<f64>().unwrap() <= 100.0), "{name}");
            // Without their levels these methods judge little of a picture.
            let judges = !["peeling", "pyramid", "template"].contains(&method.name());
            match output.status.code() {
                Some(0) if shape == "sphere" || !judges => {}
                Some(1) if shape == "torus" => {}
                Some(3) if !judges => {}
                code => panic!("{code:?}: {name}"),
            }
        }
    }
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
    // Records are of two methods.
    let project = ["project", "sphere", "--count", "600", "--size", "61x47", "-o", "mine.bin"];
    succeeds(at.path(), &project);
    let toml = "file = \"plain.exr\"\nrecords = \"mine.bin\"\n";
    fs::write(at.path().join("records.toml"), toml).unwrap();
    assert_eq!(verified(&at, "records.toml", &[]).0, 0);
    let other = [&SCENE[..1], &["records.toml"], &SCENE[1..], &["--method", "peeling"]].concat();
    assert!(refused(&other).contains("only the methods ewa and gaussians judge records"));
    assert!(refused(&["sphere", "plain.exr", "--budget", "2"]).contains("a fraction from 0 to 1"));
}

/// The planes of a picture that a client with one mistake hands in.
fn with_mistake(
    image: &Image,
    depth: &dyn Fn(f32) -> f32,
    normal: f32,
    order: [usize; 3],
) -> Frame<f32> {
    let (width, height) = (image.width, image.height);
    let three = |names: [&str; 3]| {
        let parts = names.map(|name| floats(image, name));
        (0..parts[0].len()).map(|i| [0, 1, 2].map(|part: usize| parts[part][i])).collect::<Vec<_>>()
    };
    let depths = floats(image, "Z").into_iter().map(depth).collect();
    let shifted = |n: [f32; 3]| n.map(|part| part * normal + (1.0 - normal));
    let normals = three(["normal.X", "normal.Y", "normal.Z"]);
    let normals = normals.into_iter().map(|n| if n == [0.0; 3] { n } else { shifted(n) });
    let colors = three(["R", "G", "B"]).into_iter().map(|color| order.map(|part| color[part]));
    let frame = Frame::new(width, height);
    let with = |frame: Frame<f32>, name, samples| frame.with(name, samples).unwrap();
    let frame = with(frame, "Z", Samples::Scalar(Plane::from_values(width, height, depths)));
    let normals = Plane::from_values(width, height, normals.collect());
    let frame = with(frame, "normal", Samples::Vector(normals));
    with(frame, "", Samples::Color(Plane::from_values(width, height, colors.collect())))
}

#[test]
fn what_planes_mean_is_named_where_it_is_not_what_they_should() {
    let at = pictures();
    let image = exr::read(&at.path().join("plain.exr")).unwrap();
    let named = |frame: &Frame<f32>, likely: &str| {
        exr::write(&at.path().join("other.exr"), frame, "").unwrap();
        let (code, said) = verified(&at, "other.exr", &[]);
        let found = said.lines().find(|line| line.starts_with("looks like"));
        assert!(code == i32::from(!likely.is_empty()), "{likely}: {said}");
        assert!(found.unwrap_or("").contains(likely), "{likely}: {said}");
    };
    let (own, rgb) = (|t: f32| t, [0, 1, 2]);
    named(&with_mistake(&image, &own, 1.0, rgb), "");
    let window = |near: f32, far: f32| {
        move |t: f32| {
            let (near, far, t) = (f64::from(near), f64::from(far), f64::from(t));
            if t.is_finite() { (far / (far - near) * (1.0 - near / t)) as f32 } else { 1.0 }
        }
    };
    let or = |empty: f32| move |t: f32| if t.is_finite() { t } else { empty };
    for (depth, likely) in [
        (&or(0.0) as &dyn Fn(f32) -> f32, "the background of the depth is 0, not +inf"),
        (&or(1000.0), "the background of the depth is 1000, not +inf"),
        (&window(0.01, 100.0), "a z-buffer value that is not declared (near 0.01, far 100)"),
        (&window(0.5, 20.0), "a z-buffer value that is not declared (near 0.5, far 20)"),
        (&|t| 1.0 - window(0.1, 50.0)(t), "reversed z-buffer value that is not declared (near 0.1"),
        (&|t| -t, "depth is negative"),
        (&|t| 1.0 / t, "depth is 1/t, not t"),
        (&|t| 100.0 * t, "another scale or offset"),
    ] {
        named(&with_mistake(&image, depth, 1.0, rgb), likely);
    }
    named(&with_mistake(&image, &own, 0.5, rgb), "normals are stored in [0, 1]");
    let swapped = "channels are swapped: red, green and blue are in BGR";
    named(&with_mistake(&image, &own, 1.0, [2, 1, 0]), swapped);
    let swapped = "channels are swapped: red, green and blue are in GBR";
    named(&with_mistake(&image, &own, 1.0, [2, 0, 1]), swapped);
}

#[test]
fn a_wrong_number_is_estimated() {
    let at = pictures();
    for (options, likely) in [
        (["--low-pass", "0.3"], "the low-pass filter has another variance: 0.3 px^2, not 0.25"),
        (["--low-pass", "0.07"], "the low-pass filter has another variance: 0.07 px^2, not 0.25"),
        (["--cutoff", "2.2"], "the cut-off is 2.2, not 2"),
        (["--focal", "70"], "another field of view: the focal length is 70 px"),
    ] {
        let render = [&["render"], &SCENE[..], &options, &["-o", "other.exr"]].concat();
        succeeds(at.path(), &render);
        let (code, said) = verified(&at, "other.exr", &[]);
        assert!(code == 1 && said.contains(likely), "{options:?}: {said}");
    }
}
