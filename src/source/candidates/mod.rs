//! Turn the visible surface of a mesh into points, from which the
//! [samplers](crate::source::sampler) choose \[BJFM19, 3.1\].
//!
//! Call [`candidates()`] for a scene, or [`of_cloud`] for a mesh with a texture. The triangles are
//! drawn into one picture for each direction, "orthographic \[...\] directed to the center of the
//! node". Every covered pixel becomes a candidate: the position, normal, colour, opacity and
//! further properties of the nearest surface there. A surface that no direction sees has no
//! candidates.
//!
//! # How candidates are computed
//!
//! The **camera** of a direction d is computed in f64, in the terms of [`crate::scene::camera`].
//! Let low and high be the corners of the box around the triangles' vertices ([`Scene::bounds`]),
//! and n the side of the picture in pixels:
//!
//! ```text
//!   center = (low + high) / 2      R = |high - low| / 2, or 1 if that is 0
//!   camera = Camera::framing(n, n, (center, R), d, Lens::Orthographic(2 R))
//! ```
//!
//! The sphere around the box then touches the borders, and a pixel has the side 2 R / n in every
//! picture.
//!
//! The **picture** is drawn by [`crate::method::projection`] in `f32`, without culling, with
//! corners snapped to 1/256 px. The normal belongs to the side that is seen.
//!
//! A **candidate** comes from a covered pixel. Let p be the positions of the corners of the
//! sample's triangle, and m the sample's normal. The weights c of the corners at the pixel are
//! defined in [`crate::method::projection::primitives`]; the position is interpolated with them
//! like every attribute, in `f32`. V(i,j) is the element of row i and column j of the view matrix.
//! The normal is computed in f64, and each component is rounded to `f32` once:
//!
//! ```text
//!   position  = ((c_0 p_0 + c_1 p_1) + c_2 p_2) + 0
//!   normal(j) = ((V0j m.x + V1j m.y) + V2j m.z) + 0
//! ```
//!
//! The colour is the sample's colour, if the triangles have colours. For a mesh with a texture
//! ([`of_cloud`]) it is the [mean](crate::scene::texture) of the texture around
//!
//! ```text
//!   (u, v)    = (t_0 c_0 + t_1 c_1) + t_2 c_2          t the coordinates of the corners; in f64
//! ```
//!
//! within the outline of a disc in the triangle's plane, whose radius is the side of a pixel. In
//! the terms of [`crate::source::derive`], the matrix is (S (1 / A)) times the square of that side.
//!
//! **Opacity and further properties** of the [vertices](crate::scene::Vertices) ("further
//! properties can be captured in additional buffers, like PBR material parameters" \[BJFM19, 3.1\])
//! are interpolated like every attribute, in `f32`, from the values a at the corners:
//!
//! ```text
//!   property = ((c_0 a_0 + c_1 a_1) + c_2 a_2) + 0          opacity = 1 if the same of it is > 1
//! ```
//!
//! If only some objects have opacities, the others have 1. A property must belong to all objects or
//! to none ([`join`]). A triangle is ignored if the opacity of a corner is not in [0, 1], or if a
//! property is not finite.
//!
//! **Order**: by direction, row, column. A candidate is dropped and counted if its normal is null,
//! because opposite normals of corners cancel, or if its colour or a property is not finite.
//!
//! # Decided
//!
//! - Opacity is a property like others: a picture shows the nearest surface, however transparent it
//!   is. The paper's scenes are opaque ("if they \[...\] only produce opaque surfaces"). A surface
//!   behind a transparent one is a surface of its own, which other directions may see.
//! - The position is the point on the triangle, as in the position buffer of \[BJFM19\]. It is not
//!   the point of the pixel's centre at the sample's depth, because corners are snapped, so that
//!   this point lies beside a steep triangle.
//! - [`Directions::Cube`] is the default; [`Directions::Box`] is the paper's choice. From the
//!   corners of a box, a flat mesh is seen edge-on and has no candidates. The ends of a bar ten
//!   times as long as wide and high get ten times as many candidates an area as its sides; with the
//!   cube they get as many.
//! - A texture is filtered: "samples are taken \[...\] from pixels with colors of minor importance"
//!   \[BJFM19, section 6, Fig. 4\] where a pixel has the colour of one texel. The disc does not
//!   depend on the direction, so that a place has one colour, from wherever it is seen. The weight
//!   within the disc has the variance of 1/8 of a pixel's square along each axis; the variance of
//!   the square itself is 1/12.
//! - Both sides of a triangle are seen, because meshes of leaves and of sheet metal are not closed.
//! - Lines have no area and give no candidates; a scene of nothing but lines is refused.

mod painted;
mod properties;

pub use painted::of_cloud;

use crate::error::{Error, Result};
use crate::frame::raster::Snap;
use crate::frame::{Exec, NO_ID};
use crate::memory;
use crate::method::projection::{Foremost, PixelSample, SHARES, VisibleTriangles};
use crate::number::{MapInline, Vector3};
use crate::progress::Progress;
use crate::scene::merge::join;
use crate::scene::{Camera, Cloud, Lens, Primitives, Scene, Sphere, Surfels};
use glam::{DMat4, DVec3, DVec4, Vec3};
use painted::Painting;
use properties::Properties;
use std::borrow::Cow;

/// The default side of a picture in pixels, as in the paper.
pub const SIDE: u32 = 1024;

/// The directions from which a mesh is seen: vectors from its middle, of any length from about
/// 1e-150 to 1e150.
#[derive(Clone, Debug, PartialEq)]
pub enum Directions {
    /// (-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1), then the same with z = 1.
    Cube,
    /// The same with the half extents of the box around the mesh in place of 1: its eight corners.
    Box,
    /// The given directions.
    These(Vec<DVec3>),
}

/// The candidates of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    /// Positions and normals; colours, opacities and further properties if the mesh has them.
    pub cloud: Cloud,
    /// How many candidates each direction gave.
    pub counts: Vec<u32>,
    /// The side of a pixel in world units.
    pub pixel: f64,
    /// How many candidates were dropped.
    pub dropped: u64,
}

/// The candidates of the triangles of a scene, or of its objects in their places. `progress` gets
/// the name of the step, the number of directions done, and their total.
///
/// # Errors
/// [`Error::Invalid`] in these cases:
///
/// - as [`join`];
/// - the scene has no triangles, or none of them covers a pixel's centre;
/// - there is no direction, or one is null or not finite, or so short or long that its square
///   rounds to 0 or exceeds f64;
/// - as [`Camera::new`] (no direction may be within about 1e-6 of the y axis without being on it);
/// - there are 2^32 - 1 candidates or more, or the process may not hold them.
pub fn candidates(
    scene: &Scene,
    directions: &Directions,
    side: u32,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Candidates> {
    let scene = mesh(scene)?;
    gather(&Mesh { scene: &scene, painting: None }, directions, side, exec, progress)
}

/// A scene of triangles only, and its texture.
struct Mesh<'a> {
    scene: &'a Scene,
    painting: Option<&'a Painting>,
}

fn gather(
    mesh: &Mesh<'_>,
    directions: &Directions,
    side: u32,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Candidates> {
    let (low, high) = mesh.scene.bounds();
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let half = (high - low) / 2.0;
    let radius = if half == DVec3::ZERO { 1.0 } else { half.length() };
    let sphere = Sphere { center: (low + high) / 2.0, radius };
    let directions = directions.around(half)?;
    let colored = mesh.painting.is_some() || mesh.scene.primitives.colored();
    let mut found = Candidates {
        cloud: Cloud {
            normal: Some(Vec::new()),
            color: colored.then(Vec::new),
            ..Properties::from_scene(mesh.scene).of_none()
        },
        counts: Vec::new(),
        pixel: 2.0 * radius / f64::from(side),
        dropped: 0,
    };
    for (done, &direction) in (0..).zip(&directions) {
        progress("sampling the surface", done, directions.len() as u64);
        let camera =
            Camera::framing(side, side, sphere, direction, Lens::Orthographic(2.0 * radius))?;
        found.add(mesh, &camera, exec)?;
    }
    progress("sampling the surface", directions.len() as u64, directions.len() as u64);
    if found.cloud.position.is_empty() {
        let what = "no triangle covers the centre of a pixel from any direction, because all are \
                    too small or seen edge-on; give a larger --side";
        return Err(Error::Invalid(what.into()));
    }
    Ok(found)
}

/// A scene with only the triangles of this scene.
fn mesh(scene: &Scene) -> Result<Cow<'_, Scene>> {
    let triangles = match &scene.objects {
        Some(objects) => join(objects.primitives()?, objects.fill())?.triangles,
        None if scene.surfels.is_empty()
            && scene.primitives.len() == scene.primitives.triangles.len() =>
        {
            return some(Cow::Borrowed(scene));
        }
        None => scene.primitives.triangles.clone(),
    };
    let primitives = Primitives { triangles, ..Primitives::default() };
    some(Cow::Owned(Scene { primitives, ..Scene::unlit(&scene.name, Surfels::none()) }))
}

/// Refuses a mesh without triangles.
fn some(mesh: Cow<'_, Scene>) -> Result<Cow<'_, Scene>> {
    match mesh.primitives.triangles.is_empty() {
        true => Err(Error::Invalid("there are no triangles to sample".into())),
        false => Ok(mesh),
    }
}

impl Directions {
    /// The vectors; `half` is the half extents of the box.
    fn around(&self, half: DVec3) -> Result<Vec<DVec3>> {
        let corners = |half: DVec3| {
            let sign = |i: u32, axis: u32| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
            (0..8).map(|i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * half).collect()
        };
        let all: Vec<DVec3> = match self {
            Self::Cube => corners(DVec3::ONE),
            Self::Box => corners(half),
            Self::These(all) => all.clone(),
        };
        if all.is_empty() {
            return Err(Error::Invalid("there are no directions to sample from".into()));
        }
        match all.iter().find(|d| !(d.is_finite() && d.length_squared() > 0.0)) {
            None => Ok(all),
            Some(d) => Err(Error::Invalid(format!(
                "the direction {}, {}, {} must be finite and not 0",
                d.x, d.y, d.z
            ))),
        }
    }
}

/// Bytes of a pixel of the pictures of one direction, and of a candidate while its array grows.
const OF_A_PIXEL: u64 = (SHARES + 1) as u64 * size_of::<Foremost<f32>>() as u64;
const OF_A_CANDIDATE: u64 = 2 * 36 + 60;
/// Bytes of a vertex in view space.
const OF_A_VERTEX: u64 = 20;

impl Candidates {
    /// Adds the candidates that a camera sees.
    fn add(&mut self, mesh: &Mesh<'_>, camera: &Camera, exec: &Exec) -> Result<()> {
        let pixels = u64::from(camera.width) * u64::from(camera.height);
        let vertices = mesh.scene.primitives.triangles.vertices().position.len() as u64;
        // Every pixel may be covered.
        let properties = Properties::from_scene(mesh.scene);
        let of_a_pixel = OF_A_PIXEL + OF_A_CANDIDATE + 8 * properties.count();
        memory::ask(pixels * of_a_pixel + vertices * OF_A_VERTEX, || {
            format!("a picture of {pixels} pixels for candidates")
        })?;
        let before = self.cloud.position.len();
        let mut numbers = Vec::new();
        for Seen { normal, position, color, id, weights } in seen(mesh, self.pixel, camera, exec) {
            let corners = mesh.scene.primitives.triangles.corners()[id as usize];
            properties.at(corners, weights, &mut numbers);
            let finite = color.is_finite() && numbers.iter().all(|number| number.is_finite());
            if normal == Vec3::ZERO || !finite {
                self.dropped += 1;
                continue;
            }
            properties::push(&mut self.cloud, &numbers);
            self.cloud.position.push(position);
            self.cloud.normal.iter_mut().for_each(|all| all.push(normal));
            self.cloud.color.iter_mut().for_each(|all| all.push(color));
        }
        let after = self.cloud.position.len();
        if after as u64 >= u64::from(u32::MAX) {
            return Err(Error::Invalid(format!("{after} candidates, but ids have 32 bits")));
        }
        self.counts.push((after - before) as u32);
        Ok(())
    }
}

/// The nearest surface at a covered pixel.
struct Seen {
    normal: Vec3,
    position: Vec3,
    color: Vec3,
    /// The triangle, and the weights of its corners.
    id: u32,
    weights: [f32; 3],
}

/// The nearest surface at each covered pixel, in the order of the pixels; `side` is the side of a
/// pixel.
fn seen(mesh: &Mesh<'_>, side: f64, camera: &Camera, exec: &Exec) -> Vec<Seen> {
    let columns = camera.width as usize;
    let visible = VisibleTriangles::<f32>::new(mesh.scene, camera, Snap::default());
    let foremost = visible.foremost(exec);
    let covered: Vec<usize> = (0..foremost.len()).filter(|&i| foremost[i].1 != NO_ID).collect();
    let triangles = &mesh.scene.primitives.triangles;
    let view = camera.view_from_world.as_dmat4();
    let mut all = Vec::with_capacity(covered.len());
    exec.extend(&mut all, covered.len(), |at| {
        let (i, (_, id)) = (covered[at], foremost[covered[at]]);
        let corners = triangles.corners()[id as usize];
        let [a, b, c] = corners.map_inline(|corner| triangles.vertices().position[corner as usize]);
        let pixel = ((i % columns) as u32, (i / columns) as u32);
        // The nearest triangle of a pixel covers it, so the fallback is never used.
        let (sample, w) = visible.sample(id, pixel).unwrap_or((PixelSample::empty(), [0.0; 3]));
        let position = ((a * w[0] + b * w[1]) + c * w[2]) + Vec3::ZERO;
        let color = mesh.painting.map(|painting| painting.color(id, w, side));
        let color = color.unwrap_or(Vec3::from_array(sample.color));
        Seen { normal: turned(&view, sample.normal), position, color, id, weights: w }
    });
    all
}

/// Turns a direction from view space to world space.
fn turned(view: &DMat4, v: Vector3<f32>) -> Vec3 {
    let v = v.map(f64::from);
    let column = |c: DVec4| (((c.x * v.x + c.y * v.y) + c.z * v.z) + 0.0) as f32;
    let [x, y, z] = [view.x_axis, view.y_axis, view.z_axis].map_inline(column);
    Vec3::new(x, y, z)
}

#[cfg(test)]
mod tests;
