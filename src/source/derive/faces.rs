//! Derive normals and radii of vertices from the triangles of a mesh.

use crate::number::MapInline;
use glam::{DVec3, Vec3};

/// Area-weighted vertex normals, of length 1.
///
/// See the arithmetic of [`super`]. Null if the vertex has no triangle, or if its triangles cancel.
pub(super) fn normals(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map_inline(|i| points[i as usize].as_dvec3());
        let twice_area = (b - a).cross(c - a);
        for &i in triangle {
            sums[i as usize] += twice_area;
        }
    }
    let unit = |sum: DVec3| {
        let length = sum.length();
        if length > 0.0 { (sum / length).as_vec3() } else { Vec3::ZERO }
    };
    sums.into_iter().map(unit).collect()
}

/// For each vertex, the longest edge of all triangles around it, in f64 and rounded once; 0 for a
/// vertex without a triangle.
pub(super) fn radii(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f32> {
    let mut longest = vec![0.0_f64; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map_inline(|i| points[i as usize].as_dvec3());
        for edge in [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)] {
            for &i in triangle {
                let longest = &mut longest[i as usize];
                if edge > *longest {
                    *longest = edge;
                }
            }
        }
    }
    longest.into_iter().map(|squared| squared.sqrt() as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_weighted_by_area() {
        // Two triangles on the edge from 0 to 1: area 1 facing +z, area 2 facing +y.
        let points = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(0.0, 2.0, 0.0),
            Vec3::new(0.0, 0.0, 4.0),
            Vec3::new(9.0, 9.0, 9.0),
        ];
        let normals = normals(&points, &[[0, 1, 2], [0, 3, 1]]);
        let both = Vec3::new(0.0, 2.0, 1.0) / 5.0_f32.sqrt();
        assert!(normals[0].distance(both) < 1e-7 && normals[1].distance(both) < 1e-7);
        assert_eq!(normals[2..], [Vec3::Z, Vec3::Y, Vec3::ZERO], "the last has no triangle");
    }

    #[test]
    fn radii_are_the_longest_edge_around() {
        let points = [0.0, 3.0, 4.0, 100.0].map(|x| Vec3::new(x, 0.0, 0.0));
        assert_eq!(radii(&points, &[[0, 1, 2], [1, 2, 2]]), [4.0, 4.0, 4.0, 0.0]);
    }
}
