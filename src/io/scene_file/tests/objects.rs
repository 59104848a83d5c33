//! Check objects, geometries and sequences.

use super::*;
use crate::scene::Motion;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::transform::rotation;
use crate::source::{Scatter, flatten};

const OBJECTS: &str = include_str!("../objects.toml");
const TREE: &str = "[[geometry]]\nname = \"tree\"\nshape = \"sphere\"\ncount = 50\n";

#[test]
fn the_example_says_what_it_says() {
    let file = parse(OBJECTS);
    assert_eq!((file.models.len(), file.frames, file.frame), (1, 60, 0));
    let [tree] = file.geometries.as_slice() else { panic!("one geometry") };
    assert_eq!((tree.name.as_str(), tree.model.color), ("tree", Some(Vec3::new(0.25, 0.5, 0.125))));
    let [oak, walker, table, scatter] = file.objects.as_slice() else { panic!("four") };
    assert_eq!((oak.name.as_deref(), oak.geometry), (Some("oak"), 0));
    let turned = |degrees| rotation(DVec3::Y, degrees);
    let place = |rotation, scale, translation| Similarity { rotation, scale, translation };
    let still = Motion::still(place(turned(30.0), 1.5, DVec3::Y));
    assert_eq!(oak.places, Places::One(still));
    let keys = vec![
        (0, place(glam::DMat3::IDENTITY, 1.0, -2.0 * DVec3::X)),
        (30, place(turned(90.0), 0.5, 2.0 * DVec3::X)),
    ];
    assert_eq!(walker.places, Places::One(Motion::new(keys).unwrap()));
    let path = Path::new("a").join("trees.csv");
    let transform = Similarity::IDENTITY;
    assert_eq!(table.places, Places::Table { path: path.clone(), transform });
    assert!(file.reads().any(|read| read == path));
    let places = Scatter {
        count: 100,
        seed: 1,
        low: DVec3::new(-8.0, 0.0, -8.0),
        high: DVec3::new(8.0, 0.0, 8.0),
        scale: [0.75, 1.25],
        axis: Some(DVec3::Y),
    };
    let transform = Similarity { translation: -DVec3::Y, ..Similarity::IDENTITY };
    assert_eq!(scatter.places, Places::Scatter { scatter: places, transform });
    let first = Pose { eye: DVec3::new(0.0, 2.0, 12.0), target: DVec3::ZERO, up: DVec3::Y };
    assert_eq!(file.camera.motion.as_ref().unwrap().at(0), first);
}

/// The example with its table, loaded: names, colours and places, and the surfels of a frame.
#[test]
fn objects_are_where_the_file_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(folder.path().join("trees.csv"), "x,y,z,r,g,b\n1,2,3,1,0,0\n4,5,6,0,1,0\n").unwrap();
    fs::write(&path, OBJECTS.replace("count = 2000", "count = 60").replace("4000", "40")).unwrap();
    let mut file = SceneFile::read(&path).unwrap();
    let loaded = load(&file);
    assert!(loaded.scene.surfels.is_empty());
    let objects = loaded.scene.objects.as_ref().unwrap();
    let names: Vec<_> = objects.objects().iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names[..6], ["sheets", "oak", "tree.1", "tree.2", "tree.3", "tree.4"]);
    assert_eq!((names.len(), names[103]), (105, "tree.102"));
    assert_eq!(objects.places()[3].translation, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!([3, 4].map(|i| objects.objects()[i].color), [Some(Vec3::X), Some(Vec3::Y)]);
    assert!(objects.places()[5..].iter().all(|place| place.translation.y == -1.0));
    assert_eq!(objects.geometries()[0].name, "sheets");
    let counts: Vec<_> = loaded.models.iter().map(|model| model.surfels).collect();
    assert_eq!((counts[0], counts[1]), (objects.geometries()[0].surfels.len(), 60));
    assert_eq!(objects.geometries()[1].tree().unwrap().threshold(), 1.0);
    let zones = vec![[100.0, 1.0], [300.0, 2.5]];
    let asked = Refinement { surfel_size: 2.0, budget: Some(100_000), zones };
    assert_eq!(objects.refinement(), &asked);

    let exec = Exec::sequential();
    file.frame = 15;
    let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
    let there = loaded.scene.objects.as_ref().unwrap().at(15).unwrap();
    let there = there.seen_from(&ready.camera, &exec).unwrap();
    assert_eq!(there.places()[2].translation, DVec3::ZERO);
    let flat = flatten(&Scene { objects: Some(there), ..loaded.scene.clone() }, &exec).unwrap();
    assert_eq!(ready.loaded.scene.surfels, flat.surfels);
    assert_eq!(ready.camera, file.camera(&loaded.scene).unwrap());
    // The path through another frame leads to the same scene.
    file.frame = 40;
    let other = file.ready(&exec, &|_, _, _| ()).unwrap();
    assert!(!other.is_still() && other.camera != ready.camera);
    let other = other.at(15, &exec).unwrap();
    assert_eq!((&other.loaded.scene.surfels, other.camera), (&flat.surfels, ready.camera));
}

#[test]
fn a_model_beside_objects_has_its_own_surfels() {
    let model = "[[model]]\nshape = \"torus\"\ncount = 80\n[model.transform]\nscale = 2\n\
                 rotate = { axis = [1, 2, 3], degrees = 40 }\n";
    let alone = load(&parse(model)).scene.surfels;
    let with = parse(&format!("{model}{TREE}")).ready(&Exec::sequential(), &|_, _, _| ()).unwrap();
    let scene = &with.loaded.scene;
    assert_eq!(scene.surfels.position(), alone.position());
    assert_eq!(scene.surfels.normal(), alone.normal());
    assert_eq!(scene.surfels.radius(), alone.radius());
    assert_eq!(scene.surfels.median_radius(), alone.median_radius());
    let objects = scene.objects.as_ref().unwrap();
    assert_eq!((objects.objects().len(), objects.geometries().len()), (1, 2), "one is not used");
    // A geometry in a place equals a model in this place.
    let object = "[[geometry]]\nname = \"a\"\nshape = \"torus\"\ncount = 80\n[[object]]\nof = \"a\"\n\
                  [object.transform]\nscale = 2\nrotate = { axis = [1, 2, 3], degrees = 40 }\n";
    let object = parse(object).ready(&Exec::sequential(), &|_, _, _| ()).unwrap();
    assert_eq!(object.loaded.scene.surfels.position(), alone.position());
    assert_eq!(object.loaded.scene.surfels.normal(), alone.normal());
    assert_eq!(object.loaded.scene.surfels.radius(), alone.radius());
}

/// Tables after a geometry called tree, the expected line number, and the expected error.
fn all_refused(cases: &[(&str, Option<usize>, &str)]) {
    for (text, line, what) in cases {
        let found = refused(&format!("{TREE}{text}"));
        assert!(found.contains(what), "{text}: {found}");
        let place = line.map_or(String::new(), |line| format!(" line {line}: "));
        assert!(found.contains(&place), "{text}: {place} in {found}");
    }
}

#[test]
fn names_that_are_none_are_refused() {
    all_refused(&[
        ("[[object]]\nname = \"a\"\n", Some(5), "missing field `of`"),
        (
            "[[object]]\nof = \"oak\"\n",
            Some(6),
            "no [[geometry]] has the name `oak`; the geometries",
        ),
        ("[[object]]\nof = \"a\"\nname = \"a\"\n", Some(6), "a circle of names, a of a"),
        (
            "[[object]]\nof = \"b\"\nname = \"a\"\n[[object]]\nof = \"a\"\nname = \"b\"\n",
            Some(6),
            "a circle of names, b of a of b",
        ),
        (
            "[[object]]\nof = \"tree\"\nname = \"a\"\n[[object]]\nof = \"a\"\n",
            Some(9),
            "`a` is an object",
        ),
        (
            "[[geometry]]\nname = \"tree\"\nshape = \"torus\"\n",
            None,
            "two [[geometry]] have the name",
        ),
        ("[[geometry]]\nshape = \"torus\"\n", None, "a geometry needs a `name`"),
        ("", None, "no [[object]] and no [[model]]"),
        ("[[model]]\nname = \"a\"\nshape = \"torus\"\n", Some(5), "`name` does not apply to torus"),
    ]);
    let found = refused("[[object]]\nof = \"tree\"\n");
    assert!(found.contains("no [[geometry]] has the name `tree`; there is none"), "{found}");
}

#[test]
fn places_that_are_none_are_refused() {
    all_refused(&[
        (
            "[[object]]\nof = \"tree\"\nkeys = [{ frame = 3 }, { frame = 3 }]\n",
            Some(5),
            "the key of frame 3 follows the key of frame 3; sort keys by frame",
        ),
        ("[[object]]\nof = \"tree\"\nkeys = []\n", Some(5), "no keys"),
        ("[[object]]\nof = \"tree\"\nkeys = [{ frame = -1 }]\n", Some(7), "-1"),
        (
            "[[object]]\nof = \"tree\"\nkeys = [{ frame = 3, scale = nan }]\n",
            Some(5),
            "frame 3: transform: the scale",
        ),
        (
            "[[object]]\nof = \"tree\"\ntransform = { scale = 1 }\nkeys = [{ frame = 3 }]\n",
            Some(5),
            "an object has either a transform or keys",
        ),
        (
            "[[object]]\nof = \"tree\"\ntable = \"a.csv\"\nkeys = [{ frame = 3 }]\n",
            Some(5),
            "one of `keys`, `table` and `scatter`",
        ),
        (
            "[[object]]\nof = \"tree\"\n[object.transform]\n\
             rotate = { matrix = [[1, 0, 0], [1, 0, 0], [0, 0, 1]] }\n",
            Some(5),
            "the matrix is not a rotation",
        ),
        ("[[object]]\nof = \"tree\"\ncolor = [1, 2, -1]\n", Some(5), "color must be"),
        (
            "[[object]]\nof = \"tree\"\nscatter = { count = 4294967296, low = [0, 0, 0], high = [1, 1, 1] }\n",
            None,
            "a scatter of 4294967296 objects; give at most 4294967295",
        ),
        (
            "[[object]]\nof = \"tree\"\nscatter = { count = 0, low = [0, 0, 0], high = [1, 1, 1] }\n",
            None,
            "a count of 0",
        ),
        (
            "[[object]]\nof = \"tree\"\nscatter = { count = 1, low = [0, 2, 0], high = [1, 1, 1] }\n",
            None,
            "low at most high",
        ),
    ]);
}

#[test]
fn sequences_and_cameras_that_are_none_are_refused() {
    all_refused(&[
        ("[[object]]\nof = \"tree\"\n[sequence]\nframes = 0\n", None, "a sequence of 0 frames"),
        ("[[object]]\nof = \"tree\"\n[sequence]\nframes = 1000001\n", None, "give 1 to 1000000"),
        (
            "[[object]]\nof = \"tree\"\n[camera]\neye = [0, 0, 1]\n\
             keys = [{ frame = 0, eye = [0, 0, 1], target = [0, 0, 0] }]\n",
            Some(7),
            "keys replace eye, target and up",
        ),
        (
            "[[object]]\nof = \"tree\"\n[camera]\nkeys = [{ frame = 0, eye = [0, 0, 1] }]\n",
            None,
            "missing field `target`",
        ),
        (
            "[[object]]\nof = \"tree\"\n[camera]\n\
             keys = [{ frame = 0, eye = [0, 0, 1], target = [0, 0, 1] }]\n",
            Some(7),
            "the same point",
        ),
    ]);
}

#[test]
fn a_frame_is_one_of_the_sequence() {
    let file = parse(&format!("{SHAPE}[sequence]\nframes = 3\n"));
    assert!(file.check_frame(2).is_ok());
    let error = file.check_frame(3).unwrap_err();
    assert_eq!(
        (error.exit_code(), error.to_string().as_str()),
        (2, "frame 3 of scene: give 0 to 2")
    );
    let error = parse(SHAPE).check_frame(1).unwrap_err().to_string();
    assert!(error.contains("no [sequence]"), "{error}");
}

#[test]
fn tables_and_colors_are_checked_before_models_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let error = |table: &str, more: &str| {
        fs::write(folder.path().join("a.csv"), table).unwrap();
        let object = format!("[[object]]\nof = \"tree\"\ntable = \"a.csv\"\n{more}");
        let missing = "[[model]]\nfile = \"missing.ply\"\n";
        fs::write(&path, format!("{TREE}{missing}{object}")).unwrap();
        let file = SceneFile::read(&path).unwrap();
        file.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string()
    };
    let found = error("x,y,z\n1,2,nan\n", "");
    assert!(found.contains("a.csv: line 2: ") && !found.contains('\n'), "{found}");
    let found = error("x,y,z,r,g,b\n1,2,3,0,0,0\n", "color = [1, 1, 1]\n");
    assert!(found.contains("a.csv") && found.contains("remove one"), "{found}");
    assert!(error("x,y,z\n1,2,3\n", "").contains("missing.ply"));
}
