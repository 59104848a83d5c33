//! The program as a person meets it: exit codes, one line of complaint, files whole or not there.

use splatref::io::exr::{self, Image, Values};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// What the program did in a directory.
fn splatref(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_splatref"));
    command.current_dir(directory).args(arguments).output().expect("the program starts")
}

/// Asserts success without complaint; what it printed.
fn succeeds(directory: &Path, arguments: &[&str]) -> String {
    let output = splatref(directory, arguments);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), complaint.as_ref()), (Some(0), ""), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Asserts an exit code and exactly one line of complaint; the line.
fn fails(directory: &Path, arguments: &[&str], code: i32) -> String {
    let output = splatref(directory, arguments);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {complaint}");
    assert!(complaint.starts_with("splatref: ") && complaint.ends_with('\n'), "{complaint}");
    assert_eq!(complaint.lines().count(), 1, "{arguments:?}: {complaint}");
    complaint
}

/// The names in a directory, hidden ones too.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn floats(image: &Image, name: &str) -> Vec<f32> {
    match image.channel(name) {
        Some(Values::Float(values)) => values.clone(),
        _ => panic!("no floats {name}"),
    }
}

fn indices(image: &Image, name: &str) -> Vec<u32> {
    match image.channel(name) {
        Some(Values::Index(values)) => values.clone(),
        _ => panic!("no indices {name}"),
    }
}

/// The arguments for a small picture of a shape, and more.
fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let size: &[&str] = if more.contains(&"--size") { &[] } else { &["--size", "32x24"] };
    [&["render", "sphere", "--count", "300"], size, more].concat()
}

#[test]
fn without_arguments_a_picture_is_made() {
    let at = TempDir::new().unwrap();
    let said = succeeds(at.path(), &["render"]);
    assert_eq!(names(at.path()), ["out"]);
    assert_eq!(names(&at.path().join("out")), ["cluster.exr", "cluster.png"]);
    for word in ["200000 surfels", "perspective", "1024 x 768", "ewa", "visibility", "total"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let image = exr::read(&at.path().join("out/cluster.exr")).unwrap();
    let covered = floats(&image, "A").iter().filter(|&&a| a == 1.0).count();
    let share = covered as f64 / (1024.0 * 768.0);
    assert!((0.1..0.9).contains(&share), "the scene fills a good part of the picture: {share}");
    let png = image::open(at.path().join("out/cluster.png")).unwrap();
    assert_eq!((png.width(), png.height()), (1024, 768));
}

#[test]
fn the_bits_do_not_depend_on_threads_tiles_or_the_path() {
    let at = TempDir::new().unwrap();
    let outline = ["--outline", "raycast"];
    succeeds(at.path(), &[&small(&["-o", "a.exr", "--threads", "1"])[..], &outline].concat());
    let other = ["-o", "b.exr", "--threads", "3", "--tile", "8", "--repeat", "2"];
    let said = succeeds(at.path(), &[&small(&other)[..], &outline].concat());
    assert!(said.contains("minimum and median of 2"), "{said}");
    assert_eq!(names(at.path()), ["a.exr", "a.png", "b.exr", "b.png"]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| fs::read(at.path().join(name)).unwrap());
    assert_eq!(a, b, "the whole file, its text included");
}

#[test]
fn stages_and_f64_change_planes_and_numbers() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "fast.exr"]));
    succeeds(at.path(), &small(&["-o", "plain.exr", "--stages"]));
    succeeds(at.path(), &small(&["-o", "truth.exr", "--number", "f64"]));
    let read = |name: &str| exr::read(&at.path().join(name)).unwrap();
    let (fast, plain, truth) = (read("fast.exr"), read("plain.exr"), read("truth.exr"));
    for name in ["R", "G", "B", "A", "Z", "normal.X", "weight"] {
        assert_eq!(floats(&fast, name), floats(&plain, name), "{name}");
    }
    assert!(fast.channel("margin").is_none() && plain.channel("margin").is_some());
    assert_eq!(fast.text, plain.text);
    assert_ne!(floats(&fast, "Z"), floats(&truth, "Z"), "rounded differently");
    assert!(truth.text.unwrap().contains("number = \"f64\""));
}

#[test]
fn negative_coordinates_are_numbers_not_options() {
    let at = TempDir::new().unwrap();
    let camera = ["--eye", "-1,-2,-3.5", "--target", "-0.5,0,0", "--up", "0,0,-1", "--fov", "20"];
    let said = succeeds(at.path(), &small(&camera));
    assert!(said.contains("at (-1, -2, -3.5)"), "{said}");
    succeeds(at.path(), &small(&["--ortho", "3", "--epsilon", "inf", "--cull"]));
    succeeds(at.path(), &small(&["--focal", "40", "--epsilon", "1.5r", "--kernel", "zpvbg01"]));
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &["render", "--sise", "3x3"], 2);
    assert!(line.contains("--sise"), "{line}");
    fails(at.path(), &[], 2);
    fails(at.path(), &["paint"], 2);
    fails(at.path(), &["render", "nothing-of-the-kind"], 2);
    fails(at.path(), &["render", "picture.exr"], 2);
    fails(at.path(), &["render", "a.ply", "--count", "3"], 2);
    fails(at.path(), &["explain", "torus"], 2);
    fails(at.path(), &["explain", "sphere", "32", "0", "--count", "9", "--size", "32x24"], 2);
    fails(at.path(), &["compare", "a.exr", "b.exr", "--max-abs", "-1"], 2);
    for more in [
        &["--size", "3"] as &[&str],
        &["--size", "axb"],
        &["--eye", "1,2"],
        &["--eye", "1,2,x"],
        &["--fov", "30", "--ortho", "2"],
        &["--tile", "12"],
        &["--threads", "5000"],
        &["--repeat", "0"],
        &["--outline", "round"],
        &["--kernel", "gauss"],
        &["--number", "f16"],
        &["--epsilon", "1.5x"],
        &["-o", "picture.png"],
    ] {
        fails(at.path(), &small(more), 2);
    }
    assert!(names(at.path()).is_empty());
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let at = TempDir::new().unwrap();
    for (more, what) in [
        (&["--size", "0x0"] as &[&str], "0 x 0"),
        (&["--size", "70000x1"], "70000 x 1"),
        (&["--size", "65536x65536"], "65536 x 65536"),
        (&["--eye", "1,1,1", "--target", "1,1,1"], "same point"),
        (&["--eye", "0,5,0", "--target", "0,0,0"], "--up"),
        (&["--eye", "nan,0,0"], "finite"),
        (&["--fov", "180"], "180"),
        (&["--focal", "0"], "focal length"),
        (&["--ortho", "-1"], "height"),
        (&["--epsilon", "-1"], "epsilon"),
        (&["--epsilon", "nan"], "epsilon"),
        (&["--cutoff", "9"], "cut-off of 9"),
        (&["--low-pass", "-1"], "low-pass"),
    ] {
        let line = fails(at.path(), &small(more), 1);
        assert!(line.contains(what), "{line}");
    }
    let line = fails(at.path(), &["render", "torus", "--count", "0"], 1);
    assert!(line.contains("0 surfels"), "{line}");
    assert!(names(at.path()).is_empty(), "{:?}", names(at.path()));
}

#[test]
fn the_widest_picture_is_made() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &["render", "sphere", "--count", "300", "--size", "65536x1"]);
    let header = exr::read_header(&at.path().join("out/sphere.exr")).unwrap();
    assert_eq!((header.width, header.height), (65536, 1));
}

#[test]
fn broken_files_leave_nothing_behind() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &["render", "missing.ply"], 1);
    assert!(line.contains("missing.ply"), "{line}");
    fails(at.path(), &["render", "missing.toml"], 1);
    let vertices = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
                    property float y\nproperty float z\nend_header\n";
    for (name, text) in [
        ("noise.ply", "pretty noise"),
        ("short.ply", &format!("{vertices}0 0 0\n1 0 0\n")),
        ("nan.ply", &format!("{vertices}nan 0 0\nnan 0 0\nnan 0 0\n")),
        ("heap.ply", &format!("{vertices}0 0 0\n0 0 0\n0 0 0\n")),
        ("bad.toml", "[[model]\n"),
        ("typo.toml", "[[model]]\nshape = \"sphere\"\n\n[camera]\nfow = 30\n"),
        ("points.toml", "[[model]]\nfile = \"missing.ply\"\n"),
    ] {
        fs::write(at.path().join(name), text).unwrap();
        for command in ["render", "info"] {
            let line = fails(at.path(), &[command, name], 1);
            let names_the_file = line.contains(name) || line.contains("missing.ply");
            assert!(names_the_file, "{line}");
        }
    }
    let line = fails(at.path(), &["render", "typo.toml"], 1);
    assert!(line.contains("line 5") && line.contains("fow"), "{line}");
    assert!(!at.path().join("out").exists());
}

#[test]
fn what_cannot_be_written_is_not_half_written() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &small(&["-o", "missing/a.exr"]), 1);
    assert!(line.contains("missing"), "{line}");
    fs::write(at.path().join("file"), "kept").unwrap();
    fails(at.path(), &small(&["-o", "file/a.exr"]), 1);
    fs::create_dir(at.path().join("b.exr")).unwrap();
    fails(at.path(), &small(&["-o", "b.exr"]), 1);
    assert_eq!(names(at.path()), ["b.exr", "file"]);
    assert!(names(&at.path().join("b.exr")).is_empty());
    // `out` is in the way of the default place.
    fs::write(at.path().join("out"), "kept").unwrap();
    fails(at.path(), &small(&[]), 1);
    assert_eq!(fs::read_to_string(at.path().join("out")).unwrap(), "kept");
}

/// Swaps one bit of the depth of the pixel in the middle, in a file of the same planes.
fn flip_a_bit(path: &Path) {
    use splatref::frame::{Frame, NamedPlane, Plane, Samples};
    let image = exr::read(path).unwrap();
    let (width, height) = (image.width, image.height);
    let planes = image.channels.into_iter().map(|(name, values)| {
        let samples = match values {
            Values::Index(values) => Samples::Index(Plane::from_values(width, height, values)),
            Values::Float(mut values) => {
                if name == "Z" {
                    let middle = values.len() / 2 + width as usize / 2;
                    values[middle] = f32::from_bits(values[middle].to_bits() ^ 1);
                }
                Samples::Scalar(Plane::from_values(width, height, values))
            }
        };
        NamedPlane { name, samples }
    });
    let frame = Frame { width, height, planes: planes.collect() };
    exr::write(path, &frame, &image.text.unwrap_or_default()).unwrap();
}

#[test]
fn compare_tells_equal_from_different() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr"]));
    fs::copy(at.path().join("a.exr"), at.path().join("b.exr")).unwrap();
    let said = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
    assert!(said.contains("bit for bit") && said.contains("SSIM 1.000000"), "{said}");

    flip_a_bit(&at.path().join("b.exr"));
    let output = splatref(at.path(), &["compare", "a.exr", "b.exr"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(1), 0), "{said}");
    assert!(said.contains("Z: 1 of 768 pixels differ, first (16, 12)"), "{said}");
    assert!(said.contains("1 ulp"), "{said}");
    succeeds(at.path(), &["compare", "a.exr", "b.exr", "--max-ulp", "1"]);
    succeeds(at.path(), &["compare", "a.exr", "b.exr", "--max-abs", "1e-6"]);

    succeeds(at.path(), &["render", "sphere", "--count", "9", "--size", "8x8", "-o", "c.exr"]);
    assert_eq!(splatref(at.path(), &["compare", "a.exr", "c.exr"]).status.code(), Some(1));
    fs::write(at.path().join("d.exr"), "no picture").unwrap();
    fails(at.path(), &["compare", "a.exr", "d.exr"], 1);
    fails(at.path(), &["compare", "a.exr", "missing.exr"], 1);
}

/// A directory with two golden cases.
fn golden_cases() -> TempDir {
    let at = TempDir::new().unwrap();
    fs::create_dir(at.path().join("golden")).unwrap();
    let case = |name: &str, text: &str| {
        fs::write(at.path().join("golden").join(name), text).unwrap();
    };
    let camera = "[camera]\nsize = [16, 12]\n[output]\nstages = true\n";
    case("a.toml", &format!("[[model]]\nshape = \"sphere\"\ncount = 200\n{camera}"));
    case(
        "b.toml",
        &format!("[[model]]\nshape = \"torus\"\ncount = 200\n{camera}number = \"f64\"\n"),
    );
    at
}

/// Exit code and what was printed.
fn golden(at: &TempDir, more: &[&str]) -> (Option<i32>, String) {
    let output = splatref(at.path(), &[&["golden"], more].concat());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn a_blessing_is_never_silent() {
    let at = golden_cases();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "pictures are missing: {said}");
    assert!(said.contains("0 equal, 2 different"), "{said}");
    let (code, said) = golden(&at, &["--bless"]);
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(names(&at.path().join("golden")), ["a.exr", "a.toml", "b.exr", "b.toml"]);
    let before = fs::metadata(at.path().join("golden/a.exr")).unwrap().modified().unwrap();
    let (code, said) = golden(&at, &["--bless"]);
    assert_eq!(code, Some(0), "there is nothing left to bless: {said}");
    let after = fs::metadata(at.path().join("golden/a.exr")).unwrap().modified().unwrap();
    assert_eq!(before, after, "what is equal is not rewritten");
}

#[test]
fn one_flipped_bit_in_a_golden_picture_is_found() {
    let at = golden_cases();
    golden(&at, &["--bless"]);
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(0), "{said}");
    let hash = said.lines().last().unwrap().to_owned();
    assert!(hash.len() == "sha256 ".len() + 64, "{hash}");
    for how in [["--threads", "1"], ["--tile", "8"]] {
        assert_eq!(golden(&at, &how), (Some(0), said.clone()), "{how:?}");
    }

    flip_a_bit(&at.path().join("golden/a.exr"));
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1));
    assert!(said.contains("1 equal, 1 different") && said.contains(&hash), "{said}");
    assert!(said.contains("Z: 1 of 192 pixels differ, first (8, 6)"), "{said}");
    let kept = ["a.actual.exr", "a.actual.png", "a.expected.exr", "a.expected.png"];
    assert_eq!(names(&at.path().join("out/golden")), kept);
    // The command that it prints works.
    let scene = Path::new("golden").join("a.toml");
    let command = format!("splatref explain {} 8 6", scene.display());
    assert!(said.contains(&command), "{said}");
    succeeds(at.path(), &["explain", "golden/a.toml", "8", "6"]);

    let (code, said) = golden(&at, &["b"]);
    assert_eq!(code, Some(0), "only the other one was asked for: {said}");
    fails(at.path(), &["golden", "c"], 2);
}

#[test]
fn golden_pictures_and_scenes_come_in_pairs() {
    let at = golden_cases();
    golden(&at, &["--bless"]);
    let folder = at.path().join("golden");
    fs::remove_file(folder.join("a.toml")).unwrap();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("1 equal, 1 different"), "{said}");
    // A damaged picture and a scene that cannot be rendered do not stop the others.
    fs::write(folder.join("a.toml"), "[[model]]\nshape = \"ball\"\n").unwrap();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("equal      b") && said.contains("different  a"), "{said}");
    fs::write(folder.join("b.exr"), "no picture").unwrap();
    assert!(golden(&at, &[]).1.contains("0 equal, 2 different"));
    fails(at.path(), &["golden", "--dir", "missing"], 1);
    fs::create_dir(at.path().join("empty")).unwrap();
    fails(at.path(), &["golden", "--dir", "empty"], 1);
    let elsewhere = TempDir::new().unwrap();
    let dir = folder.to_str().unwrap();
    assert_eq!(splatref(elsewhere.path(), &["golden", "b", "--dir", dir]).status.code(), Some(1));
}

/// Each committed case is tiny and can be rendered; the pictures are checked by `splatref golden`.
#[test]
fn committed_golden_cases_are_tiny() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let scenes: Vec<_> = names(&folder).into_iter().filter(|n| n.ends_with(".toml")).collect();
    assert!(scenes.len() >= 10, "{scenes:?}");
    for name in names(&folder) {
        let path = folder.join(&name);
        let length = fs::metadata(&path).unwrap().len();
        assert!(length <= 64 * 1024, "{name}: {length} bytes");
        if name.ends_with(".toml") {
            let file = splatref::io::scene_file::SceneFile::read(&path).unwrap();
            let loaded = file.load(&|_, _, _| ()).unwrap();
            let camera = file.camera(&loaded.scene.surfels).unwrap();
            assert!(camera.width <= 64 && camera.height <= 64, "{name}");
            assert!(loaded.scene.surfels.len() <= 1000, "{name}");
        }
    }
    // What they become when blessed must fit too.
    let at = TempDir::new().unwrap();
    let copy = at.path().join("golden");
    fs::create_dir(&copy).unwrap();
    for name in names(&folder).iter().filter(|name| !name.ends_with(".exr")) {
        fs::copy(folder.join(name), copy.join(name)).unwrap();
    }
    assert_eq!(golden(&at, &["--bless"]).0, Some(1));
    for name in names(&copy) {
        let length = fs::metadata(copy.join(&name)).unwrap().len();
        assert!(length <= 64 * 1024, "{name}: {length} bytes");
    }
    assert_eq!(golden(&at, &[]).0, Some(0));
}

#[test]
fn explain_agrees_with_the_picture() {
    let at = TempDir::new().unwrap();
    let options = ["--count", "300", "--size", "32x24"];
    for number in ["f32", "f64"] {
        let scene = [&options[..], &["--number", number]].concat();
        succeeds(at.path(), &[&["render", "cluster", "-o", "a.exr"], &scene[..]].concat());
        let image = exr::read(&at.path().join("a.exr")).unwrap();
        let (id, depth) = (indices(&image, "id"), floats(&image, "Z"));
        let (mut seen, mut empty) = (0, 0);
        for i in (0..32 * 24).step_by(37) {
            let (x, y) = ((i % 32).to_string(), (i / 32).to_string());
            let said = succeeds(at.path(), &[&["explain", "cluster", &x, &y], &scene[..]].concat());
            if id[i] == u32::MAX {
                assert!(said.contains("the pixel is empty"), "{said}");
                empty += 1;
            } else {
                assert!(said.contains(&format!(", surfel {},", id[i])), "{} in {said}", id[i]);
                let nearest = said.split("(nearest ").nth(1).unwrap().split(',').next().unwrap();
                let nearest: f64 = nearest.parse().unwrap();
                assert_eq!((nearest as f32).to_bits(), depth[i].to_bits());
                seen += 1;
            }
        }
        assert!(seen > 2 && empty > 2, "{seen} {empty}");
    }
}

#[test]
fn info_describes_every_kind_of_file() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr", "--stages"]));
    let said = succeeds(at.path(), &["info", "a.exr"]);
    for word in ["32 x 24", "visibility.Z: float", "id: uint", "zip", "sha256 = ", "[camera]"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let header = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
                  property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices = "0 0 0 255 0 0\n2 0 0 0 0 0\n0 3 0 0 0 0\nnan 0 0 0 0 0\n9 9 9 0 0 0\n";
    fs::write(at.path().join("a.ply"), format!("{header}{vertices}3 0 1 2\n")).unwrap();
    let said = succeeds(at.path(), &["info", "a.ply"]);
    for word in [
        "points     5",
        "triangles  1",
        "has        colours",
        "surfels    3",
        "derived from the triangles",
        "derived from the edges",
        "2 points: 1 not finite, 1 without",
        "(0, 0, 0) to (2, 3, 0)",
    ] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let scene = "[[model]]\nfile = \"a.ply\"\n[[model]]\nshape = \"torus\"\ncount = 100\n\
                 [camera]\nsize = [20, 10]\northo = 3\n[method]\noutline = \"raycast\"\n";
    fs::write(at.path().join("a.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["info", "a.toml"]);
    for word in ["a.ply", "Torus", "103 surfels", "20 x 10", "orthographic", "raycast", "headlight"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
    fails(at.path(), &["info", "a.txt"], 2);
    fails(at.path(), &["info", "b.exr"], 1);
}

#[test]
fn options_replace_what_a_scene_file_says() {
    let at = TempDir::new().unwrap();
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 100\n[camera]\nsize = [20, 10]\nfov = 30\n\
                 [method]\nkernel = \"zpvbg01\"\noutline = \"raycast\"\ncutoff = 3\n\
                 [output]\nnumber = \"f64\"\nstages = true\n";
    fs::write(at.path().join("s.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["render", "s.toml"]);
    for word in ["20 x 10 pixels, f64", "raycast outline, cut-off 3, low-pass 1", "every stage"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let more = ["--size", "12x8", "--ortho", "4", "--kernel", "default", "--number", "f32"];
    let said = succeeds(at.path(), &[&["render", "s.toml"], &more[..]].concat());
    for word in ["12 x 8 pixels, f32", "affine outline, cut-off 2, low-pass 0.25", "orthographic"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    assert_eq!(names(&at.path().join("out")), ["s.exr", "s.png"]);
}

#[test]
fn help_and_version_are_not_errors() {
    let at = TempDir::new().unwrap();
    for command in ["render", "golden", "compare", "explain", "info"] {
        assert!(succeeds(at.path(), &["--help"]).contains(command));
        assert!(succeeds(at.path(), &[command, "--help"]).contains("Usage: splatref"));
    }
    assert!(succeeds(at.path(), &["--version"]).contains(env!("CARGO_PKG_VERSION")));
}
