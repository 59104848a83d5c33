//! `p_m` and `r_m` of orders by every pair of points.

use crate::oracle::kit::dice::Dice;
use crate::oracle::sampler::cases;
use glam::Vec3;
use splatref::scene::objects::detail::prefix::Estimate;
use splatref::source::sampler::estimate;

/// The squared distance, each operation rounded to f32.
pub(crate) fn square(a: Vec3, b: Vec3) -> f32 {
    let [x, y, z] = [b.x - a.x, b.y - a.y, b.z - a.z];
    let flat = x * x + y * y;
    flat + z * z
}

/// Less than 120 degrees apart.
fn alike(a: [f64; 3], b: [f64; 3]) -> bool {
    let dot = |[ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]| {
        let flat = ax * bx + ay * by;
        flat + az * bz
    };
    let s = dot(a, b);
    s >= 0.0 || 4.0 * s * s < dot(a, a) * dot(b, b)
}

/// `p_m`, and the bits of `r_m`.
pub(crate) fn model(points: &[Vec3], normals: &[Vec3]) -> (u32, u32) {
    let count = points.len().min(1000);
    let normals: Vec<_> = normals.iter().map(|n| n.to_array().map(f64::from)).collect();
    let mut nearest = Vec::new();
    for i in 0..count {
        let mut least = None;
        for j in (0..count).filter(|&j| j != i && alike(normals[i], normals[j])) {
            let d = square(points[i], points[j]);
            if d < f32::INFINITY && least.is_none_or(|least| d < least) {
                least = Some(d);
            }
        }
        nearest.extend(least);
    }
    nearest.sort_by(f32::total_cmp);
    let rank = nearest.len().saturating_sub(1) / 2;
    let median = nearest.get(rank).map_or(0.0, |&d| f64::from(d).sqrt() as f32);
    (count as u32, median.to_bits())
}

/// Normals of every kind, and their name.
fn normals(dice: &mut Dice, count: usize) -> [(&'static str, Vec<Vec3>); 6] {
    // Of pairs of these many are exactly 120 degrees apart.
    let sixty = [[1, 1, 0], [-1, 0, 1], [0, -1, -1], [1, 0, 1], [-1, 1, 0], [0, -1, 1]];
    let sixty = sixty.map(|n: [i32; 3]| Vec3::from_array(n.map(|c| c as f32)));
    let mut all = |of: &dyn Fn(&mut Dice, usize) -> Vec3| -> Vec<Vec3> {
        (0..count).map(|i| of(dice, i)).collect()
    };
    [
        ("all one way", all(&|_, _| Vec3::Z)),
        ("any", all(&|dice, _| dice.direction())),
        ("axes", all(&|dice, _| dice.axis())),
        ("two sides", all(&|_, i| [Vec3::Y, Vec3::NEG_Y][i % 2])),
        ("six", all(&|dice, _| sixty[dice.below(6)] * dice.within(0.5, 4.0))),
        ("three that meet", all(&|_, i| sixty[i % 3])),
    ]
}

#[test]
fn estimates_are_those_of_the_page() {
    let mut dice = Dice(21);
    let [mut none, mut beyond, mut differ] = [0; 3];
    for (name, points) in cases::points() {
        for first in [points.len(), points.len() / 2 + 1, 2] {
            let points = &points[..first.min(points.len())];
            let mut all = Vec::new();
            for (kind, normals) in normals(&mut dice, points.len()) {
                let found = estimate(points, &normals);
                let truth = model(points, &normals);
                let name = format!("{} points of {name}, {kind}", points.len());
                assert_eq!((found.count, found.distance.to_bits()), truth, "{name}");
                none += usize::from(found.distance == 0.0);
                beyond += usize::from(points.iter().any(|p| p.x.abs() > 1e25));
                all.push(truth.1);
            }
            differ += usize::from(all.iter().any(|bits| *bits != all[0]));
        }
    }
    assert!(none > 10 && beyond > 10 && differ > 20, "{none} {beyond} {differ}");
}

/// Two grids face each other, closer than the points of each: no side counts for the other.
#[test]
fn the_other_side_of_a_thin_wall_does_not_count() {
    let at = |i: usize, z| Vec3::new((i % 9) as f32, (i / 9) as f32, z);
    let points: Vec<Vec3> = (0..162).map(|i| at(i / 2, [0.0, 0.125][i % 2])).collect();
    let normals: Vec<Vec3> = (0..162).map(|i| [Vec3::NEG_Z, Vec3::Z][i % 2]).collect();
    assert_eq!(estimate(&points, &normals), Estimate { count: 162, distance: 1.0 });
    assert_eq!(estimate(&points, &[Vec3::Z; 162]), Estimate { count: 162, distance: 0.125 });
}

/// Of an order of many points the first thousand alone count.
#[test]
fn points_behind_the_first_thousand_do_not_count() {
    let mut points: Vec<Vec3> = (0..1000).map(|i| Vec3::new(2.0 * i as f32, 0.0, 0.0)).collect();
    points.extend((0..1000).map(|i| Vec3::new(2.0 * i as f32 + 0.5, 0.0, 0.0)));
    let normals = vec![Vec3::Y; points.len()];
    assert_eq!(estimate(&points, &normals), Estimate { count: 1000, distance: 2.0 });
}
