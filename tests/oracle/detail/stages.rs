//! What views draw against the oracle's own.

use super::forest::{Forest, forest, wishes};
use super::view::{Shown, State, corners, model, placed, size_for};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::eye::{dot, sub, wide};
use crate::oracle::kit::scene::{discs, surfels};
use glam::Vec3;
use splatref::frame::Exec;
use splatref::scene::{
    Cloud, Geometry, Motion, Object, Objects, Primitives, Similarity, Sphere, Triangles, Vertices,
};

/// The ids of the first so many surfels of objects, by the first split that fits: object by object as
/// they ascend.
fn ids(counts: &[u32]) -> Vec<u64> {
    let even = |c: &u32| *c <= 1 << 20;
    assert!(counts.len() <= 4095 && counts.iter().all(even), "the cases have no other split");
    let all = counts.iter().zip(0_u64..);
    all.flat_map(|(&count, o)| (0..u64::from(count)).map(move |s| (o << 20) + s)).collect()
}

/// The radius of every surfel that is drawn, in the order of ids, and how often it counts for the median.
fn radii(objects: &Objects, shown: &[Shown]) -> Vec<f32> {
    let mut all = Vec::new();
    for (o, one) in shown.iter().enumerate() {
        let geometry = objects.geometry(o as u32);
        let scaled = |r: f32| (f64::from(r) * objects.places()[o].scale) as f32;
        let own = scaled(geometry.surfels.median_radius());
        let radius = one.disc.map_or(own, |[radius, _]| radius);
        all.extend(std::iter::repeat_n(radius, one.count as usize));
    }
    all
}

fn lower_median(mut all: Vec<f32>) -> f32 {
    all.sort_by(f32::total_cmp);
    all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

pub(crate) fn same(name: &str, objects: &Objects, seen: &Objects, shown: &[Shown]) {
    let counts: Vec<u32> = shown.iter().map(|s| s.count).collect();
    let found: Vec<u32> = (0..counts.len() as u32).map(|o| seen.ids().count(o)).collect();
    assert_eq!(found, counts, "counts of {name}: {:?} {shown:?}", objects.refinement());
    for (o, one) in shown.iter().enumerate().filter(|(_, one)| one.count > 0) {
        let found = seen.disc(o as u32).map(|d| [d.radius, d.side].map(f32::to_bits));
        assert_eq!(found, one.disc.map(|d| d.map(f32::to_bits)), "discs of {o} of {name}: {one:?}");
    }
    assert_eq!(seen.drawn_ids(), ids(&counts), "ids of {name}");
    let total: u64 = counts.iter().map(|&c| u64::from(c)).sum();
    assert_eq!(seen.drawn_total(), total, "{name}");
    let median = lower_median(radii(objects, shown));
    assert_eq!(seen.median_radius().to_bits(), median.to_bits(), "median of {name}");
}

/// What is placed: positions and radii of surfels, and corners of primitives.
pub(crate) fn flat(name: &str, objects: &Objects, seen: &Objects, shown: &[Shown]) {
    let (surfels, primitives) = seen.flattened(&Exec::sequential()).expect(name);
    let (mut position, mut radius, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for (o, one) in shown.iter().enumerate() {
        let (geometry, place) = (objects.geometry(o as u32), &objects.places()[o]);
        let at = |p: Vec3| placed(place, wide(p)).map(|c| (c as f32).to_bits());
        for i in 0..one.count as usize {
            position.push(at(geometry.surfels.position()[i]));
            let own = (f64::from(geometry.surfels.radius()[i]) * place.scale) as f32;
            radius.push(one.disc.map_or(own, |[r, _]| r).to_bits());
        }
        let triangles = &geometry.primitives.triangles;
        if one.primitives {
            let all = triangles.corners().iter().flatten();
            corners.extend(all.map(|&v| at(triangles.vertices().position[v as usize])));
        }
    }
    let found = surfels.position().iter().map(|p| p.to_array().map(f32::to_bits));
    assert_eq!(found.collect::<Vec<_>>(), position, "positions of {name}");
    let found = surfels.radius().iter().map(|r| r.to_bits());
    assert!(found.eq(radius.iter().copied()), "radii of {name}");
    let found = primitives.iter().flat_map(|p| {
        let all = p.triangles.corners().iter().flatten();
        all.map(|&v| p.triangles.vertices().position[v as usize].to_array().map(f32::to_bits))
    });
    assert_eq!(found.collect::<Vec<_>>(), corners, "primitives of {name}");
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn views_are_those_of_the_page() {
    let mut states: Vec<State> = Vec::new();
    let [mut steps, mut cut, mut beside] = [0; 3];
    for seed in 0..1500 {
        let Forest { objects, camera } = forest(seed);
        for wish in 0..4 {
            let name = format!("view {wish} of {seed}");
            let mut wishes = wishes(seed * 4 + wish);
            if wish > 1 {
                let object = seed as u32 % objects.objects().len() as u32;
                let size =
                    size_for(&objects, &camera, object, 0.99 + 0.00085 * (seed % 400) as f32);
                wishes.surfel_size = size.unwrap_or(1.0);
            }
            let objects = objects.clone().with_refinement(wishes).expect(&name);
            let (shown, step, parts) = model(&objects, &camera);
            let seen = objects.seen_from(&camera, &Exec::sequential()).expect(&name);
            same(&name, &objects, &seen, &shown);
            flat(&name, &objects, &seen, &shown);
            states.extend(shown.iter().map(|one| one.state));
            steps += usize::from(step > 0 && step < 2048);
            cut += parts;
            beside += usize::from(shown.iter().any(|one| one.primitives && one.count > 0));
        }
    }
    let all = [
        State::Plain,
        State::Outside,
        State::Whole,
        State::Growing,
        State::Shrinking,
        State::Gone,
        State::Beyond,
    ];
    let counts = all.map(|s| states.iter().filter(|found| **found == s).count());
    assert!(counts.iter().all(|c| *c > 100), "{all:?} {counts:?}");
    assert!(steps > 100 && cut > 10 && beside > 100, "{steps} {cut} {beside}");
}

/// The sphere of an object is that of its geometry in its place, whose radii count.
#[test]
fn spheres_are_those_of_the_page() {
    for Forest { objects, .. } in (0..100).map(forest) {
        for o in 0..objects.objects().len() as u32 {
            let (geometry, place) = (objects.geometry(o), &objects.places()[o as usize]);
            let [low, high] = corners(&objects, o);
            let middle = [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0);
            let triangles = &geometry.primitives.triangles;
            let used = triangles.corners().iter().flatten().map(|&v| v as usize);
            let used = used.map(|v| (triangles.vertices().position[v], 0.0));
            let own = geometry.surfels.position().iter().zip(geometry.surfels.radius());
            let reach = |(p, r): (Vec3, f32)| {
                let [x, y, z] = sub(wide(p), middle);
                (x * x + y * y + z * z).sqrt() + f64::from(r)
            };
            let all = own.map(|(p, r)| (*p, *r)).chain(used);
            let radius = all.map(reach).fold(0.0, f64::max) * place.scale;
            let Sphere { center: at, radius: found } = objects.sphere(o);
            assert_eq!((at.to_array(), found), (placed(place, middle), radius));
        }
    }
}

/// Ellipses reach as far as both half axes together, and vertices as far as their radius.
#[test]
fn spheres_hold_ellipses_and_vertices() {
    for seed in 0..50 {
        let mut dice = Dice(seed);
        let mut all = |count: usize| -> Vec<Vec3> {
            (0..count).map(|_| dice.vector(Vec3::splat(-1.0), Vec3::ONE)).collect()
        };
        let (position, vertices, [u, v]) = (all(5), all(6), [(); 2].map(|()| all(5)));
        let cloud = discs(position.iter().map(|p| (*p, Vec3::Z, 0.125)));
        let tangents = Some(u.iter().zip(&v).map(|(u, v)| [*u, *v]).collect());
        let surfels = surfels(Cloud { tangents, ..cloud });
        let radius: Vec<f32> = vertices.iter().map(|p| p.x.abs()).collect();
        let direction = vec![Vec3::Y; 6];
        let mesh =
            Vertices { position: vertices, direction, radius, color: None, ..Vertices::default() };
        let triangles = Triangles::new(mesh, vec![[0, 1, 2], [4, 5, 1]]).expect("triangles").0;
        let own = surfels.position().iter().zip(u.iter().zip(&v)).map(|(p, (u, v))| {
            (wide(*p), (dot(wide(*u), wide(*u)) + dot(wide(*v), wide(*v))).sqrt())
        });
        let used = [0, 1, 2, 4, 5]
            .map(|i| (triangles.vertices().position[i], triangles.vertices().radius[i]));
        let all: Vec<_> = own.chain(used.map(|(p, r)| (wide(p), f64::from(r)))).collect();
        let primitives = Primitives { triangles, ..Primitives::default() };
        let geometry = Geometry { name: String::new(), surfels, primitives, detail: None };
        let motion = Motion::still(Similarity::IDENTITY);
        let object = Object { name: String::new(), geometry: 0, motion, color: None };
        let objects = Objects::new(vec![geometry], vec![object], Vec3::ONE).expect("objects");
        let [low, high] = corners(&objects, 0);
        let middle = [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0);
        let reach = |(p, r): &([f64; 3], f64)| dot(sub(*p, middle), sub(*p, middle)).sqrt() + r;
        let radius = all.iter().map(reach).fold(0.0, f64::max);
        assert_eq!(objects.sphere(0), Sphere { center: middle.into(), radius });
    }
}
