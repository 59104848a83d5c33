//! Ordered points from a mesh, and the points that a view draws.

use super::case::quiet;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::elementary::{cos, sin};
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::objects::{Geometry, Motion, Object, Objects};
use crate::scene::{Camera, Cloud, Primitives, Scene, Similarity, Surfels, Triangles, Vertices};
use crate::source::candidates::{Candidates, Directions, candidates};
use crate::source::flatten;
use crate::source::sampler::{Graph, Greedy, Start, estimate};
use glam::DVec3;

/// Triangles under a headlight.
#[must_use]
pub fn mesh(triangles: Triangles) -> Scene {
    let primitives = Primitives { triangles, ..Primitives::default() };
    Scene { primitives, ..Scene::lit("mesh", Surfels::none()) }
}

/// Samples a mesh from directions, in pictures of a side, and orders this many points greedily from
/// point 0. Views choose their radii.
///
/// # Errors
/// As [`candidates`] and [`Greedy::order`].
pub fn order(
    mesh: &Scene,
    directions: &Directions,
    side: u32,
    count: usize,
    exec: &Exec,
) -> Result<Cloud> {
    let cloud = candidates(mesh, directions, side, exec, &quiet)?.cloud;
    let greedy = Greedy { start: Start::Index(0) };
    let order = greedy.order(&cloud.position, count, exec, &quiet)?;
    let cloud = cloud.some(&order.index);
    Ok(Cloud { radius: Some(vec![1.0; cloud.position.len()]), ..cloud })
}

/// The same with distances along the surface; neighbours are within two pixels.
///
/// # Errors
/// As [`candidates`], [`Graph::new`] and [`Greedy::along`].
pub fn order_along(
    mesh: &Scene,
    directions: &Directions,
    side: u32,
    count: usize,
    exec: &Exec,
) -> Result<Cloud> {
    let Candidates { cloud, pixel, .. } = candidates(mesh, directions, side, exec, &quiet)?;
    let normals = cloud.normal.as_deref().unwrap_or_default();
    let graph = Graph::new(&cloud.position, normals, (2.0 * pixel) as f32, exec, &quiet)?;
    let greedy = Greedy { start: Start::Index(0) };
    let cloud = cloud.some(&greedy.along(&graph, count, &quiet)?.index);
    Ok(Cloud { radius: Some(vec![1.0; cloud.position.len()]), ..cloud })
}

/// A geometry of ordered points, with the triangles that replace them nearby.
///
/// # Errors
/// As [`Surfels::new`] and [`Geometry::with_prefix`].
pub fn geometry(order: Cloud, primitives: Primitives) -> Result<Geometry> {
    let (surfels, _) = Surfels::new(order)?;
    let estimate = estimate(surfels.position(), surfels.normal());
    let plain = Geometry { name: "order".into(), surfels, primitives, detail: None };
    plain.with_prefix(estimate)
}

/// An object of one geometry at each place.
///
/// # Errors
/// As [`Objects::new`].
pub fn objects(geometry: Geometry, places: &[Similarity]) -> Result<Objects> {
    let all = places.iter().map(|place| Object {
        name: "object".into(),
        geometry: 0,
        motion: Motion::still(*place),
        color: None,
    });
    Objects::new(vec![geometry], all.collect(), [0.75; 3].into())
}

/// The surfels of objects that a camera needs, as a flat scene.
///
/// # Errors
/// As [`Objects::seen_from`] and [`flatten()`].
pub fn seen(objects: &Objects, surfel_size: f32, camera: &Camera, exec: &Exec) -> Result<Scene> {
    let asked = Refinement { surfel_size, ..Refinement::default() };
    let objects = objects.clone().with_refinement(asked)?.seen_from(camera, exec)?;
    flatten(&Scene { objects: Some(objects), ..Scene::lit("order", Surfels::none()) }, exec)
}

/// A torus with the radii 1 and 0.4 around +y, 36,864 triangles.
///
/// # Errors
/// As [`Triangles::new`].
pub fn torus() -> Result<Scene> {
    let (columns, rows) = (192, 96);
    let mut vertices = Vertices::default();
    let mut corners = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let angle = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
            let (a, b) = (angle(i, columns), angle(j, rows));
            let normal = DVec3::new(cos(b) * cos(a), sin(b), cos(b) * sin(a));
            let p = DVec3::new(cos(a), 0.0, sin(a)) + normal * 0.4;
            vertices.position.push(p.as_vec3());
            vertices.direction.push(normal.as_vec3());
            vertices.radius.push(0.0);
            let at = |i: u32, j: u32| i % columns * rows + j % rows;
            corners.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            corners.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    Ok(mesh(Triangles::new(vertices, corners)?.0))
}
