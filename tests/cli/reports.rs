//! `splatref compare`, `explain`, `info` and `--help`.

use super::*;
use splatref::method::Method;
use tempfile::TempDir;

#[test]
fn compare_tells_equal_from_different() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr"]));
    fs::copy(at.path().join("a.exr"), at.path().join("b.exr")).unwrap();
    let said = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
    assert!(said.contains("bit for bit"), "{said}");
    assert!(said.contains("SSIM 1.000000, FLIP 0\n"), "{said}");

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
fn every_method_explains_a_pixel() {
    let at = TempDir::new().unwrap();
    for method in Method::all() {
        let scene = ["--count", "300", "--size", "32x24", "--method", method.name()];
        let said = succeeds(at.path(), &[&["explain", "cluster", "16", "12"], &scene[..]].concat());
        assert!(said.contains("pixel (16, 12)"), "{}: {said}", method.name());
    }
}

#[test]
fn info_describes_every_kind_of_file() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr", "--stages"]));
    let said = succeeds(at.path(), &["info", "a.exr"]);
    for word in ["32 x 24", "visibility.Z: float", "id: uint", "rle", "sha256 = ", "[camera]"] {
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
        "surfels    1",
        "normals  from ellipses, one for each triangle",
        "radii    from ellipses, one for each triangle",
        "1 points: 1 not finite",
        "(0.66667, 1, 0) to (0.66667, 1, 0)",
    ] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let scene = "[[model]]\nfile = \"a.ply\"\n[[model]]\nshape = \"torus\"\ncount = 100\n\
                 [camera]\nsize = [20, 10]\northo = 3\n[method]\noutline = \"raycast\"\n";
    fs::write(at.path().join("a.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["info", "a.toml"]);
    for word in ["a.ply", "Torus", "101 surfels", "20 x 10", "orthographic", "raycast", "headlight"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
    let said = succeeds(at.path(), &["info", "staircase"]);
    assert!(said.contains("Staircase {") && said.contains("radius"), "{said}");
    fails(at.path(), &["info", "a.txt"], 2);
    fails(at.path(), &["info", "b.exr"], 1);
}

#[test]
fn help_and_version_are_not_errors() {
    let at = TempDir::new().unwrap();
    let all = succeeds(at.path(), &["--help"]);
    let list = all.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands: Vec<_> = list.map_while(|line| line.trim().split_once(' ')).collect();
    assert!(commands.len() > 15, "{all}");
    for (command, what) in commands.into_iter().filter(|(command, _)| *command != "help") {
        let said = succeeds(at.path(), &[command, "--help"]);
        assert!(said.starts_with(what.trim()) && said.contains("Usage: splatref"), "{said}");
    }
    assert!(succeeds(at.path(), &["--version"]).contains(env!("CARGO_PKG_VERSION")));
}

/// The lines of a help text without the breaks that a narrow terminal makes.
fn help(command: &str) -> String {
    let said = succeeds(TempDir::new().unwrap().path(), &[command, "--help"]);
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn help_tells_every_setting() {
    use splatref::io::scene_file::{GroupChoice, MethodChoice, OutputSettings};
    use splatref::setting::{Setting, Value};
    let tells = |help: &str, row: &Setting| {
        let description = row.description();
        let default = row.default_text(Value::text);
        let default = if default.is_empty() { default } else { format!(" [default: {default}]") };
        // The first letter is a capital one.
        for part in [&format!("--{}", row.option), &row.form, &description[1..], &default] {
            assert!(help.contains(part), "{part} in {help}");
        }
    };
    let render = help("render");
    let rows = MethodChoice::rows().into_iter().chain(GroupChoice::rows());
    rows.chain(OutputSettings::rows()).for_each(|row| tells(&render, &row));
    let group = help("group");
    Setting::of([("", GroupChoice::ALONE)]).iter().for_each(|row| tells(&group, row));
}

/// What becomes of the surfel that a client names, whether or not it reaches the pixel.
#[test]
fn explain_tells_the_fate_of_the_clients_surfel() {
    let at = TempDir::new().unwrap();
    let scene = ["sphere", "--count", "400", "--size", "48x36"];
    let client = |id: u32| {
        use splatref::frame::{Frame, Plane, Samples};
        use splatref::io::exr;
        let frame = Frame::<f32>::new(48, 36)
            .with("id", Samples::Index(Plane::filled(48, 36, id)))
            .unwrap();
        exr::write(&at.path().join("mine.exr"), &frame, "").unwrap();
        let words = ["explain", scene[0], "24", "18", "--client", "mine.exr"];
        succeeds(at.path(), &[&words[..], &scene[1..]].concat())
    };
    let mut found = [0; 2];
    for id in (0..400).step_by(40) {
        let said = client(id);
        let of = format!("the client's surfel {id} ");
        let line = said.lines().find_map(|line| line.trim().strip_prefix(&of)).expect("a line");
        if line.starts_with("has q ") {
            // No surfel that is named at random reaches the middle of the picture.
            assert!(line.contains(" > 4 here, and depth "), "{line}");
            found[0] += 1;
        } else if line == "is not drawn: its back is seen, and culling is on" {
            found[1] += 1;
        }
    }
    assert!(found[0] > 0 && found[1] > 0, "{found:?}");
    assert!(client(4000).contains("the client's surfel 4000 does not exist: there are 400"));
}

#[test]
fn settings_that_the_method_does_not_use_are_said() {
    let at = TempDir::new().unwrap();
    let said = |text: &str, more: &[&str]| {
        let model = "[[model]]\nshape = \"sphere\"\ncount = 50\n";
        fs::write(at.path().join("s.toml"), format!("{model}{text}")).unwrap();
        let render = ["render", "s.toml", "-o", "o.exr", "--size", "32x24"];
        let output = splatref(at.path(), &[&render[..], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stderr).unwrap()
    };
    let groups = "[groups]\ncount = 2\n";
    let found = said(groups, &[]);
    assert!(
        found.starts_with("splatref: warning: s: [groups] has no effect, because the method ewa")
    );
    assert_eq!(found.lines().count(), 1);
    assert_eq!(said(groups, &["--method", "transparent"]), "");
    let found = said("", &["--mipmaps", "3"]);
    assert!(found.contains("mipmaps have no effect, because the method ewa draws none"), "{found}");
    assert_eq!(said("mipmaps = 3\n[method]\nname = \"deferred\"\n", &[]), "");
    assert_eq!(said("", &["--mipmaps", "0"]), "");
    // A near plane counts for every method and camera: in front of it, nothing is drawn.
    for method in ["ewa", "pyramid", "template", "blue", "peeling", "single-pass"] {
        assert_eq!(said("[camera]\nnear = 100\n", &["--method", method]), "");
        let image = exr::read(&at.path().join("o.exr")).unwrap();
        assert!(floats(&image, "Z").iter().all(|z| z.is_infinite()), "{method}");
    }
}
