//! `splatref render --region` and `splatref assemble`.

use super::*;
use tempfile::TempDir;

/// What every test draws, in pictures of 60 x 41 pixels.
const SCENE: [&str; 5] = ["torus", "--count", "400", "--size", "60x41"];

fn render(at: &Path, more: &[&str]) -> String {
    succeeds(at, &[&["render"], &SCENE[..], more].concat())
}

/// Draws four parts of the picture.
fn parts(at: &Path, more: &[&str]) -> [String; 4] {
    let regions = ["0,0,60,9", "0,9,23,41", "23,9,60,24", "23,24,60,41"];
    regions.map(|region| {
        let file = format!("{}.exr", region.replace(',', "-"));
        render(at, &[&["--region", region, "-o", &file], more].concat());
        file
    })
}

fn assemble(at: &Path, files: &[&str]) -> Output {
    splatref(at, &[&["assemble"], files, &["-o", "joined.exr"]].concat())
}

#[test]
fn joined_parts_are_the_file_of_the_whole_picture() {
    let at = TempDir::new().unwrap();
    for more in [
        &["--method", "single-pass", "--compression", "zip", "--threads", "1"][..],
        &["--method", "peeling", "--opacity", "0.5", "--compression", "piz", "--tile", "8"],
        &["--method", "gaussians", "--compression", "none", "--number", "f64"],
        &["--method", "transparent", "--opacity", "0.4", "--storage", "f16", "--stages"],
    ] {
        render(at.path(), &[more, &["-o", "whole.exr"]].concat());
        let mut files = parts(at.path(), more);
        files.reverse();
        let files = files.each_ref().map(String::as_str);
        let output = assemble(at.path(), &files);
        assert!(output.status.success(), "{more:?}: {output:?}");
        for kind in ["exr", "png"] {
            let [whole, joined] = ["whole", "joined"].map(|name| format!("{name}.{kind}"));
            let [whole, joined] =
                [whole, joined].map(|name| fs::read(at.path().join(name)).unwrap());
            assert!(whole == joined, "{more:?} {kind}");
        }
    }
    // Triangles beside discs, before an environment.
    let mesh = "v -1 -1 0\nv 1 -1 0.5\nv 0 1 0\nf 1 2 3\n";
    fs::write(at.path().join("mesh.obj"), mesh).unwrap();
    let scene = "[[model]]\nfile = \"mesh.obj\"\ndraw = \"polygons\"\n[[model]]\nshape = \"torus\"\n\
                 count = 300\n[camera]\nsize = [40, 31]\n";
    fs::write(at.path().join("mesh.toml"), scene).unwrap();
    let draw = |more: &[&str]| {
        let all = ["render", "mesh.toml", "--method", "blue", "--stages", "--environment", "sky"];
        succeeds(at.path(), &[&all, more].concat());
    };
    draw(&["-o", "whole.exr"]);
    draw(&["--region", "0,0,17,31", "-o", "a.exr"]);
    draw(&["--region", "17,0,40,31", "-o", "b.exr"]);
    assert!(assemble(at.path(), &["a.exr", "b.exr"]).status.success());
    let [whole, joined] = ["whole.exr", "joined.exr"].map(|name| fs::read(at.path().join(name)));
    assert!(whole.unwrap() == joined.unwrap());
    let said = succeeds(at.path(), &["info", "23-9-60-24.exr"]);
    assert!(said.contains("60 x 41 pixels") && said.contains("23,9,60,24"), "{said}");
    // A frame of a sequence, parts that overlap, and a whole picture as the only part.
    let turn = ["--turntable", "3", "--region"];
    render(at.path(), &[&turn[..], &["0,0,60,30", "-o", "a.exr"]].concat());
    render(at.path(), &[&turn[..], &["0,11,60,41", "-o", "b.exr"]].concat());
    render(at.path(), &["--turntable", "3", "--frame", "1", "-o", "whole.exr"]);
    for files in [&["a.0001.exr", "b.0001.exr", "a.0001.exr"][..], &["whole.exr"]] {
        assert!(assemble(at.path(), files).status.success());
        let [whole, joined] =
            ["whole.exr", "joined.exr"].map(|name| fs::read(at.path().join(name)));
        assert!(whole.unwrap() == joined.unwrap(), "{files:?}");
    }
    // Nobody says where: each part has a name of its own.
    render(at.path(), &["--region", "1,2,3,4"]);
    assert_eq!(names(&at.path().join("out")), ["torus.1-2-3-4.exr", "torus.1-2-3-4.png"]);
}

/// Asserts that an `assemble` fails with these words, and leaves no file.
fn refused(at: &Path, files: &[&str], words: &[&str]) {
    let line = fails(at, &[&["assemble"], files, &["-o", "none.exr"]].concat(), 1);
    assert!(words.iter().all(|word| line.contains(word)), "{words:?}: {line}");
    assert!(!at.join("none.exr").exists() && !at.join("none.png").exists());
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let at = TempDir::new().unwrap();
    let files = parts(at.path(), &[]);
    let [a, b, c, d] = files.each_ref().map(String::as_str);
    refused(at.path(), &[a, b, d], &["--region 23,9,60,24"]);
    refused(at.path(), &[b, d], &["--region 0,0,60,9", "and 1 more"]);

    let other = ["--region", "23,9,60,24", "-o", "other.exr"];
    render(at.path(), &[&other[..], &["--seed", "9"]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: `scene.sha256`", a]);
    render(at.path(), &[&other[..], &["--epsilon", "3r"]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: `method.epsilon`", a]);
    render(at.path(), &[&other[..], &["--fov", "20"]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: `camera.", a]);
    render(at.path(), &[&other[..], &["--number", "f64"]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: `number`", a]);
    render(at.path(), &[&other[..], &["--stages"]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: its channel", a]);
    let larger = ["render", "torus", "--count", "400", "--size", "60x42"];
    succeeds(at.path(), &[&larger, &other[..]].concat());
    refused(at.path(), &[a, b, "other.exr", d], &["other.exr: ", "60 x 42", "60 x 41"]);

    // A picture that somebody changed.
    let whole = exr::read_region(&at.path().join(c), &splatref::frame::Exec::sequential()).unwrap();
    let mut frame = splatref::frame::Frame::new(whole.image.width, whole.image.height);
    for (name, values) in whole.image.channels {
        let (w, h) = (frame.width, frame.height);
        use splatref::frame::{Plane, Samples};
        let samples = match values {
            Values::Float(mut values) => {
                if name == "Z" {
                    values[0] = 7.0;
                }
                Samples::Scalar(Plane::from_values(w, h, values))
            }
            Values::Index(values) => Samples::Index(Plane::from_values(w, h, values)),
        };
        frame.push(&name, samples).unwrap();
    }
    let text = whole.image.text.unwrap();
    let exec = splatref::frame::Exec::sequential();
    let (place, window) = (at.path().join("other.exr"), whole.window);
    exr::pending_part(&place, &frame, window, &text, Default::default(), &exec)
        .unwrap()
        .put()
        .unwrap();
    refused(at.path(), &[a, b, c, d, "other.exr"], &["`Z` at pixel 23 9"]);

    let bytes = fs::read(at.path().join(c)).unwrap();
    for length in [0, 3, 200, bytes.len() / 2, bytes.len() - 1] {
        fs::write(at.path().join("other.exr"), &bytes[..length]).unwrap();
        let why = if length > 3 { "the file is truncated" } else { "not an EXR file" };
        refused(at.path(), &[a, b, "other.exr", d], &["other.exr: ", why]);
    }
    exr::write(&at.path().join("other.exr"), &frame, "").unwrap();
    refused(at.path(), &["other.exr"], &["other.exr: no text of splatref"]);
    refused(at.path(), &[a, "missing.exr"], &["missing.exr"]);
    fails(at.path(), &["assemble", a, b, c, d, "-o", a], 2);
    fails(at.path(), &["assemble", a, b, c, d, "-o", "joined.png"], 2);
    fails(at.path(), &["assemble", "-o", "joined.exr"], 2);
}

#[test]
fn a_region_that_cannot_be_drawn_is_refused_in_one_line() {
    let at = TempDir::new().unwrap();
    for (region, word) in [
        ("0,0,61,41", "60 x 41"),
        ("0,40,60,42", "60 x 41"),
        ("60,0,61,1", "60 x 41"),
        ("5,5,5,9", "no pixel"),
        ("5,9,8,5", "no pixel"),
        ("0,0,9", "X0,Y0,X1,Y1"),
        ("0,0,9,9,9", "X0,Y0,X1,Y1"),
        ("-1,0,9,9", "X0,Y0,X1,Y1"),
        ("0,0,1.5,9", "X0,Y0,X1,Y1"),
        ("a,b,c,d", "X0,Y0,X1,Y1"),
        ("0,0,4294967296,9", "X0,Y0,X1,Y1"),
        ("", "X0,Y0,X1,Y1"),
    ] {
        let line = fails(at.path(), &[&["render"], &SCENE[..], &["--region", region]].concat(), 2);
        assert!(line.contains(word), "{region}: {line}");
    }
    let arguments = ["--region", "0,0,9,9", "--method", "deferred"];
    let line = fails(at.path(), &[&["render"], &SCENE[..], &arguments].concat(), 2);
    assert!(line.contains("deferred") && line.contains("draw the whole picture"), "{line}");
    for method in ["pyramid", "template"] {
        for more in
            [&["--number", "f64"][..], &["--storage", "f16"], &["--depth-storage", "unorm24"]]
        {
            let arguments = [&["--region", "0,0,9,9", "--method", method], more].concat();
            let line = fails(at.path(), &[&["render"], &SCENE[..], &arguments].concat(), 2);
            assert!(line.contains("--number f32, --storage f32"), "{line}");
        }
    }
    let depths = ["--region", "0,0,9,9", "--write-depth", "npy"];
    fails(at.path(), &[&["render"], &SCENE[..], &depths].concat(), 2);
    assert!(!at.path().join("out").exists());
}

#[test]
fn a_region_is_judged_and_compared_alone() {
    let at = TempDir::new().unwrap();
    render(at.path(), &["--stages", "-o", "whole.exr"]);
    let region = ["--region", "23,9,60,24"];
    render(at.path(), &[&region[..], &["--stages", "-o", "part.exr"]].concat());
    let verify = |more: &[&str]| {
        splatref(at.path(), &[&["verify"], &SCENE[..], &["part.exr", "--no-cause"], more].concat())
    };
    let output = verify(&[&region[..], &["--json", "v.json", "--report", "v.html"]].concat());
    assert_eq!((output.status.code(), output.stderr.is_empty()), (Some(0), true), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("23,9,60,24; the other pixels are not judged"), "{said}");
    let json = fs::read_to_string(at.path().join("v.json")).unwrap();
    assert!(json.contains("\"region\": ["), "{json}");
    // The whole picture, with the remedy.
    let output = verify(&[]);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(complaint.contains("give --region 23,9,60,24 to judge these alone"), "{complaint}");
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    // More than the part, and regions that cannot be.
    assert_eq!(verify(&["--region", "22,9,60,24"]).status.code(), Some(1));
    for (region, method) in [("0,0,61,1", "ewa"), ("0,0,9,9", "pyramid")] {
        assert_eq!(verify(&["--region", region, "--method", method]).status.code(), Some(2));
    }

    succeeds(at.path(), &["compare", "whole.exr", "part.exr", "--region", "23,9,60,24"]);
    succeeds(at.path(), &["compare", "part.exr", "part.exr"]);
    for (region, code) in
        [(&[][..], 1), (&["--region", "22,9,60,24"], 1), (&["--region", "0,0,61,9"], 2)]
    {
        let output = splatref(at.path(), &[&["compare", "whole.exr", "part.exr"], region].concat());
        assert_eq!(output.status.code(), Some(code), "{region:?} {output:?}");
    }
}

#[test]
fn bands_are_the_file_of_the_whole_picture() {
    let at = TempDir::new().unwrap();
    let scene = ["render", "torus", "--count", "300", "--size", "50x141"];
    let draw = |more: &[&str]| splatref(at.path(), &[&scene, more].concat());
    let read = |name: &str| fs::read(at.path().join(name)).unwrap();
    for more in [
        &["--stages", "--threads", "2"][..],
        &["--compression", "zip", "--method", "gaussians"],
        &["--compression", "piz", "--number", "f64"],
        &["--compression", "none", "--method", "blue", "--tile", "64"],
    ] {
        assert!(draw(&[more, &["-o", "whole.exr"]].concat()).status.success());
        for bands in ["1", "3", "99"] {
            let output = draw(&[more, &["-o", "bands.exr", "--bands", bands]].concat());
            assert!(output.status.success() && output.stderr.is_empty(), "{more:?}: {output:?}");
            assert!(read("whole.exr") == read("bands.exr"), "{more:?} {bands}");
        }
        assert!(!at.path().join("bands.png").exists());
    }
    // The whole picture does not fit; 20 bands do, and so do as many as the program chooses.
    let large = ["render", "torus", "--count", "300", "--size", "1400x1400", "--memory", "100M"];
    let output = splatref(at.path(), &large);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("--bands auto"), "{output:?}");
    for (bands, name) in [("20", "large.exr"), ("auto", "chosen.exr")] {
        let more = ["--bands", bands, "-o", name];
        let output = splatref(at.path(), &[&large[..], &more].concat());
        assert!(output.status.success(), "{output:?}");
    }
    assert!(read("large.exr") == read("chosen.exr"));
    for more in [
        &["--bands", "0"][..],
        &["--bands", "some"],
        &["--bands", "4", "--method", "pyramid"],
        &["--bands", "4", "--method", "template"],
        &["--bands", "4", "--method", "deferred"],
        &["--bands", "4", "--turntable", "3"],
        &["--bands", "4", "--region", "0,0,9,9"],
    ] {
        assert_eq!(draw(more).status.code(), Some(2), "{more:?}");
    }
}
