mod cameras;
mod draw;
mod objects;
mod textures;
mod written;

use super::*;
use crate::frame::{Exec, Frame, NamedPlane, Plane, Samples};
use crate::index::grouping::Extension;
use crate::io::exr::{self, Compression};
use crate::method::Method;
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::{transparent, transparent_hq};
use crate::scene::environment::{Environment, Map};
use crate::scene::{Camera, CameraMotion, Cloud, Lens, Pose, Scene, Sphere};
use crate::setting::Fields;
use crate::shade::optics::{BendingLayers, Refraction};
use crate::source::derive::Origin;
use crate::splat::{Epsilon, Kernel, Outline, SplatSettings};
use proptest::prelude::*;
use std::fs;

const EXAMPLE: &str = include_str!("example.toml");
const SHAPE: &str = "[[model]]\nshape = \"sphere\"\ncount = 100\n";

fn parse(text: &str) -> SceneFile {
    SceneFile::parse(text, Path::new("a/scene.toml")).unwrap()
}

/// The splats of a file whose method is `ewa`.
fn splats(file: &SceneFile) -> SplatSettings {
    let Method::Ewa(settings) = file.method.method().unwrap() else { panic!("another method") };
    settings
}

/// The one line of a bad file's refusal.
fn refused(text: &str) -> String {
    let error = SceneFile::parse(text, Path::new("a/scene.toml")).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

fn load(file: &SceneFile) -> Loaded {
    file.load(&Exec::sequential(), &|_, _, _| ()).unwrap()
}

#[test]
fn the_example_says_what_it_says() {
    let file = parse(EXAMPLE);
    assert_eq!(file.name, "scene");
    let [bunny, sheets] = file.models.as_slice() else { panic!("two models") };
    let path = Path::new("a").join("bunny.ply");
    assert_eq!(
        bunny.source,
        Source::File {
            path,
            radius: Some(0.002),
            prefix: Some(10_000),
            texture: None,
            color_range: None,
            color_by: None
        }
    );
    assert_eq!(bunny.color, Some(Vec3::new(0.75, 0.5, 0.25)));
    assert_eq!(bunny.draw, Draw::Surfels);
    assert_eq!((bunny.transform.scale, bunny.transform.translation), (10.0, -DVec3::Y));
    let shape = Shape::Sheets { gap: 0.25 };
    assert_eq!(sheets.source, Source::Shape { shape, count: 20_000, seed: 1 });
    assert_eq!(sheets.transform.rotation * DVec3::Y, DVec3::X, "the matrix is given by rows");
    let camera = CameraChoice {
        size: Some([640, 480]),
        eye: Some(DVec3::new(0.0, 1.0, 5.0)),
        target: Some(DVec3::ZERO),
        up: Some(DVec3::Y),
        lens: Some(Lens::FieldOfView(40.0)),
        ..CameraChoice::default()
    };
    assert_eq!(file.camera, camera);
    let lights = [
        Light::Headlight { towards: Vec3::new(-1.0, 1.0, 1.0), color: Vec3::ONE },
        Light::Directional { towards: Vec3::Y, color: Vec3::ONE },
        Light::Point { position: Vec3::splat(4.0), color: Vec3::ONE },
    ];
    assert_eq!(file.lights, lights);
    let map = Path::new("a").join("sky.exr");
    assert_eq!(file.environment, Some(EnvironmentChoice::File(map)));
    let kernel = Kernel { outline: Outline::Perspective, cutoff: 2.0, low_pass: 0.25 };
    let settings = SplatSettings { kernel, epsilon: Epsilon::MedianRadii(1.5), cull: false };
    let method = file.method.method().unwrap();
    let bins = BinCount::Count(256);
    let refraction = Refraction { ratio: [0.66, 0.67, 0.68], layers: BendingLayers::Multiple };
    let layers =
        transparent::Settings { splats: settings, bins, ..transparent::Settings::default() };
    let expected = transparent_hq::Settings {
        layers,
        nearest: DepthTest::Voronoi(bins),
        refraction: Some(refraction),
    };
    assert_eq!(method, Method::TransparentHq(expected));
    let grouping = file.grouping(&method).unwrap().unwrap();
    assert_eq!((grouping.rules.overlap, grouping.count), (1.0, Some(4)));
    assert_eq!(grouping.rules.coplanar.unwrap().cosine, 0.99);
    assert_eq!(grouping.extension, Extension::Add { most: 0.5 });
    assert_eq!(bunny.opacity, Some(0.5));
    assert_eq!((bunny.mipmaps, sheets.mipmaps), (None, Some(5)));
    let compression = Compression::Zip;
    let expected = OutputSettings { stages: true, compression, ..OutputSettings::default() };
    assert_eq!(file.output, expected);
}

#[test]
fn mipmaps_are_made_on_loading_dropped_or_kept() {
    let board = "[[model]]\nshape = \"checkerboard\"\ncount = 2000\n";
    let of = |text: &str| load(&parse(text)).scene.surfels;
    let plain = of(board);
    assert_eq!(plain.mipmap(), None);
    let made = of(&format!("{board}mipmaps = 3\n"));
    let exec = Exec::sequential();
    let expected = crate::index::mipmap::build(&plain, 3, &exec, &|_, _, _| ()).unwrap();
    assert_eq!(made.mipmap(), Some(&expected));
    // They stay with the surfels through a transform, and through writing and reading a file.
    let moved = of(&format!("{board}mipmaps = 3\n[model.transform]\nscale = 2\n"));
    assert_eq!(moved.mipmap(), Some(&expected));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.ply");
    crate::io::ply::write(&path, &made.into_cloud()).unwrap();
    let read = |more: &str| {
        let text = format!("[[model]]\nfile = \"board.ply\"\n{more}");
        load(&SceneFile::parse(&text, &folder.path().join("a.toml")).unwrap()).scene.surfels
    };
    assert_eq!(read("").mipmap(), Some(&expected));
    assert_eq!(read("mipmaps = 0").mipmap(), None);
    assert_eq!(read("mipmaps = 2").mipmap().unwrap().of_surfel(7), &expected.of_surfel(7)[..2]);
    assert_eq!(read("color = [1, 0, 0]").mipmap(), None, "one colour for all");
    // Geometries of objects have them too.
    let object = format!(
        "{}name = \"a\"\nmipmaps = 3\n[[object]]\nof = \"a\"\n",
        board.replace("model", "geometry")
    );
    let objects = load(&parse(&object)).scene.objects.unwrap();
    assert_eq!(objects.geometries()[0].surfels.mipmap(), Some(&expected));
}

#[test]
fn mipmaps_of_what_has_none_are_refused() {
    let sphere = |more: &str| parse(&format!("[[model]]\nshape = \"sphere\"\n{more}"));
    let error =
        |file: &SceneFile| file.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string();
    let one = "sphere: a model in one colour has the same at every level; remove the mipmaps";
    assert_eq!(error(&sphere("color = [1, 1, 1]\nmipmaps = 2")), one);
    let tree = parse("[[model]]\nshape = \"tree\"\nmipmaps = 2");
    assert!(error(&tree).contains("has no surfels; remove the mipmaps"), "{}", error(&tree));
    let line = refused("[[model]]\nshape = \"sphere\"\nmipmaps = 17");
    assert!(line.contains("mipmaps of 17 levels; give 0 to 16"), "{line}");
    assert!(refused("[[model]]\nshape = \"sphere\"\nmipmaps = -1").contains("line 3"));
    let folder = tempfile::tempdir().unwrap();
    let points = Cloud {
        position: vec![Vec3::ZERO],
        normal: Some(vec![Vec3::Z]),
        radius: Some(vec![1.0]),
        ..Cloud::default()
    };
    crate::io::ply::write(&folder.path().join("a.ply"), &points).unwrap();
    let text = "[[model]]\nfile = \"a.ply\"\nmipmaps = 1";
    let file = SceneFile::parse(text, &folder.path().join("a.toml")).unwrap();
    let expected = "a.ply: mipmaps need colours, but the points have none; remove the mipmaps";
    assert!(error(&file).ends_with(expected), "{}", error(&file));
}

#[test]
fn what_is_absent_has_its_default() {
    let file = parse("[[model]]\nshape = \"staircase\"\n");
    let source = Source::Shape { shape: Shape::ALL[4], count: DEFAULT_COUNT, seed: 0 };
    assert_eq!(file, SceneFile { name: "scene".into(), ..SceneFile::of_model(source) });
    assert_eq!(splats(&file), SplatSettings::default());
    assert_eq!(parse(&format!("light = []\n{SHAPE}")).lights, []);
}

/// Every array, with one value too many and with one too few.
#[test]
fn arrays_have_as_many_values_as_they_must() {
    let model = "[[model]]\nshape = \"torus\"\n";
    let tree = "[[model]]\nshape = \"tree\"\ndraw = \"polygons\"\n";
    for (text, count) in [
        (format!("{model}color = VALUES\n"), 3),
        (format!("{tree}color = VALUES\n"), 3),
        (format!("{model}draw = \"hybrid\"\nsplit = VALUES\n"), 4),
        (format!("{model}[model.transform]\ntranslate = VALUES\n"), 3),
        (format!("{model}[model.transform.rotate]\naxis = VALUES\ndegrees = 1\n"), 3),
        (format!("{model}[model.transform.rotate]\nmatrix = [[1, 0, 0], [0, 1, 0], VALUES]\n"), 3),
        (format!("{model}[camera]\nsize = VALUES\n"), 2),
        (format!("{model}[camera]\neye = VALUES\n"), 3),
        (format!("{model}[camera]\ntarget = VALUES\n"), 3),
        (format!("{model}[camera]\nup = VALUES\n"), 3),
        (format!("{model}[[light]]\nkind = \"point\"\nposition = VALUES\n"), 3),
        (format!("{model}[[light]]\nkind = \"headlight\"\ntowards = VALUES\n"), 3),
        (
            format!(
                "{model}[[light]]\nkind = \"directional\"\ntowards = [0, 0, 1]\ncolor = VALUES\n"
            ),
            3,
        ),
        (format!("{model}[material]\ncolor = VALUES\n"), 3),
        (format!("{model}[method]\nname = \"transparent-hq\"\nrefraction = VALUES\n"), 3),
    ] {
        for found in [count - 1, count + 1] {
            let values = format!("[{}]", vec!["1"; found].join(", "));
            let error = refused(&text.replace("VALUES", &values));
            let says = error.contains("length") || error.contains("numbers");
            assert!(says && !error.contains('\n'), "{values} of {text}: {error}");
        }
    }
    // A matrix of four rows.
    let rows = "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]";
    let error = refused(&format!("{model}[model.transform.rotate]\nmatrix = {rows}\n"));
    assert!(error.contains("length 4"), "{error}");
}

#[test]
fn errors_name_the_file_the_line_and_the_key() {
    for (text, line, what) in [
        ("", None, "no [[model]]"),
        ("[[model]\n", Some(1), ""),
        ("[[model]]\nshap = \"torus\"\n", Some(2), "shap"),
        ("\n[[model]]\nshape = \"ball\"\n", Some(2), "`ball`; give one of sphere, torus"),
        (
            "[[model]]\nshape = \"torus\"\nfile = \"a.ply\"\n",
            Some(1),
            "either a `file` or a `shape`",
        ),
        ("[[model]]\nshape = \"torus\"\ngap = 1\n", Some(1), "`gap` does not apply to torus"),
        ("[[model]]\nfile = \"a.ply\"\ncount = 1\n", Some(1), "`count` does not apply to a file"),
        ("[[model]]\nfile = \"a.ply\"\ncolor = [1, 2]\n", Some(3), "length"),
        ("[[model]]\nfile = \"a.ply\"\ncolor = [1, 2, -1]\n", Some(1), "color"),
        ("[[model]]\nshape = \"torus\"\ncount = -1\n", Some(3), "-1"),
    ] {
        let found = refused(text);
        assert!(found.starts_with("a/scene.toml: ") && found.contains(what), "{found}");
        if let Some(line) = line {
            assert!(found.contains(&format!(" line {line}: ")), "{found}");
        }
    }
    for (table, what) in [
        ("[camera]\nfov = 30\northo = 2\n", "one of fov, focal and ortho"),
        ("[camera]\nsize = [0.5, 1]\n", "0.5"),
        ("[camera]\nsize = [-1, 1]\n", "-1"),
        ("[[light]]\nkind = \"lamp\"\n", "lamp"),
        ("[[light]]\nkind = \"point\"\ntowards = [0, 0, 1]\n", "towards"),
        ("[[light]]\nkind = \"headlight\"\ntowards = [0, 0, 0]\n", "towards"),
        ("[material]\ndiffuse = 2\n", "diffuse 2"),
        ("[environment]\n", "either a `file` or `sky = true`"),
        ("[environment]\nsky = false\n", "either a `file` or `sky = true`"),
        ("[environment]\nsky = true\nfile = \"a.exr\"\n", "either a `file` or `sky = true`"),
        ("[environment]\nmap = \"a.exr\"\n", "map"),
        ("[method]\nname = \"magic\"\n", "magic"),
        ("[method]\noutline = \"round\"\n", "affine, perspective, raycast"),
        ("[method]\nepsilon = \"1.5 radii\"\n", "1.5 radii"),
        ("[method]\nepsilon = -1\n", "epsilon: -1"),
        ("[method]\nepsilon = nan\n", "epsilon"),
        ("[method]\ncutoff = 9\n", "cut-off of 9"),
        ("[output]\nnumber = \"f16\"\n", "f32, f64"),
        ("[ouput]\nstages = true\n", "ouput"),
    ] {
        let found = refused(&format!("{SHAPE}{table}"));
        assert!(found.contains(what) && found.contains("line "), "{table}: {found}");
    }
    for transform in [
        "scale = 0",
        "rotate = { axis = [0, 0, 0], degrees = 3 }",
        "rotate = { degrees = 3 }",
        "rotate = { matrix = [[-1, 0, 0], [0, 1, 0], [0, 0, 1]] }",
        "shear = 1",
    ] {
        let found = refused(&format!("{SHAPE}[model.transform]\n{transform}\n"));
        assert!(found.contains("line "), "{transform}: {found}");
    }
}

#[test]
fn epsilon_is_a_number_or_radii() {
    let epsilon =
        |text: &str| splats(&parse(&format!("{SHAPE}[method]\nepsilon = {text}\n"))).epsilon;
    assert_eq!(epsilon("0.25"), Epsilon::World(0.25));
    assert_eq!(epsilon("2"), Epsilon::World(2.0));
    assert_eq!(epsilon("inf"), Epsilon::World(f32::INFINITY));
    assert_eq!(epsilon("\"0.5r\""), Epsilon::MedianRadii(0.5));
    assert_eq!(epsilon("\"inf\""), Epsilon::World(f32::INFINITY));
}

proptest! {
    #[test]
    fn numbers_come_back_with_their_bits(bits: [u32; 3], camera: [f64; 3]) {
        let numbers = bits.map(f32::from_bits);
        prop_assume!(numbers.iter().all(|v| v.is_finite()));
        let position = format!("[[light]]\nkind = \"point\"\nposition = {numbers:?}\n");
        let eye = format!("[camera]\neye = {camera:?}\n");
        let file = parse(&format!("{SHAPE}{position}{eye}"));
        let Light::Point { position, .. } = file.lights[0] else { unreachable!() };
        prop_assert_eq!(position.to_array().map(f32::to_bits), bits);
        let eye = file.camera.eye.unwrap();
        prop_assert_eq!(eye.to_array().map(f64::to_bits), camera.map(f64::to_bits));
        for epsilon in [Epsilon::World(numbers[0]), Epsilon::MedianRadii(numbers[1])] {
            let given = SplatSettings { epsilon, ..SplatSettings::default() };
            let (_, value) = given.values().into_iter().find(|(name, _)| *name == "epsilon").unwrap();
            let mut read = SplatSettings::default();
            prop_assert_eq!(read.set("epsilon", &value), Ok(()));
            prop_assert_eq!(read, given);
        }
    }
}

#[test]
fn models_are_joined_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                  property float z\nend_header\n";
    fs::write(folder.path().join("a.ply"), format!("{header}0 0 0\n1 0 0\nnan 0 0\n0 1 0\n"))
        .unwrap();
    let path = folder.path().join("scene.toml");
    let text = "[[model]]\nshape = \"sphere\"\ncount = 50\n\
                [[model]]\nfile = \"a.ply\"\n[model.transform]\nscale = 2\ntranslate = [10, 0, 0]\n\
                [material]\ncolor = [0.5, 0.25, 0.125]\n";
    fs::write(&path, text).unwrap();
    let file = SceneFile::read(&path).unwrap();
    let loaded = load(&file);
    let surfels = &loaded.scene.surfels;
    assert_eq!(loaded.scene.name, "scene");
    assert_eq!(surfels.len(), 53);
    let placed = [Vec3::new(10.0, 0.0, 0.0), Vec3::new(12.0, 0.0, 0.0), Vec3::new(10.0, 2.0, 0.0)];
    assert_eq!(surfels.position()[50..], placed);
    assert_eq!(surfels.color().unwrap()[50..], [Vec3::new(0.5, 0.25, 0.125); 3]);
    assert_eq!(loaded.dropped.position, 1);
    let derived = loaded.models[1].derived.unwrap();
    assert_eq!((derived.normals, derived.radii), (Origin::Neighbours, Origin::Neighbours));
    // The radii that the file alone would derive, twice as large.
    assert!(surfels.radius()[50..].iter().all(|&r| r > 1.9 && r < 3.0), "{:?}", surfels.radius());
}

#[test]
fn an_environment_is_the_sky_or_a_file() {
    let file = |text: &str| parse(&format!("{SHAPE}{text}"));
    assert_eq!(load(&file("")).scene.environment, None);
    let sky = file("[environment]\nsky = true\n");
    assert_eq!(load(&sky).scene.environment, Some(Environment::Sky));
    assert_eq!(EnvironmentChoice::from_text("sky"), EnvironmentChoice::Sky);
    assert_eq!(
        EnvironmentChoice::from_text("b/sky.exr"),
        EnvironmentChoice::File("b/sky.exr".into())
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, format!("{SHAPE}[environment]\nfile = \"a.exr\"\n")).unwrap();
    let named = SceneFile::read(&path).unwrap();
    let error = named.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string();
    let map = folder.path().join("a.exr");
    assert!(error.starts_with(&map.display().to_string()) && !error.contains('\n'), "{error}");

    let pixels = Plane::from_values(2, 1, vec![[1.0_f32, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let plane = NamedPlane { name: String::new(), samples: Samples::Color(pixels.clone()) };
    exr::write(&map, &Frame { width: 2, height: 1, planes: vec![plane] }, "").unwrap();
    let pixels = Map::new(pixels).unwrap();
    assert_eq!(load(&named).scene.environment, Some(Environment::Map(pixels)));
}

#[test]
fn one_model_alone_is_as_its_source_made_it() {
    let shape = Shape::by_name("torus").unwrap();
    let file = SceneFile::of_model(Source::Shape { shape, count: 500, seed: 3 });
    assert_eq!(load(&file).scene.surfels, shape.surfels(500, 3).unwrap());
}

#[test]
fn errors_of_models_name_their_file() {
    let missing = SceneFile::of_model(Source::File {
        path: "no/such.ply".into(),
        radius: None,
        prefix: None,
        texture: None,
        color_range: None,
        color_by: None,
    });
    let error = missing.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err();
    assert!(error.to_string().starts_with("no/such.ply: "), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.ply");
    fs::write(
        &path,
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n\
        property float y\nproperty float z\nend_header\n0 0 0\n",
    )
    .unwrap();
    let lone = SceneFile::of_model(Source::File {
        path: path.clone(),
        radius: None,
        prefix: None,
        texture: None,
        color_range: None,
        color_by: None,
    });
    let error = lone.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err();
    assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
}

#[test]
fn what_the_camera_leaves_open_shows_the_scene() {
    let shape = Shape::Sphere;
    let mut file = SceneFile::of_model(Source::Shape { shape, count: 400, seed: 0 });
    file.camera.size = Some([40, 30]);
    let scene = load(&file).scene;
    let own = Camera::new(40, 30, shape.default_pose(), shape.default_lens()).unwrap();
    assert_eq!(file.camera(&scene).unwrap(), own, "a shape has a pose of its own");

    // A transformed shape is framed like any other model.
    file.models[0].transform.translation = DVec3::new(100.0, 0.0, 0.0);
    let scene = load(&file).scene;
    let Sphere { center: middle, radius } = scene.surfels.bounding_sphere();
    let lens = Lens::FieldOfView(DEFAULT_FIELD_OF_VIEW);
    let framed =
        Camera::framing(40, 30, Sphere { center: middle, radius }, DEFAULT_SIDE, lens).unwrap();
    assert_eq!(file.camera(&scene).unwrap(), framed);

    // The rest follows from the choices: the middle of the picture is the target.
    let looks_at = |camera: &Camera, target: DVec3| {
        let p = camera.view_from_world.as_dmat4().transform_point3(target);
        assert!(p.x.abs() < 1e-4 && p.y.abs() < 1e-4 && p.z < 0.0, "{p}");
    };
    let eye = DVec3::new(100.0, 9.0, 3.0);
    file.camera.eye = Some(eye);
    let camera = file.camera(&scene).unwrap();
    looks_at(&camera, middle);
    assert!((camera.eye() - eye).length() < 1e-4);
    file.camera.eye = None;
    file.camera.target = Some(DVec3::new(100.5, 0.0, 0.0));
    looks_at(&file.camera(&scene).unwrap(), DVec3::new(100.5, 0.0, 0.0));
    file.camera.up = Some(DVec3::X);
    let camera = file.camera(&scene).unwrap();
    looks_at(&camera, DVec3::new(100.5, 0.0, 0.0));
    let right = camera.view_from_world.row(0).truncate();
    assert!(right.x.abs() < 1e-6, "up is x, so right is not: {right}");
}

#[test]
fn a_preset_can_be_changed_in_part() {
    let settings = parse(&format!("{SHAPE}[method]\nkernel = \"zpvbg01\"\nlow_pass = 0\n"));
    let kernel = splats(&settings).kernel;
    assert_eq!(kernel, Kernel { low_pass: 0.0, ..Kernel::ZPVBG01 });
}

#[test]
fn settings_are_of_their_method_and_of_their_type() {
    for (table, line, what) in [
        ("[method]\ncutof = 2\n", 5, "unknown key `cutof`; the keys are name, kernel, preset"),
        ("[method]\npeel = 3\n", 4, "`peel` does not apply to the method ewa"),
        ("[method]\nname = \"template\"\ncutoff = 2\n", 4, "`cutoff` does not apply to the method"),
        ("[method]\ncutoff = \"2\"\n", 5, "cutoff `2`; give a number"),
        ("[method]\ncull = \"on\"\n", 5, "cull `on`; give true or false"),
        ("[method]\n\nbins = -1\n", 6, "bins `-1`; give a whole number"),
        ("[method]\nname = \"transparent-hq\"\nrefraction = [1, 2]\n", 6, "give three numbers"),
        ("[method]\nname = \"transparent-hq\"\nbends = \"single\"\n", 4, "without a `refraction`"),
        ("[method]\nname = \"single-pass\"\ndepth = \"plain\"\nbins = 3\n", 4, "without depth"),
        ("[groups]\nmost = 0.5\nextend = \"none\"\n", 4, "`most` has no effect unless"),
        ("[groups]\ncoplanar = { cosine = 1, offset = 0 }\n", 5, "cosine, offset and color"),
        ("[groups]\noverlap = 2\n", 4, "c = 2; give 0 to 1"),
        ("[output]\nstages = 1\n", 5, "stages `1`; give true or false"),
    ] {
        let found = refused(&format!("{SHAPE}{table}"));
        let place = format!(" line {line}: ");
        assert!(found.contains(what) && found.contains(&place), "{table}: {found}");
    }
}

#[test]
fn another_method_keeps_what_means_something_to_it() {
    let mut choice = parse(&format!(
        "{SHAPE}[method]\nname = \"transparent-hq\"\nbins = 9\ndepth = \"plain\"\ncull = true\n\
         refraction = [0.5, 0.5, 0.5]\n"
    ))
    .method;
    choice.replace("single-pass").unwrap();
    let Method::SinglePass(settings) = choice.method().unwrap() else { panic!("single-pass") };
    assert_eq!((settings.depth, settings.splats.cull), (DepthTest::Plain, true));
    choice.replace("pyramid").unwrap();
    assert!(choice.method().is_ok() && choice.settings.has("cull") && !choice.settings.has("bins"));
}

#[test]
fn a_count_of_groups_and_an_overlap_do_without_each_other() {
    let grouping = |groups: &str, method: &str| {
        let method = Method::by_name(method).unwrap();
        let found = parse(&format!("{SHAPE}[groups]\n{groups}")).grouping(&method).unwrap();
        found.map(|found| (found.rules.overlap, found.count))
    };
    assert_eq!(grouping("count = 3\n", "single-pass"), Some((1.0, Some(3))));
    assert_eq!(grouping("overlap = 0.5\n", "transparent"), Some((0.5, None)));
    assert_eq!(grouping("overlap = 0.5\ncount = 3\n", "transparent"), Some((0.5, Some(3))));
    assert_eq!(grouping("extend = \"none\"\n", "transparent"), Some((1.0, Some(4))));
    assert_eq!(grouping("extend = \"none\"\n", "single-pass"), Some((0.4, None)));
    assert_eq!(grouping("", "transparent"), None);
    assert_eq!(grouping("count = 3\n", "ewa"), None, "the method draws no groups");
}

#[test]
fn a_scene_is_opened_by_its_name() {
    for name in ["sphere", "tree", "b/bunny.ply"] {
        let file = SceneFile::open(name).unwrap();
        assert_eq!(file.name, name.trim_start_matches("b/").trim_end_matches(".ply"));
    }
    for name in ["ball", "a.exr", "a.txt"] {
        assert_eq!(SceneFile::open(name).unwrap_err().exit_code(), 2);
    }
    assert_eq!(SceneFile::open("missing.toml").unwrap_err().exit_code(), 1);
}

#[test]
fn an_obj_is_drawn_as_the_ply_of_the_same_mesh() {
    let at = tempfile::TempDir::new().unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let load = |name: &str, text: String| {
        let path = at.path().join(name);
        fs::write(&path, text).unwrap();
        let file = SceneFile::open(&path).unwrap();
        file.load(&Exec::sequential(), &|_, _, _| ()).unwrap().scene.surfels
    };
    let ply = load("a.ply", format!("{header}0 0 0\n1 0 0\n0 2 0.5\n3 0 1 2\n"));
    let obj = load("a.OBJ", "v 0 0 0\nv 1 0 0\nv 0 2 0.5\nf 1 2 3\n".into());
    assert_eq!((obj.len(), obj), (1, ply));
}
