//! The list built from the module page alone: sorted sets, sums and maxima, with no shared code.

use super::{exp2, half_axes};
use crate::scene::{Cloud, Surfels};
use glam::{DVec3, Vec3};

/// Fields of all nodes.
#[derive(Default)]
pub(super) struct List {
    pub(super) cloud: Cloud,
    pub(super) near: Vec<f32>,
    pub(super) far: Vec<f32>,
    pub(super) gap: Vec<f32>,
}

/// One node in the order of the tree.
struct Node {
    surfel: Option<u32>,
    parent: Option<usize>,
    p: Vec3,
    n: Vec3,
    radius: f32,
    color: Vec3,
    opacity: f32,
    tangents: [Vec3; 2],
    near: f32,
    far: f32,
    gap: f32,
    /// W, and the sums of w times position, normal, colour and opacity.
    sums: [f64; 11],
    /// The radius, or the longer half axis.
    reach: f64,
}

pub(super) fn list(surfels: &Surfels, most: f32) -> (List, Vec<Option<u32>>, Vec<Option<usize>>) {
    let mut nodes = Vec::new();
    tree(surfels, most, (0..surfels.len()).collect(), &mut nodes);
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    // All values of a band, from its lowest on, in powers of two and quarters of them.
    let band = |far: f32| match far {
        f32::INFINITY => (i32::MAX, 0),
        _ => {
            let power = |e: i32| exp2(f64::from(e));
            let exponent = (-126..128).rev().find(|&e| f64::from(far) >= power(e)).unwrap_or(-126);
            (exponent, (f64::from(far) / power(exponent) * 4.0).floor() as i32)
        }
    };
    order.sort_by_cached_key(|&node| std::cmp::Reverse(band(nodes[node].far)));
    let place = |node: usize| order.iter().position(|&other| other == node).unwrap();
    let sorted: Vec<&Node> = order.iter().map(|&node| &nodes[node]).collect();
    fn of<T>(sorted: &[&Node], field: impl Fn(&Node) -> T) -> Vec<T> {
        sorted.iter().map(|node| field(node)).collect()
    }
    let cloud = Cloud {
        position: of(&sorted, |node| node.p),
        normal: Some(of(&sorted, |node| node.n)),
        radius: Some(of(&sorted, |node| node.radius)),
        color: surfels.color().map(|_| of(&sorted, |node| node.color)),
        opacity: surfels.opacity().map(|_| of(&sorted, |node| node.opacity)),
        tangents: surfels.tangents().map(|_| of(&sorted, |node| node.tangents)),
        ..Cloud::default()
    };
    let [near, far] = [of(&sorted, |node| node.near), of(&sorted, |node| node.far)];
    let list = List { cloud, near, far, gap: of(&sorted, |node| node.gap) };
    let parent = of(&sorted, |node| node.parent.map(place));
    (list, of(&sorted, |node| node.surfel), parent)
}

fn tree(surfels: &Surfels, most: f32, set: Vec<usize>, nodes: &mut Vec<Node>) {
    let at = nodes.len();
    nodes.push(leaf(surfels, set[0]));
    if set.len() == 1 {
        return;
    }
    let mut children = Vec::new();
    for half in halves(surfels, set.clone()) {
        let parts = if half.len() == 1 { vec![half] } else { halves(surfels, half).into() };
        for part in parts {
            children.push(nodes.len());
            tree(surfels, most, part, nodes);
        }
    }
    let mut own = inner(surfels, &children, nodes);
    own.near = error(surfels, most, &set, &own);
    for &child in &children {
        own.near = if nodes[child].near > own.near { nodes[child].near } else { own.near };
    }
    for child in children {
        let child = &mut nodes[child];
        (child.parent, child.far) = (Some(at), own.near);
        let gap = length(child.p.as_dvec3() - own.p.as_dvec3());
        child.gap = least_above(gap * (1.0 + (0.5_f64 / 16_777_216.0) / 8_388_608.0));
    }
    nodes[at] = own;
}

fn halves(surfels: &Surfels, mut set: Vec<usize>) -> [Vec<usize>; 2] {
    let at = |i: usize, axis: usize| f64::from(surfels.position()[i][axis]);
    let extent = |axis| {
        let mut all: Vec<f64> = set.iter().map(|&i| at(i, axis)).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all[all.len() - 1] - all[0]
    };
    let extents = [0, 1, 2].map(extent);
    let axis = (0..3).find(|&axis| extents.iter().all(|&other| other <= extents[axis])).unwrap();
    set.sort_by(|&a, &b| (at(a, axis), a).partial_cmp(&(at(b, axis), b)).unwrap());
    let high = set.split_off(set.len() / 2);
    [set, high]
}

fn leaf(surfels: &Surfels, i: usize) -> Node {
    let (p, n, radius) = (surfels.position()[i], surfels.normal()[i], surfels.radius()[i]);
    let color = surfels.color().map_or(Vec3::ZERO, |color| color[i]);
    let opacity = surfels.opacity().map_or(0.0, |opacity| opacity[i]);
    let r = f64::from(radius);
    let (mut reach, mut w, mut tangents) = (r, r * r, [Vec3::ZERO; 2]);
    if let Some(all) = surfels.tangents() {
        tangents = all[i];
        let [u, v] = tangents.map(Vec3::as_dvec3);
        let (a, b, g) = (dot(u, u), dot(v, v), dot(u, v));
        reach = (((a + b) + ((a - b) * (a - b) + (4.0 * g) * g).sqrt()) / 2.0).sqrt();
        w = length(u.cross(v));
    }
    let values = [p, n, color].map(Vec3::as_dvec3);
    let mut sums = [w; 11];
    for (k, value) in values.iter().flat_map(|v| v.to_array()).enumerate() {
        sums[k + 1] = w * value;
    }
    sums[10] = w * f64::from(opacity);
    let (near, far, gap, surfel) = (0.0, f32::INFINITY, 0.0, Some(i as u32));
    let parent = None;
    Node { surfel, parent, p, n, radius, color, opacity, tangents, near, far, gap, sums, reach }
}

fn inner(surfels: &Surfels, children: &[usize], nodes: &[Node]) -> Node {
    let mut sums = nodes[children[0]].sums;
    for &child in &children[1..] {
        for (sum, more) in sums.iter_mut().zip(nodes[child].sums) {
            *sum += more;
        }
    }
    let mean = |k: usize| Vec3::from_array([k, k + 1, k + 2].map(|k| (sums[k] / sums[0]) as f32));
    let p = mean(1);
    let sum = DVec3::new(sums[4], sums[5], sums[6]);
    let n = if length(sum) < sums[0] / 65_536.0 {
        let most =
            children.iter().map(|&c| nodes[c].sums[0]).fold(0.0, |a, b| if b > a { b } else { a });
        nodes[*children.iter().find(|&&c| nodes[c].sums[0] == most).unwrap()].n
    } else {
        Vec3::from_array(sum.to_array().map(|v| (v / length(sum)) as f32))
    };
    let reaches = children
        .iter()
        .map(|&child| length(nodes[child].p.as_dvec3() - p.as_dvec3()) + nodes[child].reach);
    let reach = reaches.fold(0.0, |a, b| if b > a { b } else { a });
    let radius = least_above(reach * (1.0 + (0.5_f64 / 16_777_216.0) / 8_388_608.0));
    let has_tangents = surfels.tangents().is_some();
    Node {
        surfel: None,
        parent: None,
        p,
        n,
        radius,
        color: mean(7),
        opacity: (sums[10] / sums[0]) as f32,
        tangents: if has_tangents { half_axes(n, radius) } else { [Vec3::ZERO; 2] },
        near: 0.0,
        far: f32::INFINITY,
        gap: 0.0,
        sums,
        reach: f64::from(radius),
    }
}

fn error(surfels: &Surfels, most: f32, set: &[usize], own: &Node) -> f32 {
    let [u, v] = half_axes(own.n, 1.0).map(Vec3::as_dvec3);
    let h = 0.5_f64.sqrt();
    let extent = |d: DVec3| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &i in set {
            let middle = dot(surfels.position()[i].as_dvec3() - own.p.as_dvec3(), d);
            let half = match surfels.tangents() {
                Some(tangents) => {
                    let [a, b] = tangents[i].map(|half| dot(half.as_dvec3(), d));
                    (a * a + b * b).sqrt()
                }
                None => {
                    let cross = surfels.normal()[i].as_dvec3().cross(d);
                    f64::from(surfels.radius()[i]) * length(cross)
                }
            };
            low = if middle - half < low { middle - half } else { low };
            high = if middle + half > high { middle + half } else { high };
        }
        high - low
    };
    let mut least = f64::INFINITY;
    for d in [u, v, (u + v) * h, (u - v) * h] {
        least = if extent(d) < least { extent(d) } else { least };
    }
    let both = 2.0 * f64::from(own.radius);
    let tangential = if both - least > 0.0 { both - least } else { 0.0 };
    let perpendicular = extent(own.n.as_dvec3());
    let mut e = (perpendicular * perpendicular + tangential * tangential).sqrt();
    let differs = |i: usize| {
        let own = own.color.as_dvec3();
        let color = surfels.color().map_or(own, |color| color[i].as_dvec3());
        (color - own).to_array().iter().any(|by| by.abs() > f64::from(most))
    };
    if set.iter().any(|&i| differs(i)) && both > e {
        e = both;
    }
    let least = f32::from_bits(1);
    if least_above(e) > least { least_above(e) } else { least }
}

fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}

fn length(v: DVec3) -> f64 {
    dot(v, v).sqrt()
}

fn least_above(value: f64) -> f32 {
    let mut rounded = value as f32;
    while f64::from(rounded) < value {
        rounded = rounded.next_up();
    }
    rounded
}
