//! Where the points of a mesh are in its texture.

use crate::number::MapInline;
use glam::Vec2;

/// Texture coordinates (u, v), see [`super::texture`] for what they mean. Values are unchecked: a
/// point with a coordinate that is not finite is dropped and counted when it should get the
/// texture's colour.
///
/// `Decided:` coordinates of corners stay with the corners, and no point is split in two at a seam
/// of the texture. So the number of points, their normals and their radii are the same with a
/// texture and without.
#[derive(Clone, Debug, PartialEq)]
pub enum Coordinates {
    /// One coordinate pair for each point.
    Points(Vec<Vec2>),
    /// One coordinate pair for each corner of each triangle.
    Corners(Vec<[Vec2; 3]>),
}

impl Coordinates {
    /// The coordinates of the corners of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle or point.
    #[must_use]
    pub fn corners(&self, triangle: usize, corners: [u32; 3]) -> [Vec2; 3] {
        match self {
            Self::Points(points) => corners.map_inline(|corner| points[corner as usize]),
            Self::Corners(all) => all[triangle],
        }
    }

    /// Whether the texture repeats along u and along v: if a finite coordinate is not in [0, 1].
    #[must_use]
    pub fn repeats(&self) -> [bool; 2] {
        let all = match self {
            Self::Points(points) => points.as_slice(),
            Self::Corners(all) => all.as_flattened(),
        };
        let outside = |x: f32| x.is_finite() && !(0.0..=1.0).contains(&x);
        [all.iter().any(|at| outside(at.x)), all.iter().any(|at| outside(at.y))]
    }

    /// How many pairs there are for points, and how many triples for triangles.
    pub(crate) fn lengths(&self) -> [Option<usize>; 2] {
        match self {
            Self::Points(points) => [Some(points.len()), None],
            Self::Corners(all) => [None, Some(all.len())],
        }
    }
}
