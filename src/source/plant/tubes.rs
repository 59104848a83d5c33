//! Convert branches to tubes.

use super::parts::Parts;
use super::{Rest, lines, mean, unit};
use crate::error::Result;
use crate::number::MapInline;
use crate::scene::{Polylines, Triangles, Vertices};
use glam::DVec3;

/// The layer of vertices that no path reaches from an open end.
const NOWHERE: u32 = u32::MAX;

/// Converts branches, which are rows of rings joined by triangles, to tubes with one vertex for
/// each ring \[MKC08, section 4.3, figure 12b\]. Also returns the triangles that are not converted.
///
/// **Which vertices form a ring.** `Decided:` ("we heuristically determined clusters") connectivity
/// alone decides. Neither the number of vertices in a ring, nor the shape of triangles, nor any
/// order matters. An edge joins two corners of a triangle. Two vertices are the same if their index
/// is the same.
///
/// 1. The open ends of a connected part are its boundaries: the connected parts of its edges that
///    have only one triangle. The **root** is the boundary with the longest edge. A tie goes to the
///    boundary that holds the lowest of the longest edges (by its lower vertex, then the other).
/// 2. The **layer** of a vertex is the least number of edges to it from a vertex of the root. A
///    vertex of a ring has an edge to the ring before, and none to an earlier one, so that rings
///    are layers, one after the other.
/// 3. Connected vertices of one layer are a **cluster**: after a fork there are several in a layer.
/// 4. A cluster is a ring if it has at least three vertices, each with exactly two neighbours in
///    it. A vertex that is alone in its cluster, which closes a branch in a point, is a ring too. A
///    ring that no edge joins to another does not count.
///
/// These triangles are not converted:
///
/// - a part without a boundary, because it has no root and no rings;
/// - closed ends of more than three sides without a vertex in their middle;
/// - the few triangles in the crotch of a fork that is one mesh.
///
/// **The tubes.** Two rings with an edge between them are joined by a segment, which begins at the
/// layer nearer to the root. So segments run from root to tip, and all segments of a branch agree.
/// A ring becomes a vertex, all in f64, and each number rounded once:
///
/// - position: the sum of its vertices in ascending index, divided by their number; colour
///   likewise;
/// - radius: the largest distance from a vertex of the ring to that position, after rounding;
/// - tangent: the sum, divided by its length, of the unit vectors along all segments at this ring
///   in ascending order, between positions after rounding. Segments shorter than 2^-80 add nothing.
///   `Decided:` if they cancel, so that the sum is shorter than 2^-80, the tangent is +y.
///
/// Rings are in ascending order of their lowest vertex. Segments are in ascending order of their
/// rings, with the ring nearer to the root first.
///
/// A triangle is converted if its corners belong to rings.
///
/// # Errors
/// [`crate::Error::Invalid`] if a radius does not fit into `f32`.
pub fn tubes(bark: &Triangles) -> Result<(Polylines, Rest)> {
    let from = bark.vertices();
    let edges = edges(bark);
    let layers = layers(bark, &edges);
    let (ring_of, segments) = rings(&edges, &layers);

    // The vertices of each ring, in ascending order.
    let mut members: Vec<(u32, u32)> =
        (0..).zip(&ring_of).filter_map(|(i, &ring)| ring.map(|ring| (ring, i))).collect();
    members.sort_unstable();
    let mut to = Vertices { color: from.color.as_ref().map(|_| Vec::new()), ..Vertices::default() };
    for ring in members.chunk_by(|a, b| a.0 == b.0) {
        let places = ring.iter().map(|&(_, i)| from.position[i as usize]);
        let center = mean(places.clone());
        let distances = places.map(|p| p.as_dvec3().distance(center.as_dvec3()));
        to.position.push(center);
        to.radius.push(distances.fold(0.0, |most, d| if d > most { d } else { most }) as f32);
        if let (Some(to), Some(from)) = (&mut to.color, &from.color) {
            to.push(mean(ring.iter().map(|&(_, i)| from[i as usize])));
        }
    }
    let mut sums = vec![DVec3::ZERO; to.position.len()];
    for ends in &segments {
        let [a, b] = ends.map_inline(|ring| to.position[ring as usize].as_dvec3());
        for ring in ends {
            sums[*ring as usize] += unit(b - a).unwrap_or(DVec3::ZERO);
        }
    }
    to.direction = sums.into_iter().map(|sum| unit(sum).unwrap_or(DVec3::Y).as_vec3()).collect();

    let in_rings = |triangle: &&[u32; 3]| triangle.iter().all(|&i| ring_of[i as usize].is_some());
    let rest = bark.corners().iter().filter(|triangle| !in_rings(triangle)).copied().collect();
    Ok((lines(to, segments)?, rest))
}

/// Every edge once, the lower vertex first, in ascending order, and whether it belongs to only one
/// triangle.
fn edges(mesh: &Triangles) -> Vec<([u32; 2], bool)> {
    let sides = mesh.corners().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<_> =
        sides.filter(|[a, b]| a != b).map(|[a, b]| if a < b { [a, b] } else { [b, a] }).collect();
    sides.sort_unstable();
    sides.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() == 1)).collect()
}

/// The layer of every vertex, see [`tubes`].
fn layers(mesh: &Triangles, edges: &[([u32; 2], bool)]) -> Vec<u32> {
    let position = &mesh.vertices().position;
    let n = position.len();
    let (mut parts, mut boundaries) = (Parts::new(n), Parts::new(n));
    for &([a, b], boundary) in edges {
        parts.join(a, b);
        if boundary {
            boundaries.join(a, b);
        }
    }
    // For each part, the longest edge of a boundary, by its squared length, and that boundary.
    let mut longest: Vec<Option<(f64, u32)>> = vec![None; n];
    for &([a, b], _) in edges.iter().filter(|edge| edge.1) {
        let [p, q] = [a, b].map_inline(|i| position[i as usize].as_dvec3());
        let (length, longest) = (p.distance_squared(q), &mut longest[parts.find(a) as usize]);
        if longest.is_none_or(|(most, _)| length > most) {
            *longest = Some((length, boundaries.find(a)));
        }
    }
    // The neighbours of vertex i are in the range from first[i] to first[i + 1].
    let mut both: Vec<[u32; 2]> = edges.iter().flat_map(|&([a, b], _)| [[a, b], [b, a]]).collect();
    both.sort_unstable();
    let first: Vec<usize> =
        (0..=n).map(|i| both.partition_point(|e| (e[0] as usize) < i)).collect();

    let mut layer = vec![NOWHERE; n];
    let mut front = Vec::new();
    for i in 0..n as u32 {
        let root = longest[parts.find(i) as usize].map(|(_, root)| root);
        if root == Some(boundaries.find(i)) {
            layer[i as usize] = 0;
            front.push(i);
        }
    }
    for next in 1.. {
        let mut reached = Vec::new();
        for i in front {
            for &[_, j] in &both[first[i as usize]..first[i as usize + 1]] {
                if layer[j as usize] == NOWHERE {
                    layer[j as usize] = next;
                    reached.push(j);
                }
            }
        }
        if reached.is_empty() {
            break;
        }
        front = reached;
    }
    layer
}

/// The ring of every vertex, if it has one, and the segments between rings, see [`tubes`].
fn rings(edges: &[([u32; 2], bool)], layer: &[u32]) -> (Vec<Option<u32>>, Vec<[u32; 2]>) {
    let n = layer.len();
    let within = |[a, b]: [u32; 2]| layer[a as usize] == layer[b as usize];
    let mut clusters = Parts::new(n);
    let mut neighbours = vec![0_u32; n];
    for &(edge, _) in edges.iter().filter(|&&(edge, _)| within(edge)) {
        clusters.join(edge[0], edge[1]);
        for i in edge {
            neighbours[i as usize] += 1;
        }
    }
    let cluster: Vec<u32> = (0..n as u32).map(|i| clusters.find(i)).collect();
    let mut size = vec![0_u32; n];
    let mut round = vec![true; n];
    for (i, &root) in cluster.iter().enumerate() {
        size[root as usize] += 1;
        round[root as usize] &= layer[i] != NOWHERE && neighbours[i] == 2;
    }
    // A single vertex has no neighbours in its cluster.
    let is_ring = |root: u32| {
        let root = root as usize;
        round[root] || (size[root] == 1 && layer[root] != NOWHERE)
    };
    let mut segments: Vec<[u32; 2]> = edges
        .iter()
        .filter(|&&(edge, _)| !within(edge))
        .map(|&([a, b], _)| if layer[a as usize] < layer[b as usize] { [a, b] } else { [b, a] })
        .map(|edge| edge.map_inline(|i| cluster[i as usize]))
        .filter(|ends| ends.iter().all(|&root| is_ring(root)))
        .collect();
    segments.sort_unstable();
    segments.dedup();

    // Rings are numbered in the order of their roots, which are their lowest vertices.
    let mut number = vec![None; n];
    for &root in segments.as_flattened() {
        number[root as usize] = Some(0);
    }
    for (next, number) in (0..).zip(number.iter_mut().flatten()) {
        *number = next;
    }
    for segment in &mut segments {
        *segment = segment.map_inline(|root| number[root as usize].unwrap_or(NOWHERE));
    }
    (cluster.iter().map(|&root| number[root as usize]).collect(), segments)
}
