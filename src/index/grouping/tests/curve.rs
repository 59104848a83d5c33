//! Points along a curve.

use super::super::curve::along;
use super::*;

#[test]
fn a_point_far_away_leaves_the_others_in_order() {
    // Points of a line share a cell because one point is far away; the last of them is there many
    // times.
    let line = |i: u16| Vec3::new(f32::from(i * 75 % 511), 0.0, 0.0);
    let mut points: Vec<Vec3> = (0..511).map(line).collect();
    points.push(Vec3::new(3e38, 0.0, 3e38));
    points.extend([Vec3::new(700.0, 0.0, 0.0); 40]);
    let order = along(&points, 8, &Exec::sequential());
    let along_line: Vec<f32> = order.iter().map(|&i| points[i as usize].x).collect();
    assert!(along_line.is_sorted(), "{along_line:?}");
    let same: Vec<u32> = order.iter().copied().filter(|&i| i > 511).collect();
    assert!(same.is_sorted() && same.len() == 40);
}

#[test]
fn neighbours_of_the_curve_are_neighbours_of_a_grid() {
    // A grid of 32 x 32 x 32, shuffled: along the Morton curve the first eight fill a cube, and so
    // on.
    let place = |i: u32| (i * 12_345 + 678) % 32_768;
    let points: Vec<Vec3> = (0..32_768)
        .map(place)
        .map(|at| Vec3::new((at % 32) as f32, (at / 32 % 32) as f32, (at / 1024) as f32))
        .collect();
    let order = along(&points, 16, &Exec::sequential());
    for side in [2, 4, 8, 16] {
        for cube in order.chunks(side * side * side) {
            let cells = cube.iter().map(|&i| (points[i as usize] / side as f32).floor());
            let first = cells.clone().next();
            assert!(cells.clone().all(|cell| Some(cell) == first), "{side}");
        }
    }
}

proptest! {
    #[test]
    fn every_point_is_there_once_whatever_they_are(points in prop::collection::vec(vector(), 1..300)) {
        let order = along(&points, 8, &Exec::sequential());
        prop_assert_eq!(&order, &along(&points, 8, &Exec::new(3, 32).unwrap()));
        let mut sorted = order;
        sorted.sort_unstable();
        prop_assert!(sorted.into_iter().eq(0..points.len() as u32));
    }
}
