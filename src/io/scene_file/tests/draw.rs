//! Check models drawn as polygons, ribbons, tubes or hybrids.

use super::*;
use crate::scene::{Counts, Primitives, Sphere, Surfels};
use crate::source::plant;

/// A pyramid of four triangles without a bottom, whose apex is up, and two edges. Vertices have
/// these further `properties` and `values`.
fn ply(properties: &[&str], values: &str) -> String {
    let properties: String = properties.iter().map(|p| format!("property float {p}\n")).collect();
    let corner = ["-1 0 -1", "1 0 -1", "1 0 1", "-1 0 1", "0 3 0"];
    let corners: String = corner.iter().map(|corner| format!("{corner} {values}\n")).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
         property float z\n{properties}element face 4\nproperty list uchar int vertex_indices\n\
         element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n\
         {corners}3 1 0 4\n3 2 1 4\n3 3 2 4\n3 0 3 4\n0 1\n1 4\n"
    )
}

/// A scene of this text beside `a.ply`.
fn scene(ply: &str, text: &str) -> (tempfile::TempDir, SceneFile) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.ply"), ply).unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    let file = SceneFile::read(&path).unwrap();
    (folder, file)
}

fn loaded(ply: &str, text: &str) -> Loaded {
    let (_folder, file) = scene(ply, text);
    load(&file)
}

/// The line that refuses a scene when it is loaded.
fn not_loaded(ply: &str, text: &str) -> String {
    let (_folder, file) = scene(ply, text);
    let error = file.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

fn model(more: &str) -> String {
    format!("[[model]]\nfile = \"a.ply\"\n{more}")
}

fn counts(triangles: usize, ribbons: usize, tubes: usize) -> Counts {
    Counts { triangles, ribbons, tubes }
}

#[test]
fn the_words_of_draw() {
    let draw = |more: &str| parse(&model(more)).models[0].draw;
    assert_eq!((draw(""), draw("draw = \"points\"\n")), (Draw::Surfels, Draw::Points));
    for (word, expected) in [
        ("facets", Draw::Facets),
        ("polygons", Draw::Polygons),
        ("ribbons", Draw::Ribbons),
        ("tubes", Draw::Tubes),
    ] {
        let found = draw(&format!("draw = \"{word}\"\n"));
        assert_eq!((found, found.word()), (expected, word));
    }
    let Draw::Hybrid(half) = draw("draw = \"hybrid\"\nsplit = [0, 1, 0, 0.5]\n") else { panic!() };
    assert!(half.contains(Vec3::Y / 2.0) && !half.contains(Vec3::X));
    parse("[[model]]\nshape = \"sphere\"\ndraw = \"points\"\n");
}

#[test]
fn keys_that_do_not_go_together_are_refused() {
    for (more, what) in [
        (
            "draw = \"lines\"\n",
            "a is drawn as surfels, points, facets, polygons, hybrid, ribbons or tubes, not as lines",
        ),
        (
            "draw = \"dots\"\n",
            "draw `dots`; give one of surfels, points, facets, polygons, hybrid, ribbons, tubes, lines",
        ),
        ("draw = \"hybrid\"\n", "a hybrid needs split = [a, b, c, d]"),
        ("split = [0, 1, 0, 0]\n", "`split` has no effect without draw = \"hybrid\""),
        ("draw = \"tubes\"\nsplit = [0, 1, 0, 0]\n", "`split` has no effect without"),
        ("draw = \"hybrid\"\nsplit = [0, 0, 0, 1]\n", "a half space of 0, 0, 0, 1; give finite"),
        ("draw = \"hybrid\"\nsplit = [0, nan, 0, 1]\n", "a half space of 0, NaN, 0, 1"),
        ("draw = \"hybrid\"\nsplit = [0, 1, 0]\n", "length"),
        ("draw = \"polygons\"\nradius = 1\n", "`radius` does not apply to polygons: remove it"),
        ("draw = \"facets\"\nradius = 1\n", "`radius` does not apply to facets: remove it"),
    ] {
        let found = refused(&model(more));
        assert!(found.contains(what) && found.contains("line "), "{found}");
    }
    let found = refused("[[model]]\nshape = \"torus\"\ndraw = \"polygons\"\n");
    assert!(found.contains("torus is drawn as points, not as polygons"), "{found}");
}

#[test]
fn polygons_are_placed_and_coloured() {
    let text = model(
        "draw = \"polygons\"\ncolor = [1, 0.5, 0]\n[model.transform]\nscale = 2\n\
         translate = [0, 10, 0]\nrotate = { axis = [0, 1, 0], degrees = 90 }\n",
    );
    let Loaded { scene, models, .. } =
        loaded(&ply(&["nx", "ny", "nz", "radius"], "4 0 0 7"), &text);
    assert!(scene.surfels.is_empty());
    assert_eq!(
        (scene.primitives.counts(), models[0].primitives),
        (counts(4, 0, 0), counts(4, 0, 0))
    );
    let triangles = &scene.primitives.triangles;
    assert_eq!(triangles.corners()[0], [1, 0, 4]);
    let vertices = triangles.vertices();
    assert_eq!(vertices.position[4], Vec3::new(0.0, 16.0, 0.0));
    assert!(vertices.direction[4].distance(-Vec3::Z) < 1e-6, "{}", vertices.direction[4]);
    assert_eq!((vertices.radius[4], models[0].derived.unwrap().normals), (0.0, Origin::File));
    assert_eq!(vertices.color, Some(vec![Vec3::new(1.0, 0.5, 0.0); 5]));
    // The rotation takes the corners onto each other, so the box keeps its width.
    assert_eq!(scene.bounds(), (Vec3::new(-2.0, 10.0, -2.0), Vec3::new(2.0, 16.0, 2.0)));
}

#[test]
fn lines_take_their_radii_from_the_file_or_the_scene() {
    let normals = ["nx", "ny", "nz"];
    let text = model("draw = \"ribbons\"\nradius = 0.5\n[model.transform]\nscale = 3\n");
    let Loaded { scene, models, .. } = loaded(&ply(&normals, "0 0 2"), &text);
    let ribbons = &scene.primitives.ribbons;
    assert_eq!((ribbons.corners(), scene.primitives.len()), ([[0, 1], [1, 4]].as_slice(), 2));
    assert_eq!((ribbons.vertices().radius[0], ribbons.vertices().direction[0]), (1.5, Vec3::Z));
    assert_eq!(models[0].derived.unwrap().radii, Origin::Given);

    let text = model("draw = \"tubes\"\nradius = 0.5\n");
    let Loaded { scene, models, .. } =
        loaded(&ply(&["radius", "tx", "ty", "tz"], "2 0 3 0"), &text);
    let tubes = scene.primitives.tubes.vertices();
    assert_eq!((tubes.radius[1], tubes.direction[1]), (2.0, Vec3::Y));
    let derived = models[0].derived.unwrap();
    assert_eq!((derived.normals, derived.radii), (Origin::File, Origin::File));
    let Loaded { scene, models, .. } = loaded(&ply(&["radius"], "2"), &text);
    assert_eq!(scene.primitives.tubes.vertices().direction[0], Vec3::X);
    assert_eq!(models[0].derived.unwrap().normals, Origin::Edges);
}

#[test]
fn hybrids_are_split_before_they_are_moved() {
    let text = model("draw = \"hybrid\"\nsplit = [1, 0, 0, 0]\n[model.transform]\nscale = 2\n");
    let Loaded { scene, models, .. } = loaded(&ply(&[], ""), &text);
    // One of the four triangles lies in x >= 0: its three corners are the boundary.
    assert_eq!((scene.surfels.len(), scene.primitives.counts()), (5, counts(1, 0, 0)));
    assert_eq!((models[0].surfels, models[0].primitives), (5, counts(1, 0, 0)));
    let vertices = scene.primitives.triangles.vertices();
    let radii = |of: &[usize]| of.iter().map(|&i| scene.surfels.radius()[i]).collect::<Vec<_>>();
    assert_eq!(vertices.radius, radii(&[1, 2, 4]), "those of the surfels, both times scaled");
    assert!(vertices.radius[0] > 6.0, "twice the longest edge: {}", vertices.radius[0]);
    let all = loaded(&ply(&[], ""), &model("draw = \"hybrid\"\nsplit = [0, 1, 0, -1]\n")).scene;
    assert_eq!((all.surfels, all.primitives.len()), (Surfels::none(), 4));
}

#[test]
fn models_of_all_kinds_are_joined() {
    let all = model("draw = \"polygons\"\n")
        + &model("draw = \"tubes\"\nradius = 1\n[model.transform]\ntranslate = [5, 0, 0]\n")
        + SHAPE
        + &model("draw = \"polygons\"\ncolor = [1, 0, 0]\n")
        + &model("draw = \"points\"\n")
        + "[material]\ncolor = [0, 0, 1]\n";
    let Loaded { scene, models, dropped, dropped_primitives, .. } = loaded(&ply(&[], ""), &all);
    assert_eq!((scene.surfels.len(), scene.primitives.counts()), (105, counts(8, 0, 2)));
    let each: Vec<_> = models.iter().map(|model| (model.surfels, model.primitives)).collect();
    let none = counts(0, 0, 0);
    let (mesh, line) = ((0, counts(4, 0, 0)), (0, counts(0, 0, 2)));
    assert_eq!(each, [mesh, line, (100, none), mesh, (5, none)]);
    assert_eq!((dropped.total(), dropped_primitives), (0, 0));
    let triangles = &scene.primitives.triangles;
    assert_eq!(triangles.corners()[4..], [[6, 5, 9], [7, 6, 9], [8, 7, 9], [5, 8, 9]]);
    let color = triangles.vertices().color.as_ref().unwrap();
    assert_eq!((color[0], color[5]), (Vec3::Z, Vec3::X), "what is missing is the material's");
    assert!(scene.primitives.tubes.vertices().color.is_none());
}

#[test]
fn what_is_dropped_is_counted() {
    let file =
        ply(&["radius"], "2").replace("-1 0 -1 2", "nan 0 -1 2").replace("1 0 1 2", "1 0 1 -2");
    let tubes = loaded(&file, &model("draw = \"tubes\"\n"));
    assert_eq!((tubes.scene.primitives.len(), tubes.dropped_primitives), (1, 1));
    assert_eq!(tubes.dropped.total(), 0, "no surfel was wanted");
    let far = "draw = \"polygons\"\n[model.transform]\nscale = 1e38\n";
    let lost = loaded(&ply(&[], ""), &(model(far) + SHAPE));
    assert_eq!((lost.scene.primitives.len(), lost.dropped_primitives), (4, 0));
    let farther = far.replace("1e38", "2e38");
    let lost = loaded(&ply(&[], ""), &(model(&farther) + SHAPE));
    assert_eq!((lost.scene.primitives, lost.dropped_primitives), (Primitives::default(), 4));
    let nothing = not_loaded(&ply(&[], ""), &model(&farther));
    assert!(nothing.contains("the scene is empty"), "{nothing}");
}

#[test]
fn what_a_file_lacks_is_one_line_with_its_name() {
    let bare = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    for (more, what) in [
        ("draw = \"polygons\"\n", "there are no triangles to draw"),
        ("draw = \"hybrid\"\nsplit = [1, 0, 0, 0]\n", "there are no triangles to draw"),
        ("draw = \"ribbons\"\n", "there are no edges to draw as ribbons"),
        ("draw = \"tubes\"\n", "there are no edges to draw as tubes"),
    ] {
        let found = not_loaded(bare, &model(more));
        assert!(found.contains("a.ply: ") && found.contains(what), "{found}");
    }
    let found = not_loaded(&ply(&["radius"], "1"), &model("draw = \"ribbons\"\n"));
    assert!(found.contains("a.ply: ribbons need normals; give nx, ny and nz"), "{found}");
    let found = not_loaded(&ply(&[], ""), &model("draw = \"tubes\"\n"));
    assert!(found.contains("a.ply: tubes need radii; give the property radius"), "{found}");
    let found = not_loaded(&ply(&[], ""), &model("draw = \"polygons\"\nopacity = 0.5\n"));
    assert!(
        found.contains("a: a model drawn as polygons is opaque; remove the opacity"),
        "{found}"
    );
}

#[test]
fn the_camera_frames_primitives_too() {
    let text = model("draw = \"polygons\"\n") + "[camera]\nsize = [40, 30]\n";
    let (_folder, mut file) = scene(&ply(&[], ""), &text);
    let alone = load(&file).scene;
    let radius = (1.0 + 1.5 * 1.5 + 1.0_f64).sqrt();
    let sphere = Sphere { center: DVec3::new(0.0, 1.5, 0.0), radius };
    assert_eq!(alone.bounding_sphere(), sphere);
    let lens = Lens::FieldOfView(DEFAULT_FIELD_OF_VIEW);
    let framed = Camera::framing(40, 30, sphere, DEFAULT_SIDE, lens).unwrap();
    assert_eq!(file.camera(&alone).unwrap(), framed);
    // With two models the shape's pose is not used.
    file.models.push(parse(SHAPE).models[0].clone());
    let both = load(&file).scene;
    let low = both.surfels.bounds().0.min(Vec3::new(-1.0, 0.0, -1.0));
    assert_eq!(both.bounds(), (low, Vec3::new(1.0, 3.0, 1.0)));
    assert_ne!(file.camera(&both).unwrap(), framed);
}

#[test]
fn a_tree_is_a_shape_of_leaves() {
    let tree = |more: &str| parse(&format!("[[model]]\nshape = \"tree\"\n{more}"));
    let source = Source::Tree { leaves: 50_124, seed: 0 };
    assert_eq!(tree(""), SceneFile { name: "scene".into(), ..SceneFile::of_model(source) });
    let few = tree("leaves = 30\nseed = 2\n");
    assert_eq!(few.models[0].source, Source::Tree { leaves: 30, seed: 2 });
    assert_eq!(few.models[0].draw, Draw::Lines);
    assert_eq!(tree("draw = \"lines\"\n").models[0].draw, Draw::Lines);
    let polygons = tree("leaves = 30\nseed = 2\ndraw = \"polygons\"\n");

    let plant = plant::apple_tree(30, 2).unwrap();
    for (file, primitives) in [(few, plant.lines().unwrap()), (polygons, plant.polygons().unwrap())]
    {
        let Loaded { scene, models, dropped_primitives, .. } = load(&file);
        assert_eq!((&scene.primitives, scene.surfels.len()), (&primitives, 0));
        let report = ModelReport {
            name: "tree".into(),
            surfels: 0,
            primitives: primitives.counts(),
            derived: None,
            colored: None,
        };
        assert_eq!((models, dropped_primitives), (vec![report], 0));
    }
    let red = load(&tree("leaves = 30\nseed = 2\ncolor = [1, 0, 0]\ntransform = { scale = 2 }\n"));
    let (found, own) = (red.scene.primitives.tubes, plant.lines().unwrap().tubes);
    let pairs = found.vertices().position.iter().zip(&own.vertices().position);
    pairs.for_each(|(found, own)| assert_eq!(*found, 2.0 * *own));
    let n = own.vertices().position.len();
    assert_eq!(found.vertices().color, Some(vec![Vec3::X; n]));
}

#[test]
fn what_is_not_of_a_tree_is_refused() {
    let tree = |more: &str| format!("[[model]]\nshape = \"tree\"\n{more}");
    for (more, what) in [
        ("count = 3\n", "`count` does not apply to tree: remove it"),
        ("radius = 3\n", "`radius` does not apply to tree: remove it"),
        ("gap = 3\n", "`gap` does not apply to tree: remove it"),
        ("leaves = -3\n", "-3"),
        ("draw = \"points\"\n", "tree is drawn as lines or polygons, not as points"),
        ("draw = \"tubes\"\n", "tree is drawn as lines or polygons, not as tubes"),
        ("split = [0, 1, 0, 0]\n", "`split` has no effect without"),
    ] {
        let found = refused(&tree(more));
        assert!(found.contains(what) && found.contains("line "), "{found}");
    }
    let found = refused("[[model]]\nshape = \"torus\"\nleaves = 3\n");
    assert!(found.contains("`leaves` does not apply to torus: remove it"), "{found}");
    let found = refused("[[model]]\nshape = \"torus\"\ndraw = \"lines\"\n");
    assert!(found.contains("torus is drawn as points, not as lines"), "{found}");
    let found = refused(&model("leaves = 3\n"));
    assert!(found.contains("`leaves` does not apply to a file: remove it"), "{found}");
    for (more, what) in [
        ("leaves = 0\n", "a tree of 0 leaves; give 1 to 1048576"),
        ("opacity = 0.5\n", "tree: a model drawn as lines is opaque; remove the opacity"),
    ] {
        let found = not_loaded("", &tree(more));
        assert!(found.contains(what), "{found}");
    }
    // Models that no scene file can describe, too.
    let mut file = parse(&tree(""));
    file.models[0].draw = Draw::Points;
    let error = file.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string();
    assert!(error.contains("tree is drawn as lines or polygons, not as points"), "{error}");
}
