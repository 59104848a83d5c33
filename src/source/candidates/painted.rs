//! Take candidates from meshes with a texture.

use super::{Candidates, Directions, Mesh};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::MapInline;
use crate::progress::Progress;
use crate::scene::texture::Ellipse;
use crate::scene::{Cloud, Paint, Primitives, Scene, Surfels};
use crate::source::derive::{self, Derived, stretch};
use glam::{DVec2, Vec2, Vec3};

/// The candidates of the triangles of a cloud, drawn as [`derive::polygons`], and a report of
/// derived and dropped attributes. Colours come from the cloud's texture if that has been
/// [read](Cloud::paint), else from its points. Opacities and [further
/// properties](Cloud::properties) come from its points.
///
/// A triangle is dropped and counted if a texture coordinate is not finite.
///
/// # Errors
/// As [`derive::polygons`] and [`super::candidates`]; [`Error::Invalid`] if every triangle is dropped.
pub fn of_cloud(
    mut cloud: Cloud,
    directions: &Directions,
    side: u32,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Candidates, Derived)> {
    cloud.check()?;
    let before = cloud.triangles.len();
    if cloud.paint.is_some() {
        // The corners before and after, and their places in the texture.
        let bytes = size_of::<Painted>() as u64 + 2 * 12 + 24;
        memory::ask(before as u64 * bytes, || format!("the texture of {before} triangles"))?;
    }
    // Drop these first, because the corners noted below need the final numbers of points.
    derive::drop_unsound(&mut cloud)?;
    let lifted = lift(&mut cloud)?;
    let dropped = (before - cloud.triangles.len()) as u64;
    let (triangles, mut derived) = derive::polygons(cloud, exec, progress)?;
    derived.dropped_primitives += dropped;
    let painting = lifted.map(|Lifted { paint, corners, at }| {
        // Whether a triangle was dropped depends on its corners alone, so triangles with equal
        // corners were dropped or kept together.
        let mut kept = triangles.corners().iter().peekable();
        let position = &triangles.vertices().position;
        let painted = corners.iter().zip(at).filter_map(|(corners, at)| {
            kept.next_if_eq(&corners)?;
            let places = corners.map_inline(|corner| position[corner as usize]);
            Some(Painted { at, disc: stretch(places, at) })
        });
        Painting { paint, painted: painted.collect() }
    });
    let primitives = Primitives { triangles, ..Primitives::default() };
    let scene = Scene { primitives, ..Scene::unlit("mesh", Surfels::none()) };
    let mesh = Mesh { scene: &scene, painting: painting.as_ref() };
    Ok((super::gather(&mesh, directions, side, exec, progress)?, derived))
}

/// A texture, the corners of triangles, and the places of these corners in the texture.
struct Lifted {
    paint: Paint,
    corners: Vec<[u32; 3]>,
    at: Vec<[Vec2; 3]>,
}

/// Takes the texture from a cloud, and drops points and triangles that cannot have candidates.
fn lift(cloud: &mut Cloud) -> Result<Option<Lifted>> {
    let (Some(paint), Some(_)) = (cloud.paint.take(), &cloud.coordinates) else { return Ok(None) };
    let before = cloud.triangles.len();
    let keep: Vec<bool> = cloud.position.iter().map(|place| place.is_finite()).collect();
    cloud.retain(&keep);
    let Some(coordinates) = cloud.coordinates.take() else { return Ok(None) };
    (cloud.color, cloud.mipmap, cloud.triangle_color) = (None, None, None);
    let finite = |at: &[Vec2; 3]| at.iter().all(|at| at.is_finite());
    let all = std::mem::take(&mut cloud.triangles).into_iter().enumerate();
    let all = all.map(|(i, corners)| (corners, coordinates.corners(i, corners)));
    let (corners, at): (Vec<_>, Vec<_>) = all.filter(|(_, at)| finite(at)).unzip();
    if corners.is_empty() && before > 0 {
        let what =
            format!("none of its {before} triangles has finite places and texture coordinates");
        return Err(Error::Invalid(format!("the scene is empty: {what}")));
    }
    cloud.triangles.clone_from(&corners);
    Ok(Some(Lifted { paint, corners, at }))
}

/// A texture on the triangles of a scene.
pub(super) struct Painting {
    paint: Paint,
    painted: Vec<Painted>,
}

/// A triangle in a texture: its corners, and the outline of a disc of radius 1 in its plane.
struct Painted {
    at: [Vec2; 3],
    disc: Ellipse,
}

impl Painting {
    /// The mean colour within a disc of this radius, at the point of a triangle where its corners
    /// have these weights.
    pub(super) fn color(&self, triangle: u32, weights: [f32; 3], radius: f64) -> Vec3 {
        let Painted { at, disc } = &self.painted[triangle as usize];
        let [a, b, c]: [DVec2; 3] =
            [0, 1, 2].map_inline(|i| at[i].as_dvec2() * f64::from(weights[i]));
        self.paint.color((a + b) + c, disc.times(radius * radius))
    }
}

#[cfg(test)]
mod tests;
