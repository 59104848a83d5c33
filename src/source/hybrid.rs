//! Draw a mesh as polygons on one side of a plane and as surfels on the other \[MKC08, section
//! 5.2\].

use crate::error::{Error, Result};
use crate::scene::Cloud;
use glam::{DVec3, Vec3};

/// The points with `(a x + b y) + c z >= d`, in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    normal: DVec3,
    offset: f64,
}

impl HalfSpace {
    /// From a, b, c and d.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not finite, or if a, b and c are 0.
    pub fn new([a, b, c, d]: [f64; 4]) -> Result<Self> {
        let normal = DVec3::new(a, b, c);
        if !(normal.is_finite() && d.is_finite() && normal != DVec3::ZERO) {
            let what =
                format!("a half space of {a}, {b}, {c}, {d}; give finite numbers, not 0, 0, 0");
            return Err(Error::Invalid(what));
        }
        Ok(Self { normal, offset: d })
    }

    /// a, b, c and d.
    pub(crate) fn numbers(&self) -> [f64; 4] {
        [self.normal.x, self.normal.y, self.normal.z, self.offset]
    }

    /// Whether a point is in the half space; NaN is not.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        let (p, n) = (point.as_dvec3(), self.normal);
        (n.x * p.x + n.y * p.y) + n.z * p.z >= self.offset
    }
}

/// Divides a cloud with triangles, normals and radii. The first result is the surfels, the second
/// the mesh of polygons.
///
/// - A triangle whose three corners are in the half space becomes a polygon. Polygons keep their
///   order.
/// - A vertex that no polygon uses becomes a surfel, even if no triangle uses it.
/// - A vertex of polygons gets the radius 0, so that it is not extended.
/// - A boundary vertex, used by a polygon and by a triangle that is not a polygon, becomes both: a
///   surfel, and a vertex of polygons that keeps the radius of its surfel. "The vertices of the
///   boundary edges between the two parts have to be attributed with radii that are large enough to
///   let the rasterized pixels of the boundary edges blend smoothly": with that radius a pixel of
///   the boundary edge is a surfel, like its neighbours beyond.
///
/// So every triangle becomes a polygon or has a surfel at each corner. Both parts keep the order of
/// the vertices. The surfels have no triangles, and neither part has edges or texture coordinates.
///
/// `Decided:` a boundary vertex is a surfel too, because the view decides which pixels a polygon
/// covers. In views where the polygon covers no pixel's centre, or shows its back, only the surfel
/// closes the surface beyond the boundary.
///
/// # Errors
/// [`Error::Invalid`] as [`Cloud::check`].
pub fn split(cloud: &Cloud, half: &HalfSpace) -> Result<(Cloud, Cloud)> {
    cloud.check()?;
    let n = cloud.position.len();
    let inside: Vec<bool> = cloud.position.iter().map(|&point| half.contains(point)).collect();
    let is_polygon = |corners: &&[u32; 3]| corners.iter().all(|&corner| inside[corner as usize]);
    let (polygons, others): (Vec<_>, Vec<_>) = cloud.triangles.iter().partition(is_polygon);
    let used = |triangles: &[[u32; 3]]| {
        let mut used = vec![false; n];
        triangles.iter().flatten().for_each(|&corner| used[corner as usize] = true);
        used
    };
    let (of_polygons, of_others) = (used(&polygons), used(&others));

    let bare = Cloud { coordinates: None, triangles: vec![], edges: vec![], ..cloud.clone() };
    let mut surfels = bare.clone();
    let is_surfel = |i: usize| !of_polygons[i] || of_others[i];
    surfels.retain(&(0..n).map(is_surfel).collect::<Vec<_>>());
    let mut mesh = Cloud { triangles: polygons, ..bare };
    for (radius, boundary) in mesh.radius.iter_mut().flatten().zip(of_others) {
        *radius = if boundary { *radius } else { 0.0 };
    }
    mesh.retain(&of_polygons);
    Ok((surfels, mesh))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The octahedron: six vertices of radii 1 to 6, eight triangles, closed.
    fn octahedron() -> Cloud {
        let position = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let corner = |axis: u32, sign: u32| axis + 3 * sign;
        let triangles = (0..8)
            .map(|bits| [corner(0, bits & 1), corner(1, bits >> 1 & 1), corner(2, bits >> 2)])
            .collect();
        Cloud {
            normal: Some(position.clone()),
            radius: Some((1..7).map(|i| i as f32).collect()),
            position,
            triangles,
            edges: vec![[0, 1]],
            ..Cloud::default()
        }
    }

    #[test]
    fn the_upper_half_of_an_octahedron_is_polygons() {
        let half = HalfSpace::new([0.0, 2.0, 0.0, 0.0]).unwrap();
        let (surfels, mesh) = split(&octahedron(), &half).unwrap();
        // All but -y are in the half space, so that the four triangles at +y are polygons and the
        // four corners around are the boundary.
        assert_eq!(surfels.position, [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z]);
        assert_eq!(surfels.radius, Some(vec![1.0, 3.0, 4.0, 5.0, 6.0]));
        assert_eq!(mesh.position, [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Z]);
        assert_eq!(mesh.radius, Some(vec![1.0, 0.0, 3.0, 4.0, 6.0]), "+y is inside");
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 1, 2], [0, 1, 4], [3, 1, 4]]);
        assert!(surfels.triangles.is_empty() && surfels.edges.is_empty() && mesh.edges.is_empty());
        assert_eq!(mesh.normal.as_deref(), Some(mesh.position.as_slice()));
    }

    #[test]
    fn a_half_space_may_hold_all_or_nothing() {
        let cloud = octahedron();
        let (surfels, mesh) =
            split(&cloud, &HalfSpace::new([0.0, 0.0, 1.0, 1.5]).unwrap()).unwrap();
        assert_eq!((surfels.position, mesh.position.len()), (cloud.position.clone(), 0));
        // -1 is in: the plane belongs to the half space.
        let (surfels, mesh) =
            split(&cloud, &HalfSpace::new([0.0, 0.0, 1.0, -1.0]).unwrap()).unwrap();
        assert_eq!((surfels.position.len(), mesh.triangles), (0, cloud.triangles));
        assert_eq!(mesh.radius, Some(vec![0.0; 6]));
    }

    #[test]
    fn what_is_no_half_space_is_refused() {
        for bad in [[0.0, 0.0, 0.0, 1.0], [f64::NAN, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, f64::INFINITY]]
        {
            assert!(HalfSpace::new(bad).unwrap_err().to_string().contains("half space"));
        }
        assert!(!HalfSpace::new([1.0, 0.0, 0.0, 0.0]).unwrap().contains(Vec3::NAN));
    }

    proptest! {
        /// Each triangle by the definition, with places for names, which are all different.
        #[test]
        fn every_triangle_is_a_polygon_or_has_surfels(
            points in prop::collection::vec(prop::array::uniform3(-4_i8..5), 4..30),
            corners in prop::collection::vec(prop::array::uniform3(0_usize..30), 0..40),
            [a, b, c, d] in prop::array::uniform4(-3_i8..4),
        ) {
            prop_assume!([a, b, c] != [0; 3]);
            let n = points.len();
            // Integers that are exact in any arithmetic; the point's number is in its radius.
            let cloud = Cloud {
                position: points.iter().map(|p| Vec3::from_array(p.map(f32::from))).collect(),
                normal: Some(vec![Vec3::Z; n]),
                radius: Some((0..n).map(|i| 1.0 + i as f32).collect()),
                color: Some((0..n).map(|i| Vec3::splat(1.0 + i as f32)).collect()),
                triangles: corners.iter().map(|t| t.map(|i| (i % n) as u32)).collect(),
                ..Cloud::default()
            };
            let half = HalfSpace::new([a, b, c, d].map(f64::from)).unwrap();
            let (surfels, mesh) = split(&cloud, &half).unwrap();
            surfels.check().unwrap();
            mesh.check().unwrap();
            let is_in = |i: u32| {
                let [x, y, z] = points[i as usize].map(i32::from);
                i32::from(a) * x + i32::from(b) * y + i32::from(c) * z >= i32::from(d)
            };
            let name = |color: &Vec3| color.x as u32 - 1;
            let is_surfel: Vec<u32> = surfels.color.iter().flatten().map(name).collect();
            let vertex: Vec<u32> = mesh.color.iter().flatten().map(name).collect();
            let mut polygons = mesh.triangles.iter().map(|t| t.map(|i| vertex[i as usize]));
            for triangle in &cloud.triangles {
                if triangle.iter().all(|&i| is_in(i)) {
                    prop_assert_eq!(polygons.next(), Some(*triangle));
                } else {
                    prop_assert!(triangle.iter().all(|i| is_surfel.contains(i)));
                }
            }
            prop_assert_eq!(polygons.next(), None);
            for i in 0..n as u32 {
                prop_assert!(is_surfel.contains(&i) || vertex.contains(&i), "{i} is lost");
            }
            // Both is exactly what has a radius among the vertices of polygons.
            for (i, radius) in vertex.iter().zip(mesh.radius.unwrap()) {
                let expected = if is_surfel.contains(i) { 1.0 + *i as f32 } else { 0.0 };
                prop_assert_eq!(radius, expected);
            }
        }
    }
}
