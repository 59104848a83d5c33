//! Cameras given by intrinsics, matrices and files.

use super::written::check;
use super::*;
use crate::io::provenance;
use crate::scene::camera::stereo::Eye;
use crate::scene::{Projection, Stereo};
use glam::DMat4;

/// A scene with these lines in its table `[camera]`.
fn with(camera: &str) -> SceneFile {
    parse(&format!("{SHAPE}[camera]\n{camera}"))
}

fn wrong(camera: &str) -> String {
    refused(&format!("{SHAPE}[camera]\n{camera}"))
}

fn scene() -> Scene {
    load(&parse(SHAPE)).scene
}

/// Turned by a quarter about y, at (0, 1, 3) in the axes of the camera; exact in every convention.
const OPENCV: &str = "[[0, 0, -1, 0.5], [0, -1, 0, -0.25], [-1, 0, 0, 3]]";
const OPENGL: &str = "[[0, 0, -1, 0.5], [0, 1, 0, 0.25], [1, 0, 0, -3], [0, 0, 0, 1]]";
const OPENCV_BACK: &str = "[[0, 0, -1, 3], [0, -1, 0, -0.25], [-1, 0, 0, 0.5], [0, 0, 0, 1]]";
const OPENGL_BACK: &str = "[[0, 0, 1, 3], [0, 1, 0, -0.25], [-1, 0, 0, 0.5], [0, 0, 0, 1]]";

#[test]
fn one_camera_in_every_convention() {
    let lens = "size = [64, 48]\nfx = 60\nfy = 70\ncx = 20.5\ncy = 30\nnear = 0.5\n";
    let scene = scene();
    let cameras: Vec<Camera> = [
        ("opencv", "world_to_camera", OPENCV),
        ("opencv", "camera_to_world", OPENCV_BACK),
        ("opengl", "world_to_camera", OPENGL),
        ("opengl", "camera_to_world", OPENGL_BACK),
        ("blender", "camera_to_world", OPENGL_BACK),
    ]
    .map(|(convention, key, rows)| {
        let file = with(&format!("{lens}convention = \"{convention}\"\n{key} = {rows}\n"));
        check(&file);
        file.camera(&scene).unwrap()
    })
    .into();
    assert!(cameras.windows(2).all(|pair| pair[0] == pair[1]), "{cameras:#?}");
    let camera = cameras[0];
    assert_eq!(
        [camera.fx, camera.fy, camera.cx, camera.cy, camera.near],
        [60.0, 70.0, 20.5, 30.0, 0.5]
    );
    assert_eq!(camera.eye(), DVec3::new(3.0, -0.25, 0.5));
}

#[test]
fn a_camera_comes_back_bit_for_bit() {
    let scene = scene();
    let pose = Pose { eye: DVec3::new(0.1, 0.7, 3.3), target: DVec3::X * 0.2, up: DVec3::Y };
    let camera = Camera::new(61, 47, pose, Lens::FieldOfView(33.3)).unwrap();
    let straight = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
    let mut tiny = Camera::new(61, 47, straight, Lens::FieldOfView(33.3)).unwrap();
    tiny.view_from_world.x_axis.y = -0.0;
    let orthographic = Camera::new(61, 47, pose, Lens::Orthographic(2.7)).unwrap();
    let odd = Camera { fx: 50.1, cx: -3.3, cy: 100.7, near: 0.123, ..camera };
    let eye = Camera { other_eye: Some(0.3), ..camera };
    for camera in [camera, tiny, odd, eye, orthographic, Camera { near: -1.5, ..orthographic }] {
        let file = with(&provenance::camera(&camera, DVec3::ZERO));
        check(&file);
        let again = file.camera(&scene).unwrap();
        assert_eq!(again, camera);
        let bits = |camera: &Camera| camera.view_from_world.to_cols_array().map(f32::to_bits);
        assert_eq!(bits(&again), bits(&camera));
    }
}

#[test]
fn a_scene_far_from_the_origin_is_seen_from_its_coordinates() {
    let offset = DVec3::new(450_000.0, 5_000_000.0, 128.0);
    let mut scene = scene();
    scene.offset = offset;
    // By eye and target, by matrix, and around: all in the coordinates of the files.
    let eye = offset + DVec3::new(0.0, 0.0, 4.0);
    let lens = "size = [64, 48]\nfx = 60\n";
    let [x, y, z] = eye.to_array();
    let places = format!("eye = {:?}\ntarget = {:?}\n", eye.to_array(), offset.to_array());
    let posed = with(&format!("{lens}{places}")).camera(&scene).unwrap();
    let back = format!("[[1, 0, 0, {x:?}], [0, 1, 0, {y:?}], [0, 0, 1, {z:?}]]");
    let matrix = format!("{lens}convention = \"opengl\"\ncamera_to_world = {back}\n");
    let given = with(&matrix).camera(&scene).unwrap();
    assert_eq!(given.view_from_world, posed.view_from_world);
    let turned = with(&format!("{lens}{places}turntable = 2\n"));
    let turned = SceneFile { frame: 1, ..turned }.camera(&scene).unwrap();
    assert!((turned.eye() - DVec3::new(0.0, 0.0, -4.0)).length() < 1e-6);
    // What a picture says gives the camera again, in this scene and beside one without an offset.
    let told = with(&provenance::camera(&posed, offset));
    check(&told);
    assert_eq!(told.camera(&scene).unwrap(), posed);
    let pair = Stereo { distance: 0.5, eye: Some(Eye::Right) }.camera(posed).unwrap();
    let told_of_eye = with(&provenance::camera(&pair, offset));
    scene.offset = offset - DVec3::X;
    let eye = told.camera(&scene).unwrap().eye();
    assert!((eye - DVec3::new(1.0, 0.0, 4.0)).length() < 1e-6, "{eye}");
    let left = told_of_eye.camera(&scene).unwrap().seen_by_other_eye().unwrap().eye();
    assert!((left - DVec3::new(0.75, 0.0, 4.0)).length() < 1e-6, "{left}");
}

#[test]
fn a_projection_matrix_has_lens_and_planes() {
    let matrix = "projection_matrix = [[3, 0, 0.25, 0], [0, 4, -0.5, 0], [0, 0, -1.5, -1.25], [0, 0, -1, 0]]\n";
    let pose = format!("world_to_camera = {OPENGL}\nconvention = \"opengl\"\n");
    let file = with(&format!("size = [64, 48]\n{matrix}{pose}"));
    check(&file);
    let camera = file.camera(&scene()).unwrap();
    // cx = 32 (1 - 0.25), cy = 24 (1 - 0.5); near 1.25 / 2.5, far 1.25 / 0.5.
    assert_eq!(
        [camera.fx, camera.fy, camera.cx, camera.cy, camera.near],
        [96.0, 96.0, 24.0, 12.0, 0.5]
    );
    assert_eq!(file.camera.far, Some(2.5));
    let nearer = with(&format!("size = [64, 48]\nnear = 0.125\n{matrix}{pose}"));
    assert_eq!(nearer.camera(&scene()).unwrap().near, 0.125);
}

#[test]
fn intrinsics_go_with_any_pose_and_size() {
    let scene = scene();
    let lens = "size = [64, 48]\nfx = 60\ncx = 20\n";
    let file = with(&format!("{lens}eye = [0, 0, 4]\ntarget = [0, 0, 0]\n"));
    let camera = file.camera(&scene).unwrap();
    let pose = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
    let plain = Camera::new(64, 48, pose, Lens::Focal(60.0)).unwrap();
    assert_eq!(camera, Camera { cx: 20.0, ..plain });
    let mut larger = file;
    larger.camera.size = Some([128, 144]);
    let camera = larger.camera(&scene).unwrap();
    let [fx, fy, cx, cy] = [120.0, 180.0, 40.0, 72.0];
    assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [fx, fy, cx, cy]);
    // A matrix takes any lens.
    let file = with(&format!(
        "size = [64, 48]\nfov = 90\nconvention = \"opencv\"\nworld_to_camera = {OPENCV}\n"
    ));
    let camera = file.camera(&scene).unwrap();
    assert_eq!((camera.projection, camera.cx), (Projection::Perspective, 32.0));
    assert!((camera.fx - 24.0).abs() < 1e-5);
    // The near plane follows from the distance to the middle of the scene.
    let middle = scene.bounding_sphere().center;
    let near = ((middle - camera.eye()).length() / 1024.0) as f32;
    assert_eq!(camera.near, near);
    let inside = with(
        "convention = \"opencv\"\nworld_to_camera = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\n",
    );
    assert!(inside.camera(&scene).unwrap().near > 0.0);
}

#[test]
fn a_turntable_begins_with_the_camera() {
    let scene = scene();
    let file = with("size = [64, 48]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\nturntable = 3\n");
    check(&file);
    assert_eq!(file.frame_count(), 3);
    let still =
        with("size = [64, 48]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n").camera(&scene).unwrap();
    assert_eq!(file.camera(&scene).unwrap(), still);
    let file = SceneFile { frame: 1, ..file };
    let eye = file.camera(&scene).unwrap().eye();
    let expected = DVec3::new(4.0 * 0.75_f64.sqrt(), 1.0, -2.0);
    assert!((eye - expected).length() < 1e-6, "{eye}");
}

#[test]
fn cameras_that_are_none_are_refused() {
    let pose = format!("world_to_camera = {OPENCV}\n");
    let opencv = "convention = \"opencv\"\n";
    let projection =
        "projection_matrix = [[3, 0, 0, 0], [0, 4, 0, 0], [0, 0, -1.5, -1.25], [0, 0, -1, 0]]\n";
    for (camera, what) in [
        (pose.clone(), "need a convention"),
        (opencv.into(), "belong to a pose"),
        (format!("{projection}convention = \"opengl\"\n"), "belong to a pose"),
        (format!("{projection}{pose}{opencv}"), "opengl, vulkan or d3d"),
        (
            format!("{pose}convention = \"colmap\"\n"),
            "give one of opencv, opengl, blender, vulkan, d3d",
        ),
        (format!("{pose}convention = \"d3d\"\n"), "opencv, opengl or blender"),
        (format!("{pose}{opencv}camera_to_world = {OPENCV}\n"), "one of world_to_camera"),
        (
            format!("{pose}{opencv}view_from_world = {OPENGL}\n"),
            "view_from_world is the whole pose",
        ),
        (format!("{pose}{opencv}eye = [0, 0, 1]\n"), "a matrix replaces eye"),
        (format!("{pose}{opencv}up = [0, 0, 1]\n"), "a matrix replaces eye"),
        (format!("{opencv}world_to_camera = [[1, 0, 0, 0], [0, 1, 0, 0]]\n"), "2 rows"),
        (format!("{opencv}world_to_camera = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"), "length"),
        (
            format!("{opencv}world_to_camera = [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]\n"),
            "scale of 2",
        ),
        (
            format!("{opencv}world_to_camera = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]]\n"),
            "mirrored",
        ),
        ("offset = [1, 0, 0]\n".into(), "offset belongs to"),
        ("fx = 60\n".into(), "give its size"),
        ("size = [64, 48]\ncx = 60\n".into(), "give fx or f"),
        ("size = [64, 48]\nfx = 60\nf = [1, 1]\n".into(), "give fx or f"),
        ("size = [64, 48]\nfx = 60\nfov = 30\n".into(), "intrinsics replace fov"),
        ("size = [64, 48]\nf = [60, 60]\nprojection = \"fisheye\"\n".into(), "fisheye"),
        ("view = 3\n".into(), "camera file"),
        ("file = \"a.json\"\neye = [0, 0, 1]\n".into(), "a camera file has the pose"),
        ("file = \"a.json\"\nturntable = 3\n".into(), "choose one with view"),
        ("turntable = 0\n".into(), "0 frames"),
        (
            "turntable = 3\nkeys = [{ frame = 0, eye = [0, 0, 1], target = [0, 0, 0] }]\n".into(),
            "remove one",
        ),
    ] {
        let error = wrong(&camera);
        assert!(error.contains(what) && error.contains("line "), "{camera}: {error}");
    }
}

/// What can only be seen when the camera is made.
#[test]
fn numbers_that_make_no_camera_are_refused() {
    for (camera, what) in [
        ("size = [64, 48]\nfx = -60\n", "focal length"),
        ("size = [64, 48]\nfx = inf\n", "focal length"),
        ("near = 0\n", "near plane"),
    ] {
        let error = with(camera).camera(&scene()).unwrap_err().to_string();
        assert!(error.contains(what), "{camera}: {error}");
    }
    let far = DMat4::from_translation(DVec3::X * 1e39);
    let mut file = with("size = [64, 48]\n");
    file.camera.view = Some(far);
    assert!(file.camera(&scene()).is_err());
}
