//! Count the flaws of a mesh. They are reported, not repaired.
//!
//! Corners are compared by place: two vertices at one place (-0 = +0) count as one. The counts are
//! over triangles of checked vertices, without the triangles that were dropped before:
//!
//! - *degenerate*: two corners at one place, or all three on a line: each component of (b - a) x (c - a) is 0 in f64.
//! - *duplicate*: the three places, in any order, are the places of an earlier triangle.
//! - *edges of many*: edges that belong to more than two triangles that are not degenerate. An edge
//!   is a pair of different places. A mesh with such edges is no manifold.
//!
//! A triangle may be both degenerate and a duplicate.

use crate::number::MapInline;
use crate::scene::Triangles;
use glam::Vec3;

/// How many flaws of each kind there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Triangles that are left out, because a corner, its normal or its colour is invalid.
    pub dropped: u64,
    /// Triangles without an area.
    pub degenerate: u64,
    /// Triangles that repeat an earlier one.
    pub duplicate: u64,
    /// Edges of more than two triangles.
    pub edges_of_many: u64,
}

impl Flaws {
    /// Counts the flaws of these triangles; `dropped` were dropped before.
    #[must_use]
    pub fn find(triangles: &Triangles, dropped: u64) -> Self {
        let position = &triangles.vertices().position;
        let place = places(position);
        let mut flaws = Self { dropped, ..Self::default() };
        let mut all = Vec::with_capacity(triangles.len());
        let mut edges = Vec::with_capacity(3 * triangles.len());
        for corners in triangles.corners() {
            let mut at = corners.map_inline(|corner| place[corner as usize]);
            at.sort_unstable();
            all.push(at);
            if is_degenerate(corners.map_inline(|corner| position[corner as usize])) {
                flaws.degenerate += 1;
            } else {
                edges.extend([[at[0], at[1]], [at[0], at[2]], [at[1], at[2]]]);
            }
        }
        all.sort_unstable();
        flaws.duplicate = all.windows(2).filter(|pair| pair[0] == pair[1]).count() as u64;
        edges.sort_unstable();
        let many = edges.chunk_by(|a, b| a == b).filter(|run| run.len() > 2);
        flaws.edges_of_many = many.count() as u64;
        flaws
    }

    /// The sum of both counts.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            dropped: self.dropped + other.dropped,
            degenerate: self.degenerate + other.degenerate,
            duplicate: self.duplicate + other.duplicate,
            edges_of_many: self.edges_of_many + other.edges_of_many,
        }
    }
}

/// For each vertex, the first vertex at its place.
fn places(position: &[Vec3]) -> Vec<u32> {
    let key = |i: u32| (position[i as usize] + Vec3::ZERO).to_array().map_inline(f32::to_bits);
    let mut order: Vec<u32> = (0..position.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut place = vec![0; position.len()];
    let mut first = 0;
    for (rank, &i) in order.iter().enumerate() {
        if rank == 0 || key(i) != key(order[rank - 1]) {
            first = i;
        }
        place[i as usize] = first;
    }
    place
}

/// Whether a triangle has no area.
fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let (u, v) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    let zero = |x: f64, y: f64| x - y == 0.0;
    zero(u.y * v.z, v.y * u.z) && zero(u.z * v.x, v.z * u.x) && zero(u.x * v.y, v.x * u.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Vertices;

    #[test]
    fn each_kind_is_counted() {
        // A unit square with a fin on its diagonal; vertex 6 is where vertex 0 is.
        let position = vec![
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::Y,
            Vec3::new(0.5, 0.5, 1.0),
            Vec3::new(2.0, 2.0, 0.0),
            Vec3::new(-0.0, 0.0, -0.0),
        ];
        let n = position.len();
        let (direction, radius) = (vec![Vec3::Z; n], vec![0.0; n]);
        let vertices = Vertices { position, direction, radius, color: None, ..Vertices::default() };
        let flaws = |corners: &[[u32; 3]]| {
            let (triangles, dropped) = Triangles::new(vertices.clone(), corners.to_vec()).unwrap();
            Flaws::find(&triangles, dropped)
        };
        let square = [[0, 1, 2], [6, 2, 3]];
        assert_eq!(flaws(&square), Flaws::default());
        let fin = Flaws { edges_of_many: 1, ..Flaws::default() };
        assert_eq!(flaws(&[square[0], square[1], [0, 2, 4]]), fin);
        let twice = flaws(&[square[0], square[1], [2, 1, 6], [1, 2, 0]]);
        assert_eq!((twice.duplicate, twice.edges_of_many), (2, 3));
        // On a line; two corners at one place; one corner three times.
        let flat = flaws(&[square[0], [0, 2, 5], [0, 6, 3], [4, 4, 4]]);
        assert_eq!(flat, Flaws { degenerate: 3, ..Flaws::default() });
        assert_eq!(flaws(&[]), Flaws::default());
    }
}
