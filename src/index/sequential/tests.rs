use super::*;
use crate::index::point_tree::given::points;
use crate::number::random::unit;
use crate::scene::Cloud;
use crate::scene::cloud::half_axes;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

mod naive;

fn made(cloud: Cloud) -> Surfels {
    let n = cloud.position.len();
    let (surfels, dropped) = Surfels::new(cloud).unwrap();
    assert_eq!((surfels.len(), dropped.total()), (n, 0));
    surfels
}

fn built(surfels: &Surfels) -> (Surfels, Sequential) {
    Sequential::new(surfels, &Exec::sequential()).unwrap()
}

/// Surfels in grids and at the same places, facing opposite ways, with very different sizes; discs
/// or ellipses.
fn any_surfels() -> impl Strategy<Value = Surfels> {
    let coordinate = || prop_oneof![2 => (-3_i8..=3).prop_map(f32::from), 3 => -4.0_f32..4.0];
    let position = prop_oneof![
        6 => [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array),
        1 => Just(Vec3::ONE),
    ];
    let direction = [-1.0_f32..1.0, -1.0_f32..1.0, 0.01_f32..1.0].prop_map(Vec3::from_array);
    let normal = prop_oneof![
        2 => prop::sample::select(vec![Vec3::Z, -Vec3::Z, Vec3::X]),
        3 => direction.clone(),
        1 => direction.prop_map(|n| -n),
    ];
    let radius = prop_oneof![1 => Just(0.5_f32), 3 => 0.01_f32..1.0, 1 => 1e-6_f32..1e-3];
    let color = [0.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0].prop_map(Vec3::from_array);
    let surfel = (position, normal, radius, color, 0.0_f32..=1.0, 0.1_f32..3.0, -0.5_f32..0.5);
    (prop::collection::vec(surfel, 1..150), any::<[bool; 3]>()).prop_map(|(all, has)| {
        let mut cloud = Cloud::default();
        let (mut normal, mut color, mut opacity, mut tangents) = (vec![], vec![], vec![], vec![]);
        let mut radius = vec![];
        for (p, n, r, c, o, aspect, skew) in all {
            let n = n.normalize();
            let [u, v] = half_axes(n, r);
            cloud.position.push(p);
            normal.push(n);
            radius.push(r);
            color.push(c);
            opacity.push(o);
            tangents.push([u, v * aspect + u * skew]);
        }
        let (normal, radius) = (Some(normal), Some(radius));
        let (color, opacity) = (has[0].then_some(color), has[1].then_some(opacity));
        let tangents = has[2].then_some(tangents);
        made(Cloud { normal, radius, color, opacity, tangents, ..cloud })
    })
}

fn any_scale() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(f64::INFINITY), 6 => (-8.0..16.0_f64).prop_map(exp2)]
}

/// A number between powers of two.
fn exp2(exponent: f64) -> f64 {
    let whole = exponent.floor();
    let power = (0..whole.abs() as u32).fold(1.0, |power, _| power * 2.0);
    (if whole < 0.0 { 1.0 / power } else { power }) * (1.0 + exponent - whole)
}

/// The children of each node.
fn children(tree: &Sequential) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); tree.near().len()];
    for node in 0..children.len() {
        if let Some(parent) = tree.parent(node) {
            children[parent].push(node);
        }
    }
    children
}

/// The nodes from each leaf to the root.
fn paths(tree: &Sequential) -> impl Iterator<Item = Vec<usize>> {
    let leaves = (0..tree.near().len()).filter(|&node| tree.surfel(node).is_some());
    leaves.map(|leaf| std::iter::successors(Some(leaf), |&node| tree.parent(node)).collect())
}

/// The cut, from the root down.
fn recursive(
    tree: &Sequential,
    children: &[Vec<usize>],
    node: usize,
    is_good: &dyn Fn(usize) -> bool,
    to: &mut Vec<usize>,
) {
    if tree.surfel(node).is_some() || is_good(node) {
        to.push(node);
    } else {
        children[node].iter().for_each(|&child| recursive(tree, children, child, is_good, to));
    }
}

fn distances(nodes: &Surfels, eye: DVec3) -> Vec<f64> {
    nodes.position().iter().map(|p| (p.as_dvec3() - eye).length()).collect()
}

proptest! {
    #[test]
    fn one_distance_takes_one_node_of_each_path(
        surfels in any_surfels(), scale in any_scale(), distance in 0.0..100.0_f64,
    ) {
        let ((_, tree), count) = (built(&surfels), surfels.len());
        let all = tree.near().len();
        let taken: Vec<usize> = (0..all).filter(|&i| tree.cuts(i, distance, scale)).collect();
        let prefix = tree.prefix(distance, scale);
        prop_assert!(taken.iter().all(|&i| i < prefix));
        for path in paths(&tree) {
            prop_assert_eq!(path.iter().filter(|i| taken.contains(i)).count(), 1);
        }
        let mut expected = Vec::new();
        let is_good = |i: usize| f64::from(tree.near()[i]) * scale <= distance;
        recursive(&tree, &children(&tree), 0, &is_good, &mut expected);
        expected.sort_unstable();
        prop_assert_eq!(&taken, &expected);
        if scale == f64::INFINITY {
            prop_assert!(taken.len() == count && taken.iter().all(|&i| tree.surfel(i).is_some()));
        }
        if scale == 0.0 {
            prop_assert_eq!(taken, [0]);
        }
    }

    #[test]
    fn distances_of_their_own_leave_no_hole(
        surfels in any_surfels(), scale in any_scale(), close in any::<bool>(),
        eye in prop::array::uniform3(-20.0..20.0_f64),
        off in prop::collection::vec(-1.0..1.0_f64, 16),
    ) {
        let (nodes, tree) = built(&surfels);
        let eye = DVec3::from(eye) * if close { 0.1 } else { 1.0 };
        let mut distances = distances(&nodes, eye);
        // Wrong by up to 2^-22 of themselves, as the distances of a less precise number type are.
        for (distance, off) in distances.iter_mut().zip(off.iter().cycle()) {
            *distance *= 1.0 + off / 4_194_304.0;
        }
        let least = distances.iter().copied().fold(f64::INFINITY, Real::at_most);
        let all = 0..tree.near().len();
        let taken: Vec<usize> =
            all.clone().filter(|&i| tree.holds(i, distances[i], scale)).collect();
        let prefix = tree.prefix(least, scale);
        if scale > 0.0 && scale < f64::INFINITY {
            for first in all.clone().step_by(64) {
                let own = first..all.end.min(first + 64);
                let word = tree.holding(own.clone(), nodes.position(), eye, scale);
                let centres = nodes.position().iter().map(|p| (p.as_dvec3() - eye).length());
                for (i, distance) in own.zip(centres.skip(first)) {
                    let drawn = word >> (i - first) & 1 != 0;
                    prop_assert_eq!(drawn, tree.holds(i, distance, scale));
                }
            }
        }
        prop_assert!(taken.iter().all(|&i| i < prefix));
        for path in paths(&tree) {
            prop_assert!(path.iter().any(|i| taken.contains(i)));
        }
        let mut expected = Vec::new();
        let is_good = |i: usize| f64::from(tree.near()[i]) * scale <= distances[i];
        recursive(&tree, &children(&tree), 0, &is_good, &mut expected);
        prop_assert!(expected.iter().all(|i| taken.contains(i)));
    }

    #[test]
    fn where_parent_and_child_nearly_miss_each_other_there_is_no_hole(
        surfels in any_surfels(), node in any::<prop::sample::Index>(), away in 1.0..1e4_f64,
        sooner in 0.0..1e-6_f64,
    ) {
        let (nodes, tree) = built(&surfels);
        let node = node.index(tree.near().len());
        let Some(parent) = tree.parent(node) else { return Ok(()) };
        let [p, q] = [parent, node].map(|i| nodes.position()[i].as_dvec3());
        prop_assume!((p - q).length() > 0.0);
        // The eye is on the line of both centres behind the parent's centre, and the parent is just
        // not good enough; distances are as wrong as they may be.
        let mut distances = distances(&nodes, p + (p - q).normalize() * away);
        for (i, distance) in distances.iter_mut().enumerate() {
            *distance *= 1.0 + if i == node { 1.0 } else { -1.0 } / 4_194_304.0;
        }
        let scale = distances[parent] * (1.0 + sooner * sooner) / f64::from(tree.near()[parent]);
        for path in paths(&tree) {
            prop_assert!(path.iter().any(|&i| tree.holds(i, distances[i], scale)));
        }
    }

    #[test]
    fn the_list_is_the_tree(surfels in any_surfels(), most in 0.0_f32..1.0) {
        for most in [most, f32::INFINITY] {
            let (nodes, tree) = Sequential::with_color(&surfels, most, &Exec::sequential()).unwrap();
            let (expected, surfel, parent) = naive::list(&surfels, most);
            let all = 0..tree.near().len();
            prop_assert_eq!(all.clone().map(|i| tree.surfel(i)).collect::<Vec<_>>(), surfel);
            prop_assert_eq!(all.map(|i| tree.parent(i)).collect::<Vec<_>>(), parent);
            prop_assert_eq!((tree.near(), tree.far()), (&expected.near[..], &expected.far[..]));
            prop_assert_eq!(tree.gap(), &expected.gap[..]);
            prop_assert_eq!(nodes, made(expected.cloud));
        }
    }

    #[test]
    fn discs_enclose_their_children_and_errors_grow(surfels in any_surfels()) {
        let (nodes, tree) = built(&surfels);
        let mut leaves: Vec<u32> = (0..nodes.len()).filter_map(|i| tree.surfel(i)).collect();
        leaves.sort_unstable();
        prop_assert_eq!(leaves, (0..surfels.len() as u32).collect::<Vec<_>>());
        let n = surfels.len();
        prop_assert!(nodes.len() < 2 * n, "{} of {}", nodes.len(), n);
        let band = |far: &f32| far.to_bits() >> 21;
        prop_assert!(tree.far().is_sorted_by(|a, b| band(a) >= band(b)));
        for i in 0..nodes.len() {
            if let Some(surfel) = tree.surfel(i) {
                let own = surfels.some(&[u64::from(surfel)], &Exec::sequential());
                let kept = nodes.some(&[i as u64], &Exec::sequential());
                prop_assert!(own.are_equal(0, 0) && tree.near()[i] == 0.0);
                prop_assert_eq!((own.position(), own.normal()), (kept.position(), kept.normal()));
                prop_assert_eq!((own.radius(), own.tangents()), (kept.radius(), kept.tangents()));
                prop_assert_eq!((own.color(), own.opacity()), (kept.color(), kept.opacity()));
            }
            let Some(parent) = tree.parent(i) else { continue };
            prop_assert!(parent < i && tree.near()[parent] > 0.0);
            prop_assert!(tree.near()[i] <= tree.near()[parent]);
            prop_assert_eq!(tree.far()[i], tree.near()[parent]);
            let [p, q] = [parent, i].map(|i| nodes.position()[i].as_dvec3());
            let reach = match nodes.tangents() {
                Some(tangents) if tree.surfel(i).is_some() => {
                    // The longest of many directions is at most a little shorter than the half
                    // axis.
                    let [u, v] = tangents[i].map(Vec3::as_dvec3);
                    let at = |k: i32| {
                        let (x, y) = (f64::from(16 - k.abs()), f64::from(k));
                        (u * x + v * y).length() / (x * x + y * y).sqrt()
                    };
                    (-16..=16).map(at).fold(0.0, larger)
                }
                _ => f64::from(nodes.radius()[i]),
            };
            let radius = f64::from(nodes.radius()[parent]);
            prop_assert!((p - q).length() + reach <= radius * (1.0 + 1e-15));
            prop_assert!((p - q).length() <= f64::from(tree.gap()[i]));
        }
    }

    #[test]
    fn extremes_make_a_tree_or_one_clear_error(points in points(), radius in 1e-45_f32..1e3) {
        let n = points.len();
        let (normal, radius) = (Some(vec![Vec3::Y; n]), Some(vec![radius; n]));
        let surfels = made(Cloud { position: points, normal, radius, ..Cloud::default() });
        match Sequential::new(&surfels, &Exec::sequential()) {
            Ok((_, tree)) => {
                let taken = (0..tree.near().len()).filter(|&i| tree.cuts(i, 1e30, f64::INFINITY));
                prop_assert_eq!(taken.count(), n);
            }
            Err(error) => prop_assert!(error.to_string().contains("range of f32"), "{}", error),
        }
    }
}

/// Surfels of a sphere or of a square of side 2, at places of a low-discrepancy sequence.
fn sampled(count: usize, on_sphere: bool) -> Surfels {
    let (mut position, mut normal) = (Vec::new(), Vec::new());
    for i in 0..count as u64 {
        let [x, y] = [1, 2].map(|seed| 2.0 * unit(seed, i) - 1.0);
        let rest = 1.0 - x * x - y * y;
        let z =
            if on_sphere { rest.abs().sqrt() * if i % 2 == 0 { 1.0 } else { -1.0 } } else { 0.0 };
        let p = Vec3::new(x, y, z);
        position.push(if on_sphere { p.normalize() } else { p });
        normal.push(if on_sphere { p.normalize() } else { Vec3::Z });
    }
    let radius = Some(vec![2.0 / (count as f32).sqrt(); count]);
    made(Cloud { position, normal: Some(normal), radius, ..Cloud::default() })
}

/// How many nodes are drawn at a distance.
fn drawn(tree: &Sequential, distance: f64, scale: f64) -> usize {
    (0..tree.near().len()).filter(|&i| tree.cuts(i, distance, scale)).count()
}

#[test]
fn neither_threads_nor_jobs_leave_a_trace() {
    let surfels = sampled(40_000, true);
    let built = built(&surfels);
    for threads in [2, 5] {
        let exec = Exec::new(threads, 8).unwrap();
        assert_eq!(built, Sequential::new(&surfels, &exec).unwrap());
    }
    let (_, tree) = built;
    let counts = [1.0, 4.0, 16.0, 64.0, 1e9].map(|distance| drawn(&tree, distance, 500.0));
    assert!(counts.is_sorted_by(|a, b| a > b) && counts[4] == 1, "{counts:?}");
    let prefixes = [0.0, 4.0, 64.0].map(|distance| tree.prefix(distance, 500.0));
    assert!(prefixes[0] == tree.near().len() && prefixes[1] > prefixes[2], "{prefixes:?}");
}

#[test]
fn a_plane_has_tangential_errors_alone() {
    let side = 16;
    let place = |i: usize| Vec3::new((i % side) as f32, (i / side) as f32, 3.0);
    let position: Vec<Vec3> = (0..side * side).map(place).collect();
    let n = position.len();
    let (normal, radius) = (Some(vec![Vec3::Z; n]), Some(vec![0.75; n]));
    let (nodes, tree) = built(&made(Cloud { position, normal, radius, ..Cloud::default() }));
    assert_eq!(tree.near().len(), n + n / 3, "4^4 leaves, 4^3 + 4^2 + 4 + 1 inner nodes");
    for (i, (&near, &radius)) in tree.near().iter().zip(nodes.radius()).enumerate() {
        let mut leaves = paths(&tree).filter(|path| path.contains(&i));
        let first = leaves.next().map_or(0, |path| path.len());
        let count = 1 + leaves.filter(|path| path.len() == first).count();
        let width = (count as f64).sqrt() - 1.0 + 1.5;
        let radius = f64::from(radius);
        let expected = if count == 1 { 0.0 } else { 2.0 * radius - width };
        assert!((f64::from(near) - expected).abs() < 1e-5, "{near} {expected}");
    }
}

#[test]
fn a_colour_that_differs_keeps_a_plane_from_collapsing() {
    let mut cloud = sampled(1000, false).into_cloud();
    let red = |p: &Vec3| Vec3::new(if p.x > 0.0 { 1.0 } else { 0.5 }, 0.0, 0.0);
    cloud.color = Some(cloud.position.iter().map(red).collect());
    let surfels = made(cloud);
    let of = |most| Sequential::with_color(&surfels, most, &Exec::sequential()).unwrap();
    let counts = [f32::INFINITY, 0.5, 0.1].map(|most| drawn(&of(most).1, 2.0, 4.0));
    assert!(counts[0] == counts[1] && counts[0] < counts[2] && counts[2] < 1000, "{counts:?}");
    let (nodes, tree) = of(0.1);
    assert!(tree.near()[0] >= 2.0 * nodes.radius()[0]);
}

#[test]
fn coincident_surfels_are_one_but_at_a_threshold_of_zero() {
    for n in [1, 2, 3, 5, 1000] {
        // A normal that is a little too long makes the extents larger than the disc: no error is
        // left.
        let long = Vec3::X * (1.0 + 1.0 / 2_097_152.0);
        let (normal, radius) = (Some(vec![long; n]), Some(vec![0.5; n]));
        let position = vec![Vec3::new(0.1, 0.7, -3.3); n];
        let (nodes, tree) = built(&made(Cloud { position, normal, radius, ..Cloud::default() }));
        assert_eq!(drawn(&tree, 0.01, 1e3), 1, "{n}");
        assert_eq!(drawn(&tree, 0.01, f64::INFINITY), n);
        assert_eq!(nodes.position()[0], Vec3::new(0.1, 0.7, -3.3));
    }
}

#[test]
fn normals_that_cancel_are_those_of_the_largest_child() {
    let root = |normals: [Vec3; 2], radii: [f32; 2]| {
        let position = vec![Vec3::ZERO, 0.1 * Vec3::Z];
        let (normal, radius) = (Some(normals.to_vec()), Some(radii.to_vec()));
        built(&made(Cloud { position, normal, radius, ..Cloud::default() })).0.normal()[0]
    };
    assert_eq!(root([Vec3::Z, -Vec3::Z], [1.0, 1.0]), Vec3::Z);
    assert_eq!(root([-Vec3::Z, Vec3::Z], [1.0, 1.0]), -Vec3::Z);
    assert_eq!(root([Vec3::Z, -Vec3::Z], [1.0, 1.000_001]), -Vec3::Z);
    assert_eq!(root([Vec3::Z, -Vec3::Z], [2.0, 1.0]), Vec3::Z);
}

#[test]
fn of_nothing_it_is_the_empty_list() {
    let (nodes, tree) = built(&Surfels::none());
    assert!(nodes.is_empty() && tree.prefix(0.0, 1.0) == 0);
}
