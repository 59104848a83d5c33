//! `splatref render --frames`, and scenes of objects.

use super::*;
use tempfile::TempDir;

const WALK: &str = "\
[[geometry]]
name = \"tree\"
shape = \"torus\"
count = 300
[[object]]
of = \"tree\"
keys = [{ frame = 0, translate = [-1, 0, 0] }, { frame = 2, translate = [1, 0, 0], scale = 0.5 }]
[[model]]
shape = \"sphere\"
count = 100
[sequence]
frames = 3
[camera]
size = [32, 24]
keys = [
  { frame = 0, eye = [0, 1, 6], target = [0, 0, 0] },
  { frame = 2, eye = [4, 1, 4], target = [0, 0, 0] },
]
";

/// The scene in a directory of its own.
fn walk() -> TempDir {
    let at = TempDir::new().unwrap();
    fs::write(at.path().join("walk.toml"), WALK).unwrap();
    at
}

const ALL: [&str; 6] =
    ["w.0000.exr", "w.0000.png", "w.0001.exr", "w.0001.png", "w.0002.exr", "w.0002.png"];

#[test]
fn a_sequence_is_a_file_a_frame() {
    let at = walk();
    let read = |name: &str| fs::read(at.path().join(name)).unwrap();
    let said = succeeds(at.path(), &["render", "walk.toml", "--frames", "0..3", "-o", "w.exr"]);
    for word in [
        "walk: 400 surfels",
        "2 of 2 geometries, ids of 12 bits",
        "tree: 300 surfels, procedural; used by 1 objects",
        "sums over 3 frames",
        "visibility",
        "w.0000.exr to w.0002.exr",
    ] {
        assert!(said.contains(word), "{word} in {said}");
    }
    assert_eq!(names(at.path()), [&ALL[..], &["walk.toml"]].concat());
    let pictures = ALL.map(read);
    assert!(pictures[0] != pictures[2] && pictures[2] != pictures[4]);

    // One frame alone, and as a single picture.
    succeeds(at.path(), &["render", "walk.toml", "--frames", "1..2", "-o", "one.exr"]);
    assert_eq!(read("one.0001.exr"), pictures[2]);
    succeeds(at.path(), &["render", "walk.toml", "--frame", "1", "-o", "f.exr", "--threads", "1"]);
    assert_eq!(read("f.exr"), pictures[2]);
    succeeds(at.path(), &["render", "walk.toml"]);
    assert_eq!(read("out/walk.exr"), pictures[0], "frame 0 if nobody says");

    // Other commands take a frame too.
    succeeds(at.path(), &["verify", "walk.toml", "w.0002.exr", "--frame", "2"]);
    let said = succeeds(at.path(), &["explain", "walk.toml", "16", "12", "--frame", "2"]);
    assert!(said.contains("at (4, 1, 4)"), "{said}");
    succeeds(at.path(), &["project", "walk.toml", "--frame", "2", "-o", "r.bin"]);
    succeeds(at.path(), &["group", "walk.toml", "-o", "g.ply"]);
    let said = succeeds(at.path(), &["info", "walk.toml"]);
    assert!(said.contains("used by 1 objects") && said.contains("frames     3"), "{said}");
}

/// A camera that moves before what rests: one session draws all frames.
#[test]
fn what_rests_is_prepared_once() {
    let at = walk();
    let still = WALK.replace("[1, 0, 0], scale = 0.5", "[-1, 0, 0]");
    fs::write(at.path().join("still.toml"), still).unwrap();
    let method = ["--method", "single-pass", "--frames"];
    let frames = |range: &str, name: &str| {
        let more = [range, "-o", name];
        succeeds(at.path(), &[&["render", "still.toml"], &method[..], &more].concat())
    };
    frames("0..3", "w.exr");
    frames("2..3", "one.exr");
    let read = |name: &str| fs::read(at.path().join(name)).unwrap();
    assert_eq!(read("one.0002.exr"), read("w.0002.exr"));
    assert_ne!(read("w.0001.exr"), read("w.0002.exr"));
}

/// An error in the middle: what is written is whole, and nothing else is there.
#[test]
fn what_was_written_stays_whole() {
    let at = walk();
    fs::create_dir(at.path().join("w.0001.png")).unwrap();
    let line = fails(at.path(), &["render", "walk.toml", "--frames", "0..3", "-o", "w.exr"], 1);
    assert!(line.contains("w.0001.png"), "{line}");
    assert_eq!(names(at.path()), ["w.0000.exr", "w.0000.png", "w.0001.png", "walk.toml"]);
    exr::read(&at.path().join("w.0000.exr")).unwrap();
}

#[test]
fn frames_that_are_none_are_refused() {
    let at = walk();
    for (more, what) in [
        (&["--frames", "5..5"] as &[&str], "5..5 holds no frame"),
        (&["--frames", "2..1"], "2..1 holds no frame"),
        (&["--frames", "0..4"], "frame 3 of walk: give 0 to 2"),
        (&["--frames", "0"], "such as 0..60"),
        (&["--frames", "0..2", "--repeat", "3"], "--repeat"),
        (&["--frames", "0..2", "--frame", "1"], "--frame"),
        (&["--frames", "0..2", "-o", "w.png"], "give a name that ends in .exr"),
        (&["--frame", "3"], "frame 3 of walk: give 0 to 2"),
    ] {
        let line = fails(at.path(), &[&["render", "walk.toml"], more].concat(), 2);
        assert!(line.contains(what), "{line}");
    }
    let line = fails(at.path(), &["render", "sphere", "--frames", "0..2"], 2);
    assert!(line.contains("no [sequence]"), "{line}");
    // An output that is an input.
    let sky = ["--environment", "sky.0001.exr", "-o", "sky.exr"];
    succeeds(
        at.path(),
        &["render", "sphere", "--count", "9", "--size", "8x8", "-o", "sky.0001.exr"],
    );
    let line =
        fails(at.path(), &[&["render", "walk.toml", "--frames", "0..3"], &sky[..]].concat(), 2);
    assert!(line.contains("sky.0001.exr is part of the scene"), "{line}");
    assert_eq!(names(at.path()), ["sky.0001.exr", "sky.0001.png", "walk.toml"]);
}

#[test]
fn an_object_is_what_a_model_in_its_place_is() {
    let at = TempDir::new().unwrap();
    let place =
        "scale = 0.75\nrotate = { axis = [1, 2, 0], degrees = 50 }\ntranslate = [0.5, 0, 0]\n";
    let camera = "[camera]\nsize = [32, 24]\neye = [0, 1, 6]\ntarget = [0, 0, 0]\nfov = 40\n";
    let shape = "shape = \"torus\"\ncount = 300\n";
    fs::write(
        at.path().join("model.toml"),
        format!("[[model]]\n{shape}[model.transform]\n{place}{camera}"),
    )
    .unwrap();
    fs::write(
        at.path().join("object.toml"),
        format!(
            "[[geometry]]\nname = \"a\"\n{shape}[[object]]\nof = \"a\"\n[object.transform]\n{place}\
             {camera}"
        ),
    )
    .unwrap();
    let planes = ["model", "object"].map(|name| {
        let out = format!("{name}.exr");
        succeeds(at.path(), &["render", &format!("{name}.toml"), "-o", &out, "--stages"]);
        exr::read(&at.path().join(out)).unwrap().channels
    });
    assert!(planes[0] == planes[1]);
}

#[test]
fn scenes_of_objects_that_cannot_be_are_refused() {
    let at = TempDir::new().unwrap();
    let tree = "[[geometry]]\nname = \"tree\"\nshape = \"torus\"\ncount = 300\n";
    let many = |count: u64| {
        format!(
            "{tree}[[object]]\nof = \"tree\"\nscatter = {{ count = {count}, low = [0, 0, 0], \
             high = [1, 1, 1] }}\n"
        )
    };
    for (text, what) in [
        (many(1 << 32), "4294967296 objects"),
        (many((1 << 32) - 1), "--memory"),
        (format!("{tree}[[object]]\nof = \"oak\"\n"), "the geometries are tree"),
        (format!("{tree}[[object]]\nof = \"tree\"\ntable = \"none.csv\"\n"), "none.csv"),
        (
            format!("{tree}[[object]]\nof = \"tree\"\ntransform = {{ scale = 1e60 }}\n"),
            "tree.0 leaves",
        ),
        (format!("{tree}[[object]]\nof = \"tree\"\n[camera]\nkeys = []\n"), "no keys"),
    ] {
        fs::write(at.path().join("s.toml"), text).unwrap();
        for arguments in [
            &["render", "s.toml"] as &[&str],
            &["info", "s.toml"],
            &["explain", "s.toml", "1", "1"],
        ] {
            let line = fails(at.path(), arguments, 1);
            assert!(line.contains(what), "{line}");
        }
    }
    assert_eq!(names(at.path()), ["s.toml"]);
}

/// A sequence of the method that carries something is the same in one go and from a state.
#[test]
fn a_frame_goes_on_from_the_state_of_the_one_before() {
    let at = walk();
    let read = |name: &str| fs::read(at.path().join(name)).unwrap();
    let render = ["render", "walk.toml", "--method", "deferred"];
    let with = |more: &[&'static str]| [&render[..], more].concat();
    let said = succeeds(at.path(), &with(&["--frames", "0..3", "-o", "w.exr"]));
    assert!(said.contains("indices") && said.contains("difference"), "{said}");
    succeeds(at.path(), &with(&["--frames", "0..2", "-o", "a.exr", "--keep-state", "s.bin"]));
    succeeds(at.path(), &with(&["--frames", "2..3", "-o", "b.exr", "--state", "s.bin"]));
    assert_eq!(read("b.0002.exr"), read("w.0002.exr"));
    let one = ["--frame", "2", "--state", "s.bin", "-o", "c.exr"];
    let said = succeeds(at.path(), &[&with(&one)[..], &["--repeat", "3"]].concat());
    assert!(said.contains(" of 400 surfels, "), "{said}");
    assert!(said.contains("minimum and median of 3 pictures after this one"), "{said}");
    assert_eq!(read("c.exr"), read("w.0002.exr"), "repeated from the same state");
    succeeds(at.path(), &with(&["--frame", "2", "-o", "d.exr"]));
    assert_ne!(read("d.exr"), read("w.0002.exr"), "from nothing");
    let explain = ["explain", "walk.toml", "16", "12", "--method", "deferred", "--frame", "2"];
    let said = succeeds(at.path(), &[&explain[..], &["--state", "s.bin"]].concat());
    assert!(said.contains("flagged") && said.contains("surfel"), "{said}");

    // What cannot be.
    let refused = |more: &[&'static str], code| fails(at.path(), &with(more), code);
    let line = refused(&["--frame", "1", "--state", "s.bin", "-o", "x.exr"], 2);
    assert!(line.contains("the state after frame 1 is for frame 2, but this is frame 1"), "{line}");
    let line = refused(&["--frame", "2", "--state", "s.bin", "--flags", "8", "-o", "x.exr"], 2);
    assert!(
        line.contains("the state was kept with --flags 1, but the method has 8; set --flags 1"),
        "{line}"
    );
    let line = refused(&["--frame", "2", "--state", "walk.toml", "-o", "x.exr"], 1);
    assert!(line.contains("not a state of splatref"), "{line}");
    let line = refused(&["-o", "x.exr", "--keep-state", "walk.toml"], 2);
    assert!(line.contains("walk.toml"), "{line}");
    for kept in ["x.exr", "./x.png"] {
        let line = refused(&["-o", "x.exr", "--keep-state", kept], 2);
        assert!(line.contains("are the same file; give two names"), "{line}");
    }
    let frame = ["--frame", "2", "--state", "s.bin", "-o", "x.exr", "--keep-state", "./s.bin"];
    let line = refused(&frame, 2);
    assert!(line.contains("is also an input; give another name"), "{line}");
    fs::write(at.path().join("tree.toml"), format!("{WALK}[[geometry]]\nname = \"real\"\nshape = \"tree\"\nleaves = 9\n[[object]]\nof = \"real\"\n")).unwrap();
    let line = fails(at.path(), &["render", "tree.toml", "--method", "deferred", "-o", "x.exr"], 1);
    assert!(
        line.contains("has triangles or lines, but the method deferred does not draw"),
        "{line}"
    );
    let ewa = ["render", "walk.toml", "-o", "x.exr", "--keep-state", "t.bin"];
    let line = fails(at.path(), &ewa, 2);
    assert!(line.contains("the method ewa has no state between frames"), "{line}");
    let other = WALK.replace("count = 100", "count = 101");
    fs::write(at.path().join("other.toml"), other).unwrap();
    let other = ["render", "other.toml", "--method", "deferred", "--frame", "2", "-o", "x.exr"];
    let line = fails(at.path(), &[&other[..], &["--state", "s.bin"]].concat(), 1);
    assert!(line.contains("the state belongs to another scene"), "{line}");
    assert!(!at.path().join("x.exr").exists() && !at.path().join("t.bin").exists());
}

/// A frame is judged from the state that it was drawn from.
#[test]
fn a_frame_is_judged_from_the_state_of_the_one_before() {
    let at = walk();
    let of = |words: &[&'static str]| {
        [words, &["--method", "deferred", "--frame", "2"], &["--state", "s.bin"]].concat()
    };
    let before = ["render", "walk.toml", "--method", "deferred", "--frames", "0..2"];
    succeeds(at.path(), &[&before[..], &["-o", "a.exr", "--keep-state", "s.bin"]].concat());
    succeeds(at.path(), &of(&["render", "walk.toml", "--stages", "-o", "c.exr"]));
    let verify = of(&["verify", "walk.toml", "c.exr"]);
    let said = succeeds(at.path(), &verify);
    assert!(said.contains("indices        right") && said.contains("right: of "), "{said}");
    let said = succeeds(at.path(), &of(&["explain", "walk.toml", "16", "12", "--client", "c.exr"]));
    assert!(said.contains("indices        right"), "{said}");
    // From nothing pass 1 draws nothing.
    let output = splatref(at.path(), &verify[..verify.len() - 2]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("visibility     WRONG"), "{said}");
}

/// Levels of detail: a still scene is chosen anew for each frame of a camera that moves; a restarted sequence
/// has the same bits; planes of ids of a method that draws surfels are judged, and what cannot be is refused.
#[test]
fn levels_of_detail_follow_the_camera() {
    let at = TempDir::new().unwrap();
    let scene = WALK.replace("count = 300", "count = 900\ndetail = 1.5");
    let still = "transform = { translate = [0, 0, -20] }";
    let keys = "keys = [{ frame = 0, translate = [-1, 0, 0] }, { frame = 2, translate = [1, 0, 0], scale = 0.5 }]";
    assert!(scene.contains(keys));
    fs::write(at.path().join("walk.toml"), scene.replace(keys, still)).unwrap();
    let read = |name: &str| fs::read(at.path().join(name)).unwrap();
    let frames = |range: &'static str, more: &[&'static str]| {
        let words = ["render", "walk.toml", "--method", "deferred", "--frames", range];
        succeeds(at.path(), &[&words[..], more].concat())
    };
    let said = frames("0..3", &["-o", "w.exr"]);
    assert!(said.contains("tree: 900 surfels, ") && said.contains(" nodes at 1.5 px"), "{said}");
    assert!(said.contains("  in view  ") && said.contains("placing"), "{said}");
    frames("0..2", &["-o", "v.exr", "--keep-state", "s.bin"]);
    frames("2..3", &["-o", "v.exr", "--state", "s.bin"]);
    for frame in ["0000", "0001", "0002"] {
        assert_eq!(read(&format!("w.{frame}.exr")), read(&format!("v.{frame}.exr")), "{frame}");
    }
    let ewa = ["walk.toml", "--method", "ewa", "--frame", "2"];
    succeeds(at.path(), &[&["render"], &ewa[..], &["-o", "e.exr", "--stages"]].concat());
    let judged = [&["verify", "walk.toml", "e.exr"], &ewa[1..]].concat();
    assert!(succeeds(at.path(), &judged).contains("right: of "));

    for (detail, why) in [
        ("detail = -1", "detail is -1 pixels; give 0 to 4096"),
        ("detail = nan", "detail is NaN pixels; give 0 to 4096"),
    ] {
        fs::write(at.path().join("bad.toml"), scene.replace("detail = 1.5", detail)).unwrap();
        let line = fails(at.path(), &["render", "bad.toml", "-o", "x.exr"], 1);
        assert!(line.contains(why), "{line}");
    }
    fs::write(at.path().join("bad.toml"), "[[model]]\nshape = \"torus\"\ndetail = 1\n").unwrap();
    let line = fails(at.path(), &["render", "bad.toml", "-o", "x.exr"], 1);
    assert!(line.contains("`detail` does not apply to torus: remove it"), "{line}");
}

/// The size of ordered points follows the time that the last frame took. The wanted times are far below and
/// far above what a frame can take, so that the sizes are known.
#[test]
fn a_walk_tells_its_sizes_and_each_frame_can_be_drawn_again() {
    let at = TempDir::new().unwrap();
    let ball = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/ball.ply");
    succeeds(at.path(), &["surfels", ball, "-o", "blue.ply", "--count", "500", "--side", "128"]);
    let draw = ["render", "blue.ply", "--method", "blue", "--size", "48x32", "--turntable", "7"];
    let wanted = [("1e-6", ["4", "8", "8"]), ("1e12", ["4", "3", "2.25"])];
    for (target, first) in wanted {
        let more = ["--surfel-size", "4", "--target-ms", target, "-o", "w.exr"];
        let said = succeeds(at.path(), &[&draw[..], &more].concat());
        let last = if target == "1e12" { "1.000 to 4.000 px" } else { "4.000 to 8.000 px" };
        for word in [last, "wanted", "w.frames.csv", "w.frames.svg"] {
            assert!(said.contains(word), "{word} in {said}");
        }
        let table = fs::read_to_string(at.path().join("w.frames.csv")).unwrap();
        let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows[0][..4], ["frame", "surfel_size", "surfels", "primitives"]);
        assert_eq!(rows.len(), 8, "a line a frame");
        assert_eq!([1, 2, 3].map(|row| rows[row][1]), first);
        let one = ["--frame", rows[3][0], "--surfel-size", rows[3][1], "-o", "one.exr"];
        succeeds(at.path(), &[&draw[..], &one].concat());
        let read = |name: &str| fs::read(at.path().join(name)).unwrap();
        assert!(read("one.exr") == read("w.0002.exr"), "{target}");
        let chart = fs::read_to_string(at.path().join("w.frames.svg")).unwrap();
        assert!(chart.contains("Times of frames") && chart.contains("placing"), "{chart}");
    }
    // A sequence that stops has told the sizes of the frames before.
    fs::create_dir(at.path().join("late.0002.exr")).unwrap();
    let late = ["--surfel-size", "4", "--target-ms", "1e12", "-o", "late.exr"];
    fails(at.path(), &[&draw[..], &late].concat(), 1);
    let table = fs::read_to_string(at.path().join("late.frames.csv")).unwrap();
    let sizes: Vec<&str> = table.lines().filter_map(|line| line.split(',').nth(1)).collect();
    assert_eq!(sizes, ["surfel_size", "4", "3"]);
    let refused = |more: &[&str], word: &str| {
        let line =
            fails(at.path(), &[&["render", "blue.ply", "--method", "blue"], more].concat(), 2);
        assert!(line.contains(word), "{line}");
    };
    refused(&["--surfel-size", "4", "--target-ms", "9"], "--target-ms needs a sequence");
    refused(&["--turntable", "2", "--target-ms", "9"], "give --surfel-size");
    refused(&["--turntable", "2", "--target-ms", "0"], "greater than 0");
}
