//! Camera files of other programs, as these write them.

use super::*;
use crate::frame::Exec;
use crate::io::scene_file::{SceneFile, Source, Views};
use crate::scene::{Camera, Scene, Surfels};
use glam::DVec3;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// Writes files into a folder of their own.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let at = TempDir::new().unwrap();
    for (name, text) in files {
        fs::write(at.path().join(name), text).unwrap();
    }
    at
}

/// The cameras of all views, for a picture of a chosen size.
fn cameras(path: PathBuf, size: Option<[u32; 2]>) -> Vec<Camera> {
    let mut file = SceneFile::of_model(Source::procedural("sphere").unwrap());
    file.camera.views = Some(Views::read(&path, None).unwrap());
    file.camera.size = size;
    let points = crate::source::Shape::by_name("sphere").unwrap().surfels(100, 0).unwrap();
    let scene = Scene::lit("sphere", points);
    (0..file.frame_count())
        .map(|frame| SceneFile { frame, ..file.clone() }.camera(&scene).unwrap())
        .collect()
}

fn refused(path: &Path) -> String {
    let error = read(path).unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

const IDENTITY: &str = "[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]";

fn transforms(file: &str, frame: &str) -> TempDir {
    let text = format!(
        "{{{file} \"frames\": [{{\"file_path\": \"./train/r_0\", {frame} \"transform_matrix\": {IDENTITY}}}]}}"
    );
    folder(&[("transforms.json", &text)])
}

#[test]
fn nerfstudio_keys() {
    let at = transforms(
        "\"camera_model\": \"OPENCV\", \"k1\": 0, \"p2\": 0.0, \"w\": 640.0, \"h\": 480, \"fl_x\": 500.5, \
         \"fl_y\": 600, \"cx\": 300, \"cy\": 250.25, \"aabb_scale\": 16, \"applied_transform\": [[1,0,0,0]],",
        "\"colmap_im_id\": 1, \"fl_y\": 601,",
    );
    let path = at.path().join("transforms.json");
    let [camera] = cameras(path.clone(), None)[..] else { panic!("one view") };
    assert_eq!(camera.size(), [640, 480]);
    assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [500.5, 601.0, 300.0, 250.25]);
    assert_eq!(camera.eye(), DVec3::Z * 4.0);
    // Half as large, with half the numbers.
    let [camera] = cameras(path, Some([320, 240]))[..] else { panic!("one view") };
    assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [250.25, 300.5, 150.0, 125.125]);
}

#[test]
fn blender_angles() {
    let at = transforms("\"camera_angle_x\": 1.0,", "");
    let path = at.path().join("transforms.json");
    let focal = 32.0 / 0.546_302_5_f32;
    let near = |found: f32, expected: f32| {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    };
    let [camera] = cameras(path.clone(), Some([64, 48]))[..] else { panic!("one view") };
    near(camera.fx, focal);
    assert_eq!((camera.fx, camera.cx, camera.cy), (camera.fy, 32.0, 24.0));
    // Without a size, the picture itself has it.
    let unsized_view = read(&path).unwrap();
    assert!(unsized_view[0].intrinsics(None).unwrap_err().contains("w and h"));
    fs::create_dir(at.path().join("train")).unwrap();
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x80\0\0\0\x40\x08\x06\0\0\0";
    fs::write(at.path().join("train/r_0.png"), png).unwrap();
    let [camera] = cameras(path, None)[..] else { panic!("one view") };
    assert_eq!(camera.size(), [128, 64]);
    near(camera.fx, 2.0 * focal);
    let both = transforms(
        "\"x_fov\": 90, \"camera_angle_y\": 1.5707963267948966, \"w\": 64, \"h\": 48,",
        "",
    );
    let [camera] = cameras(both.path().join("transforms.json"), None)[..] else {
        panic!("one view")
    };
    near(camera.fx, 32.0);
    near(camera.fy, 24.0);
}

#[test]
fn transforms_that_are_none_are_refused() {
    let lens = "\"w\": 64, \"h\": 48, \"fl_x\": 50,";
    let cases = [
        (format!("{lens} \"k1\": 0.01,"), "", "k1 = 0.01"),
        (lens.into(), "\"p2\": 1e-5,", "p2 = 0.00001"),
        (format!("{lens} \"camera_model\": \"OPENCV_FISHEYE\","), "", "OPENCV_FISHEYE"),
        (format!("{lens} \"camera_model\": \"EQUIRECTANGULAR\","), "", "EQUIRECTANGULAR"),
        (format!("{lens} \"is_fisheye\": true,"), "", "fisheye"),
        ("\"w\": 64, \"h\": 48,".into(), "", "fl_x"),
        ("\"w\": 64, \"fl_x\": 50,".into(), "", "w and h"),
        ("\"fl_x\": 50,".into(), "", "w and h"),
        ("\"w\": 64.5, \"h\": 48, \"fl_x\": 50,".into(), "", "64.5"),
        ("\"w\": \"64\", \"h\": 48, \"fl_x\": 50,".into(), "", "w: \"64\" is no number"),
    ];
    for (file, frame, what) in cases {
        let at = transforms(&file, frame);
        let error = refused(&at.path().join("transforms.json"));
        assert!(error.contains(what) && error.contains("frame 0 (./train/r_0)"), "{what}: {error}");
    }
    for (matrix, what) in
        [("[[1]]", "4 rows of 4 numbers"), ("[[2,0,0,0],[0,2,0,0],[0,0,2,0]]", "scale of 2")]
    {
        let at = transforms(lens, "");
        let path = at.path().join("transforms.json");
        let text = fs::read_to_string(&path).unwrap().replace(IDENTITY, matrix);
        fs::write(&path, text).unwrap();
        assert!(refused(&path).contains(what), "{what}");
    }
    for (text, what) in [
        ("{", "JSON"),
        ("[]", "frames"),
        ("{\"frames\": 3}", "frames"),
        ("{\"frames\": []}", "0 cameras"),
        ("{\"frames\": [3]}", "transform_matrix"),
    ] {
        let at = folder(&[("a.json", text)]);
        assert!(refused(&at.path().join("a.json")).contains(what), "{text}");
    }
}

const CAMERAS: &str = "# Camera list\n1 PINHOLE 64 48 60 70 20.5 30\r\n2 SIMPLE_RADIAL 64 48 60 32 24 0\n3 OPENCV 64 48 60 60 32 24 0 0 0.1 0\n";
/// The second has a quaternion of length 2: a half turn about z.
const IMAGES: &str = "# Image list\n\n7 1 0 0 0 0.5 0.25 3 1 a/one picture.png\n1.5 2.5 -1 3 4 17\n2 0 0 0 2 0 0 4 2 two.png\n\n";

#[test]
fn colmap_pinholes() {
    let at = folder(&[("cameras.txt", CAMERAS), ("images.txt", IMAGES)]);
    for path in [at.path().to_owned(), at.path().join("images.txt"), at.path().join("cameras.txt")]
    {
        let views = read(&path).unwrap();
        let names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
        assert_eq!(names, ["a/one picture.png", "two.png"]);
        let [one, two] = cameras(path, None)[..] else { panic!("two views") };
        assert_eq!([one.fx, one.fy, one.cx, one.cy], [60.0, 70.0, 20.5, 30.0]);
        let row = |camera: &Camera, i| camera.view_from_world.row(i).to_array();
        assert_eq!(
            [row(&one, 0), row(&one, 1), row(&one, 2)],
            [[1.0, 0.0, 0.0, 0.5], [0.0, -1.0, 0.0, -0.25], [0.0, 0.0, -1.0, -3.0]]
        );
        assert_eq!([two.fx, two.fy, two.cx, two.cy], [60.0, 60.0, 32.0, 24.0]);
        assert_eq!(
            [row(&two, 0), row(&two, 1), row(&two, 2)],
            [[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, -4.0]]
        );
    }
}

#[test]
fn colmap_that_is_none_is_refused() {
    let images = |line: &str| format!("{line}\n\n");
    let pose = "1 1 0 0 0 0 0 4";
    let cases = [
        (
            CAMERAS.to_owned(),
            images(&format!("{pose} 3 c.png")),
            "images.txt: line 1: c.png: cameras.txt: line 4: OPENCV distorts: p1 = 0.1",
        ),
        (CAMERAS.to_owned(), images(&format!("{pose} 9 c.png")), "no camera 9"),
        (CAMERAS.to_owned(), images("1 0 0 0 0 0 0 4 1 c.png"), "quaternion"),
        (CAMERAS.to_owned(), images("1 1 0 0 0 0 0 4 1"), "IMAGE_ID"),
        (CAMERAS.to_owned(), images("1 a 0 0 0 0 0 4 1 c.png"), "`a` is no number"),
        (
            CAMERAS.to_owned(),
            format!("{pose} 1 c.png\n{pose} 1 d.png\n"),
            "line 2: the line after a picture",
        ),
        (
            "1 PINHOLE 64 48 60 70\n".into(),
            images(&format!("{pose} 1 c.png")),
            "PINHOLE has 4 parameters, but here are 2",
        ),
        (
            "1 OPENCV_FISHEYE 64 48 60 70 32 24 0 0 0 0\n".into(),
            images(&format!("{pose} 1 c.png")),
            "OPENCV_FISHEYE",
        ),
        (
            "1 PINHOLE 64\n".into(),
            images(&format!("{pose} 1 c.png")),
            "cameras.txt: line 1: give CAMERA_ID",
        ),
        (
            "1 PINHOLE 0 48 60 70 32 24\n".into(),
            images(&format!("{pose} 1 c.png")),
            "0.0 x 48.0 pixels",
        ),
        (
            format!("{CAMERAS}1 PINHOLE 64 48 60 70 1 1\n"),
            images(&format!("{pose} 1 c.png")),
            "second time",
        ),
    ];
    for (cameras, images, what) in cases {
        let at = folder(&[("cameras.txt", &cameras), ("images.txt", &images)]);
        let error = refused(at.path());
        assert!(error.contains(what), "{what}: {error}");
    }
    let binary = folder(&[("cameras.bin", ""), ("images.bin", "")]);
    for path in [binary.path().to_owned(), binary.path().join("images.bin")] {
        assert!(refused(&path).contains("model_converter"));
    }
    assert!(
        refused(&folder(&[("a.yaml", "")]).path().join("a.yaml")).contains("not a camera file")
    );
}

#[test]
fn views_have_names_and_numbers() {
    let frame =
        |name: &str| format!("{{\"file_path\": \"{name}\", \"transform_matrix\": {IDENTITY}}}");
    let names = ["./train/r_0", "test/r_0", "test/r_1.png", "2"];
    let frames = names.map(frame).join(",");
    let text = format!("\u{feff}{{\"w\": 4, \"h\": 3, \"fl_x\": 5, \"frames\": [{frames}]}}");
    let at = folder(&[("t.json", &text)]);
    let path = at.path().join("t.json");
    let views = read(&path).unwrap();
    let found = |name: &str| find(&path, &views, name);
    for (name, place) in [
        ("./train/r_0", 0),
        ("test/r_0", 1),
        ("r_1.png", 2),
        ("r_1", 2),
        ("2", 3),
        ("0", 0),
        ("3", 3),
    ] {
        assert_eq!(found(name).unwrap(), place, "{name}");
    }
    let several = found("r_0").unwrap_err().to_string();
    assert!(several.contains("views 0 and 1"), "{several}");
    for name in ["4", "-1", "r_9", ""] {
        let error = found(name).unwrap_err().to_string();
        assert!(error.contains("0 to 3") && error.contains("./train/r_0"), "{name}: {error}");
    }
}

#[test]
fn a_scene_file_names_a_camera_file() {
    let at = folder(&[("cameras.txt", CAMERAS), ("images.txt", IMAGES)]);
    let scene = |camera: &str| {
        let path = at.path().join("scene.toml");
        fs::write(&path, format!("[[model]]\nshape = \"sphere\"\ncount = 50\n[camera]\n{camera}"))
            .unwrap();
        SceneFile::read(&path)
    };
    let all = scene("file = \"images.txt\"\n").unwrap();
    assert_eq!(all.frame_count(), 2);
    let exec = Exec::sequential();
    let ready = all.ready(&exec, &|_, _, _| ()).unwrap();
    let second = ready.camera_at(1).unwrap();
    let one = scene("file = \"images.txt\"\nview = \"two\"\n").unwrap();
    assert_eq!(one.frame_count(), 1);
    assert_eq!(one.ready(&exec, &|_, _, _| ()).unwrap().camera, second);
    let by_number = scene("file = \"images.txt\"\nview = 1\n").unwrap();
    assert_eq!(by_number.ready(&exec, &|_, _, _| ()).unwrap().camera, second);
    assert!(all.reads().any(|path| path.ends_with("images.txt")));
    assert_eq!(scene("file = \"images.txt\"\nview = 2\n").unwrap_err().exit_code(), 2);
    // The text of the scene names the file again.
    let path = at.path().join("again.toml");
    fs::write(&path, one.text(&path).unwrap()).unwrap();
    assert_eq!(SceneFile::read(&path).unwrap().camera, one.camera);
    // Parsing alone reads no other file.
    let text = "[[model]]\nshape = \"sphere\"\n[camera]\nfile = \"none.json\"\n";
    let parsed = SceneFile::parse(text, Path::new("scene.toml")).unwrap();
    let error = parsed.camera(&Scene::unlit("none", Surfels::none())).unwrap_err().to_string();
    assert!(error.contains("SceneFile::read"), "{error}");
}
