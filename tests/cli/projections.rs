//! `splatref render --region` and `splatref assemble` by the methods that draw the projection of a region
//! alone.

use super::*;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::io::{exr::Region, provenance};
use tempfile::TempDir;

/// Divides a picture into seven regions in a mixed order, the first two of which overlap.
fn seven([w, h]: [u32; 2]) -> Vec<[u32; 4]> {
    vec![
        [w / 3, 0, w, h / 4],
        [0, 0, w / 2, h / 3],
        [0, h / 3, 1, h],
        [w - 1, h / 4, w, h],
        [1, h / 3, w / 2, h - 1],
        [w / 2, h / 4, w - 1, h - 1],
        [1, h - 1, w - 1, h],
    ]
}

/// Draws regions, and returns the names of their files.
fn parts(at: &Path, scene: &[&str], regions: &[[u32; 4]]) -> Vec<String> {
    let draw = |(i, region): (usize, &[u32; 4])| {
        let (file, words) = (format!("part{i}.exr"), region.map(|n| n.to_string()).join(","));
        let said = succeeds(at, &[&["render"], scene, &["--region", &words, "-o", &file]].concat());
        assert!(said.contains("the projection alone") && !said.contains(".png"), "{said}");
        assert!(!at.join(&file).with_extension("png").exists());
        file
    };
    regions.iter().enumerate().map(draw).collect()
}

fn joined(at: &Path, files: &[String]) -> Output {
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    splatref(at, &[&["assemble"], &files[..], &["-o", "joined.exr"]].concat())
}

/// Asserts that the whole picture, two regions and seven are one file.
fn divided(at: &Path, scene: &[&str], [w, h]: [u32; 2]) {
    succeeds(at, &[&["render"], scene, &["-o", "whole.exr"]].concat());
    for regions in [vec![[0, h / 2, w, h], [0, 0, w, h / 2]], seven([w, h])] {
        let output = joined(at, &parts(at, scene, &regions));
        assert!(output.status.success() && output.stderr.is_empty(), "{scene:?}: {output:?}");
        for kind in ["exr", "png"] {
            let read = |name: &str| fs::read(at.join(format!("{name}.{kind}"))).unwrap();
            assert!(read("whole") == read("joined"), "{scene:?}: {} regions", regions.len());
        }
    }
}

#[test]
fn what_the_later_stages_need_of_a_scene_comes_from_the_parts() {
    let at = TempDir::new().unwrap();
    let size = ["--size", "60x41"];
    for (method, more) in [
        ("pyramid", &["--stages", "--environment", "sky"][..]),
        ("template", &["--environment", "sky", "--compression", "zip"]),
        ("template", &["--stages", "--template", "3", "--falloff", "gaussian"]),
        ("pyramid", &["--compression", "piz", "--tile", "8", "--threads", "1"]),
    ] {
        let scene = [&["torus", "--count", "900", "--method", method], &size[..], more].concat();
        divided(at.path(), &scene, [60, 41]);
    }
    // Lights of every kind, a material without colours, an orthographic camera, and no light.
    let lights = "[[model]]\nshape = \"sphere\"\ncount = 500\n[material]\nspecular = 0.3\nambient = 0.1\n\
                  color = [0.3, 0.7, 0.1]\n[[light]]\nkind = \"directional\"\ntowards = [0.1, 0.7, 0.3]\n\
                  color = [1.7, 0.3, 0.9]\n[[light]]\nkind = \"point\"\nposition = [3, 0.1, 1e-7]\n\
                  [camera]\nsize = [50, 30]\northo = 2.3\n";
    fs::write(at.path().join("lights.toml"), lights).unwrap();
    let unlit =
        "light = []\n[[model]]\nshape = \"sphere\"\ncount = 500\n[camera]\nsize = [50, 30]\n";
    fs::write(at.path().join("unlit.toml"), unlit).unwrap();
    // Far from the origin, where coordinates are stored relative to an offset; no colours.
    let far = "v 9000000 -1 0\nv 9000001 -1 0.5\nv 9000000.5 1 0\nf 1 2 3\n";
    fs::write(at.path().join("far.obj"), far).unwrap();
    // Objects, whose ids are not the indices of their surfels.
    let objects = "[[geometry]]\nname = \"ball\"\nshape = \"sphere\"\ncount = 100\n[[object]]\nof = \
                   \"ball\"\n[[object]]\nof = \"ball\"\ncolor = [1, 0.1, 0.2]\ntransform = \
                   { translate = [2, 0, 0] }\n[camera]\nsize = [50, 30]\n";
    fs::write(at.path().join("objects.toml"), objects).unwrap();
    for scene in ["lights.toml", "unlit.toml", "far.obj", "objects.toml"] {
        for method in ["pyramid", "template"] {
            let scene = [scene, "--method", method, "--size", "50x30", "--stages"];
            divided(at.path(), &scene, [50, 30]);
        }
    }
}

const SCENE: [&str; 7] = ["torus", "--count", "400", "--size", "40x30", "--method", "pyramid"];
const HALVES: [[u32; 4]; 2] = [[0, 0, 40, 14], [0, 14, 40, 30]];

/// Asserts that an `assemble` fails with these words, and leaves no file.
fn refused(at: &Path, files: &[&str], words: &[&str]) {
    let line = fails(at, &[&["assemble"], files, &["-o", "none.exr"]].concat(), 1);
    assert!(words.iter().all(|word| line.contains(word)), "{words:?}: {line}");
    assert!(!at.join("none.exr").exists() && !at.join("none.png").exists());
}

/// Writes a part again, after `change` has changed its channels and its text.
fn changed(at: &Path, from: &str, to: &str, change: impl Fn(&mut Region)) {
    let exec = Exec::sequential();
    let mut part = exr::read_region(&at.join(from), &exec).unwrap();
    change(&mut part);
    let (width, height) = (part.image.width, part.image.height);
    let mut frame = Frame::new(width, height);
    for (name, values) in part.image.channels {
        let samples = match values {
            Values::Float(values) => Samples::Scalar(Plane::from_values(width, height, values)),
            Values::Index(values) => Samples::Index(Plane::from_values(width, height, values)),
        };
        frame.push(&name, samples).unwrap();
    }
    let (window, text) = (part.window, part.image.text.unwrap());
    let pending = exr::pending_part(&at.join(to), &frame, window, &text, Default::default(), &exec);
    pending.unwrap().put().unwrap();
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let at = TempDir::new().unwrap();
    let (at, region) = (at.path(), ["--region", "0,14,40,30", "-o", "other.exr"]);
    parts(at, &SCENE, &HALVES);
    let [a, b] = ["part0.exr", "part1.exr"];
    refused(at, &[a], &["--region 0,14,40,30"]);
    for (more, key) in [
        (&["--seed", "3"][..], "`scene.sha256`"),
        (&["--fov", "20"], "`camera."),
        (&["--weights", "box"], "`method.weights`"),
        (&["--stages"], "`projection.stages`"),
        (&["--environment", "sky"], "`projection.environment`"),
    ] {
        succeeds(at, &[&["render"], &SCENE[..], &region, more].concat());
        refused(at, &[a, "other.exr"], &["other.exr: ", key, a]);
    }
    // A finished picture among the parts; a region of all pixels is one.
    succeeds(
        at,
        &[&["render"], &SCENE[..], &["--region", "0,0,40,30", "-o", "whole.exr"]].concat(),
    );
    refused(at, &[a, "whole.exr"], &["whole.exr: it holds finished pixels", a, "projection alone"]);
    refused(at, &["whole.exr", a, b], &["part0.exr: it holds the projection alone"]);
    succeeds(at, &["assemble", "whole.exr", "-o", "again.exr"]);

    let bytes = fs::read(at.join(b)).unwrap();
    for length in [0, 3, 200, bytes.len() / 2, bytes.len() - 1] {
        fs::write(at.join("other.exr"), &bytes[..length]).unwrap();
        refused(at, &[a, "other.exr"], &["other.exr: "]);
    }
    let number = |channel: &'static str, value: f32| {
        move |part: &mut Region| {
            let all = &mut part.image.channels;
            let Some((_, Values::Float(values))) = all.iter_mut().find(|(name, _)| name == channel)
            else {
                panic!("{channel}")
            };
            values[43] = value;
        }
    };
    changed(at, b, "other.exr", number("projection.extent", f32::NAN));
    refused(at, &[a, "other.exr"], &["other.exr: `projection.extent` at pixel 3 15 is NaN"]);
    changed(at, b, "other.exr", number("projection.Z", 1.0));
    refused(at, &[a, b, "other.exr"], &["`projection.Z` at pixel 3 15 differs"]);
    // Numbers that no projection leaves give some picture, not a panic.
    for value in [f32::INFINITY, -1e30, 1e-45] {
        for channel in ["projection.extent", "projection.Z", "projection.normal.X"] {
            changed(at, b, "other.exr", number(channel, value));
            succeeds(at, &["assemble", a, "other.exr", "-o", "odd.exr"]);
        }
    }
    let kinds = |value: u32| {
        move |part: &mut Region| {
            let all = &mut part.image.channels;
            let kind = all.iter_mut().find(|(name, _)| name == "projection.kind");
            kind.unwrap().1 = Values::Index(vec![value; 40 * 16]);
        }
    };
    for (value, words) in [(5, "has 5 at (0, 14); at most 4"), (256, "has 256; at most 255")] {
        changed(at, b, "other.exr", kinds(value));
        refused(at, &[a, "other.exr"], &["`projection.kind`", words]);
    }
}

#[test]
fn texts_that_were_edited_are_refused_in_one_line() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    parts(at, &SCENE, &HALVES);
    let version = format!("splatref = \"{}\"", env!("CARGO_PKG_VERSION"));
    for (old, new, words) in [
        (&*version, "splatref = \"0.0.1\"", "splatref 0.0.1 drew the projection"),
        ("number = \"f32\"", "number = \"f64\"", "not as `render --region` wrote it"),
        ("name = \"pyramid\"", "name = \"pyramid\"\nrandom = 3", "unknown key `random`"),
        ("size = [40, 30]", "size = [41, 30]", "the planes have 40 x 30 pixels"),
        ("size = [40, 30]", "size = [0, 30]", "0 x 30 pixels"),
        ("stages = false", "stages = 7", "expected a boolean"),
        ("stages = false\n", "", "missing field `stages`"),
        ("stages = false", "stages = false\nfoo = 1", "unknown field `foo`"),
        ("tangents = false", "tangents = true", "`projection.tangent` is missing"),
        ("environment = false", "environment = true", "unlike the planes"),
        ("ambient = 0.125", "ambient = 2.0", "ambient 2"),
        ("kind = \"headlight\"", "kind = \"lamp\"", "lamp"),
        ("# The planes", "# Planes", "not as `render --region` wrote it"),
        ("near = ", "near = -", "near"),
    ] {
        for (part, to) in [("part0.exr", "a.exr"), ("part1.exr", "b.exr")] {
            changed(at, part, to, |part| {
                let text = part.image.text.take().unwrap();
                assert!(text.contains(old), "{old}: {text}");
                part.image.text = Some(text.replace(old, new));
            });
        }
        // One part alone has another text than the other; both agree, and are refused all the same.
        refused(at, &["part0.exr", "b.exr"], &["b.exr"]);
        refused(at, &["a.exr", "b.exr"], &[words]);
    }
    // A channel that all parts lack.
    for (part, to) in [("part0.exr", "a.exr"), ("part1.exr", "b.exr")] {
        changed(at, part, to, |part| {
            part.image.channels.retain(|(name, _)| name != "projection.normal.Y");
        });
    }
    refused(at, &["a.exr", "b.exr"], &["`projection.normal` is missing"]);
}

#[test]
fn a_part_is_never_judged_as_a_picture() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    parts(at, &SCENE, &HALVES);
    succeeds(at, &[&["render"], &SCENE[..], &["-o", "whole.exr", "--stages"]].concat());
    let says = |line: String| {
        let what = "part0.exr: holds the projection of a region";
        assert!(line.contains(what) && line.contains("splatref assemble"), "{line}");
    };
    says(fails(at, &[&["verify"], &SCENE[..], &["part0.exr"]].concat(), 2));
    let client = "[planes]\n\"projection.Z\" = { file = \"part0.exr\" }\n";
    fs::write(at.join("client.toml"), client).unwrap();
    says(fails(at, &[&["verify"], &SCENE[..], &["client.toml"]].concat(), 2));
    let pixel = ["3", "3", "--client", "part0.exr"];
    let output = splatref(at, &[&["explain", "torus"], &pixel[..], &SCENE[1..]].concat());
    says(String::from_utf8(output.stderr).unwrap());
    says(fails(at, &["compare", "whole.exr", "part0.exr"], 1));
    says(fails(at, &["compare", "part0.exr", "whole.exr", "--region", "0,0,9,9"], 1));
    assert!(succeeds(at, &["compare", "part0.exr", "part0.exr"]).contains("equal"));
    assert_eq!(splatref(at, &["compare", "part0.exr", "part1.exr"]).status.code(), Some(1));
    let line =
        fails(at, &[&["verify"], &SCENE[..], &["part0.exr", "--region", "0,0,9,9"]].concat(), 2);
    assert!(line.contains("coarse levels"), "{line}");
    let said = succeeds(at, &["info", "part0.exr"]);
    assert!(said.contains("holds      the projection alone") && said.contains("[projection]"));
    let text = exr::read_header(&at.join("part0.exr")).unwrap().text.unwrap();
    assert!(provenance::is_projection(&text));
    // Frames of a sequence are parts too.
    let turn = ["--turntable", "2", "--region", "0,0,40,14", "-o", "turn.exr"];
    let said = succeeds(at, &[&["render"], &SCENE[..], &turn].concat());
    assert!(said.contains("the projection alone") && !said.contains(".png"), "{said}");
    assert!(at.join("turn.0001.exr").exists() && !at.join("turn.0001.png").exists());
}
