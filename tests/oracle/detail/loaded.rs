//! Hierarchies that are read: a node at a time, and as objects.

use super::folder::World;
use super::stages;
use super::view::{State, estimate, model, size_for};
use super::whole::{files, made, objects, world};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::scene;
use glam::{DVec3, Vec3};
use splatref::SceneFile;
use splatref::frame::Exec;
use splatref::io::hierarchy::Hierarchy;
use splatref::scene::objects::detail::prefix::Estimate;
use splatref::scene::objects::detail::refine::Refinement;
use splatref::scene::{Camera, Lens, Objects, Pose, Scene, Similarity, Surfels};
use splatref::source::hierarchy::{Settings, Traversal};
use std::path::Path;
use tempfile::TempDir;

/// An object of the page: its name, the number of the node that it shows, the object that it is a
/// finer one of, its place and its colour.
#[derive(Debug)]
struct Shows {
    name: String,
    node: u32,
    coarser: Option<u32>,
    place: Similarity,
    color: Option<Vec3>,
}

impl World {
    fn shows_something(&self, number: u32) -> bool {
        let (tree, first, geometry) = self.tree_of(number);
        let own = !tree[(number - first) as usize].own.is_empty();
        self.surfels_of(number).is_some() || (geometry.is_some() && own)
    }

    /// How many surfels a node has, `p_m`, and `r_m` or what stands in its place.
    fn header(&self, number: u32) -> Option<(u32, u32, f32)> {
        let (count, p, r) = self.surfels_of(number)?.header();
        let (tree, first, _) = self.tree_of(number);
        let node = &tree[(number - first) as usize];
        let [x, y, z] = [0, 1, 2].map(|k| f64::from(node.high[k]) - f64::from(node.low[k]));
        let half = (x * x + y * y + z * z).sqrt() / 2.0;
        Some((count, p, if r == 0.0 { half as f32 } else { r }))
    }

    /// The nodes above one in its tree, the nearest first.
    fn above(&self, number: u32) -> Vec<u32> {
        let (tree, first, _) = self.tree_of(number);
        let mut all = vec![number];
        while let Some(parent) = tree
            .get((all[all.len() - 1] - first) as usize)
            .map(|n| n.parent)
            .filter(|p| *p != u32::MAX)
        {
            all.push(parent + first);
        }
        all
    }

    fn shown(&self) -> Vec<Shows> {
        let mut all: Vec<Shows> = Vec::new();
        let upper = self.upper.len() as u32;
        let nearest = |all: &[Shows], below: &str, above: &[u32]| {
            above.iter().find_map(|n| all.iter().position(|s| s.name == format!("{below}node-{n}")))
        };
        for node in (0..upper).filter(|n| self.shows_something(*n)) {
            let coarser = nearest(&all, "", &self.above(node)[1..]).map(|o| o as u32);
            let (name, place) = (format!("node-{node}"), Similarity::IDENTITY);
            all.push(Shows { name, node, coarser, place, color: None });
        }
        for (number, over) in self.order() {
            let object = &self.objects[number as usize];
            let first = self.first(object.geometry);
            let own = format!("object-{number}.");
            for node in first..first + self.meshes[object.geometry].tree.len() as u32 {
                if !self.shows_something(node) {
                    continue;
                }
                let here = nearest(&all, &own, &self.above(node)[1..]);
                let there = || (over != u32::MAX).then(|| nearest(&all, "", &self.above(over)))?;
                let coarser = here.or_else(there).map(|o| o as u32);
                let (place, color) = (object.motion.at(0), object.color);
                all.push(Shows { name: format!("{own}node-{node}"), node, coarser, place, color });
            }
        }
        all
    }
}

fn same(world: &World, found: &Objects) {
    let truth = world.shown();
    let mut nodes: Vec<u32> = truth.iter().map(|s| s.node).collect();
    nodes.sort_unstable();
    nodes.dedup();
    assert_eq!(found.geometries().len(), nodes.len());
    assert_eq!(found.objects().len(), truth.len());
    for (o, shows) in (0..).zip(&truth) {
        let object = &found.objects()[o as usize];
        assert_eq!(object.name, shows.name);
        assert_eq!(found.coarser(o), shows.coarser, "{shows:?}");
        assert_eq!((found.places()[o as usize], object.color), (shows.place, shows.color));
        let geometry = nodes.binary_search(&shows.node).expect("a node");
        assert_eq!(object.geometry, geometry, "{shows:?}");
        let header = world.header(shows.node);
        let truth = header.map(|(_, count, distance)| Estimate { count, distance });
        assert_eq!(estimate(found, o), truth, "{shows:?}");
    }
    for (node, geometry) in nodes.iter().zip(found.geometries()) {
        let (tree, first, of) = world.tree_of(*node);
        let own = of.map(|g| &world.meshes[g]).map_or(Vec::new(), |mesh| {
            let all = tree[(*node - first) as usize].own.iter();
            all.flat_map(|&t| mesh.corners[t as usize].map(|v| mesh.position[v as usize])).collect()
        });
        let triangles = &geometry.primitives.triangles;
        let all = triangles.corners().iter().flatten();
        let all: Vec<Vec3> = all.map(|&v| triangles.vertices().position[v as usize]).collect();
        assert_eq!(all, own, "triangles of {node}");
        let header = world.header(*node);
        assert_eq!(geometry.surfels.len() as u32, header.map_or(0, |h| h.0));
        if let Some((n, p, r)) = header {
            let radius = f64::from(r) * (f64::from(p) / f64::from(n)).sqrt();
            assert!(geometry.surfels.radius().iter().all(|r| *r == radius as f32), "{node}");
        }
    }
}

fn settings(traversal: Traversal) -> Settings {
    Settings { most: 300, side: 200, seed: 3, traversal, ..Settings::default() }
}

/// As objects the nodes of a folder are those of the page, and so is what views draw of them.
#[test]
fn loaded_hierarchies_and_what_is_seen_of_them_are_those_of_the_page() {
    let mut states = Vec::new();
    for (seed, count) in [(4, 2), (5, 30)] {
        let at = TempDir::new().expect("a folder");
        let (file, dropped) = objects(&at, seed, count);
        let settings = settings(Traversal::BottomUp);
        let folder = at.path().join("all");
        made(&file, &folder, &settings, 2);
        let exec = Exec::sequential();
        let found = Hierarchy::open(&folder).expect("a folder");
        let found = found.load(&exec, &|_, _, _| ()).expect("objects");
        same(&world(&file, &dropped, &settings), &found);
        let mut dice = Dice(seed);
        for view in 0..60 {
            let eye = dice.direction().as_dvec3() * [3.0, 10.0, 40.0, 400.0][view % 4];
            let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Y };
            let camera = Camera::new(80, 60, pose, Lens::Focal(90.0)).expect("a camera");
            let budget = [None, Some(2000), Some(100), Some(7)][dice.below(4)];
            let root = size_for(&found, &camera, 0, dice.within(0.8, 1.4));
            let surfel_size = root.unwrap_or_else(|| dice.within(0.5, 6.0));
            let zones = vec![[10.0, 1.0], [40.0, 2.5]];
            let wish = Refinement { surfel_size, budget, zones };
            let objects = found.clone().with_refinement(wish).expect("wishes");
            let (shown, ..) = model(&objects, &camera);
            let seen = objects.seen_from(&camera, &exec).expect("a view");
            let name = format!("view {view} of {count} objects");
            stages::same(&name, &objects, &seen, &shown);
            stages::flat(&name, &objects, &seen, &shown);
            states.extend(shown.iter().map(|one| one.state));
        }
    }
    for state in [State::Whole, State::Growing, State::Shrinking, State::Gone, State::Outside] {
        let count = states.iter().filter(|found| **found == state).count();
        assert!(count > 10, "{state:?} {count}");
    }
}

/// What is left of a hierarchy, in whatever state, becomes the whole one with the same bytes.
#[test]
fn hierarchies_that_are_resumed_have_the_same_bytes() {
    let at = TempDir::new().expect("a folder");
    let (file, _) = objects(&at, 6, 25);
    let mut dice = Dice(8);
    for traversal in [Traversal::BottomUp, Traversal::TopDown] {
        let settings = settings(traversal);
        let folder = at.path().join(format!("{traversal:?}"));
        made(&file, &folder, &settings, 1);
        let truth = files(&folder);
        assert!(truth.len() > 10, "{:?}", truth.keys());
        for round in 0..12 {
            let mut lost = 0;
            for (name, bytes) in &truth {
                let path = folder.join(name);
                match dice.below(1 + round) {
                    1 | 4 if name != "plan" => std::fs::remove_file(&path).expect("a file"),
                    2 if name != "plan" => {
                        let cut = &bytes[..dice.below(bytes.len())];
                        std::fs::write(&path, cut).expect("a file");
                    }
                    _ => continue,
                }
                lost += 1;
            }
            made(&file, &folder, &settings, 1 + round % 3);
            assert!(files(&folder) == truth, "{traversal:?} {round} {lost}");
        }
    }
}

/// A single surfel has no distance to another. It is loaded all the same, and where its node is large what is
/// below the node is seen.
#[test]
fn nodes_of_one_surfel_are_loaded_and_give_way() {
    let at = TempDir::new().expect("a folder");
    let (file, dropped) = objects(&at, 5, 30);
    let settings = Settings { most: 1, ..settings(Traversal::BottomUp) };
    let folder = at.path().join("all");
    made(&file, &folder, &settings, 1);
    let exec = Exec::sequential();
    let found = Hierarchy::open(&folder).expect("a folder");
    let found = found.load(&exec, &|_, _, _| ()).expect("objects");
    assert!((0..found.objects().len() as u32).any(|o| found.geometry(o).surfels.len() == 1));
    same(&world(&file, &dropped, &settings), &found);
    let seen = |away: f64| {
        let pose = Pose { eye: DVec3::new(0.0, 0.0, away), target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(80, 60, pose, Lens::Focal(90.0)).expect("a camera");
        let seen = found.seen_from(&camera, &exec).expect("a view");
        let primitives = seen.primitives().expect("primitives");
        (seen.drawn_total(), primitives.iter().map(|p| p.triangles.len()).sum::<usize>())
    };
    assert!(seen(30.0).1 > 1000, "{:?}", seen(30.0));
    // The objects in the nodes are one surfel, and those that move are one each, or their few triangles.
    let (surfels, triangles) = seen(1e5);
    assert!((1..10).contains(&surfels) && triangles < 1000, "{surfels} {triangles}");
}

/// The folder of a golden, whose every choice lies beside a limit.
#[test]
fn the_golden_of_nodes_draws_what_the_page_says() {
    let exec = Exec::sequential();
    let file = SceneFile::read(Path::new("golden/bjfm19_nodes.toml")).expect("a scene file");
    let found = Hierarchy::open(Path::new("golden/nodes")).expect("a folder");
    let objects = found.load(&exec, &|_, _, _| ()).expect("objects");
    let objects = objects.with_refinement(file.refinement.clone()).expect("wishes");
    let scene = Scene { objects: Some(objects.clone()), ..scene(Surfels::none()) };
    let camera = file.camera(&scene).expect("a camera");
    let (shown, ..) = model(&objects, &camera);
    let seen = objects.seen_from(&camera, &exec).expect("a view");
    stages::same("nodes", &objects, &seen, &shown);
    stages::flat("nodes", &objects, &seen, &shown);
    for state in [State::Whole, State::Growing, State::Shrinking, State::Gone] {
        assert!(shown.iter().any(|one| one.state == state), "{state:?}");
    }
}
