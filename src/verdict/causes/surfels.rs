//! Mistakes with the surfels that are drawn: their normals and their radii.

use super::change::Change;
use super::depths::digits;
use crate::method::{Method, Session};
use crate::scene::{Camera, Scene, Surfels};
use crate::setting::{Fields, Value};
use crate::splat::Epsilon;
use crate::verdict::client::Client;
use glam::{Mat3, Vec3};
use std::sync::Arc;

/// Normals that reach view space another way, and the mistakes in words. They are drawn so; the
/// sums keep the normals of the scene.
pub(super) fn normals(session: &Session<'_>, camera: &Camera) -> Vec<(String, Change)> {
    let turned = Mat3::from_mat4(camera.view_from_world);
    let back = turned.transpose();
    let inwards = "fronts are culled, not backs, or normals point inwards";
    let all: [(&str, Mat3); 3] = [
        (inwards, -Mat3::IDENTITY),
        ("normals are turned by the transpose of the camera's rotation", back * back),
        ("normals are not turned to the camera: they stay in world space", back),
    ];
    let change = |(what, by): (&str, Mat3)| {
        let other = of_normals(session.scene(), |normal| by * normal)?;
        // The projection to single pixels hands its normals on; the others keep the scene's.
        let change = match session.method() {
            // The sums have the normals as they were turned.
            _ if what == inwards => Change::Scene(Box::new(other), *session.method()),
            Method::Pyramid(_) | Method::Template(_) => {
                Change::Scene(Box::new(other), *session.method())
            }
            _ => Change::Drawn(Arc::new((other, *camera))),
        };
        Some((what.to_owned(), change))
    };
    all.into_iter().filter_map(change).collect()
}

/// Each of these surfels is missing, and the mistake in words.
pub(super) fn missing(
    session: &Session<'_>,
    camera: &Camera,
    some: impl Iterator<Item = u32>,
) -> Vec<(String, Change)> {
    // A place behind the camera is not drawn.
    let behind = camera.view_from_world.inverse().transform_point3(Vec3::Z);
    let change = |surfel: u32| {
        let mut cloud = session.scene().surfels.clone().into_cloud();
        *cloud.position.get_mut(surfel as usize)? = behind;
        let other = with(session.scene(), Surfels::new(cloud).ok()?.0)?;
        let change = Change::Drawn(Arc::new((other, *camera)));
        Some((format!("surfel {surfel} is missing"), change))
    };
    some.filter_map(change).collect()
}

/// Radii that are too large or too small by one factor, if the client hands on the radii of its surfels.
/// Copied numbers are right or wrong, so that no search finds the factor.
pub(super) fn scaled(session: &Session<'_>, client: &Client) -> Option<(String, Change)> {
    let frame = client.frame();
    let ids = frame.index("projection.id").ok()?;
    let radii = frame.scalar("projection.radius").ok()?;
    let right = session.scene().surfels.radius();
    let ratio = |(id, radius): (&u32, &f64)| Some(radius / f64::from(*right.get(*id as usize)?));
    let mut ratios: Vec<f64> = ids.values().iter().zip(radii.values()).filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let by = digits(*ratios.get(ratios.len() / 2)?);
    // Another scene is a copy of all surfels.
    if by == 1.0 {
        return None;
    }
    let change = of_radii(session, |radius| radius * by as f32)?;
    Some((format!("radii are {by} times as large"), change))
}

/// The scene with other normals.
fn of_normals(scene: &Scene, of: impl Fn(Vec3) -> Vec3) -> Option<Scene> {
    let mut cloud = scene.surfels.clone().into_cloud();
    cloud.normal.as_mut()?.iter_mut().for_each(|normal| *normal = of(*normal));
    with(scene, Surfels::new(cloud).ok()?.0)
}

/// The scene with these surfels, if they are as many.
fn with(scene: &Scene, surfels: Surfels) -> Option<Scene> {
    (surfels.len() == scene.surfels.len()).then(|| Scene { surfels, ..scene.clone() })
}

/// The scene with other radii, and the method whose epsilon stays the same.
pub(super) fn of_radii(session: &Session<'_>, of: impl Fn(f32) -> f32) -> Option<Change> {
    let scene = session.scene();
    let mut cloud = scene.surfels.clone().into_cloud();
    let radii = cloud.radius.as_mut()?;
    if let Some(tangents) = &mut cloud.tangents {
        for (both, radius) in tangents.iter_mut().zip(&*radii) {
            let by = of(*radius) / radius;
            both.iter_mut().for_each(|tangent| *tangent *= by);
        }
    }
    radii.iter_mut().for_each(|radius| *radius = of(*radius));
    let other = with(scene, Surfels::new(cloud).ok()?.0)?;
    let mut method = *session.method();
    if let Some(splats) = method.splats()
        && let Epsilon::MedianRadii(_) = splats.epsilon
    {
        let epsilon = splats.epsilon.resolve(&scene.surfels);
        method.set("epsilon", &Value::Text(format!("{epsilon:?}"))).ok()?;
    }
    Some(Change::Scene(Box::new(other), method))
}
