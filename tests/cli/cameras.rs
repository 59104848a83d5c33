//! Cameras of other programs on the command line, and cameras that pictures give back.

use super::*;
use tempfile::TempDir;

/// A small picture of a shape with these options.
fn picture(at: &Path, name: &str, options: &[&str]) -> Vec<u8> {
    let mut arguments = vec!["render", "sphere", "--count", "200", "-o", name];
    arguments.extend(options);
    succeeds(at, &arguments);
    fs::read(at.join(name)).unwrap()
}

const LENS: [&str; 6] = ["--size", "64x48", "--intrinsics", "60,70,20.5,30", "--near", "0.5"];
/// From +x, looking along -x, in the axes of `OpenCV` and of OpenGL.
const OPENCV: &str = "0,0,-1,0.5, 0,-1,0,-0.25, -1,0,0,3";
const OPENGL: &str = "[[0, 0, -1, 0.5], [0, 1, 0, 0.25], [1, 0, 0, -3], [0, 0, 0, 1]]";
const BLENDER: &str = "0 0 1 3\n0 1 0 -0.25\n-1 0 0 0.5\n0 0 0 1\n";

#[test]
fn a_picture_gives_its_camera_back() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let perspective = ["--size", "64x48", "--eye", "0.1,0.7,3.3", "--fov", "33.3"];
    let orthographic = ["--size", "64x48", "--eye", "0.1,0.7,3.3", "--ortho", "2.7"];
    let odd = [&LENS[..], &["--eye", "0.3,1,4", "--target", "0.1,0.2,0"]].concat();
    for options in [&perspective[..], &orthographic, &odd] {
        let first = picture(at, "first.exr", options);
        assert_eq!(picture(at, "again.exr", &["--cameras", "first.exr"]), first, "{options:?}");
        // The table in the text is a table of a scene file.
        let said = succeeds(at, &["info", "first.exr"]);
        let camera = &said[said.find("[camera]").unwrap()..];
        let scene = format!("[[model]]\nshape = \"sphere\"\ncount = 200\n{camera}");
        fs::write(at.join("sphere.toml"), scene).unwrap();
        succeeds(at, &["render", "sphere.toml", "-o", "pasted.exr"]);
        assert_eq!(fs::read(at.join("pasted.exr")).unwrap(), first, "{options:?}");
    }
}

#[test]
fn every_convention_draws_one_picture() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let draw = |name, pose: &[&str]| picture(at, name, &[&LENS[..], pose].concat());
    let first = draw("a.exr", &["--convention", "opencv", "--world-to-camera", OPENCV]);
    let others: [&[&str]; 3] = [
        &["--convention", "opengl", "--world-to-camera", OPENGL],
        &["--convention", "blender", "--camera-to-world", BLENDER],
        &["--convention", "opencv", "--camera-to-world", "0,0,-1,3,0,-1,0,-0.25,-1,0,0,0.5"],
    ];
    for pose in others {
        assert_eq!(draw("b.exr", pose), first, "{pose:?}");
    }
    // fx = 60 and W = 64: 2 fx / W = 1.875; cx = 20.5: 1 - 2 cx / W = 0.359375; and so on.
    let (x, z, w) = ("1.875,0,0.359375,0", "0,0,0,0.5", "0,0,-1,0");
    let reversed = format!("{x},0,2.9166666666666665,0.25,0,{z},{w}");
    let vulkan = format!("{x},0,-2.9166666666666665,-0.25,0,{z},{w}");
    for (convention, matrix) in [("d3d", &reversed), ("vulkan", &vulkan)] {
        let lens = ["--size", "64x48", "--projection-matrix", matrix, "--convention", convention];
        let options = [&lens[..], &["--world-to-camera", OPENGL]].concat();
        assert_eq!(picture(at, "c.exr", &options), first, "{convention}");
    }
    // K by rows, and the scene file's camera replaced.
    let k = ["--size", "64x48", "--intrinsics", "60 0 20.5; 0 70 30; 0 0 1", "--near", "0.5"];
    let pose = ["--convention", "opencv", "--world-to-camera", OPENCV];
    assert_eq!(picture(at, "d.exr", &[&k[..], &pose].concat()), first);
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 200\n[camera]\nsize = [64, 48]\nfov = 20\n\
                 keys = [{ frame = 0, eye = [0, 0, 1], target = [0, 0, 0] }]\n";
    fs::write(at.join("sphere.toml"), scene).unwrap();
    let options = [&["render", "sphere.toml", "-o", "e.exr"], &LENS[..], &pose].concat();
    succeeds(at, &options);
    assert_eq!(fs::read(at.join("e.exr")).unwrap(), first);
}

const TRANSFORMS: &str = "{\"w\": 64, \"h\": 48, \"fl_x\": 60, \"frames\": [\
    {\"file_path\": \"train/r_0\", \"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]},\
    {\"file_path\": \"train/r_1\", \"transform_matrix\": [[0,0,1,3],[0,1,0,0],[-1,0,0,0],[0,0,0,1]]}]}";

#[test]
fn a_camera_file_is_a_sequence_or_one_view() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("t.json"), TRANSFORMS).unwrap();
    let scene = ["render", "sphere", "--count", "200", "--cameras", "t.json"];
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    succeeds(at, &[&scene[..], &["-o", "all.exr"]].concat());
    let all = [read("all.0000.exr"), read("all.0001.exr")];
    assert!(all[0] != all[1] && !at.join("all.exr").exists() && !at.join("all.0002.exr").exists());
    succeeds(at, &[&scene[..], &["--frames", "1..2", "-o", "some.exr"]].concat());
    assert_eq!(read("some.0001.exr"), all[1]);
    for (i, options) in
        [["--view", "0"], ["--view", "r_1"], ["--frame", "0"], ["--frame", "1"]].iter().enumerate()
    {
        succeeds(at, &[&scene[..], options, &["-o", "one.exr"]].concat());
        assert_eq!(read("one.exr"), all[i % 2], "{options:?}");
    }
    let error = fails(at, &[&scene[..], &["--view", "r_2", "-o", "one.exr"]].concat(), 2);
    assert!(error.contains("no view `r_2`") && error.contains("train/r_0"), "{error}");
    let error = fails(at, &[&scene[..], &["--frames", "0..3", "-o", "one.exr"]].concat(), 2);
    assert!(error.contains("give 0 to 1"), "{error}");
    // Other commands draw one of the views.
    succeeds(
        at,
        &["explain", "sphere", "32", "24", "--count", "200", "--cameras", "t.json", "--view", "1"],
    );
    // The picture must not overwrite the cameras.
    fs::copy(at.join("one.exr"), at.join("camera.exr")).unwrap();
    let error = fails(at, &["render", "sphere", "--cameras", "camera.exr", "-o", "camera.exr"], 2);
    assert!(error.contains("part of the scene"), "{error}");
    // A scene file may name the file, and the options another view.
    let text =
        "[[model]]\nshape = \"sphere\"\ncount = 200\n[camera]\nfile = \"t.json\"\nview = \"r_0\"\n";
    fs::write(at.join("sphere.toml"), text).unwrap();
    succeeds(at, &["render", "sphere.toml", "-o", "one.exr"]);
    assert_eq!(read("one.exr"), all[0]);
    succeeds(at, &["render", "sphere.toml", "--view", "1", "-o", "one.exr"]);
    assert_eq!(read("one.exr"), all[1]);
}

#[test]
fn a_turntable_goes_round() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let scene = ["render", "torus", "--count", "200", "--size", "32x24"];
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    succeeds(at, &[&scene[..], &["-o", "still.exr"]].concat());
    succeeds(at, &[&scene[..], &["--turntable", "4", "-o", "turn.exr"]].concat());
    assert_eq!(read("turn.0000.exr"), read("still.exr"));
    let exrs =
        names(at).iter().filter(|name| name.starts_with("turn.") && name.ends_with("exr")).count();
    assert_eq!(exrs, 4);
    succeeds(at, &[&scene[..], &["--turntable", "4", "--frame", "2", "-o", "half.exr"]].concat());
    assert_eq!(read("half.exr"), read("turn.0002.exr"));
    // The camera that a frame wrote gives the frame again.
    succeeds(
        at,
        &["render", "torus", "--count", "200", "--cameras", "half.exr", "-o", "again.exr"],
    );
    assert_eq!(read("again.exr"), read("half.exr"));
}

#[test]
fn cameras_that_are_none_end_in_one_line() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("t.json"), TRANSFORMS).unwrap();
    for (options, what) in [
        (&["--world-to-camera", OPENCV][..], "need a convention"),
        (&["--convention", "opencv"], "required"),
        (&["--world-to-camera", "1,2,3", "--convention", "opencv"], "12 or 16 numbers"),
        (&["--world-to-camera", "1,0,0,a", "--convention", "opencv"], "`a` is no number"),
        (&["--world-to-camera", OPENCV, "--convention", "colmap"], "opencv, opengl, blender"),
        (&["--world-to-camera", "2,0,0,0,0,2,0,0,0,0,2,0", "--convention", "opencv"], "scale of 2"),
        (&["--world-to-camera", "-1,0,0,0,0,1,0,0,0,0,1,0", "--convention", "opencv"], "mirrored"),
        (
            &["--world-to-camera", OPENCV, "--convention", "opencv", "--eye", "0,0,1"],
            "cannot be used with",
        ),
        (&["--world-to-camera", OPENCV, "--convention", "opencv", "--up", "0,0,1"], "replaces eye"),
        (&["--intrinsics", "60,60,32,24"], "give its --size"),
        (&["--size", "64x48", "--intrinsics", "60,1,32,0,60,24,0,0,1"], "skew"),
        (&["--size", "64x48", "--intrinsics", "60,60"], "FX,FY,CX,CY"),
        (&["--cameras", "t.json", "--fov", "30"], "cannot be used with"),
        (&["--cameras", "t.json", "--turntable", "3"], "choose one with view"),
        (&["--view", "3"], "give --cameras FILE"),
        (&["--turntable", "0"], "0"),
    ] {
        let arguments = [&["render", "sphere", "--count", "200", "-o", "a.exr"], options].concat();
        let error = fails(at, &arguments, 2);
        assert!(error.contains(what), "{options:?}: {error}");
    }
    let error = fails(at, &["render", "sphere", "--cameras", "none.json"], 1);
    assert!(error.contains("none.json"), "{error}");
    assert_eq!(names(at), ["t.json"]);
}
