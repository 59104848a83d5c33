//! Answers that need no program.

use crate::oracle::sampler::cases::{alone, cancelling};
use crate::oracle::sampler::orders::random;
use crate::oracle::sampler::stages::taken;
use glam::{DVec3, Vec3};
use splatref::frame::Exec;
use splatref::source::candidates::Directions;
use splatref::source::sampler::{Greedy, Start, quality};

/// A rectangle of 3 by 4 has a sphere of radius 5/2. Fifteen pixels a side are three a unit: nine
/// columns, and twelve rows whose centres are on its top border and none on its bottom border.
#[test]
fn a_rectangle_has_a_candidate_a_pixel() {
    let exec = Exec::sequential();
    let scene = alone(cancelling(Vec3::Z));
    for (direction, normal) in [(DVec3::Z, Vec3::Z), (DVec3::NEG_Z, Vec3::NEG_Z)] {
        let found = taken(&scene, &Directions::These(vec![direction]), 15, &exec);
        assert_eq!(found.counts, [108]);
        assert_eq!(found.pixel, 1.0 / 3.0);
        assert!(found.cloud.normal.expect("normals").iter().all(|n| *n == normal));
        let top = found.cloud.position[0];
        let left = if normal == Vec3::Z { -4.0 } else { 4.0 };
        assert!((top - Vec3::new(left / 3.0, 2.0, 0.0)).length() < 1e-5, "{top}");
    }
    let edge_on = Directions::These(vec![DVec3::X, DVec3::Z]);
    assert_eq!(taken(&scene, &edge_on, 15, &exec).counts, [0, 108]);
}

/// Of corner normals +z and -z nothing is left in the middle of their edge, a pixel's centre.
#[test]
fn normals_that_cancel_are_dropped() {
    let scene = alone(cancelling(Vec3::NEG_Z));
    let found = taken(&scene, &Directions::These(vec![DVec3::Z]), 15, &Exec::sequential());
    assert_eq!((found.counts, found.dropped), (vec![107], 1));
}

/// The square, its middle, and a point that is there twice.
#[test]
fn a_square_is_picked_by_hand() {
    let at = |x, y| Vec3::new(x, y, 0.0);
    let points =
        [at(1.0, 1.0), at(0.0, 0.0), at(2.0, 0.0), at(2.0, 2.0), at(0.0, 2.0), at(2.0, 0.0)];
    let sampler = Greedy { start: Start::Index(1) };
    let order = sampler.order(&points, 9, &Exec::sequential(), &|_, _, _| ()).expect("an order");
    assert_eq!(order.index, [1, 3, 2, 4, 0, 5]);
    assert_eq!(order.distance, [f32::INFINITY, 8.0, 4.0, 4.0, 2.0, 0.0]);

    let found = quality(&points, &[1, 3, 2, 5], &Exec::sequential()).expect("a quality");
    assert_eq!(found.nearest, [4.0, 4.0, 0.0, 0.0]);
    assert_eq!((found.packing, found.covering), (0.0, 4.0));
    let one = quality(&points, &[0], &Exec::sequential()).expect("a quality");
    assert_eq!((one.nearest, one.packing, one.covering), (vec![f32::INFINITY], f32::INFINITY, 2.0));
}

/// The first numbers of `SplitMix64` that was started with 0.
#[test]
fn random_numbers_are_those_of_the_paper() {
    let known = [0xE220_A839_7B1D_CDAF, 0x6E78_9E6A_A1B9_65F4, 0x06C4_5D18_8009_454F];
    for (i, known) in (0..).zip(known) {
        assert_eq!([random(0, i), splatref::number::random::bits(0, i)], [known; 2]);
    }
}
