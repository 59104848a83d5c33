//! Folders of hierarchies, file by file and byte by byte.

use super::folder::World;
use super::mesh::Mesh;
use crate::oracle::kit::dice::Dice;
use glam::{DVec3, Vec3};
use splatref::SceneFile;
use splatref::frame::Exec;
use splatref::io::hierarchy::BOUND;
use splatref::io::ply;
use splatref::scene::{Cloud, Motion, Object, Similarity};
use splatref::source::candidates::Directions;
use splatref::source::hierarchy::{Sampler, Settings, Traversal};
use splatref::source::sampler::Schedule;
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

/// A bumpy patch of 2 n n triangles of a sphere, of normals of its own.
pub(crate) fn patch(dice: &mut Dice, n: u32, colored: bool) -> Cloud {
    let mut cloud = Cloud::default();
    let mut normals = Vec::new();
    for i in 0..(n + 1) * (n + 1) {
        let [x, y] = [i % (n + 1), i / (n + 1)].map(|c| 2.0 * c as f32 / n as f32 - 1.0);
        let bump = dice.within(0.95, 1.0);
        cloud.position.push(Vec3::new(x, y, 0.75).normalize() * bump);
        normals.push((Vec3::new(x, y, 0.75) + dice.direction() * 0.25).normalize());
    }
    for i in (0..n * (n + 1)).filter(|i| i % (n + 1) < n) {
        let [a, b, c, d] = [i, i + 1, i + n + 1, i + n + 2];
        cloud.triangles.extend([[a, b, d], [a, d, c]]);
    }
    let color = |_: &Vec3| dice.vector(Vec3::ZERO, Vec3::ONE);
    cloud.color = colored.then(|| cloud.position.iter().map(color).collect());
    cloud.normal = Some(normals);
    cloud
}

/// The same with large triangles through it, and all that is wrong with a mesh: twice the same in
/// other colours, corners that meet, on a line, at -0, edges of many, and a vertex that is none.
fn flawed(dice: &mut Dice, n: u32) -> Cloud {
    let mut cloud = patch(dice, n, true);
    let inner = (n - 1) * (n + 1) + 5;
    let twice = cloud.some(&(0..cloud.position.len() as u32 / 3).collect::<Vec<_>>());
    let shift = cloud.position.len() as u32;
    let kept = cloud.triangles.iter().filter(|t| t.iter().all(|v| *v < shift / 3));
    let again: Vec<_> = kept.map(|[a, b, c]| [b + shift, c + shift, a + shift]).collect();
    cloud.triangles.extend(again);
    let mut add = |position: Vec3| {
        cloud.position.push(position);
        cloud.position.len() as u32 - 1
    };
    twice.position.into_iter().for_each(|p| {
        add(p);
    });
    let [a, b] = [Vec3::new(-2.0, -1.0, 0.5), Vec3::new(2.0, 1.0, -0.5)].map(&mut add);
    let c =
        [(0.0, 1.0), (-0.0, 1.0), (0.0, -1.0), (0.5, 0.25)].map(|(x, y)| add(Vec3::new(x, y, 0.0)));
    let bad = add(Vec3::new(f32::NAN, 0.0, 0.0));
    let line = add(Vec3::ZERO);
    let more = [
        [a, b, c[0]],
        [b, a, c[1]],
        [a, b, c[2]],
        [a, b, c[3]],
        [a, a, b],
        [b, a, a],
        // An edge of two triangles, which this one does not count for.
        [inner, inner + 1, inner],
        [c[0], c[1], a],
        [a, b, line],
        [bad, a, b],
        [a, b, c[0]],
    ];
    cloud.triangles.splice(7..7, more);
    let all = cloud.position.len();
    let normals = cloud.normal.as_mut().expect("normals");
    normals.resize_with(all, || dice.direction());
    let colors = cloud.color.as_mut().expect("colours");
    colors.resize_with(all, || dice.vector(Vec3::ZERO, Vec3::ONE));
    cloud
}

/// The same with all of it on a line, but for one triangle far below a pixel.
fn unseen(mut cloud: Cloud) -> Cloud {
    cloud.position.iter_mut().skip(1).for_each(|p| *p = Vec3::new(p.x, 0.0, 0.0));
    cloud.position[0] = Vec3::new(cloud.position[1].x, 1e-6, 0.0);
    cloud
}

/// What is loaded of a scene: its geometries and objects.
pub(crate) fn world(file: &SceneFile, dropped: &[u64], settings: &Settings) -> World {
    let (exec, quiet) = (Exec::sequential(), |_: &str, _, _| ());
    let loaded = file.load_polygons(&settings.properties, &exec, &quiet).expect("a scene");
    assert_eq!(loaded.dropped_primitives, dropped.iter().sum::<u64>());
    let fill = file.material.color;
    let one = |triangles, dropped| Mesh::new(triangles, dropped, BOUND);
    if let Some(objects) = loaded.scene.objects {
        let geometries = objects.geometries().iter().zip(dropped);
        let meshes = geometries.map(|(g, d)| one(&g.primitives.triangles, *d)).collect();
        return World::new(meshes, objects.objects().to_vec(), fill, settings.clone());
    }
    let mesh = one(&loaded.scene.primitives.triangles, dropped[0]);
    let motion = Motion::still(Similarity::IDENTITY);
    let object = Object { name: String::new(), geometry: 0, motion, color: None };
    World::new(vec![mesh], vec![object], fill, settings.clone())
}

pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries
        .map(|entry| {
            let entry = entry.expect("a file");
            let name = entry.file_name().into_string().expect("a name");
            (name, std::fs::read(entry.path()).expect("bytes"))
        })
        .collect()
}

pub(crate) fn made(file: &SceneFile, folder: &Path, settings: &Settings, threads: usize) {
    let exec = Exec::new(threads, 32).expect("threads");
    file.approximate(folder, settings, &exec, &|_, _, _| ()).expect("a hierarchy");
}

/// The files of the page and those that are there; and how many nodes have surfels.
pub(crate) fn check(name: &str, file: &SceneFile, dropped: &[u64], settings: &Settings) -> usize {
    let world = world(file, dropped, settings);
    let at = TempDir::new().expect("a folder");
    let folder = at.path().join("all");
    made(file, &folder, settings, 2);
    let [found, truth] = [files(&folder), world.files()];
    let names = |all: &BTreeMap<String, Vec<u8>>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&found), names(&truth), "{name}");
    for (one, bytes) in &truth {
        let found = &found[one];
        let first = found.iter().zip(bytes).position(|(a, b)| a != b);
        let at = |all: &[u8]| first.map(|i| all[i / 4 * 4..][..4].to_vec());
        assert_eq!((first, at(found)), (None, at(bytes)), "{one} of {name}");
        assert_eq!(found.len(), bytes.len(), "{one} of {name}");
    }
    for (number, surfels) in &world.surfels {
        let (tree, first, _) = world.tree_of(*number);
        let below = tree[(*number - first) as usize].weight;
        let count = u64::from(surfels.header().0);
        assert!(count <= 200_000 && 2 * count <= below && below >= 1000, "{number} of {name}");
    }
    world.surfels.values().filter(|surfels| surfels.header().0 > 0).count()
}

pub(crate) fn settings() -> Settings {
    Settings { most: 500, side: 256, seed: 7, ..Settings::default() }
}

/// A mesh alone, of these triangles.
pub(crate) fn alone(at: &TempDir, cloud: &Cloud) -> SceneFile {
    ply::write(&at.path().join("mesh.ply"), cloud).expect("a mesh");
    let path = at.path().join("scene.toml");
    std::fs::write(&path, "[[model]]\nfile = \"mesh.ply\"\ndraw = \"polygons\"\n")
        .expect("a scene");
    let mut file = SceneFile::read(&path).expect("a scene");
    file.material.color = Vec3::new(0.25, 0.5, 0.75);
    file
}

#[test]
fn meshes_alone_are_those_of_the_page() {
    let mut dice = Dice(5);
    let at = TempDir::new().expect("a folder");
    let plain = settings();
    let all = [
        ("small", patch(&mut dice, 22, true), 0, 0),
        ("just enough", patch(&mut dice, 23, false), 0, 1),
        ("colours", patch(&mut dice, 90, true), 0, 5),
        ("none", patch(&mut dice, 120, false), 0, 5),
        ("flawed", flawed(&mut dice, 80), 1, 3),
        ("unseen", unseen(patch(&mut dice, 80, true)), 0, 0),
    ];
    for (name, cloud, dropped, least) in all {
        let file = alone(&at, &cloud);
        for traversal in [Traversal::BottomUp, Traversal::TopDown] {
            let settings = Settings { traversal, ..plain.clone() };
            let count = check(name, &file, &[dropped], &settings);
            assert!(count >= least && (least > 0 || count == 0), "{count} of {name}");
        }
    }
}

#[test]
fn settings_are_those_of_the_page() {
    let at = TempDir::new().expect("a folder");
    let file = alone(&at, &flawed(&mut Dice(9), 75));
    let these = vec![DVec3::new(1.0, 2.0, 3.0), DVec3::new(-0.5, 0.25, -1.0)];
    let samplers = [
        (Sampler::Greedy, Directions::Box, 3000, 1024),
        (Sampler::Progressive(Schedule::Paper), Directions::Cube, 200_000, 64),
        (Sampler::Progressive(Schedule::AsShipped), Directions::These(these), 400, 100),
        (Sampler::Random, Directions::Cube, 1, 7),
    ];
    for (seed, (sampler, directions, most, side)) in (0..).zip(samplers) {
        for traversal in [Traversal::BottomUp, Traversal::TopDown] {
            let directions = directions.clone();
            let properties = Vec::new();
            let settings =
                Settings { most, side, directions, sampler, seed, traversal, properties };
            let count = check(&format!("{settings:?}"), &file, &[1], &settings);
            assert!(count > 1, "{settings:?}");
        }
    }
}

/// Objects of four geometries by lot; some move, some have a colour.
pub(crate) fn objects(at: &TempDir, seed: u64, count: usize) -> (SceneFile, [u64; 4]) {
    let mut dice = Dice(seed);
    let meshes = [
        patch(&mut dice, 12, true),
        patch(&mut dice, 30, false),
        flawed(&mut dice, 20),
        patch(&mut dice, 1, false),
    ];
    let mut scene = String::new();
    for (i, mesh) in meshes.iter().enumerate() {
        ply::write(&at.path().join(format!("{i}.ply")), mesh).expect("a mesh");
        let table = if i == 0 { "model" } else { "geometry" };
        scene += &format!("[[{table}]]\nfile = \"{i}.ply\"\ndraw = \"polygons\"\n");
        if i > 0 {
            scene += &format!("name = \"{i}\"\n");
        }
        if i == 1 {
            scene += "transform = { scale = 0.5, translate = [0.5, 0.25, -2] }\n";
        }
    }
    for i in 0..count {
        scene += &format!("[[object]]\nof = \"{}\"\n", 1 + dice.below(3));
        let mut place = || {
            let [p, axis] = [dice.vector(Vec3::splat(-9.0), Vec3::splat(9.0)), dice.direction()];
            let (degrees, scale) = (dice.within(0.0, 360.0), dice.within(0.25, 2.0));
            format!(
                "scale = {scale}, translate = [{}, {}, {}], rotate = {{ axis = [{}, {}, {}], degrees = {degrees} }}",
                p.x, p.y, p.z, axis.x, axis.y, axis.z
            )
        };
        scene += &match i % 9 {
            4 => format!("keys = [{{ frame = 1, {} }}, {{ frame = 5, {} }}]\n", place(), place()),
            _ => format!("transform = {{ {} }}\n", place()),
        };
        if i % 4 == 1 {
            scene += "color = [0.125, 1.0, 0.75]\n";
        }
    }
    let path = at.path().join("scene.toml");
    std::fs::write(&path, scene).expect("a scene");
    (SceneFile::read(&path).expect("a scene"), [0, 0, 1, 0])
}

#[test]
fn scenes_of_objects_are_those_of_the_page() {
    for (seed, count) in [(1, 3), (2, 12), (3, 40)] {
        let at = TempDir::new().expect("a folder");
        let (file, dropped) = objects(&at, seed, count);
        for traversal in [Traversal::BottomUp, Traversal::TopDown] {
            let settings = Settings { traversal, ..settings() };
            let found = check(&format!("{count} objects"), &file, &dropped, &settings);
            assert!(found >= [2, 3, 6][seed as usize - 1], "{found} of {count}");
        }
    }
}
