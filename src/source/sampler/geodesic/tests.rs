//! Check the order along a graph against a plain implementation, and what walls do to both kinds of
//! distance.

use super::super::greedy::{Start, squared_distance};
use super::*;
use crate::frame::Exec;
use crate::index::point_tree::given;
use crate::number::random;
use crate::progress::Progress;
use glam::Vec3;
use proptest::prelude::*;

const SILENT: Progress<'static> = &|_, _, _| ();

fn graph(points: &[Vec3], normals: &[Vec3], reach: f32) -> Graph {
    Graph::new(points, normals, reach, &Exec::sequential(), SILENT).unwrap()
}

/// The edges, found by testing every pair.
fn edges(points: &[Vec3], normals: &[Vec3], reach: f32) -> Vec<(usize, usize, f32)> {
    let near = |i: usize| {
        let cosine = |j: usize| {
            let [a, b] = [normals[i], normals[j]].map(Vec3::as_dvec3);
            a.dot(b) / (a.length() * b.length())
        };
        let mut all: Vec<(f32, usize)> = (0..points.len())
            .filter(|&j| j != i && cosine(j) > -0.5)
            .map(|j| (squared_distance(points[i], points[j]), j))
            .filter(|(d2, _)| *d2 <= reach * reach)
            .collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.truncate(16);
        all
    };
    let all: Vec<_> = (0..points.len()).map(near).collect();
    let both = all.iter().enumerate().flat_map(|(i, near)| {
        near.iter().flat_map(move |&(d2, j)| [(i, j, d2.sqrt()), (j, i, d2.sqrt())])
    });
    both.collect()
}

/// The distances from a point, by relaxing all edges until nothing changes (Bellman and Ford).
fn distances(n: usize, edges: &[(usize, usize, f32)], from: usize) -> Vec<f32> {
    let mut distance = vec![f32::INFINITY; n];
    distance[from] = 0.0;
    loop {
        let mut better = false;
        for &(a, b, length) in edges {
            if distance[a] + length < distance[b] {
                distance[b] = distance[a] + length;
                better = true;
            }
        }
        if !better {
            return distance;
        }
    }
}

/// The order by the definition.
fn plain(points: &[Vec3], normals: &[Vec3], reach: f32, start: usize, count: usize) -> Order {
    let (n, edges) = (points.len(), edges(points, normals, reach));
    let mut least = vec![f32::INFINITY; n];
    let mut order = Order::default();
    let mut next = start;
    while order.index.len() < count.min(n) && least[next] > 0.0 {
        order.index.push(next as u32);
        order.distance.push(least[next] * least[next]);
        for (m, d) in least.iter_mut().zip(distances(n, &edges, next)) {
            *m = if d < *m { d } else { *m };
        }
        next = (0..n).reduce(|a, b| if least[b] > least[a] { b } else { a }).unwrap();
    }
    for i in (0..n as u32).filter(|i| !order.index.contains(i)).collect::<Vec<_>>() {
        if order.index.len() < count.min(n) {
            order.index.push(i);
            order.distance.push(0.0);
        }
    }
    order
}

proptest! {
    #[test]
    fn the_order_is_that_of_the_definition(
        points in given::points(),
        reach in prop::sample::select(vec![1e-3_f32, 0.3, 1.0, 2.5, 1e9, 3e38]),
        count in 1_usize..130,
        seed in 0_u64..9,
    ) {
        // Right angles, opposites, and one of 120 degrees to a bit.
        let kinds = [Vec3::X, -Vec3::X, Vec3::Y * 3.0, Vec3::new(-1.0, 2.0, 0.5), Vec3::Z * 1e-30];
        let normals: Vec<Vec3> = (0..points.len() as u64)
            .map(|i| kinds[random::below(seed, i, if seed < 3 { 1 } else { 5 }) as usize])
            .collect();
        let start = random::below(seed, 1000, points.len() as u64) as u32;
        let greedy = Greedy { start: Start::Index(start) };
        let found = greedy.along(&graph(&points, &normals, reach), count, SILENT).unwrap();
        let right = plain(&points, &normals, reach, start as usize, count);
        prop_assert_eq!(&found, &right);
        let exec = Exec::new(3, 32).unwrap();
        let other = Graph::new(&points, &normals, reach, &exec, SILENT).unwrap();
        prop_assert_eq!(greedy.along(&other, count, SILENT).unwrap(), found);
    }
}

/// A strip bent to a U, as a row of points: its ends are near, but the way along it is long.
#[test]
fn a_bent_strip_is_as_if_it_were_straight() {
    let bent = |i: i32| match i {
        0..=20 => Vec3::new(0.0, 20.0 - i as f32, 0.0),
        _ => Vec3::new(1.0, (i - 21) as f32, 0.0),
    };
    let points: Vec<Vec3> = (0..42).map(bent).collect();
    let normals: Vec<Vec3> = (0..42)
        .map(|i| {
            if i < 20 {
                -Vec3::X
            } else if i < 22 {
                -Vec3::Y
            } else {
                Vec3::X
            }
        })
        .collect();
    let graph = graph(&points, &normals, 1.5);
    assert_eq!(graph.parts(), 1);
    let found = Greedy { start: Start::Index(0) }.along(&graph, 3, SILENT).unwrap();
    assert_eq!(found.index[..2], [0, 41], "the other end, one unit away");
    assert!((38.0_f32..=41.0).contains(&found.distance[1].sqrt()), "{:?}", found.distance);
    let halves = found.index[2];
    assert!((20..=21).contains(&halves), "then the bend, not {halves}");
}

/// Two walls of random points, back to back. The covering radius of the worse side counts only
/// picks on the same side, because a renderer that draws one side needs them.
fn worse_side(points: &[Vec3], normals: &[Vec3], order: &Order) -> f32 {
    let mut worst = 0.0;
    for (point, normal) in points.iter().zip(normals) {
        let own = order.index.iter().filter(|i| normals[**i as usize] == *normal);
        let least = own.map(|i| squared_distance(*point, points[*i as usize]));
        let least = least.fold(f32::INFINITY, |a, b| if b < a { b } else { a });
        worst = if least > worst { least } else { worst };
    }
    worst.sqrt()
}

#[test]
fn thin_walls_have_holes_by_straight_distances_and_none_along_the_surface() {
    let side = |seed: u64, z: f32| {
        let unit = move |i| random::unit(seed, i);
        (0..6000).map(move |i| Vec3::new(unit(2 * i), unit(2 * i + 1), z))
    };
    let normals = [[Vec3::Z; 6000], [-Vec3::Z; 6000]].concat();
    let greedy = Greedy { start: Start::Index(0) };
    let exec = Exec::new(2, 32).unwrap();
    let mut first = None;
    // The distance of picks is about 0.05, so thicker walls are two surfaces for both kinds of
    // distance.
    for (gap, straight_holes) in
        [(0.2, 0.9..1.1), (0.05, 0.9..1.1), (0.02, 1.3..1.6), (0.005, 1.6..2.0)]
    {
        let points: Vec<Vec3> = side(1, gap).chain(side(2, 0.0)).collect();
        let straight = greedy.order(&points, 500, &exec, SILENT).unwrap();
        let graph = graph(&points, &normals, 0.04);
        assert_eq!(graph.parts(), 2);
        let along = greedy.along(&graph, 500, SILENT).unwrap();
        let worse = [&straight, &along].map(|order| worse_side(&points, &normals, order));
        let ratio = worse[0] / worse[1];
        assert!(straight_holes.contains(&ratio), "{ratio} at a gap of {gap}");
        let first = first.get_or_insert(along.clone());
        assert_eq!(first.index, along.index, "the gap is nothing along the surface");
    }
}

#[test]
fn what_is_no_graph_is_refused() {
    let (points, up) = ([Vec3::ZERO, Vec3::X], [Vec3::Z; 2]);
    let exec = Exec::sequential();
    for (points, normals, reach, what) in [
        (&points[..], &up[..1], 1.0, "1 normals, but 2 points"),
        (&points, &up, 0.0, "a reach of 0"),
        (&points, &up, f32::NAN, "a reach of NaN"),
        (&points, &up, f32::INFINITY, "a reach of inf"),
        (&[Vec3::X, Vec3::NAN], &up, 1.0, "point 1 is not finite"),
        (&points, &[Vec3::Z, Vec3::ZERO], 1.0, "the normal of point 1 is zero"),
        (&points, &[Vec3::INFINITY, Vec3::Z], 1.0, "the normal of point 0 is zero or not finite"),
    ] {
        let error = Graph::new(points, normals, reach, &exec, SILENT).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
    let none = Graph::new(&[], &[], 1.0, &exec, SILENT).unwrap();
    assert!(none.is_empty() && Greedy { start: Start::Seed(0) }.along(&none, 1, SILENT).is_err());
    let start = Greedy { start: Start::Index(2) };
    let error = start.along(&graph(&points, &up, 1.0), 1, SILENT).unwrap_err().to_string();
    assert!(error.contains("start 2, but the points are 0 to 1"), "{error}");
}
