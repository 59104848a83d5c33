//! Convert leaves to ribbons.

use super::parts::Parts;
use super::{Rest, lines, mean, unit};
use crate::error::Result;
use crate::number::MapInline;
use crate::scene::{Polylines, Triangles, Vertices};
use glam::DVec3;

/// A leaf: its two ends and, between them, two pairs; the first pair is next to the first end.
#[derive(Debug, PartialEq)]
struct Leaf {
    ends: [u32; 2],
    pairs: [[u32; 2]; 2],
}

/// Converts leaves of four triangles and six vertices to ribbons of four vertices and three
/// segments \[MKC08, section 4.3, figure 12a\]. Also returns the triangles that belong to no such
/// leaf.
///
/// **What counts as a leaf.** A leaf is a connected part of the mesh that is a strip from end to
/// end through two pairs. Triangles that share a vertex are connected.
///
/// ```text
///             p0 ────── q0
///           ╱  │ ╲       │ ╲        end0:  in one triangle, with pair p
///      end0    │   ╲     │   end1   end1:  in one triangle, with pair q
///           ╲  │     ╲   │ ╱        between them two triangles over p0, p1, q0, q1,
///             p1 ────── q1          one that holds both p, and one that holds both q
/// ```
///
/// The diagonal of the middle, the sides that triangles face, and the order of vertices and
/// triangles do not matter. `Decided:` vertices are the same if their index is the same, whatever
/// their position. So leaves that grow from one point stay apart, and seams must be closed before.
///
/// **The ribbon.** In order end, pair, pair, end, starting with the end of the lower index:
///
/// - An end is a copy of its vertex with the radius 0. `Decided:` "a value close to zero"; with 0
///   the ribbon ends in a point, as the leaf does.
/// - A pair a, b becomes one vertex: the position (a + b) / 2, the normal the sum of the two
///   divided by its length, the radius |a - b| / 2, the colour the mean of the two, each in f64 and
///   rounded once. `Decided:` if normals cancel, so that the sum is shorter than 2^-80, the normal
///   is +y.
///
/// Ribbons are in ascending order of the lowest vertex of their leaf.
///
/// # Errors
/// [`crate::Error::Invalid`] if a half width does not fit into `f32`.
pub fn ribbons(leaves: &Triangles) -> Result<(Polylines, Rest)> {
    let from = leaves.vertices();
    let mut parts = Parts::new(from.position.len());
    for &[a, b, c] in leaves.corners() {
        parts.join(a, b);
        parts.join(b, c);
    }
    let mut by_part: Vec<_> = leaves.corners().iter().map(|t| (parts.find(t[0]), *t)).collect();
    by_part.sort_by_key(|&(part, _)| part);

    let mut to = Vertices { color: from.color.as_ref().map(|_| Vec::new()), ..Vertices::default() };
    let (mut segments, mut rest) = (Vec::new(), Vec::new());
    for part in by_part.chunk_by(|a, b| a.0 == b.0) {
        let triangles: Vec<_> = part.iter().map(|&(_, triangle)| triangle).collect();
        let Some(Leaf { ends, pairs }) = Leaf::new(&triangles) else {
            rest.extend(triangles);
            continue;
        };
        let first = to.position.len() as u32;
        segments.extend([0, 1, 2].map_inline(|i| [first + i, first + i + 1]));
        for of in [&ends[..1], &pairs[0], &pairs[1], &ends[1..]] {
            push(&mut to, from, of);
        }
    }
    Ok((lines(to, segments)?, rest))
}

/// The vertex of a ribbon for an end or for a pair.
fn push(to: &mut Vertices, from: &Vertices, of: &[u32]) {
    let places = of.iter().map(|&i| from.position[i as usize]);
    let normals = of.iter().map(|&i| from.direction[i as usize].as_dvec3());
    to.position.push(mean(places.clone()));
    to.direction.push(match of {
        &[end] => from.direction[end as usize],
        _ => unit(normals.sum()).unwrap_or(DVec3::Y).as_vec3(),
    });
    let [a, b] = [0, of.len() - 1].map_inline(|i| from.position[of[i] as usize].as_dvec3());
    to.radius.push((a.distance(b) / 2.0) as f32);
    if let (Some(to), Some(from)) = (&mut to.color, &from.color) {
        to.push(mean(of.iter().map(|&i| from[i as usize])));
    }
}

impl Leaf {
    /// Recognizes a leaf in these connected triangles.
    fn new(triangles: &[[u32; 3]]) -> Option<Self> {
        if triangles.len() != 4 || triangles.iter().any(|&[a, b, c]| a == b || b == c || c == a) {
            return None;
        }
        let mut corners = triangles.as_flattened().to_vec();
        corners.sort_unstable();
        let vertices: Vec<&[u32]> = corners.chunk_by(|a, b| a == b).collect();
        let ends: Vec<u32> = vertices.iter().filter(|v| v.len() == 1).map(|v| v[0]).collect();
        let &[first, last] = ends.as_slice() else { return None };
        let at = |end: u32| triangles.iter().position(|triangle| triangle.contains(&end));
        let at = [at(first)?, at(last)?];
        let pair = |i: usize, end: u32| {
            let [a, b, c] = triangles[i];
            if a == end {
                [b, c]
            } else if b == end {
                [c, a]
            } else {
                [a, b]
            }
        };
        let pairs = [pair(at[0], first), pair(at[1], last)];
        let has =
            |triangle: &[u32; 3], pair: usize| pairs[pair].iter().all(|v| triangle.contains(v));
        // The two triangles between the ends, each with one whole pair and half of the other.
        let middle: Vec<_> = (0..4).filter(|i| !at.contains(i)).map(|i| triangles[i]).collect();
        let &[x, y] = middle.as_slice() else { return None };
        let apart = vertices.len() == 6 && pairs[0].iter().all(|v| !pairs[1].contains(v));
        let strip = (has(&x, 0) && has(&y, 1)) || (has(&x, 1) && has(&y, 0));
        (apart && strip).then_some(Self { ends: [first, last], pairs })
    }
}
