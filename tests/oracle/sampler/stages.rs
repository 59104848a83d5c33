//! Candidates and orders against the oracle's own.

use crate::oracle::kit::dice::Dice;
use crate::oracle::sampler::candidates::{self as own, Seen, Triangle, bits};
use crate::oracle::sampler::cases;
use crate::oracle::sampler::orders::{self, Picks, Random, greedy, shuffled};
use glam::{DVec3, Vec3};
use splatref::frame::Exec;
use splatref::scene::{Cloud, Geometry, Objects, Primitives, Property, Scene, Triangles, Vertices};
use splatref::source::candidates::{Candidates, Directions, candidates, of_cloud};
use splatref::source::sampler::{self, Greedy, Order, Progressive, Schedule, Start, quality};

pub(crate) fn taken(scene: &Scene, directions: &Directions, side: u32, exec: &Exec) -> Candidates {
    candidates(scene, directions, side, exec, &|_, _, _| ()).expect("candidates")
}

/// As bits; a cloud of candidates has nothing else.
pub(crate) fn seen(found: &Candidates) -> Seen {
    let cloud = &found.cloud;
    assert!(cloud.radius.is_none() && cloud.tangents.is_none());
    assert!(cloud.triangles.is_empty() && cloud.edges.is_empty() && cloud.groups.is_none());
    let all = |list: &[Vec3]| list.iter().map(bits).collect::<Vec<_>>();
    let numbers = |i: usize| {
        let further = cloud.properties.iter().map(|one| &one.values);
        cloud.opacity.iter().chain(further).map(|all| all[i].to_bits()).collect()
    };
    Seen {
        position: all(&cloud.position),
        normal: all(cloud.normal.as_deref().expect("normals")),
        color: cloud.color.as_deref().map(all),
        numbers: (0..cloud.position.len()).map(numbers).collect(),
        counts: found.counts.clone(),
        pixel: found.pixel.to_bits(),
        dropped: found.dropped,
    }
}

/// The vectors of the page.
fn listed(directions: &Directions, triangles: &[Triangle]) -> Vec<DVec3> {
    let half = match directions {
        Directions::These(all) => return all.clone(),
        Directions::Cube => DVec3::ONE,
        Directions::Box => own::half_extents(triangles),
    };
    let signs = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 });
    (0..8).map(|i| DVec3::from_array(signs(i)) * half).collect()
}

fn differ(name: &str, found: &Seen, truth: &Seen) {
    let first = |a: &[[u32; 3]], b: &[[u32; 3]]| {
        let count = a.iter().zip(b).filter(|(a, b)| a != b).count();
        (a.iter().zip(b).position(|(a, b)| a != b), count)
    };
    assert_eq!(found.counts, truth.counts, "counts of {name}");
    assert_eq!(found.dropped, truth.dropped, "dropped of {name}");
    assert_eq!(found.pixel, truth.pixel, "pixel of {name}");
    let none = (None, 0);
    assert_eq!(first(&found.position, &truth.position), none, "positions of {name}");
    assert_eq!(first(&found.normal, &truth.normal), none, "normals of {name}");
    assert!(found == truth, "colours or numbers of {name}");
}

/// Every candidate of every mesh, bit for bit.
#[test]
fn candidates_are_those_of_the_page() {
    for mesh in cases::meshes() {
        let triangles = own::triangles(&mesh.scene);
        for directions in
            [Directions::Cube, Directions::Box, Directions::These(cases::directions())]
        {
            let name = format!("{}, {directions:?}", mesh.name);
            let listed = listed(&directions, &triangles);
            let truth = own::candidates(&triangles, &listed, mesh.side);
            let exec = Exec::sequential();
            let found = candidates(&mesh.scene, &directions, mesh.side, &exec, &|_, _, _| ());
            if truth.position.is_empty() {
                assert!(found.is_err(), "{name}");
                continue;
            }
            let found = found.expect(&name);
            differ(&name, &seen(&found), &truth);
        }
    }
}

/// Opacities and further numbers of the vertices of every mesh that is in a file.
#[test]
fn numbers_of_vertices_are_those_of_the_page() {
    let mut dice = Dice(77);
    for mesh in cases::meshes() {
        let list = &mesh.scene.primitives.triangles;
        if mesh.scene.objects.is_some() || list.is_empty() {
            continue;
        }
        let Vertices { position, direction, color, .. } = list.vertices().clone();
        let mut random =
            |low, high| position.iter().map(|_| dice.within(low, high)).collect::<Vec<f32>>();
        let (opacity, gloss) = (random(0.0, 1.0), random(-3.0, 0.75));
        // Many vertices are opaque.
        let opacity: Vec<f32> = opacity.iter().map(|o| if *o > 0.5 { 1.0 } else { *o }).collect();
        let mut triangles = own::triangles(&mesh.scene);
        for (triangle, corners) in triangles.iter_mut().zip(list.corners()) {
            triangle.numbers =
                [&opacity, &gloss].map(|all| corners.map(|i| all[i as usize])).into();
        }
        let directions = cases::directions();
        let truth = own::candidates(&triangles, &directions, mesh.side);
        let cloud = Cloud {
            opacity: Some(opacity),
            properties: vec![Property { name: "gloss".into(), values: gloss }],
            triangles: list.corners().to_vec(),
            normal: Some(direction),
            position,
            color,
            ..Cloud::default()
        };
        let (directions, exec) = (Directions::These(directions), Exec::sequential());
        let found = of_cloud(cloud, &directions, mesh.side, &exec, &|_, _, _| ());
        if truth.position.is_empty() {
            assert!(found.is_err(), "{}", mesh.name);
            continue;
        }
        differ(mesh.name, &seen(&found.expect(mesh.name).0), &truth);
    }
}

/// The same geometry, whose vertices have numbers.
fn with_numbers(dice: &mut Dice, geometry: &Geometry, veiled: bool) -> Geometry {
    let Geometry { name, surfels, primitives, .. } = geometry.clone();
    let (vertices, corners) = primitives.triangles.into_parts();
    let mut random = |high| vertices.position.iter().map(|_| dice.within(0.0, high)).collect();
    let properties =
        ["heat", "gloss"].map(|name| Property { name: name.into(), values: random(0.75) });
    let opacity = veiled.then(|| random(1.0));
    let vertices = Vertices { opacity, properties: properties.into(), ..vertices };
    let triangles = Triangles::new(vertices, corners).expect("triangles").0;
    let primitives = Primitives { triangles, ..Primitives::default() };
    Geometry { name, surfels, primitives, detail: None }
}

/// Those of objects, of which some have opacities and some have none.
#[test]
fn numbers_of_objects_are_those_of_the_page() {
    let mut dice = Dice(78);
    let mut count = 0;
    for mesh in cases::meshes() {
        let Some(objects) = &mesh.scene.objects else { continue };
        for veiled in [[false; 2], [true, false], [false, true], [true; 2]] {
            let all = objects.geometries().iter().zip(veiled);
            let all = all.map(|(one, veiled)| with_numbers(&mut dice, one, veiled)).collect();
            let objects = Objects::new(all, objects.objects().to_vec(), objects.fill());
            let scene = Scene { objects: objects.ok(), ..mesh.scene.clone() };
            let directions = cases::directions();
            let truth = own::candidates(&own::triangles(&scene), &directions, mesh.side);
            let (directions, exec) = (Directions::These(directions), Exec::sequential());
            let found = candidates(&scene, &directions, mesh.side, &exec, &|_, _, _| ());
            let found = found.expect(mesh.name);
            assert_eq!(found.cloud.opacity.is_some(), veiled.contains(&true), "{}", mesh.name);
            differ(&format!("{} {veiled:?}", mesh.name), &seen(&found), &truth);
            count += 1;
        }
    }
    assert_eq!(count, 16);
}

fn same(name: &str, found: &Order, truth: &Picks) {
    let first = found.index.iter().zip(&truth.index).position(|(a, b)| a != b);
    assert_eq!(first, None, "the first pick that is another, of {name}");
    assert_eq!(found.index.len(), truth.index.len(), "picks of {name}");
    let bits = |all: &[f32]| all.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&found.distance), bits(&truth.distance), "distances of {name}");
}

fn starts(count: usize) -> [Start; 4] {
    [0, count as u32 / 2]
        .map(Start::Index)
        .into_iter()
        .chain([1, 99].map(Start::Seed))
        .collect::<Vec<_>>()
        .try_into()
        .expect("four")
}

fn counts(all: usize) -> [usize; 4] {
    [0, 1, all / 3 + 1, all + 10]
}

#[test]
fn greedy_orders_are_those_of_the_page() {
    let exec = Exec::new(2, 32).expect("threads");
    for (name, points) in cases::points() {
        for start in starts(points.len()) {
            let truth = greedy(&points, start, points.len());
            for count in counts(points.len()) {
                let truth = truth.clone().truncate(count);
                let sampler = Greedy { start };
                let found = sampler.order(&points, count, &exec, &|_, _, _| ()).expect("an order");
                same(&format!("{name}, {start:?}, {count}"), &found, &truth);
                assert_eq!(sampler.define(&points, count).expect("an order"), found, "{name}");
            }
        }
    }
}

/// Many points, so that regions of several threads meet.
#[test]
fn a_greedy_order_of_many_points_is_that_of_the_page() {
    let exec = Exec::new(3, 32).expect("threads");
    for points in [cases::shape("cluster", 20_000), cases::lattice(&mut Dice(3), [27, 27, 27])] {
        let start = Start::Seed(12);
        let sampler = Greedy { start };
        let found = sampler.order(&points, 2000, &exec, &|_, _, _| ()).expect("an order");
        same("many", &found, &greedy(&points, start, 2000));
    }
}

fn progressive(points: &[Vec3], sampler: Progressive, count: usize, name: &str) {
    let Progressive { start, seed, schedule } = sampler;
    let truth = Random::order(points, start, seed, schedule, count);
    let found = sampler.order(points, count, &|_, _, _| ()).expect("an order");
    same(&format!("{name}, {sampler:?}, {count}"), &found, &truth);
}

#[test]
fn progressive_orders_are_those_of_the_page() {
    for (name, points) in cases::points() {
        for schedule in [Schedule::Paper, Schedule::AsShipped] {
            for (seed, start) in (0..).zip(starts(points.len())) {
                for count in counts(points.len()) {
                    progressive(&points, Progressive { start, seed, schedule }, count, name);
                }
            }
        }
    }
}

/// So many picks that each schedule has changed several times, and the samples are as few as they
/// become.
#[test]
fn long_progressive_orders_are_those_of_the_page() {
    let points = cases::shape("torus", 16_000);
    let start = Start::Seed(4);
    progressive(&points, Progressive { start, seed: 5, schedule: Schedule::Paper }, 6000, "long");
    let shipped = Progressive { start, seed: 6, schedule: Schedule::AsShipped };
    progressive(&points, shipped, 12_000, "long");
}

#[test]
fn shuffled_orders_are_those_of_the_page() {
    for (name, points) in cases::points() {
        for seed in [0, 1, u64::MAX] {
            for count in counts(points.len()) {
                let found =
                    sampler::shuffled(&points, seed, count, &|_, _, _| ()).expect("an order");
                same(&format!("{name}, {seed}, {count}"), &found, &shuffled(&points, seed, count));
            }
        }
    }
}

#[test]
fn qualities_are_those_of_the_page() {
    let exec = Exec::new(2, 32).expect("threads");
    let mut dice = Dice(1);
    for (name, points) in cases::points() {
        let order = shuffled(&points, 8, points.len()).index;
        let any: Vec<u32> = (0..points.len()).map(|_| dice.below(points.len()) as u32).collect();
        for prefix in [&order[..], &order[..1], &order[..order.len() / 3 + 1], &any] {
            let found = quality(&points, prefix, &exec).expect("a quality");
            let (nearest, packing, covering) = orders::quality(&points, prefix);
            assert_eq!(found.nearest, nearest, "{name}");
            assert_eq!([found.packing, found.covering], [packing, covering], "{name}");
        }
    }
}
