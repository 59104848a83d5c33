//! Triangles and polylines: vertices with attributes, and the primitives that join them.

use super::cloud::Property;
use super::degenerate::unit;
use super::light::is_color;
use crate::error::{Error, Result};
use glam::Vec3;

/// Unchecked vertices as a structure of arrays: the input of [`Indexed::new`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertices {
    /// Positions in world units.
    pub position: Vec<Vec3>,
    /// The normal of a triangle's or a ribbon's surface, or the tangent of a tube; any length.
    pub direction: Vec<Vec3>,
    /// Half the width of a ribbon, the radius of a tube, or how far the surface reaches at a
    /// triangle's vertex; in world units and at least 0.
    pub radius: Vec<f32>,
    /// Linear RGB, not premultiplied.
    pub color: Option<Vec<Vec3>>,
    /// Opacity in \[0, 1\]. Primitives are drawn opaque. The opacity and the properties are for
    /// choosing [candidates](mod@crate::source::candidates) among the visible parts of triangles.
    pub opacity: Option<Vec<f32>>,
    /// Further numbers of the vertices.
    pub properties: Vec<Property>,
}

/// Primitives of `N` corners over checked vertices; there may be none.
///
/// The constructor guarantees arrays of one length. For every vertex that a primitive uses, it
/// guarantees:
///
/// - a finite position;
/// - a direction of length 1 within 2^-20;
/// - a finite radius >= 0;
/// - a colour in [0, [`super::light::MAX_RADIANCE`]] and not -0;
/// - an opacity in [0, 1];
/// - finite properties.
///
/// Corners may coincide: such a segment is a point, and such a triangle covers nothing. An edge may
/// belong to any number of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Indexed<const N: usize> {
    vertices: Vertices,
    corners: Vec<[u32; N]>,
}

/// Line segments between vertices, one pixel wide until they are reconstructed \[MKC08, section
/// 4\].
pub type Polylines = Indexed<2>;
/// Triangles between vertices; the front is the side from which the corners run counter-clockwise.
pub type Triangles = Indexed<3>;

impl<const N: usize> Default for Indexed<N> {
    fn default() -> Self {
        Self { vertices: Vertices::default(), corners: Vec::new() }
    }
}

impl<const N: usize> Indexed<N> {
    /// Checks vertices and corners. Drops primitives with a degenerate vertex, and returns how many
    /// were dropped.
    ///
    /// A direction is made a unit vector as the normal of a surfel is, see [`super::Surfels::new`].
    /// Vertices are kept, even the ones that no primitive uses.
    ///
    /// # Errors
    /// [`Error::Invalid`] if an array has the wrong length, if a corner is no vertex, or if there
    /// are more than 2^32 - 2 vertices or primitives.
    pub fn new(mut vertices: Vertices, mut corners: Vec<[u32; N]>) -> Result<(Self, u64)> {
        let n = vertices.position.len();
        let lengths = [
            ("directions", vertices.direction.len()),
            ("radii", vertices.radius.len()),
            ("colours", vertices.color.as_ref().map_or(n, Vec::len)),
            ("opacities", vertices.opacity.as_ref().map_or(n, Vec::len)),
        ];
        let properties = vertices.properties.iter();
        let properties = properties.map(|one| (one.name.as_str(), one.values.len()));
        for (what, length) in lengths.into_iter().chain(properties) {
            if length != n {
                return Err(Error::Invalid(format!("{n} vertices, but {length} {what}")));
            }
        }
        if n.max(corners.len()) as u64 >= u64::from(u32::MAX) {
            return Err(Error::Invalid(format!(
                "{n} vertices and {} primitives, but ids have 32 bits: split the scene",
                corners.len()
            )));
        }
        if let Some(corner) = corners.iter().flatten().find(|&&corner| corner as usize >= n) {
            return Err(Error::Invalid(format!("vertex {corner} does not exist; there are {n}")));
        }
        let drawable: Vec<bool> = (0..n)
            .map(|i| {
                vertices.position[i].is_finite()
                    && unit(&mut vertices.direction[i])
                    && vertices.radius[i] >= 0.0
                    && vertices.radius[i].is_finite()
                    && vertices.color.as_ref().is_none_or(|color| is_color(color[i]))
                    && sound(vertices.opacity.as_deref(), &vertices.properties, i)
            })
            .collect();
        // Adding 0 turns -0 into 0.
        vertices.color.iter_mut().flatten().for_each(|color| *color += Vec3::ZERO);
        let before = corners.len();
        corners.retain(|corners| corners.iter().all(|&corner| drawable[corner as usize]));
        let dropped = (before - corners.len()) as u64;
        Ok((Self { vertices, corners }, dropped))
    }

    /// How many primitives there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The vertices; a vertex that no primitive uses may hold anything.
    #[must_use]
    pub fn vertices(&self) -> &Vertices {
        &self.vertices
    }

    /// The vertices of each primitive.
    #[must_use]
    pub fn corners(&self) -> &[[u32; N]] {
        &self.corners
    }

    /// Changes the vertices, but not their number, and checks them again as [`Indexed::new`] does.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Indexed::new`].
    pub fn map(self, change: impl FnOnce(&mut Vertices)) -> Result<(Self, u64)> {
        let (mut vertices, corners) = self.into_parts();
        change(&mut vertices);
        Self::new(vertices, corners)
    }

    /// Positions and radii of vertices that a primitive uses, one for each corner.
    fn used(&self) -> impl Iterator<Item = (Vec3, f32)> + '_ {
        let vertices = &self.vertices;
        let corners = self.corners.iter().flatten();
        corners.map(|&i| (vertices.position[i as usize], vertices.radius[i as usize]))
    }

    /// Takes the parts out, to be changed or joined.
    #[must_use]
    pub fn into_parts(self) -> (Vertices, Vec<[u32; N]>) {
        (self.vertices, self.corners)
    }
}

/// Whether a point's opacity is in [0, 1] and its properties are finite, if it has any.
pub(crate) fn sound(opacity: Option<&[f32]>, properties: &[Property], point: usize) -> bool {
    opacity.is_none_or(|all| (0.0..=1.0).contains(&all[point]))
        && properties.iter().all(|one| one.values[point].is_finite())
}

/// How many primitives there are of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Polygons, cut into triangles.
    pub triangles: usize,
    /// Segments of ribbons.
    pub ribbons: usize,
    /// Segments of tubes.
    pub tubes: usize,
}

/// The primitives of a scene beside its surfels \[MKC08, sections 4 and 5\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Primitives {
    /// Polygons.
    pub triangles: Triangles,
    /// Flat strips: direction is the normal, radius half the width.
    pub ribbons: Polylines,
    /// Bent cylinders: direction is the tangent.
    pub tubes: Polylines,
}

impl Primitives {
    /// How many there are in all.
    #[must_use]
    pub fn len(&self) -> usize {
        let Counts { triangles, ribbons, tubes } = self.counts();
        triangles + ribbons + tubes
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many there are of each kind.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let Self { triangles, ribbons, tubes } = self;
        Counts { triangles: triangles.len(), ribbons: ribbons.len(), tubes: tubes.len() }
    }

    /// [`Indexed::map`] for each kind; returns how many primitives were dropped in all.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Indexed::new`].
    pub fn map(self, change: impl Fn(&mut Vertices)) -> Result<(Self, u64)> {
        let (triangles, a) = self.triangles.map(&change)?;
        let (ribbons, b) = self.ribbons.map(&change)?;
        let (tubes, c) = self.tubes.map(&change)?;
        Ok((Self { triangles, ribbons, tubes }, a + b + c))
    }

    /// Positions and radii of vertices that a primitive uses, one for each corner.
    pub(super) fn used(&self) -> impl Iterator<Item = (Vec3, f32)> + '_ {
        self.triangles.used().chain(self.ribbons.used()).chain(self.tubes.used())
    }

    /// Whether vertices of some kind that is present have colours.
    #[must_use]
    pub fn colored(&self) -> bool {
        fn colored<const N: usize>(of: &Indexed<N>) -> bool {
            !of.is_empty() && of.vertices.color.is_some()
        }
        colored(&self.triangles) || colored(&self.ribbons) || colored(&self.tubes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(n: usize) -> Vertices {
        Vertices {
            position: (0..n).map(|i| Vec3::X * i as f32).collect(),
            direction: vec![3.0 * Vec3::Z; n],
            radius: vec![0.0; n],
            ..Vertices::default()
        }
    }

    #[test]
    fn primitives_with_a_bad_vertex_are_dropped_and_counted() {
        let mut bad = vertices(6);
        bad.position[1].y = f32::NAN;
        bad.direction[2] = Vec3::ZERO;
        bad.radius[3] = -1.0;
        bad.radius[4] = f32::INFINITY;
        let corners = vec![[0, 1], [0, 5], [2, 5], [0, 0], [3, 0], [4, 4]];
        for wrong in [f32::NAN, -0.25, 1.5] {
            let opacity = Some(vec![1.0, 1.0, 0.5, 0.0, wrong, 1.0]);
            let veiled = Vertices { opacity, ..vertices(6) };
            let (lines, dropped) = Polylines::new(veiled, corners.clone()).unwrap();
            assert_eq!((lines.len(), dropped), (5, 1), "{wrong}");
        }
        let heat =
            Property { name: "heat".into(), values: vec![0.0, f32::INFINITY, -7.0, 0.0, 0.0, 0.0] };
        let hot = Vertices { properties: vec![heat], ..vertices(6) };
        assert_eq!(Polylines::new(hot, corners.clone()).unwrap().1, 1);
        let (lines, dropped) = Polylines::new(bad, corners).unwrap();
        assert_eq!((lines.corners(), dropped), ([[0, 5], [0, 0]].as_slice(), 4));
        assert_eq!(lines.vertices().direction[0], Vec3::Z, "made a unit vector");
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let error = Triangles::new(vertices(3), vec![[0, 1, 3]]).unwrap_err();
        assert_eq!(error.to_string(), "vertex 3 does not exist; there are 3");
        let few = Vertices { radius: vec![1.0; 2], ..vertices(3) };
        let error = Triangles::new(few, vec![]).unwrap_err();
        assert_eq!(error.to_string(), "3 vertices, but 2 radii");
        let few = Vertices { color: Some(vec![]), ..vertices(3) };
        assert!(Triangles::new(few, vec![]).is_err());
        let heat = Property { name: "heat".into(), values: vec![0.0] };
        let few = Vertices { properties: vec![heat], ..vertices(3) };
        let error = Triangles::new(few, vec![]).unwrap_err();
        assert_eq!(error.to_string(), "3 vertices, but 1 heat");
    }
}
