//! Orders as scenes, and what a picture covers of the mesh that they were made of.

use splatref::Result;
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::{Method, Session, blue};
use splatref::scene::objects::detail::refine::Refinement;
use splatref::scene::objects::{Geometry, Motion, Object, Objects};
use splatref::scene::{Camera, Cloud, Primitives, Scene, Similarity, Surfels, Triangles};
use splatref::source::candidates::{Candidates, Directions, candidates};
use splatref::source::flatten;
use splatref::source::sampler::{Graph, Greedy, Start, estimate};
use splatref::verify::metrics::{Coverage, coverage};

/// Triangles under a headlight.
pub(crate) fn mesh(triangles: Triangles) -> Scene {
    let primitives = Primitives { triangles, ..Primitives::default() };
    Scene { primitives, ..Scene::lit("mesh", Surfels::none()) }
}

/// So many of the points that are seen of a mesh from directions, in pictures of a side, in the greedy order
/// from point 0.
pub(crate) fn order(
    mesh: &Scene,
    (directions, side): (&Directions, u32),
    count: usize,
    exec: &Exec,
) -> Result<Cloud> {
    let quiet = |_: &str, _, _| ();
    let cloud = candidates(mesh, directions, side, exec, &quiet)?.cloud;
    let greedy = Greedy { start: Start::Index(0) };
    let order = greedy.order(&cloud.position, count, exec, &quiet)?;
    let cloud = cloud.some(&order.index);
    // Radii are chosen by views.
    Ok(Cloud { radius: Some(vec![1.0; cloud.position.len()]), ..cloud })
}

/// The same along the surface: neighbours are within two pixels.
pub(crate) fn order_along(
    mesh: &Scene,
    (directions, side): (&Directions, u32),
    count: usize,
    exec: &Exec,
) -> Result<Cloud> {
    let quiet = |_: &str, _, _| ();
    let Candidates { cloud, pixel, .. } = candidates(mesh, directions, side, exec, &quiet)?;
    let normals = cloud.normal.as_deref().unwrap_or_default();
    let graph = Graph::new(&cloud.position, normals, (2.0 * pixel) as f32, exec, &quiet)?;
    let greedy = Greedy { start: Start::Index(0) };
    let cloud = cloud.some(&greedy.along(&graph, count, &quiet)?.index);
    Ok(Cloud { radius: Some(vec![1.0; cloud.position.len()]), ..cloud })
}

/// A geometry of points in an order, and of the triangles that take their place close by.
pub(crate) fn geometry(order: Cloud, primitives: Primitives) -> Result<Geometry> {
    let (surfels, _) = Surfels::new(order)?;
    let estimate = estimate(surfels.position(), surfels.normal());
    let plain = Geometry { name: "order".into(), surfels, primitives, detail: None };
    plain.with_prefix(estimate)
}

/// An object of a geometry for each place.
pub(crate) fn objects(geometry: Geometry, places: &[Similarity]) -> Result<Objects> {
    let all = places.iter().map(|place| Object {
        name: "object".into(),
        geometry: 0,
        motion: Motion::still(*place),
        color: None,
    });
    Objects::new(vec![geometry], all.collect(), [0.75; 3].into())
}

/// What a camera asks of objects, as a scene of surfels.
pub(crate) fn seen(
    objects: &Objects,
    surfel_size: f32,
    camera: &Camera,
    exec: &Exec,
) -> Result<Scene> {
    let asked = Refinement { surfel_size, ..Refinement::default() };
    let objects = objects.clone().with_refinement(asked)?.seen_from(camera, exec)?;
    flatten(&Scene { objects: Some(objects), ..Scene::lit("order", Surfels::none()) }, exec)
}

/// The picture of a scene.
pub(crate) fn draw(
    scene: &Scene,
    method: Method,
    camera: &Camera,
    exec: &Exec,
) -> Result<Frame<f32>> {
    Ok(Session::new(scene, method, exec)?.render(camera)?.frame.clone())
}

/// Both sides of everything: walls are seen from behind, too.
pub(crate) fn blue() -> Method {
    blue::Settings::default().into()
}

/// Where a picture shows something.
pub(crate) fn alpha(frame: &Frame<f32>) -> &[f32] {
    match frame.plane("A") {
        Some(Samples::Scalar(plane)) => plane.values(),
        _ => &[],
    }
}

/// Holes and spill of a picture against that of the mesh.
pub(crate) fn against(found: &Frame<f32>, truth: &Frame<f32>) -> Coverage {
    coverage(alpha(found), alpha(truth), truth.width as usize)
}

/// A part in hundredths of a whole.
pub(crate) fn percent(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}
