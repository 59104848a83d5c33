//! Meshes with a texture.

use super::{Candidates, Directions, Mesh};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::scene::texture::Ellipse;
use crate::scene::{Cloud, Paint, Primitives, Scene, Surfels};
use crate::source::derive::{self, Derived, stretch};
use glam::{DVec2, Vec2, Vec3};

/// The candidates of the triangles of a cloud, drawn as [`derive::polygons`], in the colours of its texture if that has been
/// [read](Cloud::paint), else in those of its points; and what was derived and dropped on the way.
///
/// A triangle of which a texture coordinate is not finite is dropped and counted.
///
/// # Errors
/// As [`derive::polygons`] and [`super::candidates`]; [`Error::Invalid`] if every triangle is dropped.
pub fn of_cloud(
    mut cloud: Cloud,
    directions: &Directions,
    side: u32,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Candidates, Derived)> {
    cloud.check()?;
    let before = cloud.triangles.len();
    let texture = lift(&mut cloud);
    if cloud.triangles.is_empty() && before > 0 {
        let what =
            format!("none of its {before} triangles has finite places and texture coordinates");
        return Err(Error::Invalid(format!("the scene is empty: {what}")));
    }
    let (given, lifted) = (cloud.triangles.clone(), before - cloud.triangles.len());
    let (triangles, mut derived) = derive::polygons(cloud, exec, progress)?;
    derived.dropped_primitives += lifted as u64;
    let paint = match texture {
        None => None,
        Some((paint, at)) => {
            let (count, bytes) = (given.len(), size_of::<Painted>() as u64);
            memory::ask(count as u64 * bytes, || format!("the texture of {count} triangles"))?;
            // Which were dropped depends on their corners alone, so that equal ones share their fate.
            let mut kept = triangles.corners().iter().peekable();
            let position = &triangles.vertices().position;
            let painted = given.iter().zip(at).filter_map(|(corners, at)| {
                kept.next_if_eq(&corners)?;
                let places = corners.map(|corner| position[corner as usize]);
                Some(Painted { at, disc: stretch(places, at) })
            });
            let painted = painted.collect();
            Some(Painting { paint, painted })
        }
    };
    let primitives = Primitives { triangles, ..Primitives::default() };
    let scene = Scene { primitives, ..Scene::unlit("mesh", Surfels::none()) };
    let mesh = Mesh { scene: &scene, painting: paint.as_ref() };
    Ok((super::gather(&mesh, directions, side, exec, progress)?, derived))
}

/// Takes a texture and its coordinates from a cloud, of which points and triangles that can have no candidates are dropped.
fn lift(cloud: &mut Cloud) -> Option<(Paint, Vec<[Vec2; 3]>)> {
    cloud.coordinates.as_ref()?;
    let paint = cloud.paint.take()?;
    let keep: Vec<bool> = cloud.position.iter().map(|place| place.is_finite()).collect();
    // With none left the cloud is refused later.
    if keep.contains(&true) {
        cloud.retain(&keep);
    }
    (cloud.color, cloud.mipmap) = (None, None);
    let coordinates = cloud.coordinates.take()?;
    let finite = |at: &[Vec2; 3]| at.iter().all(|at| at.is_finite());
    let all = std::mem::take(&mut cloud.triangles).into_iter().enumerate();
    let all = all.map(|(i, corners)| (corners, coordinates.of(i, corners)));
    let (triangles, at) = all.filter(|(_, at)| finite(at)).unzip();
    cloud.triangles = triangles;
    Some((paint, at))
}

/// A texture on the triangles of a scene.
pub(super) struct Painting {
    paint: Paint,
    painted: Vec<Painted>,
}

/// A triangle in a texture: its corners, and what a disc of radius 1 in its plane becomes.
struct Painted {
    at: [Vec2; 3],
    disc: Ellipse,
}

impl Painting {
    /// The colour in a triangle where its corners have these weights, within a disc of this radius.
    pub(super) fn color(&self, triangle: u32, weights: [f32; 3], radius: f64) -> Vec3 {
        let Painted { at, disc } = &self.painted[triangle as usize];
        let [a, b, c]: [DVec2; 3] = [0, 1, 2].map(|i| at[i].as_dvec2() * f64::from(weights[i]));
        self.paint.color((a + b) + c, disc.times(radius * radius))
    }
}

#[cfg(test)]
mod tests;
