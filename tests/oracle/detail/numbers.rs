//! Opacities and further properties in folders, byte by byte, and as they are read again.

use super::whole::{alone, check, files, made, objects, patch, settings, world};
use crate::oracle::kit::dice::Dice;
use splatref::SceneFile;
use splatref::frame::Exec;
use splatref::io::hierarchy::Hierarchy;
use splatref::io::ply;
use splatref::scene::{Cloud, Property};
use splatref::source::hierarchy::{Numbers, Settings, Traversal};
use std::path::Path;
use tempfile::TempDir;

/// Numbers by lot, a third of the opacities 1 and a third 0.
fn veil(dice: &mut Dice, cloud: &mut Cloud) {
    let any = |dice: &mut Dice| [0.0, 1.0, dice.within(0.0, 1.0)][dice.below(3)];
    cloud.opacity = Some(cloud.position.iter().map(|_| any(dice)).collect());
}

fn add(dice: &mut Dice, cloud: &mut Cloud, names: &[&str]) {
    for name in names {
        let values = cloud.position.iter().map(|_| dice.within(-3.0, 9.0)).collect();
        cloud.properties.push(Property { name: (*name).into(), values });
    }
}

fn named(names: &[&str], traversal: Traversal) -> Settings {
    let properties = names.iter().map(|&name| name.to_owned()).collect();
    Settings { properties, traversal, ..settings() }
}

const WAYS: [Traversal; 2] = [Traversal::BottomUp, Traversal::TopDown];

#[test]
fn meshes_with_numbers_are_those_of_the_page() {
    let mut dice = Dice(41);
    let at = TempDir::new().expect("a folder");
    let mut mesh = patch(&mut dice, 90, true);
    add(&mut dice, &mut mesh, &["heat", "gloss_2", "unnamed"]);
    let names: [&[&str]; 4] = [&[], &["heat"], &["gloss_2", "heat"], &["unnamed"]];
    for veiled in [false, true] {
        if veiled {
            veil(&mut dice, &mut mesh);
        }
        let file = alone(&at, &mesh);
        for names in names {
            for traversal in WAYS {
                let settings = named(names, traversal);
                let world = world(&file, &[0], &settings);
                assert_eq!(world.meshes[0].opacity, mesh.opacity);
                let values = |name: &str| {
                    let one = mesh.properties.iter().find(|one| one.name == name);
                    one.expect("a property").clone()
                };
                let all: Vec<Property> = names.iter().map(|name| values(name)).collect();
                assert_eq!(world.meshes[0].properties, all);
                let count = check(&format!("{veiled}, {names:?}"), &file, &[0], &settings);
                assert!(count >= 5, "{count}");
            }
        }
    }
}

/// The opacity of a model stands in the place of its file's; what is opaque all over has none, and neither has
/// what nobody names.
#[test]
fn what_is_opaque_has_the_bytes_of_what_has_no_opacity() {
    let mut dice = Dice(42);
    let at = TempDir::new().expect("a folder");
    let bare = patch(&mut dice, 40, true);
    let bytes = |name: &str, cloud: &Cloud, opacity: Option<f32>| {
        let mut file = alone(&at, cloud);
        file.models[0].opacity = opacity;
        let folder = at.path().join(name);
        made(&file, &folder, &named(&[], Traversal::BottomUp), 1);
        files(&folder)
    };
    let truth = bytes("bare", &bare, None);
    let mut opaque = bare.clone();
    opaque.opacity = Some(vec![1.0; bare.position.len()]);
    add(&mut dice, &mut opaque, &["heat"]);
    assert!(bytes("opaque", &opaque, None) == truth);
    let mut veiled = bare.clone();
    veil(&mut dice, &mut veiled);
    assert!(bytes("veiled", &veiled, None) != truth);
    assert!(bytes("one", &veiled, Some(1.0)) == truth);
    let half = bytes("half", &veiled, Some(0.5));
    veiled.opacity = Some(vec![0.5; bare.position.len()]);
    assert!(half == bytes("of the file", &veiled, None) && half != truth);
}

/// A corner that cannot be takes its triangles with it.
#[test]
fn triangles_of_unsound_numbers_are_dropped() {
    let mut dice = Dice(43);
    let at = TempDir::new().expect("a folder");
    let mut mesh = patch(&mut dice, 40, false);
    veil(&mut dice, &mut mesh);
    add(&mut dice, &mut mesh, &["heat"]);
    let inner = 5 * 41 + 7;
    mesh.opacity.as_mut().expect("opacities")[inner] = 1.5;
    mesh.properties[0].values[20 * 41 + 20] = f32::NAN;
    let settings = named(&["heat"], Traversal::BottomUp);
    assert!(check("both", &alone(&at, &mesh), &[12], &settings) >= 1);
    let settings = named(&[], Traversal::BottomUp);
    assert!(check("opacities", &alone(&at, &mesh), &[6], &settings) >= 1);
}

/// Geometries of a scene: two with opacities and two without, all with two properties.
fn scene(at: &TempDir, seed: u64, count: usize) -> (SceneFile, [u64; 4]) {
    let (file, dropped) = objects(at, seed, count);
    let mut dice = Dice(seed + 100);
    for i in 0..4 {
        let path = at.path().join(format!("{i}.ply"));
        let mut mesh = ply::read(&path).expect("a mesh");
        if i == 1 || i == 3 {
            veil(&mut dice, &mut mesh);
        }
        add(&mut dice, &mut mesh, &["heat", "gloss"]);
        ply::write(&path, &mesh).expect("a mesh");
    }
    (file, dropped)
}

#[test]
fn scenes_with_numbers_are_those_of_the_page() {
    for (seed, count) in [(4, 12), (5, 30)] {
        let at = TempDir::new().expect("a folder");
        let (file, dropped) = scene(&at, seed, count);
        for traversal in WAYS {
            for names in [&["gloss", "heat"][..], &[]] {
                let settings = named(names, traversal);
                let found = check(&format!("{count} objects"), &file, &dropped, &settings);
                assert!(found >= 3, "{found} of {count}");
            }
        }
    }
}

/// What is read is what the page has: of a node, and of all as objects, for a view or whole.
#[test]
fn numbers_come_back() {
    let at = TempDir::new().expect("a folder");
    let (file, dropped) = scene(&at, 6, 25);
    let settings = named(&["gloss", "heat"], Traversal::BottomUp);
    let truth = world(&file, &dropped, &settings);
    let folder = at.path().join("all");
    made(&file, &folder, &settings, 1);
    let found = Hierarchy::open(&folder).expect("a folder");
    assert_eq!(found.numbers(), Numbers { opacity: true, properties: settings.properties });
    for (number, surfels) in &truth.surfels {
        for most in [u32::MAX, 7] {
            let cloud = found.surfels(*number, most).expect("surfels");
            let opacity = cloud.opacity.expect("opacities");
            let numbers = |i: usize| {
                let further = cloud.properties.iter().map(|one| one.values[i]);
                [opacity[i]].into_iter().chain(further).collect::<Vec<f32>>()
            };
            let all: Vec<Vec<f32>> = (0..opacity.len()).map(numbers).collect();
            assert_eq!(all[..], surfels.numbers()[..all.len()], "{number}");
            assert_eq!(cloud.properties[0].name, "gloss");
        }
    }
    let exec = Exec::sequential();
    let quiet = |_: &str, _, _| ();
    let objects = found.load(&exec, &quiet).expect("objects");
    for geometry in objects.geometries() {
        let vertices = geometry.primitives.triangles.vertices();
        assert!(
            vertices.opacity.is_none() && vertices.properties.is_empty(),
            "they are drawn opaque"
        );
        let number = geometry.name.trim_start_matches("node-").parse().expect("a node");
        let Some(surfels) = truth.surfels_of(number) else { continue };
        let opacity: Vec<f32> = surfels.numbers().iter().map(|all| all[0]).collect();
        assert_eq!(geometry.surfels.opacity(), Some(&opacity[..]));
    }
    let (whole, _) = objects.flattened(&exec).expect("surfels");
    assert!(whole.opacity().is_some_and(|all| all.iter().any(|o| *o < 0.75)));
}

/// A name that a mesh lacks is told before anything is made.
#[test]
fn what_a_mesh_lacks_is_told() {
    let at = TempDir::new().expect("a folder");
    let (file, _) = scene(&at, 7, 3);
    let path = at.path().join("2.ply");
    let mut mesh = ply::read(&path).expect("a mesh");
    add(&mut Dice(1), &mut mesh, &["heat"]);
    ply::write(&path, &mesh).expect("a mesh");
    let folder = at.path().join("none");
    let refused = |folder: &Path| {
        let settings = named(&["heat", "gloss"], Traversal::BottomUp);
        let exec = Exec::sequential();
        file.approximate(folder, &settings, &exec, &|_, _, _| ())
    };
    let line = refused(&folder).expect_err("no gloss").to_string();
    assert!(line.contains("2.ply: element vertex has no property `gloss`"), "{line}");
    assert!(!folder.exists());
}
