//! Divide the triangles of a geometry among the nodes of its tree, and put them together again.

use super::octree::{Item, Octree, octree};
use crate::error::Result;
use crate::memory;
use crate::number::MapInline;
use crate::scene::{Cloud, Property, Similarity, Triangles, Vertices};
use glam::Vec3;

/// The numbers that vertices and surfels have beside normals and colours.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbers {
    /// Whether any vertex has an opacity. Then all surfels have one, and vertices without one
    /// have 1.
    pub opacity: bool,
    /// The names of further properties, which all vertices have.
    pub properties: Vec<String>,
}

impl Numbers {
    /// Empty arrays for the properties.
    #[must_use]
    pub fn of_none(&self) -> Vec<Property> {
        let empty = |name: &String| Property { name: name.clone(), values: Vec::new() };
        self.properties.iter().map(empty).collect()
    }
}

/// The triangles of a node, with the vertices that they use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Positions in the coordinates of the geometry.
    pub position: Vec<Vec3>,
    /// Unit normals.
    pub normal: Vec<Vec3>,
    /// Linear RGB, if the geometry has colours.
    pub color: Option<Vec<Vec3>>,
    /// Opacities, if the geometry has them.
    pub opacity: Option<Vec<f32>>,
    /// Further properties.
    pub properties: Vec<Property>,
    /// Triangles as indices into `position`.
    pub triangles: Vec<[u32; 3]>,
}

/// Bytes of a triangle while a tree is made: its box and its place, its number in two levels, and
/// its sorted corners.
const OF_A_TRIANGLE: u64 = 160;

/// The tree over the triangles of a geometry; each triangle is an item of weight 1, with its own
/// box.
///
/// # Errors
/// [`crate::Error::Invalid`] if the process may not hold it.
pub fn tree(triangles: &Triangles, bound: u64) -> Result<Octree> {
    let count = triangles.len();
    memory::ask(count as u64 * OF_A_TRIANGLE, || format!("a tree of {count} triangles"))?;
    let position = &triangles.vertices().position;
    let item = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map_inline(|corner| position[corner as usize]);
        Item { low: a.min(b).min(c), high: a.max(b).max(c), weight: 1 }
    };
    let items: Vec<Item> = triangles.corners().iter().map(item).collect();
    Ok(octree(&items, bound))
}

impl Part {
    /// The vertices of these triangles, in ascending order.
    ///
    /// # Panics
    /// If a triangle does not exist.
    #[must_use]
    pub fn vertices_of(triangles: &Triangles, some: &[u32]) -> Vec<u32> {
        let corners = some.iter().map(|&i| triangles.corners()[i as usize]);
        let mut used: Vec<u32> = corners.flatten().collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The part with these triangles, in ascending order; vertices keep their order.
    ///
    /// # Panics
    /// If a triangle does not exist.
    #[must_use]
    pub fn from_triangles(triangles: &Triangles, some: &[u32]) -> Self {
        let corners = some.iter().map(|&i| triangles.corners()[i as usize]);
        let used = Self::vertices_of(triangles, some);
        let all = triangles.vertices();
        let new = |old: u32| used.partition_point(|&i| i < old) as u32;
        let property =
            |one: &Property| Property { name: one.name.clone(), values: at(&one.values, &used) };
        Self {
            position: at(&all.position, &used),
            normal: at(&all.direction, &used),
            color: all.color.as_ref().map(|all| at(all, &used)),
            opacity: all.opacity.as_ref().map(|all| at(all, &used)),
            properties: all.properties.iter().map(property).collect(),
            triangles: corners.map(|corners| corners.map_inline(new)).collect(),
        }
    }
}

fn at<T: Copy>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|&i| values[i as usize]).collect()
}

/// Triangles gathered from several places; all have colours and the same numbers.
#[derive(Debug)]
pub struct Gathered {
    vertices: Vertices,
    corners: Vec<[u32; 3]>,
}

/// How far the sides of a regular hexagon are from its middle, if its corners are 1 away.
const HALF_SQRT_3: f32 = 0.866_025_4;

/// Bytes of a vertex and of a triangle while they are gathered, their arrays growing.
const OF_A_VERTEX: u64 = 2 * 40;
const OF_A_NUMBER: u64 = 2 * 4;
const OF_CORNERS: u64 = 2 * 12;

impl Gathered {
    /// No triangles yet; vertices will have these numbers.
    #[must_use]
    pub fn new(numbers: &Numbers) -> Self {
        let vertices = Vertices {
            color: Some(Vec::new()),
            opacity: numbers.opacity.then(Vec::new),
            properties: numbers.of_none(),
            ..Vertices::default()
        };
        Self { vertices, corners: Vec::new() }
    }

    /// Adds the triangles of a part in a place. `color` replaces all colours if it is given, `fill`
    /// is the colour of parts without colours, and 1 the opacity of parts without opacities.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the process may not hold them.
    pub fn part(
        &mut self,
        part: Part,
        place: &Similarity,
        color: Option<Vec3>,
        fill: Vec3,
    ) -> Result<()> {
        let n = part.position.len();
        let colors = match (color, part.color) {
            (None, Some(own)) => own,
            (color, _) => vec![color.unwrap_or(fill); n],
        };
        let mut vertices = Vertices {
            position: part.position,
            direction: part.normal,
            radius: vec![0.0; n],
            color: Some(colors),
            opacity: part.opacity,
            properties: part.properties,
        };
        place.apply_to_vertices(&mut vertices);
        self.add(vertices, &part.triangles)
    }

    /// Adds surfels as the regular hexagons whose corners lie on the circle of their disc; `numbers`
    /// has the opacity and properties of each surfel. For the half axes u and v
    /// ([`crate::scene::cloud::half_axes`]) of a disc of this `radius`, in `f32`:
    ///
    /// ```text
    ///   h = u / 2      w = v s      s = sqrt(3) / 2, rounded to f32
    ///   corners    p + u, (p + h) + w, (p - h) + w, p - u, (p - h) - w, (p + h) - w
    ///   triangles  0 1 2, 0 2 3, 0 3 4, 0 4 5 of these corners
    /// ```
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the process may not hold them.
    pub fn hexagons(&mut self, surfels: &[[Vec3; 3]], numbers: &Cloud, radius: f32) -> Result<()> {
        let n = 6 * surfels.len();
        let six = |all: &[f32]| {
            all[..surfels.len()].iter().flat_map(|&number| [number; 6]).collect::<Vec<_>>()
        };
        let property =
            |one: &Property| Property { name: one.name.clone(), values: six(&one.values) };
        let mut vertices = Vertices {
            position: Vec::with_capacity(n),
            direction: Vec::with_capacity(n),
            radius: vec![0.0; n],
            color: Some(Vec::with_capacity(n)),
            opacity: numbers.opacity.as_deref().map(six),
            properties: numbers.properties.iter().map(property).collect(),
        };
        let mut corners = Vec::with_capacity(4 * surfels.len());
        for &[p, normal, color] in surfels {
            let [u, v] = crate::scene::cloud::half_axes(normal, radius);
            let (h, w) = (u / 2.0, v * HALF_SQRT_3);
            let first = vertices.position.len() as u32;
            corners.extend([1, 2, 3, 4].map(|i| [first, first + i, first + i + 1]));
            vertices.position.extend([p + u, p + h + w, p - h + w, p - u, p - h - w, p + h - w]);
            vertices.direction.extend([normal; 6]);
            vertices.color.iter_mut().for_each(|all| all.extend([color; 6]));
        }
        self.add(vertices, &corners)
    }

    fn add(&mut self, vertices: Vertices, corners: &[[u32; 3]]) -> Result<()> {
        let (n, more) = (vertices.position.len() as u64, corners.len() as u64);
        let numbers = 1 + self.vertices.properties.len() as u64;
        memory::ask(n * (OF_A_VERTEX + numbers * OF_A_NUMBER) + more * OF_CORNERS, || {
            format!("{} triangles of a subtree", more + self.corners.len() as u64)
        })?;
        // An overflow is refused in the end, where the vertices are counted.
        let first = self.vertices.position.len() as u32;
        let moved = corners.iter().map(|corners| corners.map_inline(|i| first.wrapping_add(i)));
        self.corners.extend(moved);
        self.vertices.position.extend(vertices.position);
        self.vertices.direction.extend(vertices.direction);
        self.vertices.radius.extend(vertices.radius);
        let colors = vertices.color.unwrap_or_default();
        self.vertices.color.iter_mut().for_each(|all| all.extend(&colors));
        if let Some(all) = &mut self.vertices.opacity {
            all.extend(vertices.opacity.unwrap_or_else(|| vec![1.0; n as usize]));
        }
        let properties = self.vertices.properties.iter_mut().zip(vertices.properties);
        properties.for_each(|(to, from)| to.values.extend(from.values));
        Ok(())
    }

    /// All gathered triangles, except those that a place moved out of the range of `f32`.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`Triangles::new`].
    pub fn finish(self) -> Result<Triangles> {
        Ok(Triangles::new(self.vertices, self.corners)?.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn soup(corners: Vec<[u32; 3]>, position: Vec<Vec3>, colored: bool) -> Triangles {
        let n = position.len();
        let color = colored.then(|| (0..n).map(|i| Vec3::splat(i as f32)).collect());
        let vertices = Vertices {
            position,
            direction: vec![Vec3::Z; n],
            radius: vec![0.0; n],
            color,
            ..Vertices::default()
        };
        Triangles::new(vertices, corners).unwrap().0
    }

    fn places(vertices: &Vertices, corners: &[[u32; 3]]) -> Vec<[[u32; 3]; 3]> {
        let bits = |i: u32| vertices.position[i as usize].to_array().map(f32::to_bits);
        corners.iter().map(|corners| corners.map(bits)).collect()
    }

    proptest! {
        /// The parts of all nodes are the mesh: no triangle lost, none twice, none changed.
        #[test]
        fn parts_are_the_mesh(
            position in prop::collection::vec(prop::array::uniform3(-9.0_f32..9.0), 4..60),
            corners in prop::collection::vec(prop::array::uniform3(0_usize..1000), 1..200),
            bound in 1_u64..50,
            colored: bool,
        ) {
            let n = position.len();
            let corners = corners.iter().map(|c| c.map(|i| (i % n) as u32)).collect();
            let mesh = soup(corners, position.into_iter().map(Vec3::from_array).collect(), colored);
            let tree = tree(&mesh, bound).unwrap();
            let mut all = Gathered::new(&Numbers::default());
            for node in 0..tree.nodes.len() as u32 {
                let part = Part::from_triangles(&mesh, tree.own(node));
                prop_assert_eq!(part.color.is_some(), colored);
                all.part(part, &Similarity::IDENTITY, None, Vec3::X).unwrap();
            }
            let all = all.finish().unwrap();
            let mut found = places(all.vertices(), all.corners());
            let mut given = places(mesh.vertices(), mesh.corners());
            found.sort_unstable();
            given.sort_unstable();
            prop_assert_eq!(found, given);
            let fill = all.vertices().color.as_ref().unwrap().iter().all(|&c| c == Vec3::X);
            prop_assert_eq!(fill, !colored);
        }
    }

    #[test]
    fn hexagons_are_inscribed_and_face_as_their_surfels() {
        let mut all = Gathered::new(&Numbers { opacity: true, properties: vec!["heat".into()] });
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let heat = |values| Property { name: "heat".into(), values };
        let numbers = Cloud {
            opacity: Some(vec![0.25, 0.75]),
            properties: vec![heat(vec![7.0, 8.0])],
            ..Cloud::default()
        };
        all.hexagons(&[[Vec3::ONE, normal, Vec3::X]], &numbers, 0.5).unwrap();
        let all = all.finish().unwrap();
        let position = &all.vertices().position;
        let mut area = 0.0;
        for corners in all.corners() {
            let [a, b, c] = corners.map(|i| position[i as usize]);
            let across = (b - a).cross(c - a);
            assert!((across.normalize() - normal).length() < 1e-5, "{across}");
            area += across.length() / 2.0;
            assert!(((a - Vec3::ONE).length() - 0.5).abs() < 1e-6, "{a} is not on the circle");
        }
        assert!((area - 0.75 * HALF_SQRT_3).abs() < 1e-6, "{area}");
        assert_eq!(all.vertices().direction, [normal; 6]);
        assert_eq!(all.vertices().opacity, Some(vec![0.25; 6]), "those of the first");
        assert_eq!(all.vertices().properties, [heat(vec![7.0; 6])]);
    }
}
