//! `splatref render --stereo`.

use super::*;
use tempfile::TempDir;

const BALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/ball.ply");

/// Balls of ordered points in a row, a camera that passes them, and eyes that are far apart.
const ROW: &str = "\
[[geometry]]
name = \"ball\"
file = \"blue.ply\"
progressive = true
[[object]]
of = \"ball\"
[[object]]
of = \"ball\"
transform = { translate = [1.5, 0, -1] }
[sequence]
frames = 3
[camera]
size = [48, 32]
stereo = 0.25
keys = [
  { frame = 0, eye = [0, 0.5, 3], target = [0, 0, 0] },
  { frame = 2, eye = [2, 0.5, 3], target = [1.5, 0, -1] },
]
[refinement]
surfel_size = 3
";

fn row() -> TempDir {
    let at = TempDir::new().unwrap();
    let count = ["--count", "500", "--side", "128"];
    succeeds(at.path(), &[&["surfels", BALL, "-o", "blue.ply"], &count[..]].concat());
    fs::write(at.path().join("row.toml"), ROW).unwrap();
    at
}

fn same(at: &TempDir, one: &str, other: &str) {
    let [one_bytes, other_bytes] = [one, other].map(|name| fs::read(at.path().join(name)).unwrap());
    assert!(one_bytes == other_bytes, "{one} differs from {other}");
}

#[test]
fn an_eye_is_a_camera_beside_the_camera() {
    let at = TempDir::new().unwrap();
    let draw = |more: &[&str]| {
        let sphere = ["render", "sphere", "--count", "500", "--size", "32x24", "--up", "0,1,0"];
        succeeds(at.path(), &[&sphere[..], more].concat())
    };
    let middle = ["--eye", "0,0,4", "--target", "0,0,0", "--stereo", "0.5"];
    let said = draw(&[&middle[..], &["-o", "p.exr"]].concat());
    for word in ["left eye of a stereo pair, 0.5 apart", "p.left.exr to p.right.exr"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let pictures = ["p.left.exr", "p.left.png", "p.right.exr", "p.right.png"];
    assert_eq!(names(at.path()), pictures);
    draw(&["--eye=-0.25,0,4", "--target=-0.25,0,0", "-o", "left.exr"]);
    draw(&["--eye", "0.25,0,4", "--target", "0.25,0,0", "-o", "right.exr"]);
    for eye in ["left", "right"] {
        let [own, plain] = [format!("p.{eye}.exr"), format!("{eye}.exr")]
            .map(|name| exr::read(&at.path().join(name)).unwrap().channels);
        assert!(own == plain, "{eye}");
    }
    // The default name, and a part of both pictures.
    draw(&[&middle[..], &["--region", "0,0,32,8"]].concat());
    let out = names(&at.path().join("out"));
    assert_eq!(out[0], "sphere.0-0-32-8.left.exr");
    assert_eq!(out.len(), 4);
}

/// A pair, one eye alone, and the camera of a picture give the same file.
#[test]
fn each_picture_of_a_pair_can_be_drawn_again() {
    let at = row();
    for method in ["blue", "deferred"] {
        let draw = |more: &[&str]| {
            succeeds(at.path(), &[&["render", "row.toml", "--method", method], more].concat())
        };
        draw(&["--frames", "all", "-o", "w.exr"]);
        for eye in ["left", "right"] {
            let stereo = format!("0.25,{eye}");
            draw(&["--stereo", &stereo, "--frames", "all", "-o", "alone.exr"]);
            for frame in 0..3 {
                same(&at, &format!("w.{eye}.000{frame}.exr"), &format!("alone.000{frame}.exr"));
            }
            // A frame of `deferred` depends on the frame before.
            let of = format!("w.{eye}.0000.exr");
            draw(&["--cameras", &of, "-o", "again.exr"]);
            same(&at, &of, "again.exr");
            let verify = ["verify", "row.toml", &of, "--method", method];
            let by_eye = [&verify[..], &["--stereo", &stereo]].concat();
            assert!(succeeds(at.path(), &by_eye).contains("right"));
            succeeds(at.path(), &[&verify[..], &["--cameras", &of]].concat());
        }
    }
}

#[test]
fn a_walk_counts_the_time_of_both_pictures() {
    let at = row();
    let more = ["--frames", "all", "--target-ms", "1e-6", "-o", "w.exr"];
    let said =
        succeeds(at.path(), &[&["render", "row.toml", "--method", "blue"], &more[..]].concat());
    assert!(said.contains("3 frames, two pictures each"), "{said}");
    let table = fs::read_to_string(at.path().join("w.frames.csv")).unwrap();
    let last: Vec<&str> = table.lines().last().unwrap().split(',').collect();
    let one = ["--frame", last[0], "--surfel-size", last[1], "--stereo", "0.25,right"];
    let draw = ["render", "row.toml", "--method", "blue", "-o", "one.exr"];
    succeeds(at.path(), &[&draw[..], &one].concat());
    same(&at, "w.right.0002.exr", "one.exr");
}

#[test]
fn pairs_that_cannot_be_drawn_are_refused() {
    let at = TempDir::new().unwrap();
    let refused = |more: &[&str], what: &str| {
        let line = fails(at.path(), &[&["render", "sphere", "--count", "9"], more].concat(), 2);
        assert!(line.contains(what), "{what} in {line}");
    };
    for distance in ["0", "-0.065", "nan", "inf"] {
        refused(&["--stereo", distance], "give a distance above 0");
    }
    refused(&["--stereo", "far"], "as in 0.065,left");
    refused(&["--stereo", "0.065,middle"], "give left or right");
    let pair = ["--stereo", "0.5"];
    for more in [&["--bands", "2"] as &[&str], &["--repeat", "2"], &["--keep-state", "s"]] {
        refused(&[&pair[..], more].concat(), &format!("{} belongs to one", more[0]));
    }
    let line = fails(at.path(), &["explain", "sphere", "1", "1", "--stereo", "0.5"], 2);
    assert!(line.contains("choose an eye: --stereo 0.5,left"), "{line}");
    for (camera, what) in [
        ("stereo = -1", "give a distance above 0"),
        ("stereo = nan", "give a distance above 0"),
        ("stereo_eye = \"left\"", "add stereo"),
        ("stereo = 1\nstereo_eye = \"third\"", "give left or right"),
        ("other_eye = 1", "belongs to view_from_world"),
    ] {
        let text = format!("[[model]]\nshape = \"sphere\"\ncount = 9\n[camera]\n{camera}\n");
        fs::write(at.path().join("bad.toml"), text).unwrap();
        let line = fails(at.path(), &["render", "bad.toml", "-o", "x.exr"], 1);
        assert!(line.contains(what), "{what} in {line}");
    }
}
