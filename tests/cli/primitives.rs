//! Scenes with polygons, ribbons and tubes.

use super::*;
use tempfile::TempDir;

/// A directory with a mesh that has edges, a line, and scenes of them.
fn scenes() -> TempDir {
    let at = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(at.path().join(name), text).unwrap();
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let edges = "property int vertex1\nproperty int vertex2\nend_header\n";
    write(
        "mesh.ply",
        &format!(
            "ply\nformat ascii 1.0\nelement vertex 4\n{xyz}element face 2\n\
             property list uchar int vertex_indices\nelement edge 1\n{edges}\
             0 0 0\n4 0 0\n0 2 0\n4 2 0\n3 0 1 2\n3 1 3 2\n0 3\n"
        ),
    );
    write(
        "line.ply",
        &format!(
            "ply\nformat ascii 1.0\nelement vertex 2\n{xyz}property float radius\n\
             property float tx\nproperty float ty\nproperty float tz\nelement edge 1\n{edges}\
             0 0 0 1 0 0 1\n0 0 8 0.5 0 0 1\n0 1\n"
        ),
    );
    let model =
        |file: &str, draw: &str| format!("[[model]]\nfile = \"{file}.ply\"\ndraw = {draw}\n");
    let (polygons, tubes) = (model("mesh", "\"polygons\""), model("line", "\"tubes\""));
    let hybrid = model("mesh", "\"hybrid\"\nsplit = [-1, -2, 0, -4]");
    write("polygons.toml", &polygons);
    write("hybrid.toml", &hybrid);
    write("all.toml", &format!("{polygons}{tubes}[[model]]\nshape = \"sphere\"\ncount = 100\n"));
    at
}

#[test]
fn info_counts_what_there_is() {
    let at = scenes();
    let says = |name: &str, words: &[&str]| {
        let said = succeeds(at.path(), &["info", name]);
        words.iter().for_each(|word| assert!(said.contains(word), "{word} in {said}"));
        said
    };
    says("mesh.ply", &["triangles  2", "edges      1", "surfels    2", "one for each triangle"]);
    says("line.ply", &["has        radii, tangents", "surfels    none: normals"]);
    let words = ["polygons: 2 triangles, normals derived from the triangles\n", "(4, 2, 0)"];
    let said = says("polygons.toml", &words);
    assert!(said.contains("drawn as polygons") && !said.contains("the median"), "{said}");
    // The triangle with x + 2 y <= 4 is a polygon, the corners of the other are surfels.
    says("hybrid.toml", &["drawn as hybrid", "hybrid: 3 surfels, 1 triangles, normals derived"]);
    says(
        "all.toml",
        &[
            "all: 100 surfels, 2 triangles, 1 segments of tubes\n",
            "line: 1 segments of tubes, tangents from the file, radii from the file",
            "sphere: 100 surfels, procedural",
            "dropped  none",
            "(4, 2, 8)",
            "the median",
        ],
    );
}

#[test]
fn only_the_pyramid_draws_them_and_deferred_and_blue_triangles() {
    let at = scenes();
    let before = names(at.path());
    let triangles = ["deferred", "blue"];
    let others = ["ewa", "single-pass", "transparent", "transparent-hq", "peeling", "template"];
    for method in others.into_iter().chain(triangles) {
        let able = "deferred or --method pyramid or --method blue";
        for (scene, able) in [("polygons", able), ("all", "pyramid")] {
            let file = format!("{scene}.toml");
            if triangles.contains(&method) && scene == "polygons" {
                succeeds(at.path(), &["render", &file, "--method", method, "-o", "a.exr"]);
                continue;
            }
            let line = fails(at.path(), &["render", &file, "--method", method], 1);
            let expected = format!(
                "splatref: {scene} has triangles or lines, but the method {method} does not draw \
                 them; use --method {able}\n"
            );
            assert_eq!(line, expected);
        }
    }
    let size = ["--size", "32x24", "--method", "pyramid", "-o", "a.exr"];
    for scene in ["polygons", "hybrid", "all"] {
        let scene = format!("{scene}.toml");
        let said = succeeds(at.path(), &[&["render", &scene], &size[..]].concat());
        assert!(said.contains(" triangles"), "{said}");
        let text = exr::read(&at.path().join("a.exr")).unwrap().text.unwrap();
        assert!(text.contains("\ntriangles = "), "{text}");
    }
    ["a.exr", "a.png"].iter().for_each(|name| fs::remove_file(at.path().join(name)).unwrap());
    let line = fails(at.path(), &["explain", "all.toml", "3", "4"], 1);
    assert!(line.contains("but the method ewa does not draw them"), "{line}");
    let line = fails(at.path(), &["group", "all.toml", "-o", "b.ply"], 1);
    assert!(line.contains("only surfels are divided into groups"), "{line}");
    let line = fails(at.path(), &["render", "all.toml", "--opacity", "0.5"], 1);
    assert!(line.contains("a model drawn as polygons is opaque"), "{line}");
    assert_eq!(names(at.path()), before, "nothing was written");
}

#[test]
fn what_a_model_lacks_is_said_with_its_file() {
    let at = scenes();
    let scene = |model: &str| fs::write(at.path().join("bad.toml"), model).unwrap();
    for (model, what) in [
        ("file = \"line.ply\"\ndraw = \"polygons\"", "line.ply: there are no triangles"),
        ("file = \"line.ply\"\ndraw = \"ribbons\"", "line.ply: ribbons need normals"),
        ("file = \"mesh.ply\"\ndraw = \"tubes\"", "mesh.ply: tubes need radii"),
        ("file = \"mesh.ply\"\ndraw = \"hybrid\"", "bad.toml: line 1: a hybrid needs split"),
        ("shape = \"torus\"\ndraw = \"tubes\"", "bad.toml: line 1: torus is drawn as points"),
    ] {
        scene(&format!("[[model]]\n{model}\n"));
        for command in ["info", "render"] {
            let line = fails(at.path(), &[command, "bad.toml"], 1);
            assert!(line.contains(what), "{line}");
        }
    }
}

#[test]
fn a_tree_is_drawn_by_its_name_and_as_a_scene() {
    let at = TempDir::new().unwrap();
    let picture = |scene: &str, more: &[&str], to: &str| {
        let all = [&["render", scene, "--size", "64x64", "-o", to], more].concat();
        let said = succeeds(at.path(), &all);
        (said, exr::read(&at.path().join(to)).unwrap())
    };
    let pyramid = ["--count", "200", "--method", "pyramid"];
    let (said, tree) = picture("tree", &pyramid, "a.exr");
    let line = said.lines().find(|line| line.starts_with("scene ")).unwrap();
    assert!(line.contains(" triangles, 600 segments of ribbons, "), "{line}");
    assert!(line.ends_with(" segments of tubes, procedural"), "{line}");
    let covered = floats(&tree, "A").iter().filter(|&&a| a == 1.0).count();
    assert!(covered > 200 && covered < 64 * 64, "{covered} of 64 x 64 pixels");

    let text = "[[model]]\nshape = \"tree\"\nleaves = 200\n[method]\nname = \"pyramid\"\n";
    fs::write(at.path().join("scene.toml"), text).unwrap();
    let (_, scene) = picture("scene.toml", &[], "b.exr");
    assert_eq!(floats(&scene, "Z"), floats(&tree, "Z"));
    let (_, other) = picture("tree", &[&pyramid[..], &["--seed", "1"]].concat(), "c.exr");
    assert_ne!(floats(&other, "Z"), floats(&tree, "Z"));
    let said = succeeds(at.path(), &["info", "scene.toml"]);
    assert!(said.contains("Tree of 200 leaves, seed 0, drawn as lines\n"), "{said}");
}

#[test]
fn a_tree_is_refused_where_it_cannot_be_drawn() {
    let at = TempDir::new().unwrap();
    let tree = ["render", "tree", "--count", "20"];
    for (more, what) in [
        (
            &[] as &[&str],
            "tree has triangles or lines, but the method ewa does not draw them; use --method pyramid",
        ),
        (&["--method", "pyramid", "--opacity", "0.5"], "tree: a model drawn as lines is opaque"),
        (&["--method", "pyramid", "--count", "0"], "a tree of 0 leaves"),
    ] {
        // An option that comes twice is another mistake.
        let count = if more.contains(&"--count") { 2 } else { 4 };
        let line = fails(at.path(), &[&tree[..count], more].concat(), 1);
        assert!(line.contains(what), "{line}");
    }
    let line = fails(at.path(), &["group", "tree", "--count", "20", "-o", "a.ply"], 1);
    assert!(line.contains("only surfels are divided into groups"), "{line}");
    assert!(names(at.path()).is_empty());
}
