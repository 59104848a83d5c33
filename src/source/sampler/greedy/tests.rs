//! Check the order against its definition, index by index and bit by bit, and against its laws.

use super::rounds::{self, How};
use super::*;
use crate::index::point_tree::given;
use proptest::prelude::*;

const SILENT: &dyn Fn(&str, u64, u64) = &|_, _, _| ();

fn random_points(seed: u64, n: u64) -> Vec<Vec3> {
    (0..n).map(|i| Vec3::from([0, 1, 2].map(|j| random::unit(seed, 3 * i + j)))).collect()
}

fn grid(sides: [u32; 3]) -> Vec<Vec3> {
    let [a, b, c] = sides;
    let points = (0..a * b * c).map(|i| [i % a, i / a % b, i / a / b].map(|v| v as f32));
    points.map(Vec3::from).collect()
}

/// Shuffles points by random numbers.
fn shuffled(mut points: Vec<Vec3>) -> Vec<Vec3> {
    for i in (1..points.len()).rev() {
        points.swap(i, random::bits(5, i as u64) as usize % (i + 1));
    }
    points
}

fn sphere(n: u64) -> Vec<Vec3> {
    let onto = |p: Vec3| (p - Vec3::splat(0.5)).normalize_or(Vec3::X);
    random_points(3, n).into_iter().map(onto).collect()
}

/// Point sets that expose programs that are almost right.
fn hard_sets() -> Vec<(&'static str, Vec<Vec3>)> {
    let line = |step: Vec3| (0..700).map(|i| step * i as f32).collect::<Vec<_>>();
    let spiral = (0..1500).map(|i| {
        // A spiral of ever wider turns: reaches grow along the curve, without sines.
        let t = i as f32 * 0.01;
        let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        Vec3::new(c * t * t, s * t * t, t)
    });
    let far = random_points(7, 900);
    let far = far.iter().zip(0..).map(|(&p, i)| p + Vec3::X * 1e6 * (i % 2) as f32);
    let lattice = random_points(8, 2000).into_iter().map(|p| (p * 5.0).floor());
    let scales: Vec<f32> = std::iter::successors(Some(1.0), |s| Some(s / 10.0)).take(13).collect();
    let decades = random_points(9, 1500);
    let decades = decades.iter().enumerate().map(|(i, &p)| p * scales[i % 13]);
    vec![
        ("uniform", random_points(1, 2500)),
        ("all equal", vec![Vec3::new(1.0, -2.0, 3.0); 300]),
        ("integer line", line(Vec3::X)),
        ("slanted line", line(Vec3::new(0.1, 0.2, 0.3))),
        ("lattice with repeats", lattice.collect()),
        ("raster", grid([12; 3])),
        ("flat raster", grid([50, 40, 1])),
        ("shuffled grid", shuffled(grid([13, 11, 10]))),
        ("sphere and centre", sphere(1500).into_iter().chain([Vec3::ZERO]).collect()),
        ("spiral", spiral.collect()),
        ("two far clusters", far.collect()),
        ("1e38", random_points(10, 400).into_iter().map(|p| (p - 0.5) * 2.0 * 3e38).collect()),
        ("1e-22", random_points(11, 800).into_iter().map(|p| p * 3e-22).collect()),
        ("13 decades", decades.collect()),
        ("-0 and 0", [0.0, -0.0, 0.0, 1.0, -0.0].map(Vec3::splat).to_vec()),
    ]
}

fn bits(order: &Order) -> Vec<(u32, u32)> {
    order.index.iter().copied().zip(order.distance.iter().map(|d| d.to_bits())).collect()
}

#[track_caller]
fn check(name: &str, points: &[Vec3], start: u32, execs: &[Exec]) {
    let n = points.len();
    let defined = Greedy { start: Start::Index(start) }.define(points, n + 5).unwrap();
    let ways = [(1, 1, 0.95, 1000), (3, 40, 0.9, 1), (8, 64, 0.5, 1), (2, 200, 0.98, 40)];
    for (i, (regions, leaf, floor, warm)) in ways.into_iter().enumerate() {
        let how = How { regions, leaf, warm, floor };
        let how = if i == 0 { How { leaf: 896, ..how } } else { how };
        for count in [n, n / 3 + 1] {
            let exec = &execs[i % execs.len()];
            let order = rounds::order(points, start, count, &how, exec, SILENT);
            assert_eq!(bits(&order), bits(&defined)[..count], "{name}, start {start}, {how:?}");
        }
    }
}

#[test]
fn hard_sets_are_in_the_order_of_the_definition() {
    let execs = [Exec::sequential(), Exec::new(3, 32).unwrap()];
    for (name, points) in hard_sets() {
        for start in [0, points.len() as u32 / 2] {
            check(name, &points, start, &execs);
        }
    }
}

#[test]
fn few_points_are_in_the_order_of_the_definition() {
    let execs = [Exec::new(2, 32).unwrap()];
    for n in [1, 2, 3, 5, 17, 63, 64, 65, 130, 1024, 1025] {
        check("uniform", &random_points(n, n), n as u32 - 1, &execs);
    }
}

#[test]
fn the_order_is_that_of_any_number_of_threads() {
    let points = random_points(20, 30_000);
    let greedy = Greedy { start: Start::Index(3) };
    let orders = [1, 2, 5].map(|threads| {
        let exec = Exec::new(threads, 32).unwrap();
        greedy.order(&points, 20_000, &exec, SILENT).unwrap()
    });
    assert_eq!(bits(&orders[0]), bits(&orders[1]));
    assert_eq!(bits(&orders[0]), bits(&orders[2]));
    let defined = greedy.define(&points, 300).unwrap();
    assert_eq!(bits(&orders[0])[..300], bits(&defined));
}

/// Five points on a line, by hand.
#[test]
fn a_known_order() {
    let points = [0.0, 1.0, 4.0, 8.0, 8.0].map(|x| Vec3::new(x, 2.0, 2.0));
    let order = Greedy { start: Start::Index(1) }.define(&points, 9).unwrap();
    // 8 twice, the lower first; then 4, 3 from 1; then 0; then the other 8.
    assert_eq!(order.index, [1, 3, 2, 0, 4]);
    assert_eq!(order.distance, [f32::INFINITY, 49.0, 9.0, 1.0, 0.0]);
    let fast = Greedy { start: Start::Index(1) };
    assert_eq!(fast.order(&points, 9, &Exec::sequential(), SILENT).unwrap(), order);
    assert_eq!(fast.order(&points, 0, &Exec::sequential(), SILENT).unwrap(), Order::default());
    assert_eq!(fast.define(&points, 0).unwrap(), Order::default());
}

#[test]
fn a_start_by_chance_is_a_function_of_the_seed() {
    let points = random_points(30, 1000);
    let first = |seed| Greedy { start: Start::Seed(seed) }.define(&points, 1).unwrap().index[0];
    // The first output of the seed 0 is 0xE220A8397B1DCDAF, 0.88331... of 2^64.
    assert_eq!(first(0), 883);
    assert!((1..20).any(|seed| first(seed) != 883));
}

#[test]
fn what_has_no_order_is_refused() {
    let exec = Exec::sequential();
    let mut points = random_points(40, 10);
    let refused = |points: &[Vec3], start| {
        let greedy = Greedy { start };
        let error = greedy.order(points, 3, &exec, SILENT).unwrap_err().to_string();
        assert_eq!(greedy.define(points, 3).unwrap_err().to_string(), error);
        error
    };
    let line = refused(&points, Start::Index(10));
    assert_eq!(line, "start 10, but the points are 0 to 9; give one of them");
    assert!(refused(&[], Start::Seed(0)).contains("no points"));
    points[7].y = f32::NAN;
    assert!(refused(&points, Start::Seed(0)).contains("point 7 is not finite"));
    points[4].z = f32::NEG_INFINITY;
    assert!(refused(&points, Start::Seed(0)).contains("point 4 is not finite"));
}

proptest! {
    #[test]
    fn any_points_are_in_the_order_of_the_definition(points in given::points(), start: u32) {
        let start = start % points.len() as u32;
        check("given", &points, start, &[Exec::sequential()]);
    }

    /// Packing and covering at every prefix, distances that never increase, every index once.
    #[test]
    fn every_prefix_is_a_net(points in given::points(), seed: u64) {
        let exec = Exec::sequential();
        let order = Greedy { start: Start::Seed(seed) }.order(&points, 200, &exec, SILENT).unwrap();
        let mut all = order.index.clone();
        all.sort_unstable();
        prop_assert!(all.into_iter().eq(0..points.len() as u32));
        let at = |i: u32| points[i as usize];
        for (j, (&pick, &r)) in order.index.iter().zip(&order.distance).enumerate() {
            let (before, from) = order.index.split_at(j);
            for &other in before {
                prop_assert!(squared_distance(at(other), at(pick)) >= r, "packing");
            }
            prop_assert!(j == 0 || r <= order.distance[j - 1]);
            for &rest in from.iter().filter(|_| j > 0) {
                let near = before.iter().any(|&b| squared_distance(at(b), at(rest)) <= r);
                prop_assert!(near, "covering");
            }
        }
    }

    /// Without ties, points given in another order are picked in the same one.
    #[test]
    fn only_ties_look_at_indices(seed: u64) {
        let points = random_points(seed, 150);
        let exec = Exec::sequential();
        let order = |points: &[Vec3], start| {
            Greedy { start: Start::Index(start) }.order(points, 150, &exec, SILENT).unwrap()
        };
        let one = order(&points, 0);
        prop_assume!(one.distance.windows(2).all(|two| two[0] > two[1]));
        let turned: Vec<Vec3> = points.iter().rev().copied().collect();
        let other = order(&turned, 149);
        prop_assert_eq!(one.distance, other.distance);
        let back: Vec<u32> = other.index.iter().map(|i| 149 - i).collect();
        prop_assert_eq!(one.index, back);
    }
}
