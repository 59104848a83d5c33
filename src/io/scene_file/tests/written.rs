//! Check that written scene files are read as the same scene.

use super::*;

/// Reads the written text of a file, which must describe the same scene.
pub(super) fn check(file: &SceneFile) -> String {
    let path = Path::new("a/scene.toml");
    let text = file.text(path).unwrap();
    let again = SceneFile::parse(&text, path).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let method = file.method.method().unwrap();
    assert_eq!(again.method.method().unwrap(), method, "{text}");
    assert_eq!(again.grouping(&method).unwrap(), file.grouping(&method).unwrap(), "{text}");
    let (name, groups) = (file.name.clone(), file.groups.clone());
    let told = SceneFile { name, method: file.method.clone(), groups, ..again };
    assert_eq!(told, *file, "{text}");
    text
}

#[test]
fn the_examples_are_written() {
    check(&parse(EXAMPLE));
    check(&parse(include_str!("../objects.toml")));
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let scenes = fs::read_dir(golden).unwrap().map(|entry| entry.unwrap().path());
    let scenes = scenes.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let mut count = 0;
    for path in scenes {
        check(&parse(&fs::read_to_string(path).unwrap()));
        count += 1;
    }
    assert!(count > 30, "{count} goldens");
}

#[test]
fn what_nobody_said_is_not_written() {
    let file = SceneFile::of_model(Source::procedural("sphere").unwrap());
    let text = file.text(Path::new("sphere.toml")).unwrap();
    let model = "[[model]]\nshape = \"sphere\"\ncount = 200000\nseed = 0\n";
    assert_eq!(text, format!("{model}\n[method]\nname = \"ewa\"\n"));
}

#[test]
fn the_greatest_seed_is_written() {
    let mut file = SceneFile::of_model(Source::procedural("sphere").unwrap());
    let Source::Shape { seed, .. } = &mut file.models[0].source else { panic!("a shape") };
    *seed = u64::MAX;
    check(&file);
}

#[test]
fn paths_lead_from_the_file_to_the_same_place() {
    let model = |path: &str| {
        SceneFile::of_model(Source::File {
            path: path.into(),
            radius: None,
            prefix: None,
            texture: None,
            color_range: None,
            color_by: None,
        })
    };
    let first = |file: &SceneFile, to: &Path| {
        let text = file.text(to).unwrap();
        let again = SceneFile::parse(&text, to).unwrap();
        (text, again.reads().next().unwrap().to_owned())
    };
    let (text, within) = first(&model("a/b/bunny.ply"), Path::new("a/scene.toml"));
    assert!(text.contains("file = \"b/bunny.ply\""), "{text}");
    assert_eq!(within, Path::new("a/b/bunny.ply"));
    let (_, beside) = first(&model("a/bunny.ply"), Path::new("c/scene.toml"));
    assert_eq!(beside, std::path::absolute("a/bunny.ply").unwrap());
}

#[cfg(unix)]
#[test]
fn what_toml_cannot_say_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    let path = Path::new(std::ffi::OsStr::from_bytes(b"\xff.ply")).to_owned();
    let source = Source::File {
        path,
        radius: None,
        prefix: None,
        texture: None,
        color_range: None,
        color_by: None,
    };
    let error = SceneFile::of_model(source).text(Path::new("scene.toml")).unwrap_err().to_string();
    assert!(!error.contains('\n') && error.contains("TOML"), "{error}");
}

proptest! {
    #[test]
    fn numbers_come_back_with_their_bits(
        eye in prop::array::uniform3(-1e9_f64..1e9),
        angle in -180.0_f64..180.0,
        radius in 1e-30_f32..1e30,
        shininess in 0.0_f32..1e4,
        cutoff in 0.25_f32..4.0,
        epsilon in 0.0_f32..10.0,
        in_radii: bool,
        frame in 1_u32..100,
    ) {
        let mut file = parse("[[geometry]]\nname = \"one\"\nfile = \"one.ply\"\n[[object]]\nof = \"one\"\n");
        let Source::File { radius: own, .. } = &mut file.geometries[0].model.source else {
            panic!("a file")
        };
        *own = Some(radius);
        let turned = Similarity {
            rotation: crate::scene::transform::rotation(DVec3::new(1.0, 2.0, 3.0), angle),
            scale: f64::from(radius),
            translation: DVec3::from_array(eye),
        };
        let keys = vec![(0, turned), (frame, Similarity::IDENTITY)];
        file.objects[0].places = Places::One(crate::scene::Motion::new(keys).unwrap());
        file.geometries[0].model.transform = turned;
        let pose = Pose { eye: DVec3::from_array(eye), target: DVec3::splat(2e9), up: DVec3::Y };
        file.camera.motion = Some(CameraMotion::new(vec![(frame, pose)]).unwrap());
        file.material.shininess = shininess;
        file.frames = frame;
        let settings = &mut file.method.settings;
        settings.push("cutoff", crate::setting::Value::Number(cutoff));
        let epsilon = format!("{epsilon}{}", if in_radii { "r" } else { "" });
        settings.push("epsilon", crate::setting::Value::Text(epsilon));
        check(&file);
    }
}
