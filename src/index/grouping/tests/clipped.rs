//! Tests of how much of a disc is covered.

use super::super::clipped::{area, by_lower};
use super::super::disc_tree::DiscTree;
use super::*;
use crate::number::random::unit;
use std::f64::consts::PI;

/// The samples of a surfel that another surfel covers, as points in space.
pub(super) fn naive_cover(surfels: &Surfels, i: usize, j: usize, scale: f64) -> u64 {
    let (n, other) = (facing(surfels, i), facing(surfels, j));
    if n.dot(other) < 0.0 {
        return 0;
    }
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let first = DVec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x);
    let second = DVec3::new(n.x * n.y * a, sign + n.y * n.y * a, -n.y);
    let turn = (crate::number::random::bits(0, i as u64) / (1 << 58)) as f64 * PI / 32.0;
    let (radius, reach) = (scale * reach(surfels, i), scale * reach(surfels, j));
    let mut mask = 0;
    for m in 0..64 {
        let rho = radius * ((m as f64 + 0.5) / 64.0).sqrt();
        // The angles of the sample and of the turn add up.
        let angle = m as f64 * PI * (3.0 - 5.0_f64.sqrt()) + turn;
        let offset = first * (rho * libm::cos(angle)) + second * (rho * libm::sin(angle));
        let distance = (place(surfels, i) + offset).distance(place(surfels, j));
        if distance <= reach {
            mask |= 1 << m;
        }
    }
    mask
}

fn cover(surfels: &Surfels, i: usize, j: usize) -> u64 {
    let tree = DiscTree::new(surfels, 0..surfels.len() as u32, &Exec::sequential());
    let at = |i: usize| tree.surfel.iter().position(|&s| s as usize == i).unwrap();
    tree.samples(at(i)).covered_by(&tree.discs[at(j)])
}

/// The area that two circles share, divided by the area of the first.
fn lens(r: f64, other: f64, distance: f64) -> f64 {
    if distance >= r + other {
        return 0.0;
    }
    if distance <= (r - other).abs() {
        return if r < other { 1.0 } else { (other * other) / (r * r) };
    }
    let part = |r: f64, other: f64| {
        let cosine = (distance * distance + r * r - other * other) / (2.0 * distance * r);
        let angle = libm::acos(cosine);
        r * r * (angle - cosine * libm::sin(angle))
    };
    (part(r, other) + part(other, r)) / (PI * r * r)
}

#[test]
fn the_overlap_of_two_discs_is_that_of_two_circles() {
    // A sample stands for a cell with sides of about sqrt(pi / 64) = 0.22. The edge of an overlap
    // is at most pi long and passes some 14 cells, and each is wrong by up to a half. If the errors
    // are random, that is sqrt(14 / 12) = 1.1 in all, and three times that in the worst of 360.
    let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0);
    for radius in [0.5_f32, 1.0, 3.0] {
        for step in 0..120 {
            // Random directions; 50 surfels beside, so that there are many turns of the pattern.
            let turn = f64::from(unit(1, step)) * 2.0 * PI;
            let distance = f64::from(step as f32 / 120.0) * (1.0 + f64::from(radius));
            let at = [distance * libm::cos(turn), distance * libm::sin(turn), 0.0];
            let mut centers = vec![[900.0; 3]; step as usize % 50];
            centers.extend([[0.0; 3], at.map(|x| x as f32)]);
            let mut radii = vec![1.0; centers.len()];
            *radii.last_mut().unwrap() = radius;
            let scene = discs(&centers, &radii);
            let i = scene.len() - 2;
            let part = f64::from(cover(&scene, i, i + 1).count_ones()) / 64.0;
            let error = part - lens(1.0, radius.into(), distance);
            worst = worst.max_of(error.abs());
            (sum, count) = (sum + error, count + 1);
        }
    }
    assert!(worst < 3.5 / 64.0, "{worst}");
    assert!((sum / f64::from(count)).abs() < 0.002, "{}", sum / f64::from(count));
}

#[test]
fn only_discs_that_face_the_same_way_cover() {
    let two = |n: Vec3, z: f32| {
        surfels(Cloud {
            position: vec![Vec3::ZERO, Vec3::new(0.0, 0.0, z)],
            normal: Some(vec![Vec3::Z, n]),
            radius: Some(vec![1.0; 2]),
            ..Cloud::default()
        })
    };
    assert_eq!(cover(&two(Vec3::Z, 0.0), 0, 1), u64::MAX, "itself");
    assert_eq!(cover(&two(Vec3::Z, 1.5), 0, 1), 0, "out of reach");
    assert_eq!(cover(&two(-Vec3::Z, 0.01), 0, 1), 0, "the other side of a wall");
    // At height 0.6 the ball of radius 1 cuts the plane in a circle of radius 0.8: 0.64 of 64 is
    // 40.96.
    assert_eq!(cover(&two(Vec3::new(0.6, 0.0, 0.8), 0.6), 0, 1).count_ones(), 41);
}

proptest! {
    #[test]
    fn samples_are_covered_as_points_in_space_are(seed in 0..1000_u64) {
        let scene = cluttered(seed, 12, [2.0, 2.0, 0.3], 1.5);
        for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))).filter(|(i, j)| i != j) {
            prop_assert_eq!(cover(&scene, i, j), naive_cover(&scene, i, j, 1.0));
        }
    }

    #[test]
    fn lower_surfels_cover_what_they_do_one_by_one(seed in 0..200_u64, scale in 1.0..4.0_f64) {
        let scene = cluttered(seed, 60, [8.0, 8.0, 0.5], 0.5);
        let tree = DiscTree::new(&scene, (0..60).filter(|i| i % 3 != 1), &Exec::sequential());
        let covered = by_lower(&tree, scale, &Exec::sequential(), &|_, _| ()).unwrap();
        for (place, &i) in tree.surfel.iter().enumerate() {
            let lower = (0..i as usize).filter(|j| j % 3 != 1);
            let mask = lower.fold(0, |mask, j| mask | naive_cover(&scene, i as usize, j, scale));
            prop_assert_eq!(covered.at(place), mask, "surfel {}", i);
        }
    }
}

#[test]
fn the_covered_area_is_that_of_the_union() {
    // 300 discs in a plane. Their union is measured by a grid of 1500 x 1500 points, off by its
    // perimeter times half a cell at most, and in fact far less.
    let flat = cluttered(5, 300, [30.0, 30.0, 0.0], 0.0);
    let tree = DiscTree::new(&flat, 0..300, &Exec::sequential());
    let covered = by_lower(&tree, 1.0, &Exec::sequential(), &|_, _| ()).unwrap();
    let (part, sum) = area(&tree, &covered);
    let (cells, low, side) = (1500, -2.0, 34.0);
    let cell = side / f64::from(cells);
    let inside = |x: f64, y: f64| {
        (0..300).any(|i| {
            let p = place(&flat, i);
            (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) <= reach(&flat, i) * reach(&flat, i)
        })
    };
    let at = |i: i32| low + (f64::from(i) + 0.5) * cell;
    let hits = (0..cells).map(|y| (0..cells).filter(|&x| inside(at(x), at(y))).count());
    let union = hits.sum::<usize>() as f64 * cell * cell;
    assert!(PI * sum > 1.3 * union, "they overlap");
    // A sample is 1/64 of a disc; 300 discs have independent errors of about one sample each.
    assert!((PI * part / union - 1.0).abs() < 0.01, "{} {union}", PI * part);
}

#[test]
fn the_area_of_a_sphere_is_4_pi() {
    let sphere = crate::source::Shape::Sphere.surfels(50_000, 0).unwrap();
    let tree = DiscTree::new(&sphere, 0..50_000, &Exec::sequential());
    let covered = by_lower(&tree, 1.0, &Exec::sequential(), &|_, _| ()).unwrap();
    let ratio = area(&tree, &covered).0 / 4.0;
    assert!((ratio - 1.0).abs() < 0.004, "{ratio}");
}
