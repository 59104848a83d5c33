//! What candidates and samplers must keep.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{discs, surfels};
use crate::oracle::sampler::cases;
use crate::oracle::sampler::orders::squared;
use crate::oracle::sampler::stages::{seen, taken};
use glam::Vec3;
use splatref::frame::Exec;
use splatref::scene::Scene;
use splatref::source::candidates::Directions;
use splatref::source::flatten;
use splatref::source::sampler::{Greedy, Order, Progressive, Schedule, Start, quality, shuffled};

fn picked(points: &[Vec3], start: u32, count: usize, exec: &Exec) -> Order {
    let sampler = Greedy { start: Start::Index(start) };
    sampler.order(points, count, exec, &|_, _, _| ()).expect("an order")
}

/// All that [`Exec`] may be.
fn execs() -> Vec<Exec> {
    let all = [1, 2, 3].map(|threads| [8, 64].map(|tile| Exec::new(threads, tile)));
    all.into_iter().flatten().collect::<Result<_, _>>().expect("threads")
}

/// Neither threads nor tiles, nor what is no triangle, change candidates; objects are those of the
/// flat scene.
#[test]
fn candidates_are_a_function_of_the_triangles() {
    let execs = execs();
    for mesh in cases::meshes() {
        let found = taken(&mesh.scene, &Directions::Cube, mesh.side, &Exec::sequential());
        let found = seen(&found);
        for exec in &execs {
            let again = taken(&mesh.scene, &Directions::Cube, mesh.side, exec);
            assert_eq!(seen(&again), found, "{}", mesh.name);
        }
        let flat = match &mesh.scene.objects {
            Some(_) => flatten(&mesh.scene, &Exec::sequential()).expect("a flat scene"),
            None => {
                let points = surfels(discs([(Vec3::splat(-50.0), Vec3::X, 3.0)]));
                Scene { surfels: points, ..mesh.scene }
            }
        };
        let again = taken(&flat, &Directions::Cube, mesh.side, &Exec::sequential());
        assert_eq!(seen(&again), found, "{} beside a surfel", mesh.name);
    }
}

/// Of given directions each has the candidates that it has alone.
#[test]
fn directions_do_not_meet() {
    for mesh in cases::meshes() {
        let exec = Exec::sequential();
        let all = taken(&mesh.scene, &Directions::Cube, mesh.side, &exec);
        let signs = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 });
        let mut before = 0;
        for (i, count) in (0..).zip(&all.counts) {
            let one = Directions::These(vec![glam::DVec3::from_array(signs(i))]);
            let Ok(one) = splatref::source::candidates::candidates(
                &mesh.scene,
                &one,
                mesh.side,
                &exec,
                &|_, _, _| (),
            ) else {
                assert_eq!(*count, 0, "{}", mesh.name);
                continue;
            };
            let part = before..before + *count as usize;
            assert_eq!(one.cloud.position, all.cloud.position[part], "{}", mesh.name);
            before += *count as usize;
        }
        assert_eq!(before, all.cloud.position.len(), "{}", mesh.name);
    }
}

/// Threads change no order, and the first of many picks are the few.
#[test]
fn orders_are_functions_of_the_points() {
    let execs = execs();
    for (name, points) in cases::points() {
        let all = picked(&points, 0, points.len(), &execs[0]);
        for exec in &execs {
            assert_eq!(picked(&points, 0, points.len(), exec), all, "{name}");
        }
        let part = points.len() / 2;
        let few = picked(&points, 0, part, &execs[0]);
        assert_eq!(few.index, all.index[..part], "{name}");
        assert_eq!(few.distance, all.distance[..part], "{name}");
    }
}

/// Packing and covering of every prefix of a greedy order are those of its own radii.
#[test]
fn every_greedy_prefix_is_a_net_of_its_own_radius() {
    for (name, points) in cases::points() {
        let order = picked(&points, 0, points.len(), &Exec::sequential());
        let mut nearest = vec![f32::INFINITY; points.len()];
        for (j, pick) in order.index.iter().enumerate() {
            for (m, p) in nearest.iter_mut().zip(&points) {
                *m = squared(points[*pick as usize], *p).min(*m);
            }
            let covering = nearest.iter().copied().fold(0.0, f32::max);
            let next = order.distance.get(j + 1).copied().unwrap_or(0.0);
            assert_eq!(covering, next, "{name}: the first {} picks", j + 1);
            assert!(next <= order.distance[j], "{name}: pick {}", j + 1);
        }
        for count in [2, 3, 17, 150] {
            let Some(prefix) = order.index.get(..count) else { continue };
            let found = quality(&points, prefix, &Exec::sequential()).expect("a quality");
            assert_eq!(found.packing, order.distance[count - 1], "{name}: {count}");
            let next = order.distance.get(count).copied().unwrap_or(0.0);
            assert_eq!(found.covering, next, "{name}: {count}");
        }
    }
}

/// No other few points of twelve cover all with less than half of the radius.
#[test]
fn no_other_points_cover_with_half_of_the_radius() {
    let mut dice = Dice(2);
    for _ in 0..20 {
        let points: Vec<Vec3> =
            (0..12).map(|_| dice.vector(Vec3::splat(-1.0), Vec3::ONE)).collect();
        let order = picked(&points, 0, points.len(), &Exec::sequential());
        for set in 1_u32..1 << points.len() {
            let others: Vec<Vec3> =
                (0..points.len()).filter(|i| set >> i & 1 == 1).map(|i| points[i]).collect();
            let Some(radius) = order.distance.get(others.len()) else { continue };
            let reach = |p: &Vec3| others.iter().map(|q| squared(*p, *q)).fold(9e9, f32::min);
            let covering = points.iter().map(reach).fold(0.0, f32::max);
            assert!(covering >= radius / 4.0, "{covering} of {set:b}, {radius}");
        }
    }
}

/// Without ties another order of the given points leaves the same places.
#[test]
fn greedy_asks_for_the_order_of_points_only_in_ties() {
    let mut dice = Dice(9);
    let points = cases::shape("torus", 900);
    let mut turn: Vec<u32> = (0..900).collect();
    (1..900).rev().for_each(|i| turn.swap(i, dice.below(i + 1)));
    let turned: Vec<Vec3> = turn.iter().map(|i| points[*i as usize]).collect();
    let all = picked(&points, turn[0], 900, &Exec::sequential());
    let again = picked(&turned, 0, 900, &Exec::sequential());
    assert_eq!(all.distance, again.distance);
    let back: Vec<u32> = again.index.iter().map(|i| turn[*i as usize]).collect();
    assert_eq!(all.index, back);
}

/// No index comes twice, the distances are those to all picks before, and the first picks are the
/// few.
#[test]
fn every_order_is_one() {
    for (name, points) in cases::points() {
        let random = |schedule, count| {
            let sampler = Progressive { start: Start::Seed(3), seed: 2, schedule };
            sampler.order(&points, count, &|_, _, _| ()).expect("an order")
        };
        let orders: [&dyn Fn(usize) -> Order; 3] = [
            &|count| random(Schedule::Paper, count),
            &|count| random(Schedule::AsShipped, count),
            &|count| shuffled(&points, 1, count, &|_, _, _| ()).expect("an order"),
        ];
        for order in orders {
            let all = order(points.len() + 1);
            let mut sorted = all.index.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), all.index.len(), "{name}");
            let mut nearest = vec![f32::INFINITY; points.len()];
            for (pick, distance) in all.index.iter().zip(&all.distance) {
                assert_eq!(nearest[*pick as usize], *distance, "{name}");
                for (m, p) in nearest.iter_mut().zip(&points) {
                    *m = squared(points[*pick as usize], *p).min(*m);
                }
            }
            let part = all.index.len() / 2;
            let few = order(part);
            assert_eq!(few.index, all.index[..part], "{name}");
            assert_eq!(few.distance, all.distance[..part], "{name}");
        }
    }
}
