//! What the pages say is refused.

use crate::oracle::kit::scene::{discs, scene, surfels};
use crate::oracle::sampler::cases::{alone, ball, cancelling};
use glam::{DVec3, Vec3};
use splatref::Error;
use splatref::frame::Exec;
use splatref::scene::{Polylines, Primitives, Scene, Surfels, Vertices};
use splatref::source::candidates::{Directions, candidates};
use splatref::source::sampler::{Greedy, Progressive, Schedule, Start, quality, shuffled};

fn refused<T>(found: Result<T, Error>, what: &str) {
    assert!(matches!(found, Err(Error::Invalid(_))), "{what}");
}

#[test]
fn candidates_refuse_what_the_page_says() {
    let flat = alone(cancelling(Vec3::Z));
    let these = |all: &[DVec3]| Directions::These(all.to_vec());
    let take = |scene: &Scene, directions: &Directions, side| {
        candidates(scene, directions, side, &Exec::sequential(), &|_, _, _| ())
    };
    for (what, directions, side) in [
        ("no direction", these(&[]), 8),
        ("a null direction", these(&[DVec3::Z, DVec3::ZERO]), 8),
        ("a direction that is none", these(&[DVec3::Z, DVec3::new(0.0, f64::NAN, 1.0)]), 8),
        ("an infinite direction", these(&[DVec3::new(f64::INFINITY, 0.0, 0.0)]), 8),
        ("no pixels", Directions::Cube, 0),
        ("too many pixels", Directions::Cube, 65_536),
        ("edge-on alone", these(&[DVec3::X]), 8),
        ("the box of a flat mesh", Directions::Box, 8),
    ] {
        refused(take(&flat, &directions, side), what);
    }
    let points = surfels(discs([(Vec3::ZERO, Vec3::Z, 1.0)]));
    refused(take(&scene(points), &Directions::Cube, 8), "surfels alone");
    let vertices = Vertices {
        position: vec![Vec3::ZERO, Vec3::ONE],
        direction: vec![Vec3::Z; 2],
        radius: vec![0.1; 2],
        color: None,
        ..Vertices::default()
    };
    let ribbons = Polylines::new(vertices, vec![[0, 1]]).expect("a ribbon").0;
    let lines = Primitives { ribbons, ..Primitives::default() };
    let lines = Scene { primitives: lines, ..scene(Surfels::none()) };
    refused(take(&lines, &Directions::Cube, 8), "lines alone");
}

/// Directions are vectors of any length whose square f64 holds, and what is all but straight up has
/// no camera.
#[test]
fn a_direction_may_have_almost_any_length() {
    let all = alone(ball(0, Vec3::ONE, Vec3::ZERO));
    let take = |d: DVec3| {
        let these = Directions::These(vec![d]);
        candidates(&all, &these, 8, &Exec::sequential(), &|_, _, _| ()).map(|found| found.counts)
    };
    let one = take(DVec3::ONE).expect("candidates");
    for length in [1e-150, 1e-100, 1e100, 1e150] {
        assert_eq!(take(DVec3::splat(length)).ok(), Some(one.clone()), "{length:e}");
    }
    for length in [1e-300, 1e-170, 1e170, 1e300] {
        refused(take(DVec3::splat(length)), "a length whose square is out of range");
    }
    assert!(take(DVec3::new(1.1e-6, 1.0, 0.0)).is_ok());
    refused(take(DVec3::new(0.9e-6, 1.0, 0.0)), "all but straight up");
}

#[test]
fn samplers_refuse_what_the_page_says() {
    let exec = Exec::sequential();
    let good = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let bad = vec![Vec3::ZERO, Vec3::new(0.0, f32::NAN, 0.0)];
    for (what, points, start) in [
        ("no points", &vec![], Start::Seed(0)),
        ("a point that is none", &bad, Start::Seed(0)),
        ("a start beyond the points", &good, Start::Index(3)),
    ] {
        refused(Greedy { start }.order(points, 2, &exec, &|_, _, _| ()), what);
        refused(Greedy { start }.define(points, 2), what);
        for schedule in [Schedule::Paper, Schedule::AsShipped] {
            let sampler = Progressive { start, seed: 0, schedule };
            refused(sampler.order(points, 2, &|_, _, _| ()), what);
        }
    }
    refused(shuffled(&[], 0, 1, &|_, _, _| ()), "no points");
    refused(shuffled(&bad, 0, 1, &|_, _, _| ()), "a point that is none");
    refused(quality(&good, &[], &exec), "no index");
    refused(quality(&good, &[0, 3], &exec), "an index of no point");
    refused(quality(&bad, &[0], &exec), "a point that is none");
}
